"""Special functions that neither NumPy nor `math` has."""
from __future__ import annotations

import numpy as np


def digamma(x):
    """The derivative of log(gamma(x)), nan at the poles 0, -1, -2, ...

    Below 0 by reflection, psi(x) = psi(1 - x) - pi / tan(pi x); then psi(x) = psi(x + 1) - 1 / x up to
    x >= 10, and there by the asymptotic series, whose first term left out is 0.44 / x**16
    (M. Abramowitz, I. A. Stegun, Handbook of Mathematical Functions, 1964, 6.3.5, 6.3.7, 6.3.18).

    >>> round(digamma(1.0), 12), round(digamma(-0.5), 12)
    (-0.577215664902, 0.036489973979)
    """
    shifted = np.float64(x)
    if shifted <= 0.0 and shifted == np.floor(shifted):
        return np.nan
    result = 0.0
    if shifted < 0.0:
        result -= np.pi / np.tan(np.pi * (shifted - np.rint(shifted)))
        shifted = 1.0 - shifted
    while shifted < 10.0:
        result -= 1.0 / shifted
        shifted += 1.0
    s = 1.0 / (shifted * shifted)
    series = 1 / 132 - s * (691 / 32760 - s / 12)
    series = s * (1 / 12 - s * (1 / 120 - s * (1 / 252 - s * (1 / 240 - s * series))))
    return float(result + (np.log(shifted) - 0.5 / shifted - series))
