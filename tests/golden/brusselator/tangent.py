"""Tangent of kernel: d(du) / d(u, p).

Engine: NumPy. Level: plain. Arguments:
    du: float64[:, :, :], out
    u: float64[:, :, :], in
    p: float64[:], in
"""

# ruff: noqa: FURB136, RUF100


def limit(a, n):
    return a - n if a >= n else a + n if a < 0 else a


def kernel_tangent(du, du_dot, u, u_dot, p, p_dot):
    assert len(p) == 2, "unpacked into another number of names than it has items"
    b = p[0]
    b_dot = p_dot[0]
    alpha = p[1]
    alpha_dot = p_dot[1]
    n = u.shape[0]
    for i in range(n):
        for j in range(n):
            ip1 = limit(i + 1, n)
            jm1 = limit(j - 1, n)
            du_dot[i, j, 0] = (
                (u[ip1, j, 0] - u[i, jm1, 0]) * alpha_dot +
                alpha * (u_dot[ip1, j, 0] - u_dot[i, jm1, 0]) + (
                    u[i, j, 1] * (2.0 * u[i, j, 0] * u_dot[i, j, 0]) +
                    u[i, j, 0] ** 2 * u_dot[i, j, 1]
                )
            )
            du[i, j, 0] = alpha * (u[ip1, j, 0] - u[i, jm1, 0]) + u[i, j, 0] ** 2 * u[i, j, 1]
            du_dot[i, j, 1] = (
                u[i, j, 0] * b_dot + b * u_dot[i, j, 0] - (
                    u[i, j, 1] * (2.0 * u[i, j, 0] * u_dot[i, j, 0]) +
                    u[i, j, 0] ** 2 * u_dot[i, j, 1]
                )
            )
            du[i, j, 1] = b * u[i, j, 0] - u[i, j, 0] ** 2 * u[i, j, 1]
