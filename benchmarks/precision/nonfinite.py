"""What every elementwise rule gives where an argument is infinite or nan, held against what is promised there.

Both modes give the same partial, and both engines do. Where the function is nan its partials are, but for those that
read nothing that is not finite, and for choices. Where it is not, and an argument is infinite, a partial is its limit
there, if it has one: by mpmath, at three sizes, and along several ways where more than one argument is infinite.
"""
from __future__ import annotations

import functools
import itertools
import math
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.precision.quad import mpmath as m
from benchmarks.precision.rules import NAMES, groups, results, takes_arrays
from benchmarks.precision.truths import Truth, truth
from benchmarks.tables import Table
from s2sad import rules

FINITE = (-2.5, -1.0, 0.0, 0.5, 1.0, 3.0)
NOT_FINITE = (math.inf, -math.inf, math.nan)
LARGE = (50, 100, 150)          # powers of ten that stand for infinity
FRACTIONS = ("0.37", "1e-200", "-1e-200")     # beside whole numbers, where there may be poles
DIGITS = 500
NEAR = 1e-12
# those of the runtime have no name for users; Python's gamma raises at -inf, and its partial calls it under NumPy
LEFT = ("runtime.heaviside", "runtime.remainder", "math.gamma")
ENGINES = {"numpy": "NumPy", "numba": "Numba"}


@dataclass(frozen=True)
class Broken:
    """A promise that a rule does not keep: which, of which parameter, where; what is found and what is expected."""
    rule: str
    promise: str
    parameter: str
    engine: str
    point: tuple[float, ...]
    value: float
    found: tuple[float, ...]
    expected: str


def points(count: int) -> np.ndarray:
    """All arguments of which one is not finite."""
    listed = itertools.product((*FINITE, *NOT_FINITE), repeat=count)
    return np.array([p for p in listed if not all(map(math.isfinite, p))]).T


def limit(function: Callable[..., Any], point: Sequence[float]) -> float | None:
    """What the function tends to where arguments go to infinity, None where nothing is found."""
    places = [k for k, p in enumerate(point) if math.isinf(p)]
    ways = {_tends([_at(function, point, dict(zip(places, powers)), size) for size in range(len(LARGE))])
            for powers in itertools.product((1, 2), repeat=len(places)) if len(places) > 1 or powers == (1,)}
    return ways.pop() if len(ways) == 1 else None


def _at(function: Callable[..., Any], point: Sequence[float], powers: dict[int, int], size: int) -> Any:
    numbers = [m.sign(p) * (m.mpf(10) ** (powers[k] * LARGE[size]) + m.mpf(FRACTIONS[size])) if k in powers else
               m.mpf(p) for k, p in enumerate(point)]
    try:
        found = function(*numbers)
    except (ZeroDivisionError, ValueError, OverflowError, m.libmp.NoConvergence):
        return m.nan
    return m.nan if isinstance(found, m.mpc) else m.mpf(found)


def _tends(values: list[Any]) -> float | None:
    first, second, third = values
    if any(map(m.isnan, values)):
        return None
    if max(map(abs, values)) < 1e-10 and abs(third) <= abs(second) <= abs(first):
        return 0.0
    if max(abs(second - first), abs(third - second)) <= NEAR * abs(third):
        return float(third)
    if abs(third) > 1.2 * abs(second) > 1.44 * abs(first) and m.sign(first) == m.sign(second) == m.sign(third):
        return math.copysign(math.inf, float(m.sign(third)))
    return None


@functools.lru_cache(None)
def _limits(given: Truth) -> list[list[float | None]]:
    """The limits of the value and of the partials, by point."""
    with m.workdps(DIGITS):
        return [[None if any(map(math.isnan, point)) else limit(function, point)
                 for function in (given.value, *given.partials)] for point in points(len(given.partials)).T]


def measured(engines: Sequence[str] = ("numpy", "numba")) -> tuple[int, list[Broken]]:
    """How many partials at how many points were asked, and which promises do not hold."""
    listed = [r for r in rules.names() if truth(r) is not None and r not in LEFT
              and ("numba" in engines or takes_arrays(r))]      # the value of others is the compiled one's
    asked, broken = 0, []
    with tempfile.TemporaryDirectory() as folder:
        for group in groups(listed, 12):
            count = len(rules.find(group[0]).parameters)
            rows = np.ones((len(group), len(NAMES), points(count).shape[1]))
            rows[:, :count] = points(count)
            found = {engine: results(group, rows, engine, Path(folder), engine == "numba" or takes_arrays(group[0]))
                     for engine in engines}
            for k, rule in enumerate(group):
                for i, k_parameter in itertools.product(range(rows.shape[2]), range(count)):
                    asked += 1
                    broken += _broken(rule, k, k_parameter, i, rows, found)
    return asked, broken


def _broken(rule: str, row: int, parameter: int, place: int, rows: np.ndarray,
            found: dict[str, dict[str, np.ndarray]]) -> list[Broken]:
    """The promises that are not kept for one partial at one point."""
    given, count = rules.find(rule), len(rules.find(rule).parameters)
    point = tuple(float(v) for v in rows[row, :count, place])
    pairs = {e: (float(f[f"tangent {parameter}"][row, place]), float(f[f"adjoint {parameter}"][row, place]))
             for e, f in found.items()}
    value = next(float(f["value"][row, place]) for f in found.values() if "value" in f)

    def broken(promise: str, engine: str, expected: str) -> Broken:
        return Broken(rule, promise, given.parameters[parameter], engine, point, value, pairs[engine], expected)
    made = [broken("the same in both modes", e, "") for e, pair in pairs.items() if not _same(*pair)]
    first, *others = pairs
    made += [broken("the same under both engines", e, f"{pairs[first][1]:g}") for e in others
             if not _same(pairs[e][1], pairs[first][1])]
    expected, promise = None, ""            # nothing is promised where the function has no limit either
    if math.isnan(value) and not _may_stay(given, parameter, point):
        expected, promise = math.nan, "nan where the function is"
    else:
        limits = _limits(truth(rule))[place]
        if limits[0] is not None and _same(value, limits[0]):
            expected, promise = limits[1 + parameter], "the limit"
    if expected is not None:
        made += [broken(promise, e, f"{expected:g}") for e, pair in pairs.items() if not _same(pair[1], expected)]
    return made


def _may_stay(rule: rules.Rule, parameter: int, point: Sequence[float]) -> bool:
    """Whether a partial need not be nan where the function is: a choice, and what reads nothing that is not finite."""
    name = rule.parameters[parameter]
    read = rule.uses(name)
    return rule.chooses(name) or "y" not in read and all(
        map(math.isfinite, (p for n, p in zip(rule.parameters, point) if n in read)))


def _same(one: float, other: float) -> bool:
    return one == other or math.isnan(one) and math.isnan(other) or abs(one - other) <= NEAR * abs(other) < math.inf


def table(asked: int, found: Sequence[Broken]) -> Table:
    """A line for each promise that the rules of a function do not keep."""
    made = Table("Where an argument is infinite or nan: what is not as promised",
                 ("rules", "promised", "engines", "partials", "for example by", "at", "where it is", "tangent",
                  "adjoint", "should be"))
    lines: dict[tuple[int, str], list[Broken]] = {}
    for one in found:
        lines.setdefault((id(truth(one.rule)), one.promise), []).append(one)
    for (_, promise), broken in lines.items():
        first = broken[0]
        names = list(dict.fromkeys(b.rule for b in broken))
        partials = len({(b.parameter, b.point) for b in broken})
        made.rows.append((", ".join(f"`{n}`" for n in names), promise,
                          ", ".join(dict.fromkeys(ENGINES[b.engine] for b in broken)), str(partials), first.parameter,
                          ", ".join(f"{p:g}" for p in first.point), f"{first.value:g}",
                          *(f"{f:g}" for f in first.found), first.expected))
    made.notes = [
        f"Of {asked} partials at such arguments {len({(b.rule, b.parameter, b.point) for b in found})} are here. "
        "Promised is: where the function is nan a partial is, but for choices and those that read nothing that is not "
        "finite; else it is its limit, where it and the function have one there; both modes and both engines give the "
        "same.",
        "Tangents are along one argument, and 0 along the others: in front of a factor that is infinite or nan itself, "
        "as in `a * b`, a tangent of 0 gives nan, where the adjoint gives nothing. `math.gamma`, whose partial calls "
        "it, raises at -inf under NumPy, as Python does."]
    return made
