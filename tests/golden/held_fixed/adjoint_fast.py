"""Adjoint of kernel: d(du) / d(u).

Engine: Numba. Level: fast. Arguments:
    du: float64[:], out
    u: float64[:], in
    p: float64[:], in

It records nothing.
"""


def kernel_adjoint(du, du_bar, u, u_bar, p):
    # forward sweep: only what the reverse sweep reads
    rate = p[0] / p[1]
    # reverse sweep
    for i in range(u.size):
        # du[i] = rate * u[i] * u[i] + p[1] * rate
        seed = du_bar[i]
        du_bar[i] = 0.0
        u_bar[i] += rate * (u[i] * seed) + rate * u[i] * seed
