"""Extrapolated central differences, with an estimate of their own error.

Richardson's extrapolation over halved steps, from several first steps; of all entries of the tableaux the one with the
least estimated error is taken for each output. (Ridders, Advances in Engineering Software 4, 1982.) That two entries
agree can be chance where rounding decides, and of many entries the one that does is chosen: what rounding adds to
the values is therefore measured, and no entry is taken for better than that over its finest step. (Moré and Wild,
Estimating computational noise, SIAM Journal on Scientific Computing 33, 2011.)
"""
from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

Line = Callable[[float], np.ndarray]
_LEAST = 4 * np.finfo(float).eps        # what rounding does to a number at least, as a fraction of it
_STEPS, _LEVELS = (1e-2, 2e-3, 3e-4, 4e-5), 5
_APART, _EACH_SIDE, _ORDERS = 1e-7, 4, range(4, 7)     # where rounding is measured: so near that nothing else is seen


def differences(line: Line, wanted: float = 1e-9, noise: np.ndarray | None = None) -> tuple[np.ndarray, np.ndarray]:
    """The derivative of `line(h)` at 0, by output, with estimates of the errors; infinite where there is a kink.

    `noise` is what rounding adds to the values, if it is known; it is measured along the line otherwise.

    >>> slope, error = differences(lambda h: np.array([math.sin(1.0 + h)]))
    >>> bool(abs(slope[0] - math.cos(1.0)) < 1e-10)
    True
    """
    centre, (down, up) = line(0.0), (line(-_APART), line(_APART))
    noise = np.maximum(_LEAST * np.abs(centre), rounding(line) if noise is None else noise)
    best, error = np.zeros(0), np.full(centre.shape, math.inf)
    for step in _STEPS:
        found, estimate = _tableau(line, centre, noise, step)
        best = found if not best.size else np.where(estimate < error, found, best)
        error = np.minimum(estimate, error)
        scale = np.abs(best) + 1e-3 * np.abs(best).max(initial=0.0)
        if np.all(error <= wanted * scale):
            break
    return best, _unless_narrower(best, error, noise, down, up)


def _unless_narrower(best: np.ndarray, error: np.ndarray, noise: np.ndarray, down: np.ndarray, up: np.ndarray
                     ) -> np.ndarray:
    """The error; infinite where the slope between two neighbours is another: the steps went past something narrow."""
    if down.shape != best.shape or up.shape != best.shape:
        return np.full(best.shape, math.inf)
    with np.errstate(all="ignore"):
        apart, scale = np.abs(best - (up - down) / (2 * _APART)), np.abs(best) + 1e-3 * np.abs(best).max(initial=0.0)
        return np.where(apart <= 10 * (error + noise / _APART) + 1e-8 * scale + 1e-11, error, math.inf)


def rounding(line: Line) -> np.ndarray:
    """The standard deviation of what rounding adds to the values of a line near 0, by output; infinite if unknown.

    High differences of values at neighbouring places hold nothing else; those of a condition number c have
    about c times the machine's precision of the value.

    >>> bool(1e-9 < rounding(lambda h: np.array([1e8 + h - 1e8]))[0] < 1e-8)
    True
    """
    with np.errstate(all="ignore"):
        near = [line(k * _APART) for k in range(-_EACH_SIDE, _EACH_SIDE + 1)]
        if any(v.shape != near[_EACH_SIDE].shape for v in near):
            return np.full(near[_EACH_SIDE].shape, math.inf)
        table, found = np.array(near), np.zeros(near[0].shape)
        for order in range(1, _ORDERS.stop):
            table = np.diff(table, axis=0)
            if order in _ORDERS:
                weight = math.factorial(order) / math.sqrt(math.factorial(2 * order))
                found = np.maximum(found, weight * np.sqrt(np.mean(table * table, axis=0)))
    return np.where(np.isfinite(found), found, math.inf)


def _tableau(line: Line, centre: np.ndarray, noise: np.ndarray, step: float) -> tuple[np.ndarray, np.ndarray]:
    steps = [step / 2 ** k for k in range(_LEVELS)]
    with np.errstate(all="ignore"):
        ups, downs = [line(h) for h in steps], [line(-h) for h in steps]
        if any(v.shape != centre.shape for v in (*ups, *downs)):
            return np.zeros(centre.shape), np.full(centre.shape, math.inf)
        rows = [(u - d) / (2 * h) for u, d, h in zip(ups, downs, steps)]
        best, error = rows[-1], np.full(centre.shape, math.inf)
        for order in range(1, _LEVELS):
            new = [fine + (fine - coarse) / (4 ** order - 1) for coarse, fine in zip(rows, rows[1:])]
            for coarse, previous, fine, finest in zip(rows, rows[1:], new, steps[order:]):
                found = np.maximum(np.abs(previous - fine), np.abs(coarse - fine))
                found += noise / finest + _LEAST * np.abs(fine)
                best, error = np.where(found < error, fine, best), np.minimum(found, error)
            rows = new
        # at a kink the second difference over h stays; where the function is smooth it falls with h
        bends = [np.abs(u - 2 * centre + d) / h for u, d, h in zip(ups, downs, steps)]
        top = np.abs(best) + 1e-3 * np.abs(best).max(initial=0.0)
        kinked = (bends[-1] > 0.6 * bends[0]) & (bends[-1] > 1e-5 * top) & (bends[-1] > 20 * noise / steps[-1])
    return best, np.where(kinked | ~np.isfinite(best) | ~np.isfinite(error), math.inf, error)
