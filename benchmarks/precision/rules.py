"""The errors of every elementwise rule: values, tangents and adjoints of generated functions, in ulp.

Each rule stands in a kernel of whole arrays under the engine NumPy and in a loop that Numba compiles; seeds are 1, so
that what comes back is the partial. Points lie in the domain, near its edges, at kinks and at extremes; the errors are
of the partials themselves.
"""
from __future__ import annotations

import functools
import importlib.util
import math
import re
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

import s2sad
from benchmarks.precision.quad import mpmath as m
from benchmarks.precision.truths import Truth, truth
from s2sad import rules

HEAD = "import math\n\nimport numpy as np\nimport scipy.special\n\n\n"
NAMES = "abc"
LEAST = 2.0 ** -1022        # what is less has fewer digits
LARGEST = 1.797e308
CONDITIONED = 1e-25         # the relative step for the condition of a partial

SIZES = (5e-324, 1e-310, 2.3e-308, 1e-300, 1e-200, 1e-153, 1e-100, 1e-30, 1e-16, 1e-8, 1e-4, 0.01, 0.0999, 0.1, 0.1001,
         0.25, 0.3, 0.367, 0.3679, 0.49, 0.5, 0.51, 0.65, 0.7, 0.9, 0.99, 1 - 1e-8, 1 - 2 ** -53, 1.0, 1 + 2 ** -52,
         1 + 1e-8, 1.1, 1.3, 1.4616, 1.5, 1.5707963267948966, 1.9, 2.0, 2.5, 2.718281828459045, 3.0, 3.14159, 4.7, 5.0,
         6.0, 9.99, 10.0, 19.0, 22.0, 26.0, 30.0, 100.0, 170.5, 340.0, 353.0, 355.0, 700.0, 709.7, 710.4, 1000.0, 1e4,
         1e8, 1e16, 1e100, 1e153, 1e155, 1e200, 1e300, 1.7e308)
PAIRED = (1e-310, 1e-300, 1e-153, 1e-16, 1e-4, 0.1, 0.3, 0.7, 1 - 1e-8, 1.0, 1 + 2 ** -52, 1.5, 2.0, 3.0, 10.0, 340.0,
          709.0, 1e8, 1e153, 1e200, 1e300)
TRIPLED = (1e-300, 0.3, 1.0, 2.5, 1e300)


@dataclass(frozen=True)
class Error:
    """An error in ulp: of `what` ("value", "tangent a", "adjoint b", ...) under an engine at a point."""
    what: str
    engine: str
    point: tuple[float, ...]
    ulp: float
    condition: float        # of the function that the error is of, 1 where it was not asked for
    found: float
    expected: float

    @property
    def scaled(self) -> float:
        """The error over the condition, where that is above 1."""
        return self.ulp / max(1.0, self.condition)


@dataclass
class Measured:
    """A rule with its largest errors, by what they are of, and those at the edges of the numbers: where an argument,
    the value or the partial is denormal, or the value or the partial too large."""
    rule: str
    points: int = 0
    worst: dict[tuple[str, str], Error] = field(default_factory=dict)
    edges: list[Error] = field(default_factory=list)


def points(count: int, domains: Sequence[tuple[float, float]], drawn: int) -> np.ndarray:
    """Places for a function of so many parameters: a grid of sizes of both signs, and random ones in its domain."""
    listed = {1: SIZES, 2: PAIRED, 3: TRIPLED}[count]
    axis = np.array([0.0, *listed, *(-s for s in listed)])
    grid = np.stack([g.ravel() for g in np.meshgrid(*[axis] * count, indexing="ij")])
    random = np.random.default_rng(23)
    inside = np.stack([random.uniform(low, high, drawn) for low, high in domains])
    wide = random.choice((-1.0, 1.0), (count, drawn)) * 10.0 ** random.uniform(-12.0, 12.0, (count, drawn))
    return np.concatenate((grid, inside, wide), axis=1)


def spelled(rule: str, index: str) -> str:
    """A call of the rule's function over the rows a, b, c."""
    parameters = rules.find(rule).parameters
    places = dict(zip(parameters, NAMES))
    if " " in rule or rule[0] in "+-":
        return re.sub(r"\b([ab])\b", lambda found: f"{places[found[0]]}{index}", rule)
    called = rule.removeprefix("builtins.").replace("numpy.", "np.")
    given = [f"{p}{index}" for p in places.values()]
    if rule == "numpy.where":
        given[0] += " > 0.0"
    return f"{called}({', '.join(given)})"


def takes_arrays(rule: str) -> bool:
    """Whether the function is of arrays, too."""
    return not rule.startswith(("math.", "builtins.", "numpy.float"))


def kernel_text(listed: Sequence[str], loop: bool) -> str:
    """A kernel with one row of `out` for each rule."""
    parameters = "out, " + ", ".join(NAMES)
    if not loop:
        return f"def kernel({parameters}):\n" + "".join(
            f"    out[{k}] = {spelled(rule, f'[{k}]')}\n" for k, rule in enumerate(listed))
    return (f"def kernel({parameters}):\n    for i in range(out.shape[1]):\n" + "".join(
        f"        out[{k}, i] = {spelled(rule, f'[{k}, i]')}\n" for k, rule in enumerate(listed)))


def loaded(text: str, folder: Path) -> Callable[..., Any]:
    """The function `kernel` of a text, from a file of its own."""
    path = folder / f"kernel_{len(list(folder.iterdir()))}.py"
    path.write_text(HEAD + text)
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.kernel


def results(listed: Sequence[str], rows: np.ndarray, engine: str, folder: Path, values: bool = True
            ) -> dict[str, np.ndarray]:
    """Values, if they are asked for, tangents and adjoints of rules, one row for each, at rows[rule, parameter, point].

    Under NumPy a rule of numbers alone stands in a loop, and its value raises where Python does.
    """
    loop = engine == "numba" or not takes_arrays(listed[0])
    function = s2sad.differentiate(loaded(kernel_text(listed, loop), folder), wrt=tuple(NAMES), of=("out",),
                                   engine=engine)
    columns = [np.ascontiguousarray(rows[:, k]) for k in range(len(NAMES))]
    out, ones = np.zeros(columns[0].shape), np.ones(columns[0].shape)
    found = {}
    with np.errstate(all="ignore"):
        if values:
            function.primal(out, *columns)
            found["value"] = out
        gains = s2sad.vjp(function, (np.zeros_like(out), *columns), {"out": ones})
        for k, name in enumerate(NAMES):
            found[f"adjoint {k}"] = gains[name]
            tangents = {n: ones if n == name else 0.0 * ones for n in NAMES}
            found[f"tangent {k}"] = s2sad.jvp(function, (np.zeros_like(out), *columns), tangents)["out"]
    return found


def defined(given: Truth, point: Sequence[float]) -> tuple[Any, list[Any]] | None:
    """Value and partials; None where the function is not defined, or not finite."""
    try:
        numbers = [m.mpf(p) for p in point]
        found = [given.value(*numbers), *(partial(*numbers) for partial in given.partials)]
    except (ZeroDivisionError, ValueError, OverflowError, m.libmp.NoConvergence):
        return None
    if any(isinstance(v, m.mpc) or not m.isfinite(v) for v in found):
        return None
    return found[0], found[1:]


def ulp(found: float, expected: Any) -> float:
    """The error in units in the last place of the expected value."""
    if not math.isfinite(found):
        return 0.0 if abs(expected) > LARGEST else math.inf
    return float(abs(m.mpf(found) - expected) / math.ulp(float(expected))) if abs(expected) < LARGEST else math.inf


def condition(function: Callable[..., Any], point: Sequence[float]) -> float:
    """How much more a function moves than its arguments, relatively: the sum over these."""
    numbers = [m.mpf(p) for p in point]
    base, total = function(*numbers), m.mpf(0)
    for k, number in enumerate(numbers):
        moved = [*numbers[:k], number * (1 + m.mpf(CONDITIONED)), *numbers[k + 1:]]
        try:
            total += abs((function(*moved) - base) / base) / CONDITIONED
        except (ZeroDivisionError, ValueError):
            return math.inf
    return float(total)


@functools.lru_cache(None)
def exact(given: Truth, domains: tuple[tuple[float, float], ...], drawn: int) -> list[tuple[Any, Any]]:
    """The points where a function is defined, each with its value and partials."""
    with m.workdps(given.digits):
        found = [(point, defined(given, point)) for point in points(len(domains), domains, drawn).T]
    return [(point, real) for point, real in found if real is not None]


def measure(listed: Sequence[str], folder: Path, drawn: int, engines: Sequence[str] = ("numpy", "numba")
            ) -> list[Measured]:
    """The errors of rules that stand in one kernel."""
    found = [Measured(rule) for rule in listed]
    truths = {rule: truth(rule) for rule in listed}
    places, expected = [], []
    for rule in listed:
        domains = tuple(rules.find(rule).domain.get(p, (-2.0, 2.0)) for p in rules.find(rule).parameters)
        pairs = [(point, real) for point, real in exact(truths[rule], domains, drawn)
                 if takes_arrays(rule) or abs(real[0]) <= LARGEST]     # else `math` raises
        places.append(np.array([point for point, _ in pairs]).T)
        expected.append([real for _, real in pairs])
    size = max(p.shape[1] for p in places)
    rows = np.ones((len(listed), len(NAMES), size))
    for k, place in enumerate(places):
        rows[k, :place.shape[0]] = np.take(place, np.arange(size), axis=1, mode="wrap")
    for engine in engines:
        given = results(listed, rows, engine, folder)
        for k, rule in enumerate(listed):
            with m.workdps(truths[rule].digits):
                _compared(found[k], truths[rule], rows[k], expected[k], engine, {w: v[k] for w, v in given.items()})
    return found


def _compared(into: Measured, given: Truth, row: np.ndarray, expected: list[Any], engine: str,
              found: dict[str, np.ndarray]) -> None:
    count = len(given.partials)
    into.points = len(expected)
    for i, (value, partials) in enumerate(expected):
        point = tuple(float(v) for v in row[:count, i])
        tiny = any(0.0 < abs(p) < LEAST for p in point)
        lost = value != 0 and not LEAST <= abs(value) <= LARGEST
        for what, real, function in [("value", value, given.value)] + [
                (f"{mode} {k}", partials[k], given.partials[k])
                for k in range(count) for mode in ("tangent", "adjoint")]:
            error = ulp(float(found[what][i]), real)
            if error == 0.0:
                continue
            edge = real != 0 and not LEAST <= abs(real) <= LARGEST or lost and what != "value" or tiny
            known = Error(what, engine, point, error, 1.0, float(found[what][i]), float(real))
            if edge:
                if error > 4.0:
                    into.edges.append(known)
                continue
            if error > 4.0 and math.isfinite(error):
                known = Error(what, engine, point, error, condition(function, point),
                              known.found, known.expected)
            place = (what.split()[0], engine)
            if place not in into.worst or known.scaled > into.worst[place].scaled:
                into.worst[place] = known


def groups(listed: Sequence[str], size: int) -> list[list[str]]:
    """Rules that one kernel takes: of arrays or of numbers, with as many parameters, so that rows have one length."""
    found: dict[tuple[bool, int], list[str]] = {}
    for rule in listed:
        found.setdefault((takes_arrays(rule), len(rules.find(rule).parameters)), []).append(rule)
    return [rest[k:k + size] for rest in found.values() for k in range(0, len(rest), size)]


def measured(drawn: int = 60, only: Sequence[str] = (), engines: Sequence[str] = ("numpy", "numba")) -> list[Measured]:
    """All elementwise rules with their errors, in the order of the table of rules."""
    listed = [r for r in rules.names() if truth(r) is not None and r != "runtime.heaviside"
              and r != "runtime.remainder" and (not only or r in only)]
    made: dict[str, Measured] = {}
    with tempfile.TemporaryDirectory() as folder:
        for group in groups(listed, 12):
            made.update((one.rule, one) for one in measure(group, Path(folder), drawn, engines))
    return [made[rule] for rule in listed]
