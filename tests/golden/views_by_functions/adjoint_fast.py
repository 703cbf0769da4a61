"""Adjoint of kernel: d(dy) / d(y).

Engine: Numba. Level: fast. Arguments:
    dy: float64[:], in-out
    y: float64[:], in
    n: int64, in

It records nothing.
"""

import numpy as np

from s2sad.runtime import position  # isort: skip


def kernel_adjoint(dy, dy_bar, y, y_bar, n):
    # forward sweep: only what the reverse sweep reads
    u = np.empty((n, n))
    assert position(n * n, y.shape[0]) == n * n, (
        "an array is reshaped to another number of elements: give "
        "np.reshape sizes that multiply to its own"
    )
    v = np.empty((n, n))
    assert y.shape[0] - position(n * n, y.shape[0]) == n * n, (
        "an array is reshaped to another number of elements: give "
        "np.reshape sizes that multiply to its own"
    )
    for i_2 in range(u.shape[0]):
        for j_2 in range(u.shape[1]):
            u[i_2, j_2] = y[i_2 * n + j_2]
            v[i_2, j_2] = y[i_2 * n + position(n * n, y.shape[0]) + j_2]
    du = np.empty((n, n))
    assert position(n * n, dy.shape[0]) == n * n, (
        "an array is reshaped to another number of elements: give "
        "np.reshape sizes that multiply to its own"
    )
    dv = np.empty((n, n))
    assert dy.shape[0] - position(n * n, dy.shape[0]) == n * n, (
        "an array is reshaped to another number of elements: give "
        "np.reshape sizes that multiply to its own"
    )
    assert position(n * n, dy.shape[0]) == n * n, (
        "shapes differ: a length of 1 repeats only where it is "
        "written, as in x[:, None] or x[:1], or an argument's"
    )
    assert max(dy.shape[0] - position(n * n, dy.shape[0]), 0) == position(n * n, dy.shape[0]), (
        "shapes differ: a length of 1 repeats only where it is "
        "written, as in x[:, None] or x[:1], or an argument's"
    )
    # reverse sweep
    u_bar = np.zeros_like(u)
    v_bar = np.zeros_like(v)
    du_bar = np.zeros_like(du)
    dv_bar = np.zeros_like(dv)
    for i_2 in range(dy.shape[0] - 1, position(n * n, dy.shape[0]) - 1, -1):
        seed = dy_bar[np.uintp(i_2)]
        dy_bar[np.uintp(i_2)] = 0.0
        dv_bar[
            (i_2 - position(n * n, dy.shape[0])) // dv.shape[1],
            (i_2 - position(n * n, dy.shape[0])) % dv.shape[1]
        ] += seed
    for i_2 in range(position(n * n, dy.shape[0])):
        seed = dy_bar[i_2]
        dy_bar[i_2] = 0.0
        du_bar[i_2 // du.shape[1], i_2 % du.shape[1]] += seed
    for i in range(n):
        for j in range(n):
            # dv[i, j] = u[i, j] ** 2 - du[j, i]
            seed = dv_bar[i, j]
            dv_bar[i, j] = 0.0
            du_bar[j, i] -= seed
            u_bar[i, j] += 2.0 * u[i, j] * seed
    for i_2 in range(du.shape[0]):
        for j_2 in range(1, du.shape[1]):
            # du[:, 1:] = u[:, 1:] * v[:, :-1]
            seed = du_bar[i_2, j_2]
            du_bar[i_2, j_2] = 0.0
            v_bar[i_2, j_2 - 1] += u[i_2, j_2] * seed
            u_bar[i_2, j_2] += v[i_2, j_2 - 1] * seed
    for i_2 in range(dv.shape[0]):
        for j_2 in range(dv.shape[1]):
            # du, dv = dy[:n * n].reshape(n, n), dy[n * n:].reshape(n, n)
            seed = dv_bar[i_2, j_2]
            dv_bar[i_2, j_2] = 0.0
            dy_bar[i_2 * n + position(n * n, dy.shape[0]) + j_2] += seed
    for i_2 in range(du.shape[0]):
        for j_2 in range(du.shape[1]):
            # du, dv = dy[:n * n].reshape(n, n), dy[n * n:].reshape(n, n)
            seed = du_bar[i_2, j_2]
            du_bar[i_2, j_2] = 0.0
            dy_bar[i_2 * n + j_2] += seed
            # u, v = y[:n * n].reshape(n, n), y[n * n:].reshape(n, n)
            seed = v_bar[i_2, j_2]
            v_bar[i_2, j_2] = 0.0
            y_bar[i_2 * n + position(n * n, y.shape[0]) + j_2] += seed
    for i_2 in range(u.shape[0]):
        for j_2 in range(u.shape[1]):
            # u, v = y[:n * n].reshape(n, n), y[n * n:].reshape(n, n)
            seed = u_bar[i_2, j_2]
            u_bar[i_2, j_2] = 0.0
            y_bar[i_2 * n + j_2] += seed
