"""Adjoint of kernel: d(y) / d(y, x).

Engine: Numba. Level: fast. Arguments:
    y: float64[:], in-out
    x: float64[:, :], in

It records:
    energy_value_stack: a part of `y[i] = y[i] * energy(x[i])`, 8 * x.shape[0] bytes
    y_stack: y before `y[i] = y[i] * energy(x[i])`, 8 * x.shape[0] bytes
"""

import numpy as np

from s2sad.runtime import sized  # isort: skip


def square(a):
    return a * a


def energy(row):
    total = 0.0
    for i in range(row.size):
        square_value = square(row[i])
        total += square_value
    return total


def square_adjoint(a, result_bar):
    """Adjoint of square: d(return) / d(a)."""
    # reverse sweep
    # return a * a
    a_bar = 2.0 * (a * result_bar)
    return (a_bar,)


def energy_adjoint(row, row_bar, result_bar):
    """Adjoint of energy: d(return) / d(row)."""
    # reverse sweep
    # return total
    total_bar = result_bar
    for i in range(row.size):
        # total += square(row[i])
        square_value_bar = total_bar
        (gain,) = square_adjoint(row[i], square_value_bar)
        row_bar[i] += gain


def kernel_adjoint_taped(y, y_bar, x, x_bar, energy_value_stack, y_stack):
    """Adjoint of kernel: d(y) / d(y, x), over given stacks."""
    # forward sweep: only what the reverse sweep reads
    energy_value_stack = sized(energy_value_stack, (x.shape[0],))
    y_stack = sized(y_stack, (x.shape[0],))
    for i in range(x.shape[0]):
        energy_value = energy(x[i])
        energy_value_stack[i] = energy_value
        y_stack[i] = y[i]
        y[i] = y[i] * energy_value
    # reverse sweep
    for i in range(x.shape[0]):
        # y[i] = y[i] * energy(x[i])
        energy_value = energy_value_stack[i]
        y[i] = y_stack[i]
        seed = y_bar[i]
        energy_value_bar = y[i] * seed
        y_bar[i] = energy_value * seed
        energy_adjoint(x[i], x_bar[i], energy_value_bar)
    return energy_value_stack, y_stack


def kernel_adjoint(y, y_bar, x, x_bar):
    kernel_adjoint_taped(y, y_bar, x, x_bar, np.empty(0), np.empty(0))
