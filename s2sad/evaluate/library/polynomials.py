"""polynomials: series that are summed, and polynomials as objects.

    legval(x, c)        c[0] + x * b[1] - 0.5 * b[2], b by a recurrence from the last coefficient on (Clenshaw)
"""
from __future__ import annotations

import numpy as np


def clenshaw(x, c, factor, behind):
    """The last two of b[k] = c[k] + factor(k, x) * b[k + 1] - behind(k) * b[k + 2] before c[0] is added."""
    given = np.asarray(c)
    if given.ndim != 1:
        raise NotImplementedError("series of coefficients with several axes")
    ahead, second = 0.0 * x, 0.0 * x
    for k in range(len(given) - 1, 0, -1):
        ahead, second = given[k] + factor(k, x) * ahead - behind(k) * second, ahead
    return given[0], ahead, second


def chebval(x, c):
    first, ahead, second = clenshaw(x, c, lambda k, v: 2.0 * v, lambda k: 1.0)
    return first + x * ahead - second


def legval(x, c):
    first, ahead, second = clenshaw(x, c, lambda k, v: (2 * k + 1) / (k + 1) * v, lambda k: (k + 1) / (k + 2))
    return first + x * ahead - 0.5 * second


def hermval(x, c):
    first, ahead, second = clenshaw(x, c, lambda k, v: 2.0 * v, lambda k: 2.0 * (k + 1))
    return first + 2.0 * x * ahead - 2.0 * second


def hermeval(x, c):
    first, ahead, second = clenshaw(x, c, lambda k, v: v, lambda k: 1.0 * (k + 1))
    return first + x * ahead - second


def lagval(x, c):
    first, ahead, second = clenshaw(x, c, lambda k, v: (2 * k + 1 - v) / (k + 1), lambda k: (k + 1) / (k + 2))
    return first + (1.0 - x) * ahead - 0.5 * second


def polyadd(a1, a2):
    left, right = np.atleast_1d(a1), np.atleast_1d(a2)
    n = max(len(left), len(right))
    whole = np.zeros(n)
    whole[n - len(left):] += left
    whole[n - len(right):] += right
    return whole


def polysub(a1, a2):
    return polyadd(a1, -np.asarray(a2))


class poly1d:   # noqa: PLW1641
    """A polynomial by its coefficients, the highest power first."""

    def __init__(self, c_or_r):
        self._given = np.asarray(c_or_r)

    def __call__(self, val):
        return np.polyval(self._given, val)

    def __add__(self, other):
        return poly1d(polyadd(self._given, other._given))

    def __sub__(self, other):
        return poly1d(polysub(self._given, other._given))

    def __mul__(self, other):
        return poly1d(np.polymul(self._given, other._given) if isinstance(other, poly1d) else self._given * other)

    def __rmul__(self, other):
        return poly1d(self._given * other)

    def __eq__(self, other):
        raise NotImplementedError("polynomials that are compared")

    def deriv(self):
        return poly1d(np.polyder(self._given))

    def integ(self):
        return poly1d(np.polyint(self._given))


class Polynomial:   # noqa: PLW1641
    """A polynomial by its coefficients, the lowest power first."""

    def __init__(self, coef):
        self.coef = np.asarray(coef)

    def __call__(self, arg):
        return np.polynomial.polynomial.polyval(arg, self.coef)

    def __eq__(self, other):
        raise NotImplementedError("polynomials that are compared")
