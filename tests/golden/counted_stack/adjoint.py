"""Adjoint of kernel: d(return) / d(x).

Engine: NumPy. Level: plain. Arguments:
    x: float64[:], in

It records:
    state_stack: state where an iteration of `for i in range(x.size):` begins,
        8 * x.size bytes
"""

import numpy as np


def kernel_adjoint(x, x_bar, result_bar):
    # forward sweep: only what the reverse sweep reads
    state = 0.5
    state_stack = np.empty(x.size)
    for i in range(x.size):
        state_stack[i] = state
        state = np.sin(state) * x[i]
    # reverse sweep
    # return state
    state_bar = result_bar
    for i in range(x.size - 1, -1, -1):
        state = state_stack[i]
        # state = math.sin(state) * x[i]
        state_bar_1 = state_bar
        state_bar = np.cos(state) * (x[i] * state_bar_1)
        x_bar[i] += np.sin(state) * state_bar_1
