"""Tangent of kernel: d(return) / d(x, a).

Engine: NumPy. Level: plain. Arguments:
    x: float64[:], in
    a: float64, in
"""


def kernel_tangent(x, x_dot, a, a_dot):
    product = a
    product_dot = a_dot
    total_dot = 0.0
    for i in range(x.size):
        total_dot += x[i] * a_dot + a * x_dot[i]
        product_1 = product * x[i]
        product_dot = x[i] * product_dot + product * x_dot[i]
        product = product_1
    return total_dot, product_dot
