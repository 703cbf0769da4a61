"""Adjoint of kernel: d(return) / d(x).

Engine: NumPy. Level: plain. Arguments:
    x: float64[:], in
    the array TABLE: float64[:], in

It records nothing.
"""

G = 9.81


def kernel_adjoint(x, x_bar, TABLE, result_bar):
    # reverse sweep
    # return G * total
    total_bar = G * result_bar
    for i in range(x.size - 1, -1, -1):
        # total += TABLE[i] * x[i] ** 2
        x_bar[i] += 2.0 * x[i] * (TABLE[i] * total_bar)
