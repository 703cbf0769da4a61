"""Normal form."""

import numpy as np

from s2sad.runtime import position  # isort: skip


def kernel(dy, y, n):
    u = np.empty((n, n))
    u[...] = np.reshape(y[:n * n], (n, n))
    v = np.empty((n, n))
    v[...] = np.reshape(y[n * n:], (n, n))
    du = np.empty((n, n))
    du[...] = np.reshape(dy[:n * n], (n, n))
    dv = np.empty((n, n))
    dv[...] = np.reshape(dy[n * n:], (n, n))
    du[:, 1:] = u[:, 1:] * v[:, :-1]
    for i in range(n):
        for j in range(n):
            u_here = u[i, j]
            du_here = du[j, i]
            dv[i, j] = u_here ** 2 - du_here
    assert position(n * n, dy.shape[0]) == n * n, (
        "shapes differ: a length of 1 repeats only where it is "
        "written, as in x[:, None] or x[:1], or an argument's"
    )
    dy[:n * n] = np.ravel(du)
    assert max(dy.shape[0] - position(n * n, dy.shape[0]), 0) == position(n * n, dy.shape[0]), (
        "shapes differ: a length of 1 repeats only where it is "
        "written, as in x[:, None] or x[:1], or an argument's"
    )
    dy[n * n:] = np.ravel(dv)
