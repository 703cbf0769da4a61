"""Tangent of kernel: d(y) / d(x).

Engine: NumPy. Level: plain. Arguments:
    y: float64[:], out
    x: float64[:], in-out
"""


def kernel_tangent(y, y_dot, x, x_dot):
    for i in range(x.size):
        x_here = x[i]
        x_here_dot = x_dot[i]
        x_dot[i] = x_here * x_here_dot + x_here * x_here_dot
        x[i] = x_here * x_here
        y_dot[i] = 3.0 * x_dot[i]
        y[i] = 3.0 * x[i]
