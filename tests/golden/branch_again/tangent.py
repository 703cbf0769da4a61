"""Tangent of kernel: d(y) / d(x).

Engine: NumPy. Level: plain. Arguments:
    y: float64[:], out
    x: float64[:], in
"""

# ruff: noqa: PLR1730, RUF100


def kernel_tangent(y, y_dot, x, x_dot):
    for i in range(x.size):
        if x[i] > 0.5:
            y_dot[i] = x[i] * x_dot[i] + x[i] * x_dot[i]
            y[i] = x[i] * x[i]
        else:
            y_dot[i] = 3.0 * x_dot[i]
            y[i] = 3.0 * x[i]
