"""Special functions that neither NumPy nor `math` has; those of SciPy's of numbers, for compiled code."""
from __future__ import annotations

import math

import numpy as np


def digamma(x):
    """The derivative of log(gamma(x)), nan at the poles -1, -2, ..., infinite at 0, as SciPy's.

    Below 0 by reflection, psi(x) = psi(1 - x) - pi / tan(pi x); then psi(x) = psi(x + 1) - 1 / x up to
    x >= 10, and there by the asymptotic series, whose first term left out is 0.44 / x**16
    (M. Abramowitz, I. A. Stegun, Handbook of Mathematical Functions, 1964, 6.3.5, 6.3.7, 6.3.18).

    >>> round(digamma(1.0), 12), round(digamma(-0.5), 12)
    (-0.577215664902, 0.036489973979)
    """
    shifted = np.float64(x)
    if shifted == 0.0:
        return -math.copysign(math.inf, shifted)
    if shifted <= 0.0 and shifted == np.floor(shifted):
        return np.nan
    result = 0.0
    if shifted < 0.0:
        result -= np.pi / np.tan(np.pi * (shifted - np.rint(shifted)))
        shifted = 1.0 - shifted
    lost = 0.0  # what additions round off
    while shifted < 10.0:
        before = result
        result -= 1.0 / shifted
        lost += (before - result) - 1.0 / shifted
        shifted += 1.0
    s = 1.0 / (shifted * shifted)
    series = 1 / 132 - s * (691 / 32760 - s / 12)
    series = s * (1 / 12 - s * (1 / 120 - s * (1 / 252 - s * (1 / 240 - s * series))))
    return float(result + np.log(shifted) + (lost - 0.5 / shifted - series))


def gammaln(x):
    """log(abs(gamma(x))), infinite at its poles and where it is above all numbers, as SciPy's.

    >>> gammaln(1.0), gammaln(-1.0), gammaln(3e305)
    (0.0, inf, inf)
    """
    value = float(x)
    if value == -math.inf:
        return value
    if value > 2.5e305 or value <= 0.0 and value == math.floor(value):
        return math.inf
    return math.lgamma(value)


def expit(x):
    """1 / (1 + exp(-x)), the logistic function.

    >>> float(expit(0.0)), float(expit(-800.0))
    (0.5, 0.0)
    """
    return 1.0 / (1.0 + np.exp(-x))


def logit(x):
    """log(x / (1 - x)); around 1 / 2 without a difference of logarithms.

    >>> float(logit(0.5)), float(logit(0.0))
    (0.0, -inf)
    """
    if 0.3 < x < 0.65:
        return np.log1p((2.0 * x - 1.0) / (1.0 - x))
    if x == 1.0:
        return np.inf
    return np.log(x / (1.0 - x))


def xlogy(a, b):
    """a * log(b), 0 where a is 0.

    >>> float(xlogy(0.0, 0.0)), float(xlogy(2.0, 1.0))
    (0.0, 0.0)
    """
    if a == 0.0 and b == b:
        return 0.0
    return a * np.log(b)


def xlog1py(a, b):
    """a * log(1 + b), 0 where a is 0.

    >>> float(xlog1py(0.0, -1.0)), float(xlog1py(2.0, 0.0))
    (0.0, 0.0)
    """
    if a == 0.0 and b == b:
        return 0.0
    return a * np.log1p(b)


def entr(x):
    """-x * log(x), 0 at 0, -inf below.

    >>> float(entr(0.0)), float(entr(-1.0)), abs(float(entr(1.0)))
    (0.0, -inf, 0.0)
    """
    if x == 0.0:
        return 0.0
    return -np.inf if x < 0.0 else -x * np.log(x)


def rel_entr(a, b):
    """a * log(a / b), 0 where a is 0 and b is not below 0, inf where either is below 0.

    >>> float(rel_entr(0.0, 0.0)), float(rel_entr(2.0, 2.0)), float(rel_entr(1.0, 0.0))
    (0.0, 0.0, inf)
    """
    if a != a or b != b:
        return a + b
    if a > 0.0 and b > 0.0:
        return a * np.log(a / b)
    return 0.0 if a == 0.0 and b >= 0.0 else np.inf


def kl_div(a, b):
    """a * log(a / b) - a + b, as `rel_entr`.

    >>> float(kl_div(0.0, 2.0)), float(kl_div(2.0, 2.0)), float(kl_div(1.0, 0.0))
    (2.0, 0.0, inf)
    """
    if a != a or b != b:
        return a + b
    if a > 0.0 and b > 0.0:
        return a * np.log(a / b) - a + b
    return b if a == 0.0 and b >= 0.0 else np.inf
