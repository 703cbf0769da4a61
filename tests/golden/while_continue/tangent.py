"""Tangent of kernel: d(return) / d(x).

Engine: NumPy. Level: plain. Arguments:
    x: float64[:], in
"""


def kernel_tangent(x, x_dot):
    k = 0
    total_dot = 0.0
    while k < x.size:
        k = k + 1
        if not x[k - 1] < 0.0:
            total_dot += 3.0 * x[k - 1] ** 2 * x_dot[k - 1]
    return (total_dot,)
