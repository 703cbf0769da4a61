"""Tangent of kernel: d(y) / d(y, x).

Engine: NumPy. Level: plain. Arguments:
    y: float64[:], in-out
    x: float64[:], in
"""


def kernel_tangent(y, y_dot, x, x_dot):
    total = 0.0
    product = 1.0
    total_dot = 0.0
    product_dot = 0.0
    for i in range(x.size):
        total += x[i] * x[i]
        total_dot += x[i] * x_dot[i] + x[i] * x_dot[i]
        y_dot[0] -= 2.0 * x_dot[i]
        y[0] -= 2.0 * x[i]
        product_1 = product * x[i]
        product_dot = x[i] * product_dot + product * x_dot[i]
        product = product_1
    y_dot[1] = product * total_dot + total * product_dot
    y[1] = total * product
