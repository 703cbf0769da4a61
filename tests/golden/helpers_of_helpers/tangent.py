"""Tangent of kernel: d(y) / d(y, x).

Engine: NumPy. Level: plain. Arguments:
    y: float64[:], in-out
    x: float64[:, :], in
"""


def square_tangent(a, a_dot):
    """Tangent of square: d(return) / d(a)."""
    return a * a, a * a_dot + a * a_dot


def energy_tangent(row, row_dot):
    """Tangent of energy: d(return) / d(row)."""
    total = 0.0
    total_dot = 0.0
    for i in range(row.size):
        square_value, square_value_dot = square_tangent(row[i], row_dot[i])
        total += square_value
        total_dot += square_value_dot
    return total, total_dot


def kernel_tangent(y, y_dot, x, x_dot):
    for i in range(x.shape[0]):
        energy_value, energy_value_dot = energy_tangent(x[i], x_dot[i])
        y_here = y[i]
        y_dot[i] = energy_value * y_dot[i] + y_here * energy_value_dot
        y[i] = y_here * energy_value
