"""Adjoint of kernel: d(y) / d(y, x).

Engine: Numba. Level: fast. Arguments:
    y: float64[:], in-out
    x: float64[:, :], in

It records nothing.
"""


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


def kernel_adjoint(y, y_bar, x, x_bar):
    # reverse sweep
    for i in range(x.shape[0]):
        # y[i] = y[i] * energy(x[i])
        energy_value = energy(x[i])
        seed = y_bar[i]
        energy_value_bar = y[i] * seed
        y_bar[i] = energy_value * seed
        energy_adjoint(x[i], x_bar[i], energy_value_bar)
