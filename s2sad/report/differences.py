"""Extrapolated central differences, with an estimate of their own error.

Richardson's extrapolation over halved steps, from several first steps; of all entries of the tableaux the one with the
least estimated error is taken for each output. (Ridders, Advances in Engineering Software 4, 1982.)
"""
from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

Line = Callable[[float], np.ndarray]
_STEPS, _LEVELS = (1e-2, 1e-3, 5e-5), 5


def differences(line: Line, wanted: float = 1e-9) -> tuple[np.ndarray, np.ndarray]:
    """The derivative of `line(h)` at 0, by output, with estimates of the errors; infinite where there is a kink.

    >>> slope, error = differences(lambda h: np.array([math.sin(1.0 + h)]))
    >>> bool(abs(slope[0] - math.cos(1.0)) < 1e-10)
    True
    """
    centre = line(0.0)
    best, error = np.zeros(0), np.full(centre.shape, math.inf)
    for step in _STEPS:
        found, estimate = _tableau(line, centre, step)
        best = found if not best.size else np.where(estimate < error, found, best)
        error = np.minimum(estimate, error)
        scale = np.abs(best) + 1e-3 * np.abs(best).max(initial=0.0)
        if np.all(error <= wanted * scale):
            break
    return best, error


def _tableau(line: Line, centre: np.ndarray, step: float) -> tuple[np.ndarray, np.ndarray]:
    steps = [step / 2 ** k for k in range(_LEVELS)]
    with np.errstate(all="ignore"):
        ups, downs = [line(h) for h in steps], [line(-h) for h in steps]
        if any(v.shape != centre.shape for v in (*ups, *downs)):
            return np.zeros(centre.shape), np.full(centre.shape, math.inf)
        rows = [(u - d) / (2 * h) for u, d, h in zip(ups, downs, steps)]
        best, error = rows[-1], np.full(centre.shape, math.inf)
        rounding = 4 * np.finfo(float).eps * np.abs(centre) / steps[-1]
        for order in range(1, _LEVELS):
            new = [fine + (fine - coarse) / (4 ** order - 1) for coarse, fine in zip(rows, rows[1:])]
            for previous, fine in zip(rows[1:], new):
                found = np.abs(previous - fine) + rounding
                best, error = np.where(found < error, fine, best), np.minimum(found, error)
            rows = new
        # at a kink the second difference over h stays; where the function is smooth it falls with h
        bends = [np.abs(u - 2 * centre + d) / h for u, d, h in zip(ups, downs, steps)]
        top = np.abs(best) + 1e-3 * np.abs(best).max(initial=0.0)
        kinked = (bends[-1] > 0.6 * bends[0]) & (bends[-1] > 1e-5 * top) & (bends[-1] > 100 * rounding)
    return best, np.where(kinked | ~np.isfinite(best) | ~np.isfinite(error), math.inf, error)
