"""Tracebacks without frames of this package: what a user sees is where they called, and what their kernel did.

Python adds the frame that raises, so one stays: that of the function which they called. `S2SAD_TRACEBACK=full` leaves
everything as it is. What goes wrong inside the compiler itself is an internal error, and keeps all of it.
"""
from __future__ import annotations

import functools
import os
import traceback
from collections.abc import Callable
from pathlib import Path
from types import TracebackType
from typing import ParamSpec, TypeVar

from s2sad.diagnostics import HOME, Diagnostic, S2sadError, WaitingForFacts

P = ParamSpec("P")
R = TypeVar("R")
_COMPILER = {"pipeline.py", "passes.py", "read", "evaluate", "normalize", "infer", "analyze", "differentiate",
             "simplify", "optimize", "emit", "units"}


def public(function: Callable[P, R]) -> Callable[P, R]:
    """The function, whose errors come without the frames inside."""
    @functools.wraps(function)
    def call(*args: P.args, **keywords: P.kwargs) -> R:
        try:
            return with_facts(function, *args, **keywords)
        except Exception as error:
            outside = shortened(error)
        try:
            raise outside
        finally:
            del outside                 # its traceback has this frame
    return call


def with_facts(function: Callable[P, R], *args: P.args, **keywords: P.kwargs) -> R:
    """The function's result, called again where its kernel waits for what it is given."""
    try:
        return function(*args, **keywords)
    except WaitingForFacts:
        return function(*args, **keywords)


def shortened(error: Exception) -> Exception:
    """The error, whose traceback leaves this package out."""
    if _of_compiler(error):
        found = internal(error)
        found.__cause__ = error         # with all that led to it
        return found
    if os.environ.get("S2SAD_TRACEBACK", "") != "full":
        error.__traceback__ = _outside(error.__traceback__)
        if isinstance(error, S2sadError):
            error.__suppress_context__ = True
            error.__cause__ = None
    return error


def internal(error: BaseException) -> S2sadError:
    """The S2sadError for an error inside the compiler, with its place."""
    frames = [f for f in traceback.extract_tb(error.__traceback__) if f.filename.startswith(HOME)]
    place = f", in {Path(frames[-1].filename).stem} (line {frames[-1].lineno})" if frames else ""
    return S2sadError(Diagnostic("S901", f"internal error: {type(error).__name__}: {error}{place}",
                                 help="this is a defect of s2sad: please report it with the function"))


def _of_compiler(error: Exception) -> bool:
    """Whether something went wrong while a derivative was made, and not while it ran."""
    if isinstance(error, (S2sadError, MemoryError)):
        return False
    rooms = {Path(f.filename).relative_to(HOME).parts[0] for f in traceback.extract_tb(error.__traceback__)
             if f.filename.startswith(HOME)}
    return bool(rooms & _COMPILER)


def _outside(inner: TracebackType | None) -> TracebackType | None:
    frames: list[TracebackType] = []
    while inner is not None:
        if not inner.tb_frame.f_code.co_filename.startswith(HOME):
            frames.append(inner)
        inner = inner.tb_next
    outside = None
    for one in reversed(frames):
        outside = TracebackType(outside, one.tb_frame, one.tb_lasti, one.tb_lineno)
    return outside
