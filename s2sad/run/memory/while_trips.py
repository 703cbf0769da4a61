"""The number of trips of a `while` loop, where it follows from numbers that are known before it.

    t = 0.0
    while t < end:          0.0 < end, 0.0 + dt < end, 0.0 + dt + dt < end, ...
        ...
        t += dt

It is counted by the same sums as those of the run, for the last digit may decide.
"""
from __future__ import annotations

import ast
import operator
from collections.abc import Callable, Mapping
from functools import lru_cache
from typing import Any

from s2sad.run.memory.interval_arithmetic import Between

_MOST = 5_000_000       # trips that are counted
_GROWS = {"Lt": operator.lt, "LtE": operator.le}
_FALLS = {"Gt": operator.gt, "GtE": operator.ge}
_TURNED = {"Lt": "Gt", "LtE": "GtE", "Gt": "Lt", "GtE": "LtE"}
Value = Callable[[ast.expr, Mapping[str, Any]], Any]


def trips_of(test: ast.expr, ident: int, entry: Mapping[str, Any], scope: Mapping[str, Any], value: Value
             ) -> int | None:
    """How often a loop runs whose names hold `entry` before it, and what is in the scope behind one trip; None if that
    is not known, or is none."""
    if not isinstance(test, ast.Compare) or len(test.ops) > 1:
        return None
    begun = {**scope, **{n: Between(loops=frozenset({ident}), base=(n, ident)) for n in entry}}
    compared, other = (value(side, begun) for side in (test.left, test.comparators[0]))
    how = type(test.ops[0]).__name__
    if not isinstance(compared, Between):
        compared, other, how = other, compared, _TURNED.get(how, "")
    if not isinstance(compared, Between) or compared.base is None or compared.base[1] != ident:
        return None
    counted = compared.base[0]
    behind = scope.get(counted)
    if not isinstance(behind, Between) or behind.base != compared.base:
        return None
    numbers = entry[counted], compared.offset, other, behind.offset
    return _counted(how, *numbers) if all(isinstance(n, (int, float)) for n in numbers) else None


@lru_cache(256)
def _counted(how: str, first: float, ahead: float, last: float, gain: float) -> int | None:
    """How often `how` holds of first + ahead and last, where so much is gained each time."""
    holds = (_GROWS if gain > 0 else _FALLS).get(how)
    if holds is None or not gain:
        return None
    count = 0
    while holds(first + ahead, last):
        first += gain
        count += 1
        if count > _MOST:
            return None
    return count
