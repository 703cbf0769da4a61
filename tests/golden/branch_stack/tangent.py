"""Tangent of kernel: d(x) / d(x).

Engine: NumPy. Level: plain. Arguments:
    x: float64[:], in-out
"""

# ruff: noqa: PLR1730, RUF100


def kernel_tangent(x, x_dot):
    for i in range(1, x.size):
        if x[i] > x[i - 1]:
            x_here = x[i]
            x_here_2 = x[i - 1]
            x_dot[i] = x_here_2 * x_dot[i] + x_here * x_dot[i - 1]
            x[i] = x_here * x_here_2
        else:
            x_dot[i] = 3.0 * x_dot[i]
            x[i] = 3.0 * x[i]
