"""The elementwise functions and their partials over real numbers, by mpmath: what is measured against.

A partial is written from the definition, not as the rule writes it; where it has no closed form that holds, or several
branches, the one that is meant at the kinks of `docs/semantics.md` is chosen. None where there is no derivative.
"""
from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from benchmarks.precision.quad import mpmath as m

Real = Callable[..., Any]


@dataclass(frozen=True)
class Truth:
    """value: the function; partials: by parameter, in their order; digits: how many it takes."""
    value: Real
    partials: tuple[Real, ...]
    digits: int = 60


def _zero(*_: Any) -> Any:
    return m.mpf(0)


def _one(*_: Any) -> Any:
    return m.mpf(1)


def _whole(quotient: Any) -> Any:
    """To the nearest integer, halves to even ones."""
    return m.nint(quotient)


def _first(better: Callable[[Any, Any], bool]) -> tuple[Real, Real]:
    """The partials of a choice of two that keeps the first unless the second is better."""
    return (lambda a, b: m.mpf(not better(b, a))), (lambda a, b: m.mpf(better(b, a)))


def _choice(better: Callable[[Any, Any], bool]) -> Truth:
    return Truth(lambda a, b: b if better(b, a) else a, _first(better))


def _sigma(x: Any) -> Any:
    return 1 / (1 + m.exp(-x))


def _sinc(x: Any) -> Any:
    return m.mpf(1) if x == 0 else m.sin(m.pi * x) / (m.pi * x)


def _sinc_partial(x: Any) -> Any:
    return m.mpf(0) if x == 0 else (m.cos(m.pi * x) - _sinc(x)) / x


def _truncated(a: Any, b: Any) -> Any:
    quotient = a / b
    return m.floor(quotient) if quotient >= 0 else m.ceil(quotient)


def _gamma_log(x: Any) -> Any:
    return m.log(abs(m.gamma(x)))


def _inside(a: Any, b: Any) -> int:
    if a <= 0 or b <= 0:
        raise ValueError("an entropy of what is not above 0")
    return 1


def _clip(x: Any, low: Any, high: Any) -> Any:
    return min(max(x, low), high)


_SUM = Truth(lambda a, b: a + b, (_one, _one), 700)
_ANGLE = 180 / m.pi
SQUARED = 2 / m.sqrt(m.pi)

TRUTHS: dict[str, Truth] = {
    "+": _SUM, "-": Truth(lambda a, b: a - b, (_one, lambda a, b: m.mpf(-1)), 700),
    "*": Truth(lambda a, b: a * b, (lambda a, b: b, lambda a, b: a)),
    "/": Truth(lambda a, b: a / b, (lambda a, b: 1 / b, lambda a, b: -a / b ** 2)),
    "%": Truth(lambda a, b: a - b * m.floor(a / b), (_one, lambda a, b: -m.floor(a / b)), 700),
    "fmod": Truth(lambda a, b: a - b * _truncated(a, b), (_one, lambda a, b: -_truncated(a, b)), 700),
    "remainder": Truth(lambda a, b: a - b * _whole(a / b), (_one, lambda a, b: -_whole(a / b)), 700),
    "negative": Truth(lambda a: -a, (lambda a: m.mpf(-1),)), "positive": Truth(lambda a: a, (_one,)),
    "square": Truth(lambda x: x * x, (lambda x: 2 * x,)),
    "reciprocal": Truth(lambda x: 1 / x, (lambda x: -1 / x ** 2,)),
    "absolute": Truth(abs, (m.sign,)), "heaviside": Truth(
        lambda x, h: h if x == 0 else m.mpf(x > 0), (_zero, lambda x, h: m.mpf(x == 0))),
    "copysign": Truth(lambda a, b: abs(a) if b >= 0 else -abs(a),
                      (lambda a, b: m.sign(a) if b >= 0 else -m.sign(a), _zero)),
    "maximum": _choice(lambda b, a: b > a), "minimum": _choice(lambda b, a: b < a),
    "clip": Truth(_clip, (lambda x, low, high: m.mpf(low <= x <= high), lambda x, low, high: m.mpf(x < low <= high),
                          lambda x, low, high: m.mpf(max(x, low) > high))),
    "where": Truth(lambda c, a, b: a if c > 0 else b,
                   (_zero, lambda c, a, b: m.mpf(c > 0), lambda c, a, b: m.mpf(c <= 0))),
    "exp": Truth(m.exp, (m.exp,)), "exp2": Truth(lambda x: 2 ** x, (lambda x: m.ln2 * 2 ** x,)),
    "expm1": Truth(m.expm1, (m.exp,)), "log": Truth(m.log, (lambda x: 1 / x,)),
    "log2": Truth(lambda x: m.log(x) / m.ln2, (lambda x: 1 / (x * m.ln2),)),
    "log10": Truth(m.log10, (lambda x: 1 / (x * m.ln10),)), "log1p": Truth(m.log1p, (lambda x: 1 / (1 + x),)),
    "logaddexp": Truth(lambda a, b: max(a, b) + m.log1p(m.exp(-abs(a - b))),
                       (lambda a, b: _sigma(a - b), lambda a, b: _sigma(b - a)), 400),
    "logaddexp2": Truth(lambda a, b: max(a, b) + m.log1p(2 ** -abs(a - b)) / m.ln2,
                        (lambda a, b: 1 / (1 + 2 ** (b - a)), lambda a, b: 1 / (1 + 2 ** (a - b))), 400),
    "sqrt": Truth(m.sqrt, (lambda x: 1 / (2 * m.sqrt(x)),)),
    "cbrt": Truth(lambda x: m.sign(x) * m.cbrt(abs(x)), (lambda x: 1 / (3 * m.cbrt(abs(x)) ** 2),)),
    "hypot": Truth(m.hypot, (lambda a, b: a / m.hypot(a, b) if a or b else m.mpf(0),
                             lambda a, b: b / m.hypot(a, b) if a or b else m.mpf(0))),
    "sin": Truth(m.sin, (m.cos,), 400), "cos": Truth(m.cos, (lambda x: -m.sin(x),), 400),
    "tan": Truth(m.tan, (lambda x: 1 + m.tan(x) ** 2,), 400),
    "arcsin": Truth(m.asin, (lambda x: 1 / m.sqrt((1 - x) * (1 + x)),)),
    "arccos": Truth(m.acos, (lambda x: -1 / m.sqrt((1 - x) * (1 + x)),)),
    "arctan": Truth(m.atan, (lambda x: 1 / (1 + x * x),)),
    "arctan2": Truth(m.atan2, (lambda a, b: b / (a * a + b * b), lambda a, b: -a / (a * a + b * b))),
    "deg2rad": Truth(lambda x: x / _ANGLE, (lambda x: 1 / _ANGLE,)),
    "rad2deg": Truth(lambda x: x * _ANGLE, (lambda x: _ANGLE,)),
    "sinc": Truth(_sinc, (_sinc_partial,), 1400),
    "sinh": Truth(m.sinh, (m.cosh,)), "cosh": Truth(m.cosh, (m.sinh,)),
    "tanh": Truth(m.tanh, (lambda x: m.sech(x) ** 2,)),
    "arcsinh": Truth(m.asinh, (lambda x: 1 / m.sqrt(1 + x * x),), 700),
    "arccosh": Truth(m.acosh, (lambda x: 1 / m.sqrt((x - 1) * (x + 1)),)),
    "arctanh": Truth(m.atanh, (lambda x: 1 / ((1 - x) * (1 + x)),), 700),
    "erf": Truth(m.erf, (lambda x: SQUARED * m.exp(-x * x),)),
    "erfc": Truth(m.erfc, (lambda x: -SQUARED * m.exp(-x * x),)),
    "gamma": Truth(m.gamma, (lambda x: m.gamma(x) * m.digamma(x),)),
    "lgamma": Truth(_gamma_log, (m.digamma,)),
    "expit": Truth(_sigma, (lambda x: _sigma(x) * _sigma(-x),)),
    "logit": Truth(lambda x: m.log(x / (1 - x)), (lambda x: 1 / (x * (1 - x)),)),
    "xlogy": Truth(lambda a, b: a * m.log(b) if a else a, (lambda a, b: m.log(b), lambda a, b: a / b)),
    "xlog1py": Truth(lambda a, b: a * m.log1p(b) if a else a, (lambda a, b: m.log1p(b), lambda a, b: a / (1 + b))),
    "entr": Truth(lambda x: -x * m.log(x), (lambda x: -m.log(x) - 1,)),
    "rel_entr": Truth(lambda a, b: _inside(a, b) * a * m.log(a / b),
                      (lambda a, b: m.log(a / b) + 1, lambda a, b: -a / b)),
    "kl_div": Truth(lambda a, b: _inside(a, b) * a * m.log(a / b) - a + b,
                    (lambda a, b: m.log(a / b), lambda a, b: 1 - a / b)),
    "power": Truth(m.power, (lambda a, b: b * m.power(a, b - 1) if b else m.mpf(0),
                             lambda a, b: m.power(a, b) * m.log(a) if a else m.mpf(0))),
}
SAME = {"add": "+", "subtract": "-", "multiply": "*", "divide": "/", "true_divide": "/", "mod": "%", "abs": "absolute",
        "fabs": "absolute", "max": "maximum", "min": "minimum", "fmax": "maximum", "fmin": "minimum", "asin": "arcsin",
        "acos": "arccos", "atan": "arctan", "atan2": "arctan2", "radians": "deg2rad", "degrees": "rad2deg",
        "asinh": "arcsinh", "acosh": "arccosh", "atanh": "arctanh", "gammaln": "lgamma", "pow": "power",
        "float_power": "power", "**": "power", "float": "positive", "float64": "positive", "conj": "positive",
        "conjugate": "positive", "real": "positive"}


def truth(rule: str) -> Truth | None:
    """What a rule is held against; None for what is a matter of dtypes or of complex numbers."""
    if rule == "-a" or rule == "+a":
        return TRUTHS["negative" if rule == "-a" else "positive"]
    if rule == "numpy.remainder":
        return TRUTHS["%"]
    last = rule.split()[1] if " " in rule else rule.rpartition(".")[2]
    return TRUTHS.get(SAME.get(last, last))
