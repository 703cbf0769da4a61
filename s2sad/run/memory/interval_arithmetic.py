"""Numbers of which only bounds are known: what data decide, and what differs from trip to trip of a loop.

A number that is known is Python's. `Between` is one that is not: with the loops that would have to be followed trip by
trip to know it, and, where it is what a name held when a trip of a loop began, that beginning and how much was added.
"""
from __future__ import annotations

import math
import operator
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

INF = math.inf
_ORDER = {"Lt": operator.lt, "LtE": operator.le, "Gt": operator.gt, "GtE": operator.ge}
_EXACT: dict[str, Callable[[Any, Any], Any]] = {
    "Add": operator.add, "Sub": operator.sub, "Mult": operator.mul, "FloorDiv": operator.floordiv,
    "Div": operator.truediv, "Mod": operator.mod, "Pow": operator.pow, "LShift": operator.lshift,
    "RShift": operator.rshift, "BitAnd": operator.and_, "BitOr": operator.or_, "BitXor": operator.xor,
    "Eq": operator.eq, "NotEq": operator.ne, "Is": operator.is_, "IsNot": operator.is_not, **_ORDER}


@dataclass(frozen=True)
class Between:
    """A number from `low` to `high`; `loops` are those whose trips tell it, `base` the name and the loop at the
    beginning of whose trip it was less by `offset`; it is `reached` if some trip has it as large as that."""
    low: float = -INF
    high: float = INF
    loops: frozenset[int] = frozenset()
    base: tuple[str, int] | None = None
    offset: Any = 0
    reached: bool = False


UNKNOWN = Between()


def is_number(value: Any) -> bool:
    return isinstance(value, (int, float, complex))


def bounds(value: Any) -> tuple[float, float]:
    """The least and the largest that a value can be."""
    if isinstance(value, Between):
        return value.low, value.high
    return (value, value) if isinstance(value, (int, float)) and not math.isnan(value) else (-INF, INF)


def loops_of_values(*values: Any) -> frozenset[int]:
    """The loops whose trips would tell these values."""
    return frozenset().union(*(v.loops for v in values if isinstance(v, Between)))


def operated(op: str, left: Any, right: Any) -> Any:
    """A binary operation or a comparison, of this name of Python's syntax."""
    if not isinstance(left, Between) and not isinstance(right, Between):
        return _EXACT[op](left, right) if is_number(left) and is_number(right) or op in ("Is", "IsNot") else UNKNOWN
    if op == "Mult" and 1 in (left, right):
        return right if left == 1 else left
    loops = loops_of_values(left, right)
    if op in _ORDER:
        return _ordered(op, left, right, loops)
    if op in ("Eq", "NotEq", "Is", "IsNot"):
        return truth_value(loops)
    low, high = _range_of(op, bounds(left), bounds(right))
    base, offset = _moved(op, left, right) or (None, 0)
    return Between(low, high, loops, base, offset, _is_reached(op, left, right))


def negated(value: Any) -> Any:
    return operated("Sub", 0, value)


def truth(value: Any) -> bool | None:
    """Whether a value is true; None if that is not known."""
    if isinstance(value, Between):
        return True if value.low > 0 or value.high < 0 else False if value.low == value.high == 0 else None
    return bool(value)


def least(values: list[Any], largest: bool = False) -> Any:
    """What Python's min gives, or its max."""
    pick = max if largest else min
    if not any(isinstance(v, Between) for v in values):
        return pick(values)
    low, high = (pick(b) for b in zip(*map(bounds, values)))
    return Between(low, high, loops_of_values(*values), reached=_one_is_reached(values)) if low < high else low


def truth_value(loops: frozenset[int]) -> Between:
    """A truth that is not known."""
    return Between(0, 1, loops)


def joined(first: Any, second: Any) -> Any:
    """A number that is one or the other."""
    if isinstance(first, Between) or isinstance(second, Between) or is_number(first) and is_number(second):
        low, high = zip(bounds(first), bounds(second))
        one = first.base if isinstance(first, Between) else None
        if one is not None and isinstance(second, Between) and second.base == one:
            same = first.offset == second.offset
            return Between(min(low), max(high), loops_of_values(first, second), one,
                           first.offset if same else joined(first.offset, second.offset))
        return Between(min(low), max(high), loops_of_values(first, second))
    return UNKNOWN


def _is_reached(op: str, left: Any, right: Any) -> bool:
    """Whether the largest value of an operation is one of those that the operands have together."""
    grows = op in ("Add", "Sub") and not isinstance(right, Between) or op == "Add" and not isinstance(left, Between) \
        or op == "Mult" and min(bounds(left)[0], bounds(right)[0]) >= 0 \
        or op == "FloorDiv" and not isinstance(right, Between) and bounds(right)[0] > 0
    return grows and _one_is_reached([left, right])


def _one_is_reached(values: list[Any]) -> bool:
    """Whether one value alone is not known, and is as large as it can be at some time."""
    several = [v for v in values if isinstance(v, Between)]
    return len(several) == 1 and several[0].reached


def _ordered(op: str, left: Any, right: Any, loops: frozenset[int]) -> Any:
    holds = _ORDER[op]
    (a, b), (c, d) = bounds(left), bounds(right)
    found = {holds(a, c), holds(a, d), holds(b, c), holds(b, d)}
    return found.pop() if len(found) == 1 else truth_value(loops)


def _moved(op: str, left: Any, right: Any) -> tuple[tuple[str, int], Any] | None:
    """What a sum counts from, and by how much it is more."""
    if op == "Add" and isinstance(right, Between) and right.base is not None:
        left, right = right, left
    if op not in ("Add", "Sub") or not isinstance(left, Between) or left.base is None or isinstance(
            right, Between) and right.base is not None:
        return None
    return left.base, operated(op, left.offset, right)


def _range_of(op: str, left: tuple[float, float], right: tuple[float, float]) -> tuple[float, float]:
    (a, b), (c, d) = left, right
    if op == "Add":
        return _number(a + c, -INF), _number(b + d, INF)
    if op == "Sub":
        return _number(a - d, -INF), _number(b - c, INF)
    if op == "Mult" or op == "FloorDiv" and c > 0:
        corners = [_corner(op, x, y) for x in left for y in right]
        return min(corners), max(corners)
    if op == "Mod" and c > 0:
        return 0, d
    return -INF, INF


def _corner(op: str, x: float, y: float) -> float:
    if op == "Mult":
        return 0 if not x or not y else x * y
    if math.isinf(x):
        return x
    return x // y if not math.isinf(y) else 0 if x >= 0 else -1


def _number(value: float, otherwise: float) -> float:
    return otherwise if math.isnan(value) else value
