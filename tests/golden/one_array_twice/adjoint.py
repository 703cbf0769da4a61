"""Adjoint of kernel: d(u, v) / d(u, v).

Engine: NumPy. Level: plain. Arguments:
    u: float64[:], in-out
    v: float64[:], in-out

It records nothing.
"""


def add(out, a, b):
    for i in range(out.size):
        out[i] = a[i] * b[i]


def add_adjoint(out, out_bar, a, a_bar, b, b_bar):
    """Adjoint of add: d(out) / d(out, a, b)."""
    # reverse sweep
    for i in range(out.size - 1, -1, -1):
        # out[i] = a[i] * b[i]
        seed = out_bar[i]
        out_bar[i] = 0.0
        a_bar[i] += b[i] * seed
        b_bar[i] += a[i] * seed


def add_2_adjoint(out, out_bar, b, b_bar):
    """Adjoint of add: d(out) / d(out, b)."""
    # reverse sweep
    for i in range(out.size - 1, -1, -1):
        # out[i] = a[i] * b[i]
        seed = out_bar[i]
        b_bar[i] += out[i] * seed
        out_bar[i] = b[i] * seed


def kernel_adjoint(u, u_bar, v, v_bar):
    # forward sweep: only what the reverse sweep reads
    add(v, u, u)
    # reverse sweep
    # add(u, u, v)
    add_2_adjoint(u, u_bar, v, v_bar)
    # add(v, u, u)
    add_adjoint(v, v_bar, u, u_bar, u, u_bar)
