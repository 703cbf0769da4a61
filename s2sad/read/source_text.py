"""A Python file as text and as a tree."""
from __future__ import annotations

import io
import os
import re
import tokenize
import warnings

from s2sad import tree
from s2sad.deep_stack import on_deep_stack
from s2sad.diagnostics import Diagnostic, S2sadError, Source, Span

_COOKIE = re.compile(rb"(?:[^\r\n]*\r?\n)??[^\r\n#]*#[^\r\n]*?coding[:=][ \t]*([-\w.]+)")
_SYNTAX_HELP = "correct the line; the file must be one that Python itself can read"


def read_text(path: str) -> str:
    """A Python file's text; raises S2sadError (S101) where there is none."""
    def fail(message: str, help: str) -> S2sadError:
        return S2sadError(Diagnostic("S101", f"{path}: {message}", help=help))
    if os.path.isdir(path):
        raise fail("this is a directory", "give a Python file: kernel.py:function")
    if os.path.exists(path) and not os.path.isfile(path):
        raise fail("this is no file, but a pipe or a device", "write the text to a file: kernel.py:function")
    try:
        with open(path, "rb") as file:
            content = file.read()
    except FileNotFoundError:
        raise fail("no such file", "check the path, which is relative to the working directory") from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise fail(f"cannot be read ({reason})", "check the file's path and its permissions") from None
    return _decoded(path, content)


def _decoded(path: str, content: bytes) -> str:
    """A file's text, in the encoding that it names; raises S2sadError (S101), with the place."""
    cookie = _COOKIE.match(content)
    try:
        encoding = tokenize.detect_encoding(io.BytesIO(content).readline)[0]
    except SyntaxError:
        encoding = "" if cookie else "utf-8"
    try:
        return io.StringIO(content.decode(encoding), newline=None).read()
    except UnicodeDecodeError as error:
        message, start, length = f"not {encoding.upper()} (byte 0x{content[error.start]:02x})", error.start, 1
        help = "save the file as UTF-8, or name its encoding in the first line: # -*- coding: latin-1 -*-"
    except (LookupError, UnicodeError):
        start, length = (cookie.start(1), len(cookie[1])) if cookie else (0, 1)
        message, help = "an encoding that Python does not read files in", "save the file as UTF-8"
    raise S2sadError(Diagnostic("S101", message, _place(path, content, start, length), help=help))


def _place(path: str, content: bytes, start: int, length: int) -> Span:
    """The place of bytes in a file that cannot be decoded: what can be is shown."""
    before = content[:start].decode("utf-8", "replace")
    text = before + content[start:].decode("utf-8", "replace")
    line = before.count("\n") + 1
    column = len(before) - before.rfind("\n") - 1
    return Span(Source(path, text), line, column, line, column + length)


def parsed(source: Source, text: str) -> tree.Module:
    """The tree of a file's text; raises S2sadError (S102), with the place, if it is not Python."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            compile(text, source.path, "exec", dont_inherit=True)
            return tree.parse(text)
    except SyntaxError as error:
        line = error.lineno or 1
        column = max(0, (error.offset or 1) - 1)
        end = error.end_offset - 1 if error.end_offset and error.end_lineno == line else column + 1
        place = Span(source, line, column, line, max(end, column + 1))
        raise S2sadError(Diagnostic("S102", f"not Python: {error.msg}", place, help=_SYNTAX_HELP)) from None
    except RecursionError:
        if not on_deep_stack():
            raise
        raise S2sadError(Diagnostic("S102", f"{source.path}: nesting too deep", help=_SYNTAX_HELP)) from None
    except (ValueError, MemoryError):
        raise S2sadError(Diagnostic("S102", f"{source.path}: not Python: a null byte, or nesting too deep",
                                    help=_SYNTAX_HELP)) from None
