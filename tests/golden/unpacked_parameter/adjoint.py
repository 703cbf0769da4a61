"""Adjoint of kernel: d(u) / d(u, p).

Engine: NumPy. Level: plain. Arguments:
    u: float64[:], in-out
    p: float64[:], in

It records nothing.
"""

# ruff: noqa: FURB136, RUF100


def kernel_adjoint(u, u_bar, p, p_bar):
    # forward sweep: only what the reverse sweep reads
    assert len(p) == 3, "unpacked into another number of names than it has items"
    a = p[0]
    b = p[1]
    c = p[2]
    # reverse sweep
    a_bar = 0.0
    b_bar = 0.0
    c_bar = 0.0
    for i in range(u.size - 1, -1, -1):
        # u[i] = a * u[i] * u[i] + b / c
        u_here = u[i]
        seed = u_bar[i]
        seed_2 = u_here * seed
        a_bar += u_here * seed_2
        b_bar += seed / c if seed != 0.0 else 0.0
        c_bar -= b / c * seed / c if seed != 0.0 else 0.0
        u_bar[i] = a * seed_2 + a * u_here * seed
    # a, b, c = p
    p_bar[2] += c_bar
    p_bar[1] += b_bar
    p_bar[0] += a_bar
