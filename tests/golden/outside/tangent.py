"""Tangent of kernel: d(return) / d(x).

Engine: NumPy. Level: plain. Arguments:
    x: float64[:], in
    the array TABLE: float64[:], in
"""

G = 9.81


def kernel_tangent(x, x_dot, TABLE):
    total_dot = 0.0
    for i in range(x.size):
        total_dot += TABLE[i] * (2.0 * x[i] * x_dot[i])
    return (G * total_dot,)
