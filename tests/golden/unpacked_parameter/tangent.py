"""Tangent of kernel: d(u) / d(u, p).

Engine: NumPy. Level: plain. Arguments:
    u: float64[:], in-out
    p: float64[:], in
"""

# ruff: noqa: FURB136, RUF100


def kernel_tangent(u, u_dot, p, p_dot):
    assert len(p) == 3, "unpacked into another number of names than it has items"
    a = p[0]
    a_dot = p_dot[0]
    b = p[1]
    b_dot = p_dot[1]
    c = p[2]
    c_dot = p_dot[2]
    for i in range(u.size):
        u_here = u[i]
        u_here_dot = u_dot[i]
        ratio = b / c
        u_dot[i] = (
            u_here * (u_here * a_dot + a * u_here_dot) + a * u_here * u_here_dot +
            ((b_dot / c if b_dot != 0.0 else 0.0) - (ratio * c_dot / c if c_dot != 0.0 else 0.0))
        )
        u[i] = a * u_here * u_here + ratio
