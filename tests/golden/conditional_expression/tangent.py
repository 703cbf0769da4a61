"""Tangent of kernel: d(y) / d(x).

Engine: NumPy. Level: plain. Arguments:
    y: float64[:], out
    x: float64[:], in
"""

# ruff: noqa: PLR1730, RUF100


def kernel_tangent(y, y_dot, x, x_dot):
    for i in range(x.size):
        if i < x.size - 1:
            right = x[i + 1]
            right_dot = x_dot[i + 1]
        else:
            right = 0.5
            right_dot = 0.0
        y_dot[i] = x[i] * right_dot + right * x_dot[i]
        y[i] = right * x[i]
