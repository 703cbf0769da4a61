"""Adjoint of kernel: d(x) / d(x).

Engine: NumPy. Level: plain. Arguments:
    x: float64[:], in-out
    tolerance: float64, in

It records:
    guess_stack: guess where an iteration of `while abs(guess * guess - x[0]) > tolerance:`
        begins, 8 bytes per push
"""

# ruff: noqa: FURB136, RUF100

import numpy as np

from s2sad.runtime import grow  # isort: skip


def kernel_adjoint(x, x_bar, tolerance):
    # forward sweep: only what the reverse sweep reads
    guess = 1.0
    guess_stack = np.empty(64)
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
    for trip in range(trips - 1, -1, -1):
        guess = guess_stack[trip]
        # guess = 0.5 * (guess + x[0] / guess)
        seed = 0.5 * guess_bar
        guess_bar = seed
        guess_bar -= x[0] / guess * seed / guess if seed != 0.0 else 0.0
        x_bar[0] += seed / guess if seed != 0.0 else 0.0
