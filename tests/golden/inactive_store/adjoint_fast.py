"""Adjoint of kernel: d(y) / d(x, y).

Engine: Numba. Level: fast. Arguments:
    y: float64[:], out
    x: float64[:], in

It records nothing.
"""


def kernel_adjoint(y, y_bar, x, x_bar):
    # reverse sweep
    # y[0] = x[0] * x[1]
    seed = y_bar[0]
    y_bar[0] = 0.0
    x_bar[0] += x[1] * seed
    x_bar[1] += x[0] * seed
    for i in range(y.size):
        # y[i] = 0.5
        y_bar[i] = 0.0
    for i in range(y.size):
        # y[i] = x[i] * x[i]
        seed = y_bar[i]
        y_bar[i] = 0.0
        x_bar[i] += 2.0 * (x[i] * seed)
