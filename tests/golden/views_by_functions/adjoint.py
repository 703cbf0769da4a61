"""Adjoint of kernel: d(dy) / d(y).

Engine: NumPy. Level: plain. Arguments:
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
    u[...] = np.reshape(y[:n * n], (n, n))
    v = np.empty((n, n))
    v[...] = np.reshape(y[n * n:], (n, n))
    du = np.empty((n, n))
    dv = np.empty((n, n))
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
    seed = np.copy(dy_bar[n * n:])
    dy_bar[n * n:] = 0.0
    dv_bar[...] += np.reshape(seed, dv.shape)
    seed_2 = np.copy(dy_bar[:n * n])
    dy_bar[:n * n] = 0.0
    du_bar[...] += np.reshape(seed_2, du.shape)
    for i in range(n - 1, -1, -1):
        for j in range(n - 1, -1, -1):
            # dv[i, j] = u[i, j] ** 2 - du[j, i]
            seed_3 = dv_bar[i, j]
            dv_bar[i, j] = 0.0
            du_bar[j, i] -= seed_3
            u_bar[i, j] += 2.0 * u[i, j] * seed_3
    # du[:, 1:] = u[:, 1:] * v[:, :-1]
    seed_4 = np.copy(du_bar[:, 1:])
    du_bar[:, 1:] = 0.0
    u_bar[:, 1:] += v[:, :-1] * seed_4
    v_bar[:, :-1] += u[:, 1:] * seed_4
    # du, dv = dy[:n * n].reshape(n, n), dy[n * n:].reshape(n, n)
    dy_bar[n * n:] += np.reshape(dv_bar, dy[n * n:].shape)
    dy_bar[:n * n] += np.reshape(du_bar, dy[:n * n].shape)
    # u, v = y[:n * n].reshape(n, n), y[n * n:].reshape(n, n)
    y_bar[n * n:] += np.reshape(v_bar, y[n * n:].shape)
    y_bar[:n * n] += np.reshape(u_bar, y[:n * n].shape)
