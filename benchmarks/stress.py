"""Derivatives where rounding is hardest: infinite partials under zero seeds, very large and small values, long sums.

Each kernel is a plain function as users write it; the reference is worked out by hand, or by mpmath where installed.
"""
from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

import s2sad
from benchmarks.tables import Table, verdict


def guarded_root(x):
    return math.sqrt(x) if x > 0.0 else 0.0


def capped_inverse(x):
    return min(1.0, 1.0 / x)


def unused_root(x):
    root = math.sqrt(x)
    return 0.0 * root + x


def square(x):
    return x ** 2.0


def cube(x):
    return x ** 3


def arc(x):
    return math.tanh(x)


def logarithm(x):
    return math.log1p(x)


def gained(x):
    return math.expm1(x)


def length(x):
    return math.hypot(x, 1e-200)


def angle(x):
    return math.atan2(1e200, x)


def logistic(x):
    return 1.0 / (1.0 + math.exp(-x))


def bell(x):
    return math.exp(-x * x)


def soft_maximum(x):
    top = max(x, 0.0)
    return top + math.log(math.exp(x - top) + math.exp(-top))


def scaled_sum(u, c):
    total = 0.0
    for i in range(u.size):
        total += c * u[i]
    return total


@dataclass(frozen=True)
class Hard:
    what: str
    function: Callable[..., float]
    at: float
    expected: Callable[[Any, Any], Any]
    limit: float = 4e-16


CASES = (
    Hard("sqrt(x) if x > 0, x = 0", guarded_root, 0.0, lambda m, x: 0),
    Hard("min(1, 1 / x), x = 1e-310", capped_inverse, 1e-310, lambda m, x: 0),
    Hard("0 * sqrt(x) + x, x = 0", unused_root, 0.0, lambda m, x: 1),
    Hard("x ** 2.0, x = 0", square, 0.0, lambda m, x: 0),
    Hard("x ** 3, x = -1e100", cube, -1e100, lambda m, x: 3 * x ** 2),
    Hard("tanh(x), x = 1e-9", arc, 1e-9, lambda m, x: 1 / m.cosh(x) ** 2),
    Hard("tanh(x), x = 19", arc, 19.0, lambda m, x: 1 / m.cosh(x) ** 2),
    Hard("tanh(x), x = 800", arc, 800.0, lambda m, x: 0),
    Hard("log1p(x), x = 1e-17", logarithm, 1e-17, lambda m, x: 1 / (1 + x)),
    Hard("expm1(x), x = -50", gained, -50.0, lambda m, x: m.exp(x)),
    Hard("hypot(x, 1e-200), x = 1e-200", length, 1e-200, lambda m, x: 1 / m.sqrt(m.mpf(2))),
    Hard("hypot(x, 1e-200), x = 1e200", length, 1e200, lambda m, x: 1),
    Hard("atan2(1e200, x), x = 1e200", angle, 1e200, lambda m, x: -1 / (2 * x)),
    Hard("1 / (1 + exp(-x)), x = 40", logistic, 40.0, lambda m, x: m.exp(-x) / (1 + m.exp(-x)) ** 2),
    Hard("1 / (1 + exp(-x)), x = -40", logistic, -40.0, lambda m, x: m.exp(-x) / (1 + m.exp(-x)) ** 2),
    Hard("1 / (1 + exp(-x)), x = -400", logistic, -400.0, lambda m, x: m.exp(-x) / (1 + m.exp(-x)) ** 2),
    Hard("exp(-x * x), x = 30", bell, 30.0, lambda m, x: 0),
    Hard("log(exp(x) + 1), x = 1000", soft_maximum, 1000.0, lambda m, x: 1),
    Hard("log(exp(x) + 1), x = -700", soft_maximum, -700.0, lambda m, x: m.exp(x) / (1 + m.exp(x))),
)


def table() -> Table:
    """One line for each hard case."""
    made = Table("Derivatives where rounding is hardest", ("what", "derivative", "error", "limit", ""))
    for case in CASES:
        found = float(s2sad.gradient(case.function)(case.at))
        error = _error(found, _reference(case))
        made.rows.append((case.what, f"{found:.17g}", f"{error:.1e}", f"{case.limit:g}", verdict(error, case.limit)))
    for dtype, count, limit in ((np.float64, 10 ** 6, 1e-12), (np.float32, 10 ** 6, 1e-3)):
        u = (0.1 + np.random.default_rng(3).random(count)).astype(dtype)
        found = float(s2sad.gradient(scaled_sum, "c")(u, dtype(1.5)))
        error = _error(found, math.fsum(map(float, u)))
        made.rows.append((f"sum of {count} adjoints, {np.dtype(dtype).name}", f"{found:.17g}", f"{error:.1e}",
                          f"{limit:g}", verdict(error, limit)))
    made.notes.append("relative errors; absolute where the derivative is 0. Without mpmath references are doubles.")
    return made


def _reference(case: Hard) -> Any:
    try:
        import mpmath
    except ImportError:
        return case.expected(_Doubles, case.at)
    with mpmath.workdps(60):
        return case.expected(mpmath, mpmath.mpf(case.at))


class _Doubles:
    """What the references ask of mpmath, in doubles."""
    mpf, exp, sqrt, cosh = float, math.exp, math.sqrt, math.cosh


def _error(found: float, expected: Any) -> float:
    """Relative, unless 0 is expected; infinite where the derivative is not a number."""
    if not math.isfinite(found):
        return math.inf
    apart = abs(found - expected)
    return float(apart / abs(expected)) if expected else float(apart)
