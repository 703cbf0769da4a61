"""Adjoint of kernel: d(dy) / d(y).

Engine: Numba. Level: fast. Arguments:
    dy: float64[:], in-out
    y: float64[:], in
    n: int64, in

It records nothing.
"""

import numpy as np

from s2sad.runtime import allocate, allocate_zeros, position  # isort: skip


def kernel_adjoint_taped(dy, dy_bar, y, y_bar, n, arena):
    """Adjoint of kernel: d(dy) / d(y), in given memory."""
    # forward sweep: only what the reverse sweep reads
    u, top = allocate(arena, 0, (n, n))
    assert position(n * n, y.shape[0]) == n * n, (
        "an array is reshaped to another number of elements: give "
        "np.reshape sizes that multiply to its own"
    )
    v, top = allocate(arena, top, (n, n))
    assert y.shape[0] - position(n * n, y.shape[0]) == n * n, (
        "an array is reshaped to another number of elements: give "
        "np.reshape sizes that multiply to its own"
    )
    for i_2 in range(n):
        for j_2 in range(n):
            u[i_2, j_2] = y[i_2 * n + j_2]
            v[i_2, j_2] = y[i_2 * n + position(n * n, y.shape[0]) + j_2]
    assert position(n * n, dy.shape[0]) == n * n, (
        "an array is reshaped to another number of elements: give "
        "np.reshape sizes that multiply to its own"
    )
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
    u_bar, top = allocate_zeros(arena, top, (n, n))
    v_bar, top = allocate_zeros(arena, top, (n, n))
    du_bar, top = allocate_zeros(arena, top, (n, n))
    dv_bar, top = allocate_zeros(arena, top, (n, n))
    for i_2 in range(dy.shape[0] - 1, position(n * n, dy.shape[0]) - 1, -1):
        seed = dy_bar[np.uintp(i_2)]
        dy_bar[np.uintp(i_2)] = 0.0
        dv_bar[
            (i_2 - position(n * n, dy.shape[0])) // n, (i_2 - position(n * n, dy.shape[0])) % n
        ] += seed
    for i_2 in range(position(n * n, dy.shape[0])):
        seed = dy_bar[i_2]
        dy_bar[i_2] = 0.0
        du_bar[i_2 // n, i_2 % n] += seed
    for i in range(n):
        for j in range(n):
            # dv[i, j] = u[i, j] ** 2 - du[j, i]
            seed = dv_bar[i, j]
            dv_bar[i, j] = 0.0
            du_bar[j, i] -= seed
            u_bar[i, j] += 2.0 * u[i, j] * seed
    for i_2 in range(n):
        for j_2 in range(1, n):
            # du[:, 1:] = u[:, 1:] * v[:, :-1]
            seed = du_bar[i_2, j_2]
            du_bar[i_2, j_2] = 0.0
            v_bar[i_2, j_2 - 1] += u[i_2, j_2] * seed
            u_bar[i_2, j_2] += v[i_2, j_2 - 1] * seed
    for i_2 in range(n):
        for j_2 in range(n):
            # du, dv = dy[:n * n].reshape(n, n), dy[n * n:].reshape(n, n)
            seed = dv_bar[i_2, j_2]
            dv_bar[i_2, j_2] = 0.0
            dy_bar[i_2 * n + position(n * n, dy.shape[0]) + j_2] += seed
    for i_2 in range(n):
        for j_2 in range(n):
            # du, dv = dy[:n * n].reshape(n, n), dy[n * n:].reshape(n, n)
            seed = du_bar[i_2, j_2]
            du_bar[i_2, j_2] = 0.0
            dy_bar[i_2 * n + j_2] += seed
            # u, v = y[:n * n].reshape(n, n), y[n * n:].reshape(n, n)
            seed = v_bar[i_2, j_2]
            v_bar[i_2, j_2] = 0.0
            y_bar[i_2 * n + position(n * n, y.shape[0]) + j_2] += seed
    for i_2 in range(n):
        for j_2 in range(n):
            # u, v = y[:n * n].reshape(n, n), y[n * n:].reshape(n, n)
            seed = u_bar[i_2, j_2]
            u_bar[i_2, j_2] = 0.0
            y_bar[i_2 * n + j_2] += seed
    return (top,)


def kernel_adjoint(dy, dy_bar, y, y_bar, n):
    kernel_adjoint_taped(dy, dy_bar, y, y_bar, n, np.empty(0))
