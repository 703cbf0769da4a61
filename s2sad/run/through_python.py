"""Runtime functions that compiled code calls through Python, since Numba cannot compile them: what SciPy solves."""
from __future__ import annotations

import importlib
from collections.abc import Callable
from typing import Any

from s2sad import runtime


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


_MAKERS: dict[str, Callable[[Any], Any]] = {"sparse_solve": _solving}


def through_python(identifier: str) -> Any:
    """The function for compiled code; None for one that Numba compiles as it stands."""
    maker = _MAKERS.get(identifier)
    return None if maker is None else maker(importlib.import_module("numba"))
