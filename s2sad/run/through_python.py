"""Runtime functions that compiled code calls through Python, since Numba cannot compile them: what SciPy solves,
what NumPy draws, and memory that is mapped to files.

Compiled code that raises lets go of nothing that it holds: files that it has mapped are emptied then, by who calls it,
and are those of the next call that needs as much.
"""
from __future__ import annotations

import importlib
import tempfile
import threading
import weakref
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

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


@dataclass
class _MappedFile:
    """A file that compiled code has mapped: with the same `key` another call can use it. Code that has raised keeps one
    mapped for good (`lost`)."""
    file: Any
    key: tuple[str, int]
    content: Callable[[], Any] = lambda: None
    lost: bool = False


class _Files(threading.local):
    """The files that compiled code has mapped in this thread."""
    now: list[_MappedFile] | None = None


_FILES = _Files()
_LOST: dict[tuple[str, int], list[_MappedFile]] = {}        # which are empty until they are used again


@contextmanager
def files_emptied_on_error() -> Iterator[None]:
    """The files that compiled code maps inside are empty behind it if it raises."""
    outer, _FILES.now = _FILES.now, (here := [])
    raised = True
    try:
        yield
        raised = False
    finally:
        _FILES.now = outer
        for mapped in here:
            content = mapped.content()
            if content is None or not (raised or mapped.lost):
                mapped.file.close()
                continue
            mapped.file.truncate(0)
            _LOST.setdefault(mapped.key, []).append(_MappedFile(mapped.file, mapped.key, partial(_same, content), True))


def _same(value: Any) -> Any:
    return value


def _mapped(array: Any, rows: int, folder: str) -> Any:
    """`runtime.on_disk`, of which the file is known until the call is over."""
    if _FILES.now is None:
        return runtime.on_disk(array, rows, folder)
    key = folder, max(1, rows * array.nbytes)
    with suppress(KeyError, IndexError):    # another thread may take the last one
        again = _LOST[key].pop()
        _FILES.now.append(again)
        runtime.extend(again.file, key[1], folder)
        return np.ndarray((rows, *array.shape), array.dtype, again.content())
    _FILES.now.append(new := _MappedFile(tempfile.TemporaryFile(dir=folder), key))
    found = runtime.mapped(new.file, array, rows, folder)
    new.content = weakref.ref(found.base)
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
