"""Runtime functions that compiled code calls through Python, since Numba cannot compile them: what SciPy solves,
what NumPy draws, and memory that is mapped to files.

Compiled code that raises lets go of nothing that it holds: files that it has mapped are emptied then, by who calls it.
"""
from __future__ import annotations

import importlib
import tempfile
import threading
import weakref
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from typing import Any

from s2sad import runtime
from s2sad.run.lanes import lanes_on_stack
from s2sad.runtime.random_sequences import FUNCTIONS, TANGENTS, cleared


def _solving(numba: Any) -> Any:
    """`runtime.sparse_solve` for compiled code; its result has the type of the right side."""
    objmode, solve = numba.objmode, runtime.sparse_solve

    def solution(data, rows, columns, b, m, n, kept):
        return solve(data, rows, columns, b, m, n, kept)

    def typed(data, rows, columns, b, m, n, kept):
        kind = numba.types.Array(b.dtype, b.ndim, "C")

        def through_python(data, rows, columns, b, m, n, kept):
            with objmode(found=kind):  # Numba reads the type by its name
                found = solve(data, rows, columns, b, m, n, kept)
            return found  # noqa: RET504
        return through_python
    numba.extending.overload(solution)(typed)

    def sparse_solve(data, rows, columns, b, m, n, kept):
        return solution(data, rows, columns, b, m, n, kept)
    return numba.njit(sparse_solve)


def _mapping(numba: Any) -> Any:
    """`runtime.on_disk` for compiled code; its result has an axis more than the array."""
    objmode = numba.objmode

    def room(array, rows, folder):
        pass

    def typed(array, rows, folder):
        kind = numba.types.Array(array.dtype, array.ndim + 1, "C")

        def through_python(array, rows, folder):
            with objmode(found=kind):
                found = _mapped(array, rows, folder)
            return found  # noqa: RET504
        return through_python
    numba.extending.overload(room)(typed)

    def on_disk(array, rows, folder):
        return room(array, rows, folder)
    return numba.njit(on_disk)


class _Files(threading.local):
    """The files that compiled code has mapped in this thread, each with what keeps it mapped."""
    now: list[tuple[Any, Any]] | None = None


_FILES = _Files()


@contextmanager
def files_emptied_on_error() -> Iterator[None]:
    """The files that compiled code maps inside are empty behind it if it raises."""
    outer, _FILES.now = _FILES.now, (here := [])
    try:
        yield
    except BaseException:
        for file, content in here:
            if content() is not None:
                file.truncate(0)
        raise
    finally:
        _FILES.now = outer
        for file, _ in here:
            file.close()


def _mapped(array: Any, rows: int, folder: str) -> Any:
    """`runtime.on_disk`, of which the file is known until the call is over."""
    if _FILES.now is None:
        return runtime.on_disk(array, rows, folder)
    file = tempfile.TemporaryFile(dir=folder)
    _FILES.now.append((file, lambda: None))
    found = runtime.mapped(file, array, rows, folder)
    _FILES.now[-1] = file, weakref.ref(found.base)
    return found


def _drawing(function: Any, numba: Any) -> Any:
    """A draw of random numbers, by NumPy's generators."""
    objmode = numba.objmode

    def called(*arguments):
        with objmode():
            function(*arguments)
    return numba.njit(called)


_MAKERS: dict[Any, Callable[[Any], Any]] = {
    runtime.lanes: lanes_on_stack, runtime.sparse_solve: _solving, runtime.on_disk: _mapping, **{
        f: partial(_drawing, f) for f in (*FUNCTIONS, *TANGENTS.values(), cleared)}}


def through_python(function: Any) -> Any:
    """A function of the runtime for compiled code; None for one that Numba compiles as it stands."""
    maker = _MAKERS.get(function)
    return None if maker is None else maker(importlib.import_module("numba"))
