"""index_check: whether the arguments of a call keep all indices within their arrays, asked before each call.

What has been found out of a kernel (`analyze/index_bounds.py`) is a condition on sizes and integers. Where it holds,
nothing has to be looked at; where it does not, or none was found, the kernel is run with bounds checks once.
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from s2sad.program import Generated, IndexLimit

Limits = tuple[tuple[IndexLimit, ...], ...]
Spelling = Callable[[str, "int | None"], str]


class IndexCheck:
    """`check(arguments)` of a generated function; `run` is given the values of the kernel's parameters by name, and
    runs it with bounds checks. Once that has been `done`, nothing is looked at any more."""

    def __init__(self, generated: Generated, run: Callable[[dict[str, Any]], None]):
        taken = generated.facts.get("taken", generated.parameters)
        self._places = {p.name: k for k, p in enumerate(taken) if p.role == "primal"}
        self.limits: Limits | None = generated.facts.get("index_limits")
        self.inside = None if self.limits is None else condition(self.limits, self._places)
        self._run, self.done = run, False

    @property
    def is_needed(self) -> bool:
        """Whether there is something to ask."""
        return self.inside is not _always

    def __call__(self, arguments: Sequence[Any]) -> None:
        if self.done or self.inside is not None and self.inside(arguments):
            return
        self._run({name: arguments[k] for name, k in self._places.items()})
        self.done = True


def _always(arguments: Sequence[Any]) -> bool:
    return True


def condition(limits: Limits, places: dict[str, int]) -> Callable[[Sequence[Any]], bool]:
    """A function of arguments that says whether each system has a negative form.

    >>> rows = IndexLimit((("n", None, 1), ("x", 0, -1)), -1)         # n - len(x) - 1
    >>> inside = condition(((rows,),), {"n": 0, "x": 1})
    >>> import numpy as np
    >>> inside((3, np.zeros(3))), inside((4, np.zeros(3)))
    (True, False)
    """
    if not limits:
        return _always
    arrays = sorted({places[name] for system in limits for form in system for name, axis, _ in form.terms
                     if axis is not None})
    test = condition_text(limits, lambda name, axis: (
        f"a[{places[name]}]" if axis is None else f"s{places[name]}[{axis}]"))
    lines = ["def inside(a):", *(f"    s{k} = a[{k}].shape" for k in arrays), f"    return {test}"]
    space: dict[str, Any] = {}
    exec("\n".join(lines), space)  # noqa: S102
    return space["inside"]


def condition_text(limits: Limits, value: Spelling) -> str:
    """The condition as an expression, in which `value(name, axis)` stands for a size, or for an integer."""
    tests = [" or ".join(f"{_text(form, value)} < 0" for form in system) or "False" for system in limits]
    return " and ".join(f"({test})" for test in tests) or "True"


def _text(form: IndexLimit, value: Spelling) -> str:
    """The form as an expression."""
    text = ""
    for name, axis, factor in form.terms:
        size = value(name, axis)
        text += ("-" if factor < 0 else "+") + (size if abs(factor) == 1 else f"{abs(factor)} * {size}")
    return f"{text}{form.constant:+d}" if form.constant or not text else text
