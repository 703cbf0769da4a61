"""Adjoint of kernel: d(x) / d(x).

Engine: Numba. Level: fast. Arguments:
    x: float64[:], in-out
    tolerance: float64, in

It records:
    guess_stack: guess where an iteration of `while abs(guess * guess - x[0]) > tolerance:`
        begins, 8 bytes per push
"""

# ruff: noqa: FURB136, PLR1730, RUF100

import numpy as np

from s2sad.runtime import added, grow, sized  # isort: skip


def kernel_adjoint_taped(x, x_bar, tolerance, guess_stack):
    """Adjoint of kernel: d(x) / d(x), in given memory."""
    # forward sweep: only what the reverse sweep reads
    guess = 1.0
    guess_stack = sized(guess_stack, (max(64, guess_stack.shape[0]),))
    trips = 0
    while abs(guess * guess - x[0]) > tolerance:
        guess_stack = grow(guess_stack, trips)
        guess_stack[trips] = guess
        guess = 0.5 * (guess + x[0] / guess)
        trips += 1
    # reverse sweep
    # x[0] = guess * x[1]
    seed = x_bar[0]
    x_bar[0] = 0.0
    guess_bar = x[1] * seed
    x_bar[1] += guess * seed
    if trips - 1 > -1:
        x_bar_total = x_bar[0]
        for trip in range(trips - 1, -1, -1):
            guess = guess_stack[trip]
            # guess = 0.5 * (guess + x[0] / guess)
            seed = 0.5 * guess_bar
            guess_bar = seed
            reciprocal = 1.0 / guess
            guess_bar -= x[0] * reciprocal * seed * reciprocal if seed != 0.0 else 0.0
            x_bar_total = added(x_bar_total, seed * reciprocal if seed != 0.0 else 0.0)
        # guess = 0.5 * (guess + x[0] / guess)
        x_bar[0] = x_bar_total
    return (guess_stack,)


def kernel_adjoint(x, x_bar, tolerance):
    kernel_adjoint_taped(x, x_bar, tolerance, np.empty(0))
