"""Tangent of kernel: d(return) / d(x).

Engine: NumPy. Level: plain. Arguments:
    x: float64[:], in
    limit: float64, in
"""

# ruff: noqa: PLR1730, RUF100


def kernel_tangent(x, x_dot, limit):
    total = 1.0
    returned = False
    result_dot = 0.0
    total_dot = 0.0
    for i in range(x.size):
        if x[i] < 0.0:
            result_dot = x[i] * total_dot + total * x_dot[i]
            returned = True
            break
        else:
            total_1 = total * x[i]
            total_dot = x[i] * total_dot + total * x_dot[i]
            if total_1 > limit:
                total = total_1
                break
            else:
                total = total_1
    if not returned:
        result_dot = total * total_dot + total * total_dot
    return (result_dot,)
