"""index_check: whether the arguments of a call keep all indices within their arrays, asked before each call.

What has been found out of a kernel (`analyze/index_bounds.py`) is a condition on sizes, integers, and the extremes of
arrays of integers. Where it holds, nothing has to be looked at; where it does not, or none was found, the kernel is run
with bounds checks: elements that no call reads may be anything. Where integers alone decide what it asks for, a call
with the same ones needs no such run.

    (x.shape[0], picked.shape[0])       s1 = a[1].shape
                                        if not (-s1[0] + 1 < 0 or ...): return False        what costs least comes first
                                        l1, g1 = extremes(a[1]) if a[1].size else (0, 0)
                                        return g1 - s0[0] < 0 and -l1 - s0[0] - 1 < 0 and (2 if l1 >= 0 else 1)
"""
from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from hashlib import blake2b
from typing import Any

import numpy as np

from s2sad.infer.argument_parts import GREATEST, LEAST, Part
from s2sad.program import Generated, IndexLimit
from s2sad.run.compiled import compiled
from s2sad.run.module_loader import keep_loaded

Limits = tuple[tuple[IndexLimit, ...], ...]
Spelling = Callable[[str, Part], str]
_KEPT = 256     # calls
_OFTEN = 16     # calls from which on it is worth the time to compile what looks into arrays
_FORWARDS = 2   # what a condition gives where no element that it has looked at is negative


class IndexCheck:
    """`check(arguments)` of a generated function says whether no element of the arrays `scanned` is negative, as far as
    that is known; `run` is given the values of the kernel's parameters by name, and
    runs it with bounds checks. With the same integers it is not run again where these decide alone what it asks for."""

    def __init__(self, generated: Generated, run: Callable[[dict[str, Any]], None]):
        taken = generated.facts.get("taken", generated.parameters)
        self._places = {p.name: k for k, p in enumerate(taken) if p.role == "primal"}
        self.limits: Limits | None = generated.facts.get("index_limits")
        self.inside = None if self.limits is None else condition(self.limits, self._places)
        self.scanned = frozenset(name for name, part in _terms(self.limits or ()) if isinstance(part, str))
        self._run = run
        self._left = _OFTEN if self.scanned else -1
        self._inside: set[bytes] | None = set() if generated.facts.get("decided_by_integers") else None

    @property
    def is_needed(self) -> bool:
        """Whether there is something to ask."""
        return self.inside is not _always

    def __call__(self, arguments: Sequence[Any]) -> bool:
        if self._left == 0 and self.limits is not None:
            module = keep_loaded(compiled(_TEXT, "extremes", entries=["extremes"]), self)
            self.inside = condition(self.limits, self._places, module.extremes)
        self._left -= self._left >= 0
        if self.inside is not None and (found := self.inside(arguments)):
            return found == _FORWARDS
        self._look(arguments)
        return False

    def _look(self, arguments: Sequence[Any]) -> None:
        """Runs the kernel with bounds checks, unless that has been done."""
        values = {name: arguments[k] for name, k in self._places.items()}
        key = b"" if self._inside is None else integers_of(values)
        if self._inside is not None and key in self._inside:
            return
        self._run(values)
        if self._inside is not None:
            if len(self._inside) >= _KEPT:
                self._inside.clear()
            self._inside.add(key)


def _always(arguments: Sequence[Any]) -> int:
    return 1


def integers_of(values: Mapping[str, Any]) -> bytes:
    """A digest of the sizes of arrays, and of all that is no float.

    >>> a, b = (integers_of({"x": np.full(n, 0.5), "k": np.array([1, 2])}) for n in (3, 4))
    >>> a == integers_of({"x": np.full(3, 7.5), "k": np.array([1, 2])}), a == b
    (True, False)
    """
    found = blake2b(digest_size=16)
    for value in values.values():
        is_array = isinstance(value, np.ndarray)
        is_float = value.dtype.kind in "fc" if is_array else not isinstance(value, (int, np.integer, np.bool_))
        found.update(repr(value.shape if is_array else None if is_float else value).encode())
        if is_array and not is_float:
            found.update(np.ascontiguousarray(value).view(np.uint8).data if value.size else b"")
    return found.digest()


def extremes(array: np.ndarray) -> tuple[int, int]:
    """The least and the greatest element of an array of integers, which has some.

    >>> extremes(np.array([[2, 0], [7, -1]]))
    (-1, 7)
    """
    return int(np.minimum.reduce(array, None)), int(np.maximum.reduce(array, None))


_TEXT = """
def extremes(array):
    row = array.ravel()
    least = greatest = row[0]
    for k in range(row.size):
        least = min(least, row[k])
        greatest = max(greatest, row[k])
    return least, greatest
"""


def condition(limits: Limits, places: dict[str, int], extremes: Callable[[Any], tuple[int, int]] = extremes
              ) -> Callable[[Sequence[Any]], int]:
    """A function of arguments that says whether each system has a negative form; 2 if so, and no element of the arrays
    that it looks into is negative.

    >>> rows = IndexLimit((("n", None, 1), ("x", 0, -1)), -1)         # n - len(x) - 1
    >>> inside = condition(((rows,),), {"n": 0, "x": 1})
    >>> inside((3, np.zeros(3))), inside((4, np.zeros(3)))
    (True, False)
    >>> picked = IndexLimit((("k", "greatest", 1), ("x", 0, -1)), 0)  # max(k) - len(x)
    >>> inside = condition(((picked,),), {"k": 0, "x": 1})
    >>> [inside((np.array([k, 0]), np.zeros(3))) for k in (2, 3, -1)]
    [2, False, 1]
    """
    if not limits:
        return _always
    arrays = {places[name] for name, part in _terms(limits) if isinstance(part, int)}
    scanned = {places[name] for name, part in _terms(limits) if isinstance(part, str)}
    first = tuple(system for system in limits if not any(isinstance(part, str) for _, part in _terms((system,))))
    lines = ["def inside(a):", *(f"    s{k} = a[{k}].shape" for k in sorted(arrays)),
             f"    if not ({condition_text(first, _spelling(places))}):", "        return False",
             *(f"    l{k}, g{k} = extremes(a[{k}]) if a[{k}].size else (0, 0)" for k in sorted(scanned)),
             f"    return {condition_text(tuple(s for s in limits if s not in first), _spelling(places))}" + (
                 f" and ({_FORWARDS} if min(0, {', '.join(f'l{k}' for k in sorted(scanned))}) == 0 else 1)"
                 if scanned else "")]
    space: dict[str, Any] = {"extremes": extremes}
    exec("\n".join(lines), space)  # noqa: S102
    return space["inside"]


def _terms(limits: Limits) -> list[tuple[str, Part]]:
    """What the forms of some systems are made of."""
    return [(name, part) for system in limits for form in system for name, part, _ in form.terms]


def _spelling(places: dict[str, int]) -> Spelling:
    """How `condition` names what a form is made of."""
    def value(name: str, part: Part) -> str:
        known = {None: f"a[{places[name]}]", LEAST: f"l{places[name]}", GREATEST: f"g{places[name]}"}
        return f"s{places[name]}[{part}]" if isinstance(part, int) else known[part]
    return value


def condition_text(limits: Limits, value: Spelling) -> str:
    """The condition as an expression, in which `value(name, part)` stands for a size, an extreme, or an integer."""
    tests = [" or ".join(f"{_text(form, value)} < 0" for form in system) or "False" for system in limits]
    return " and ".join(f"({test})" for test in tests) or "True"


def _text(form: IndexLimit, value: Spelling) -> str:
    """The form as an expression."""
    text = ""
    for name, part, factor in form.terms:
        size = value(name, part)
        text += ("-" if factor < 0 else "+") + (size if abs(factor) == 1 else f"{abs(factor)} * {size}")
    return f"{text}{form.constant:+d}" if form.constant or not text else text
