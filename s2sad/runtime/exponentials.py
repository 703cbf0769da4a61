"""The exponential and the hyperbolic functions of float64 numbers, in a form that compilers turn into
vector instructions: no branch, no table, no call.

x = k ln 2 + r with |r| <= ln(2) / 2, so that e^x = 2^k e^r; k ln 2 is subtracted in two parts, of which
k times the first is exact (W. J. Cody, W. Waite, Software Manual for the Elementary Functions, 1980).
Every function is within 2.5 units in the last place (exp: 1, sech_squared: 3.2), and gives what NumPy's does at 0,
infinity and nan.
"""
from __future__ import annotations

import numpy as np


def exp(x):
    """`numpy.exp(x)` of a number.

    >>> float(exp(0.0)), float(exp(-745.0)), float(exp(-np.inf)), float(exp(np.inf))
    (1.0, 5e-324, 0.0, inf)
    """
    inside = min(710.0, max(-746.0, x))
    k = exponent(inside)
    value = scaled(1.0 + less_one(inside, k), k)
    return 1.0 * x if np.isnan(x) else value


def expm1(x):
    """`numpy.expm1(x)` of a number: exp(x) - 1, right for small x as well.

    >>> float(expm1(1e-300)), float(expm1(-np.inf)), float(expm1(np.inf))
    (1e-300, -1.0, inf)
    """
    value = exp_less_one(x, 0)
    return value if x != 0.0 and not np.isnan(x) else 1.0 * x


def sinh(x):
    """`numpy.sinh(x)` of a number.

    >>> float(sinh(1e-300)), float(sinh(-np.inf)), bool(np.isfinite(sinh(710.4)))
    (1e-300, -inf, True)
    """
    half = exp_less_one(max(0.0, abs(x)), -1)
    size = half + half / (2.0 * half + 1.0) if half < 1e18 else half
    value = size if x > 0.0 else -size
    return value if x != 0.0 and not np.isnan(x) else 1.0 * x


def cosh(x):
    """`numpy.cosh(x)` of a number.

    >>> float(cosh(0.0)), float(cosh(-np.inf)), bool(np.isfinite(cosh(710.4)))
    (1.0, inf, True)
    """
    inside = min(712.0, abs(x))
    k = exponent(inside)
    half = scaled(1.0 + less_one(inside, k), k - 1)
    value = half + 0.25 / half
    return 1.0 * x if np.isnan(x) else value


def tanh(x):
    """`numpy.tanh(x)` of a number.

    >>> float(tanh(1e-300)), float(tanh(-40.0)), float(tanh(np.inf))
    (1e-300, -1.0, 1.0)
    """
    raised = exp_less_one(min(708.0, 2.0 * abs(x)), 0)
    size = raised * (1.0 / (raised + 2.0))
    value = size if x > 0.0 else -size
    return value if x != 0.0 and not np.isnan(x) else 1.0 * x


def sech_squared(x):
    """1 / `numpy.cosh(x)` ** 2 of a number, the derivative of tanh; 0 where it is less than 2e-307.

    Beside tanh it shares the exponential and the quotient with it.

    >>> float(sech_squared(0.0)), float(sech_squared(-np.inf)), 0.0 < float(sech_squared(353.0)) < 1e-305
    (1.0, 0.0, True)
    """
    raised = exp_less_one(min(708.0, 2.0 * abs(x)), 0)
    half = 1.0 / (raised + 2.0)
    value = 0.0 if abs(x) > 354.0 else 4.0 * ((raised + 1.0) * half) * half
    return 1.0 * x if np.isnan(x) else value


def exp_less_one(x, power):
    """(e^x - 1) 2^power, for a power of 0 or -1.

    >>> float(exp_less_one(0.0, 0)), float(exp_less_one(-100.0, -1))
    (0.0, -0.5)
    """
    inside = min(712.0, max(-60.0, x))
    k = exponent(inside)
    one = 1.0 - scaled(1.0, -min(k, 100))  # what is less does not count
    return scaled(less_one(inside, k) + one, k + power)


def exponent(x):
    """The integer next to x / ln 2.

    >>> int(exponent(1.0)), int(exponent(-1.0))
    (1, -1)
    """
    return np.int64(np.floor(1.4426950408889634 * x + 0.5))


def less_one(x, k):
    """e^(x - k ln 2) - 1 for k = exponent(x): Taylor's polynomial of degree 13.

    >>> less_one(0.0, 0)
    0.0
    """
    r = (x - k * 6.93145751953125e-1) - k * 1.4286068203094172e-6
    r2 = r * r
    r4 = r2 * r2
    low = 0.5 + r * (1 / 6) + r2 * (1 / 24 + r * (1 / 120))
    middle = 1 / 720 + r * (1 / 5040) + r2 * (1 / 40320 + r * (1 / 362880))
    high = 1 / 3628800 + r * (1 / 39916800) + r2 * (1 / 479001600 + r * (1 / 6227020800))
    return r + r2 * (low + r4 * (middle + r4 * high))


def scaled(x, k):
    """x 2^k, rounded once; |k| up to 2044.

    >>> float(scaled(0.75, 2)), float(scaled(1.0, -1074)), float(scaled(1.0, 1024))
    (3.0, 5e-324, inf)
    """
    half = k >> 1
    first = np.int64((half + 1023) << 52).view(np.float64)
    second = np.int64((k - half + 1023) << 52).view(np.float64)
    return x * first * second
