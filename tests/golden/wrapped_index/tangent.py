"""Tangent of kernel: d(y) / d(x).

Engine: NumPy. Level: plain. Arguments:
    y: float64[:], in-out
    x: float64[:], in
"""


def kernel_tangent(y, y_dot, x, x_dot):
    n = x.size
    for i in range(n):
        y_dot[i] = x[(i + 2) % n] * x_dot[i - 1] + x[i - 1] * x_dot[(i + 2) % n]
        y[i] = x[i - 1] * x[(i + 2) % n]
    y_here = y[-1]
    y_dot[-1] = x[-2] * y_dot[-1] + y_here * x_dot[-2]
    y[-1] = y_here * x[-2]
