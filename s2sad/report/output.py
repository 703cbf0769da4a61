"""Where the command's texts go: to standard output, or to a file that is written beside and renamed."""
from __future__ import annotations

import os
import stat
import sys
import tempfile
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

from s2sad.diagnostics import Diagnostic, S2sadError

_PRINTS = ("", ", or leave it out to print")
_FOLDER = "give -o a file in a folder that is there and can be written to"


def check_output(output: str | None, read: Iterable[str], option: str = "-o") -> None:
    """Refuses to write over one of the files that were read, under whatever name, and over what is no plain file;
    raises S2sadError (S407)."""
    found = None if output in (None, "-") else _status(output)
    if found is None:
        return
    if not stat.S_ISREG(found.st_mode):
        kind = "a directory" if stat.S_ISDIR(found.st_mode) else "no plain file"
        raise _refused(f"{output}: cannot be written (it is {kind})", f"give {option} a file{_PRINTS[option == '-o']}")
    for path in read:
        other = _status(path)
        if other is not None and os.path.samestat(found, other):
            same = "" if os.path.abspath(output or "") == os.path.abspath(path) else f", which is {path}"
            raise _refused(f"{output}: the function is read from this file{same}", f"give {option} another file")


def write_output(output: str | None, text: str | bytes) -> None:
    """Writes a text, to standard output for None or "-", or a picture; a file is never there by half.

    Raises S2sadError (S407) where it cannot be written, and BrokenPipeError where nobody reads any more.
    """
    if output is None or output == "-" and isinstance(text, str):
        _print(str(text))
        return
    path = Path(os.path.realpath(output))   # a link goes on to lead where it led
    try:
        handle, beside = tempfile.mkstemp(prefix=f".{path.name}."[:40], dir=path.parent)
        try:
            with os.fdopen(handle, "wb") as file:
                file.write(text.encode() if isinstance(text, str) else text)
            found = _status(str(path))
            os.chmod(beside, 0o666 & ~_umask() if found is None else stat.S_IMODE(found.st_mode))
            os.replace(beside, path)
        except BaseException:
            Path(beside).unlink(missing_ok=True)
            raise
    except (OSError, ValueError) as error:
        raise _refused(f"{output}: cannot be written ({_reason(error)})", _FOLDER) from None


def _print(text: str) -> None:
    try:
        try:
            sys.stdout.write(text)
        except UnicodeEncodeError:      # the terminal's encoding lacks a letter: a Python file is UTF-8
            sys.stdout.buffer.write(text.encode())
        sys.stdout.flush()
    except BrokenPipeError:
        raise
    except OSError as error:
        with suppress(OSError, ValueError):     # what is left in the buffer would be tried again at exit
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        raise _refused(f"standard output cannot be written ({_reason(error)})", "give -o a file") from None


def _refused(message: str, help: str) -> S2sadError:
    return S2sadError(Diagnostic("S407", message, help=help))


def _reason(error: Exception) -> str:
    return getattr(error, "strerror", None) or str(error)


def _status(path: str | None) -> os.stat_result | None:
    try:
        return os.stat(path or "")
    except (OSError, ValueError):
        return None


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
