"""Adjoint of kernel: d(return) / d(x).

Engine: Numba. Level: fast. Arguments:
    x: float64[:], in

It records:
    state_stack: state where an iteration of `for i in range(x.size):` begins,
        8 * x.size bytes
"""

import math

import numpy as np

from s2sad.runtime import sized  # isort: skip


def kernel_adjoint_taped(x, x_bar, result_bar, state_stack):
    """Adjoint of kernel: d(return) / d(x), in given memory."""
    # forward sweep: only what the reverse sweep reads
    state = 0.5
    state_stack = sized(state_stack, (x.size,))
    for i in range(x.size):
        state_stack[i] = state
        state = math.sin(state) * x[i]
    # reverse sweep
    # return state
    state_bar = result_bar
    for i in range(x.size - 1, -1, -1):
        state = state_stack[i]
        # state = math.sin(state) * x[i]
        state_bar_1 = state_bar
        state_bar = np.cos(state) * (x[i] * state_bar_1)
        x_bar[i] += math.sin(state) * state_bar_1
    return (state_stack,)


def kernel_adjoint(x, x_bar, result_bar):
    kernel_adjoint_taped(x, x_bar, result_bar, np.empty(0))
