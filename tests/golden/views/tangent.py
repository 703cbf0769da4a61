"""Tangent of kernel: d(x) / d(x).

Engine: NumPy. Level: plain. Arguments:
    x: float64[:, :], in-out
"""


def kernel_tangent(x, x_dot):
    for i in range(1, x.shape[0]):
        for j in range(x.shape[1]):
            x_here = x[i, j]
            x_here_2 = x[i - 1, j]
            x_dot[i, j] = x_here_2 * x_dot[i, j] + x_here * x_dot[i - 1, j]
            x[i, j] = x_here * x_here_2
