"""Adjoint of kernel: d(y) / d(x).

Engine: Numba. Level: fast. Arguments:
    y: float64[:], in-out
    x: float64[:], in

It records nothing.
"""


def kernel_adjoint(y, y_bar, x, x_bar):
    # forward sweep: only what the reverse sweep reads
    n = x.size
    for i in range(n - 2):
        y[i] = x[i - 1] * x[i + 2]
    for i in range(max(n - 2, 0), n):
        y[i] = x[i - 1] * x[(i + 2) % n]
    # reverse sweep
    # y[-1] = y[-1] * x[-2]
    seed = y_bar[-1]
    x_bar[-2] += y[-1] * seed
    y_bar[-1] = x[-2] * seed
    for i in range(n - 2):
        # y[i] = x[i - 1] * x[(i + 2) % n]
        seed = y_bar[i]
        y_bar[i] = 0.0
        x_bar[i - 1] += x[i + 2] * seed
        x_bar[i + 2] += x[i - 1] * seed
    for i in range(max(n - 2, 0), n):
        # y[i] = x[i - 1] * x[(i + 2) % n]
        seed = y_bar[i]
        y_bar[i] = 0.0
        x_bar[i - 1] += x[(i + 2) % n] * seed
        x_bar[(i + 2) % n] += x[i - 1] * seed
