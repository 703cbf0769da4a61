"""Adjoint of kernel: d(x) / d(x).

Engine: NumPy. Level: plain. Arguments:
    x: float64[:], in-out

It records nothing.
"""


def kernel_adjoint(x, x_bar):
    # forward sweep: only what the reverse sweep reads
    a = x[0]
    b = 2.0 * x[1]
    a_before = a
    a_1 = b
    b_1 = a_before
    # reverse sweep
    # x[0] = a * b
    seed = x_bar[0]
    x_bar[0] = 0.0
    a_1_bar = b_1 * seed
    b_1_bar = a_1 * seed
    # x[1], x[2] = x[2], x[1]
    seed = x_bar[2]
    x_bar[2] = 0.0
    held_bar = seed
    x_here_2_bar = x_bar[1]
    x_bar[1] = held_bar
    x_bar[2] += x_here_2_bar
    # a, b = b, a
    a_before_bar = b_1_bar
    b_bar = a_1_bar
    a_bar = a_before_bar
    # a, b = x[0], 2.0 * x[1]
    x_bar[1] += 2.0 * b_bar
    x_bar[0] += a_bar
