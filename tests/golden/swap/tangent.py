"""Tangent of kernel: d(x) / d(x).

Engine: NumPy. Level: plain. Arguments:
    x: float64[:], in-out
"""


def kernel_tangent(x, x_dot):
    a = x[0]
    a_dot = x_dot[0]
    b = 2.0 * x[1]
    b_dot = 2.0 * x_dot[1]
    a_before = a
    a_before_dot = a_dot
    a_1 = b
    a_1_dot = b_dot
    b_1 = a_before
    b_1_dot = a_before_dot
    held = x[1]
    held_dot = x_dot[1]
    x_dot[1] = x_dot[2]
    x[1] = x[2]
    x_dot[2] = held_dot
    x[2] = held
    x_dot[0] = b_1 * a_1_dot + a_1 * b_1_dot
    x[0] = a_1 * b_1
