"""Tangent of kernel: d(y) / d(x).

Engine: NumPy. Level: plain. Arguments:
    y: float64[:], out
    x: float64[:], in
"""

# ruff: noqa: FURB136, PLR1730, RUF100


def bent_tangent(a, a_dot, b, b_dot):
    """Tangent of bent: d(return) / d(a, b)."""
    if a * b <= 0.0:
        result = 0.0
        result_dot = 0.0
    else:
        result = a * a / b
        result_dot = (
            ((a * a_dot + a * a_dot) / b if a * a_dot + a * a_dot != 0.0 else 0.0) -
            (result * b_dot / b if b_dot != 0.0 else 0.0)
        )
    return result, result_dot


def bent_tangent_2(a, a_dot, b):
    """Tangent of bent: d(return) / d(a)."""
    if a * b <= 0.0:
        result = 0.0
        result_dot = 0.0
    else:
        result = a * a / b
        result_dot = (a * a_dot + a * a_dot) / b if a * a_dot + a * a_dot != 0.0 else 0.0
    return result, result_dot


def kernel_tangent(y, y_dot, x, x_dot):
    for i in range(1, x.size):
        bent_value, bent_value_dot = bent_tangent(x[i], x_dot[i], x[i - 1], x_dot[i - 1])
        bent_value_2, bent_value_2_dot = bent_tangent_2(x[i - 1], x_dot[i - 1], 2.0)
        y_dot[i] = bent_value_dot + 3.0 * bent_value_2_dot
        y[i] = bent_value + 3.0 * bent_value_2
