"""Adjoint of kernel: d(du) / d(u, p).

Engine: NumPy. Level: plain. Arguments:
    du: float64[:, :, :], out
    u: float64[:, :, :], in
    p: float64[:], in

It records nothing.
"""

# ruff: noqa: FURB136, RUF100


def limit(a, n):
    return a - n if a >= n else a + n if a < 0 else a


def kernel_adjoint(du, du_bar, u, u_bar, p, p_bar):
    # forward sweep: only what the reverse sweep reads
    assert len(p) == 2, "unpacked into another number of names than it has items"
    b = p[0]
    alpha = p[1]
    n = u.shape[0]
    # reverse sweep
    b_bar = 0.0
    alpha_bar = 0.0
    for i in range(n - 1, -1, -1):
        for j in range(n - 1, -1, -1):
            # ip1, jm1 = limit(i + 1, n), limit(j - 1, n)
            ip1 = limit(i + 1, n)
            jm1 = limit(j - 1, n)
            # du[i, j, 1] = b * u[i, j, 0] - u[i, j, 0] ** 2 * u[i, j, 1]
            seed = du_bar[i, j, 1]
            du_bar[i, j, 1] = 0.0
            b_bar += u[i, j, 0] * seed
            u_bar[i, j, 0] += b * seed - 2.0 * u[i, j, 0] * (u[i, j, 1] * seed)
            u_bar[i, j, 1] -= u[i, j, 0] ** 2 * seed
            # du[i, j, 0] = alpha * (u[ip1, j, 0] - u[i, jm1, 0]) + u[i, j, 0] ** 2 * u[i, j, 1]
            seed = du_bar[i, j, 0]
            du_bar[i, j, 0] = 0.0
            seed_2 = alpha * seed
            alpha_bar += (u[ip1, j, 0] - u[i, jm1, 0]) * seed
            u_bar[ip1, j, 0] += seed_2
            u_bar[i, jm1, 0] -= seed_2
            u_bar[i, j, 0] += 2.0 * u[i, j, 0] * (u[i, j, 1] * seed)
            u_bar[i, j, 1] += u[i, j, 0] ** 2 * seed
    # b, alpha = p
    p_bar[1] += alpha_bar
    p_bar[0] += b_bar
