"""Tangent of kernel: d(y) / d(x).

Engine: NumPy. Level: plain. Arguments:
    y: float64[:], out
    x: float64[:], in
"""


def kernel_tangent(y, y_dot, x, x_dot):
    assert x.size > 0, "no data"
    for i in range(x.size):
        y_dot[i] = 2.0 * x_dot[i]
        y[i] = 2.0 * x[i]
