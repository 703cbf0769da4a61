"""Tangent of kernel: d(y, return) / d(x, y).

Engine: NumPy. Level: plain. Arguments:
    x: float64[:], in
    y: float64[:], in-out
"""


def kernel_tangent(x, x_dot, y, y_dot):
    total = 0.0
    total_dot = 0.0
    for index in range(min(len(x), len(y))):
        value = x[index]
        value_dot = x_dot[index]
        other = y[index]
        other_dot = y_dot[index]
        total += value * other
        total_dot += other * value_dot + value * other_dot
    for k in range(len(x)):
        value_1 = x[k]
        value_1_dot = x_dot[k]
        y_dot[k] = value_1 * total_dot + total * value_1_dot
        y[k] = total * value_1
    for i in range(x.size - 1, 0, -1):
        total_1 = total * x[i]
        total_dot = x[i] * total_dot + total * x_dot[i]
        total = total_1
    return (total_dot,)
