"""Tangent of kernel: d(y) / d(x, y).

Engine: NumPy. Level: plain. Arguments:
    y: float64[:], out
    x: float64[:], in
"""


def kernel_tangent(y, y_dot, x, x_dot):
    for i in range(y.size):
        y_dot[i] = x[i] * x_dot[i] + x[i] * x_dot[i]
        y[i] = x[i] * x[i]
    for i in range(y.size):
        y_dot[i] = 0.0
        y[i] = 0.5
    y_dot[0] = x[1] * x_dot[0] + x[0] * x_dot[1]
    y[0] = x[0] * x[1]
