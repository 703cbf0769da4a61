"""integer_cases: the functions of integers that are no affine forms, by cases that are."""
from __future__ import annotations

from collections.abc import Sequence

from s2sad.infer.affine import Affine, at_most

Case = tuple[Affine | None, list[Affine]]
"""What the value is, None where nothing is known of it but what holds in this case: forms that are not negative."""

_ZERO, _ONE, _LAST = Affine(), Affine((), 1), Affine((), -1)


def cases_of(function: str, given: Sequence[Affine], value: Affine) -> list[Case]:
    """The cases of a call with these arguments, of which one holds; `value` is the symbol of what it gives. Empty for
    a function that is not known.

    >>> a, b = map(Affine.symbol, "ab")
    >>> cases_of("builtins.min", [a, b], Affine.symbol("m")) == [(a, [at_most(a, b)]), (b, [at_most(b, a)])]
    True
    """
    first, *rest = given
    if function in ("builtins.max", "builtins.min") and rest:
        up = function == "builtins.max"
        return [(form, [at_most(other, form) if up else at_most(form, other)
                        for j, other in enumerate(given) if j != k]) for k, form in enumerate(given)]
    if function == "builtins.abs" and not rest:
        return [(first, [first]), (first.times(-1), [at_most(first, _LAST)])]
    if function == "builtins.range":
        start, stop, step = (_ZERO, first, _ONE) if not rest else (first, rest[0], *rest[1:], _ONE)[:3]
        return [] if step.terms or not step.constant else _range_length(start, stop, step.constant, value)
    if len(rest) != 1:
        return []
    second, = rest
    below, above = at_most(first, _LAST), at_most(second, _LAST)
    if function == "%":
        return [(None, [second.shift(-1), value, at_most(value.shift(1), second)]),
                (None, [above, at_most(value, _ZERO), at_most(second.shift(1), value)]),
                (None, [second, second.times(-1)])]
    if function == "//" and not second.terms and second.constant > 0:
        left = first.plus(value, -second.constant)
        return [(None, [left, at_most(left.shift(1), second)])]
    if function == "runtime.element":
        return [(first, [first, at_most(first.shift(1), second)]),
                (first.plus(second), [below, first.plus(second)])]
    if function in ("runtime.position", "runtime.position_down"):
        least = _ZERO if function == "runtime.position" else _LAST
        most = second if function == "runtime.position" else second.shift(-1)
        return [(first, [first, at_most(first, most)]), (most, [first, at_most(most.shift(1), first)]),
                (first.plus(second), [below, at_most(least, first.plus(second))]),
                (least, [below, at_most(first.plus(second).shift(1), least)])]
    return []


def _range_length(start: Affine, stop: Affine, step: int, value: Affine) -> list[Case]:
    """The cases of the length of a range, which is that of a slice."""
    way = stop.plus(start, -1) if step > 0 else start.plus(stop, -1)
    most = value.times(abs(step)).plus(way, -1)         # the last step may lead behind the end
    return [(None, [value.shift(-1), most, at_most(most.shift(1), Affine((), abs(step)))]),
            (_ZERO, [at_most(way, _ZERO)])]
