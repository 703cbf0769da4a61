"""Adjoint of kernel: d(y) / d(x).

Engine: NumPy. Level: plain. Arguments:
    y: float64[:], out
    x: float64[:], in

It records nothing.
"""


def kernel_adjoint(y, y_bar, x, x_bar):
    # reverse sweep
    for i in range(x.size - 1, -1, -1):
        if x[i] > 0.5:
            # y[i] = x[i] * x[i]
            seed = y_bar[i]
            y_bar[i] = 0.0
            x_bar[i] += 2.0 * (x[i] * seed)
        else:
            # y[i] = 3.0 * x[i]
            seed = y_bar[i]
            y_bar[i] = 0.0
            x_bar[i] += 3.0 * seed
