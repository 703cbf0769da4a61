"""What an exception of generated code means: a guard that fails is refused with the kernel's line and what it
compared, what a signal's handler raised is raised as it is, and the kernel's own exceptions stay as they are.

Guards raise AssertionError with their message, their line in the generated text and what they compared (`load`).
"""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import TracebackType

from s2sad.diagnostics import Diagnostic, S2sadError, S2sadIndexError, S2sadValueError
from s2sad.program import TextGuard, SourcePlace

CAUGHT = (AssertionError, MemoryError, OSError, SystemError, ValueError)      # the exceptions that may have a `meaning`


class ExceptionMeanings:
    """What the exceptions of one generated module mean; `kernel` is the kernel's name."""

    def __init__(self, facts: Mapping[str, object], path: str, kernel: str):
        self.guards: Mapping[int, TextGuard] = facts.get("guards", {})  # pyright: ignore[reportAttributeAccessIssue]
        self.places: Mapping[int, SourcePlace] = facts.get("places", {})  # pyright: ignore[reportAttributeAccessIssue]
        self.folders: tuple[str, ...] = facts.get("folders", ())  # pyright: ignore[reportAttributeAccessIssue]
        self.path, self.kernel = path, kernel

    def meaning(self, error: BaseException) -> BaseException:
        """What to raise in place of an exception; the exception itself where it has the meaning."""
        if isinstance(error, SystemError) and error.__cause__ is not None:
            return error.__cause__      # a handler raised while compiled code ran, which gave a result all the same
        if isinstance(error, AssertionError) and len(error.args) > 1 and error.args[1] in self.guards:
            return _refused(self.guards[error.args[1]], error.args[2:], self.kernel)
        if isinstance(error, OSError) and self.folders:
            return no_room(self.kernel, self.folders, str(error.strerror))
        if type(error) is ValueError and (place := self._place(error.__traceback__)) is not None:
            return S2sadValueError(Diagnostic("S501", str(error), place.span()))
        return error

    def of_index(self, error: IndexError, line: int) -> IndexError:
        """What to raise for an index out of bounds in a line of the text; the kernel's own exceptions as they are."""
        place = self.places.get(line)
        return error if place is None else S2sadIndexError(Diagnostic("S501", str(error), place.span()))

    def _place(self, traceback: TracebackType | None) -> SourcePlace | None:
        """Where NumPy raised for a statement of the kernel; None where the kernel itself did, or another function."""
        found = None
        while traceback is not None:
            frame = traceback.tb_frame
            if frame.f_code.co_filename == self.path:
                found = self.places.get(traceback.tb_lineno)
            elif found is not None and not _is_library(frame.f_globals.get("__name__", "")):
                return None
            traceback = traceback.tb_next
        return found


def no_room(kernel: str, folders: Sequence[str], reason: str) -> S2sadError:
    """The error where the folders of a kernel's snapshots cannot hold them."""
    return S2sadError(Diagnostic("S407", f"snapshots of '{kernel}' cannot be written: {reason}",
                                 note=f"the folder is {' or '.join(folders)}",
                                 help="give a folder with room for them, or keep fewer"))


def _is_library(module: str) -> bool:
    return module.partition(".")[0] in ("numpy", "scipy") or module.startswith("s2sad.runtime")


def _refused(guard: TextGuard, values: tuple[object, ...], kernel: str) -> S2sadError:
    """The error for a guard that does not hold for these values."""
    if guard.seed:
        result, seed = values
        return S2sadError(Diagnostic("S403", f"the seed '{guard.seed}' has shape {seed}, what '{kernel}' returns there "
                                     f"has {result}", help="give an array of its shape"))
    place = guard.place.span() if guard.place is not None else None
    note = ", ".join(f"{text} is {value}" for text, value in zip(guard.compared, values) if not _is_number(text))
    return S2sadValueError(Diagnostic("S501", guard.message, place, note, guard.help))


def _is_number(text: str) -> bool:
    return text.lstrip("-").isdigit()
