"""A Python file as text and as a tree."""
from __future__ import annotations

import os
import tokenize
import warnings

from s2sad import tree
from s2sad.diagnostics import Diagnostic, S2sadError, Source, Span

_SYNTAX_HELP = "correct the line; the file must be one that Python itself can read"


def read_text(path: str) -> str:
    """A Python file's text; raises S2sadError (S101) where there is none."""
    def fail(message: str, help: str) -> S2sadError:
        return S2sadError(Diagnostic("S101", f"{path}: {message}", help=help))
    if os.path.isdir(path):
        raise fail("this is a directory", "give a Python file: kernel.py:function")
    try:
        with tokenize.open(path) as file:
            return file.read()
    except FileNotFoundError:
        raise fail("no such file", "check the path, which is relative to the working directory") from None
    except UnicodeDecodeError as error:
        raise fail(f"not UTF-8 (byte 0x{error.object[error.start]:02x})", "save the file as UTF-8, or name its "
                   "encoding in the first line: # -*- coding: latin-1 -*-") from None
    except SyntaxError:
        raise fail("not UTF-8, or an unknown encoding is named in its first lines", "save the file as UTF-8") from None
    except OSError as error:
        raise fail(f"cannot be read ({error.strerror})", "check the file's permissions") from None


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
    except (ValueError, RecursionError, MemoryError):
        raise S2sadError(Diagnostic("S102", f"{source.path}: not Python: a null byte, or nesting too deep",
                                    help=_SYNTAX_HELP)) from None
