"""Tangent of kernel: d(u, v) / d(u, v).

Engine: NumPy. Level: plain. Arguments:
    u: float64[:], in-out
    v: float64[:], in-out
"""


def add_tangent(out, out_dot, a, a_dot, b, b_dot):
    """Tangent of add: d(out) / d(out, a, b)."""
    for i in range(out.size):
        out_dot[i] = b[i] * a_dot[i] + a[i] * b_dot[i]
        out[i] = a[i] * b[i]


def add_2_tangent(out, out_dot, b, b_dot):
    """Tangent of add: d(out) / d(out, b)."""
    for i in range(out.size):
        out_here = out[i]
        out_dot[i] = b[i] * out_dot[i] + out_here * b_dot[i]
        out[i] = out_here * b[i]


def kernel_tangent(u, u_dot, v, v_dot):
    add_tangent(v, v_dot, u, u_dot, u, u_dot)
    add_2_tangent(u, u_dot, v, v_dot)
