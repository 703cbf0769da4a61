"""Tangent of kernel: d(dy) / d(y).

Engine: NumPy. Level: plain. Arguments:
    dy: float64[:], in-out
    y: float64[:], in
    n: int64, in
"""

import numpy as np

from s2sad.runtime import position  # isort: skip


def kernel_tangent(dy, dy_dot, y, y_dot, n):
    u = np.empty((n, n))
    u_dot = np.zeros_like(u)
    u[...] = np.reshape(y[:n * n], (n, n))
    u_dot[...] = np.reshape(y_dot[:n * n], (n, n))
    v = np.empty((n, n))
    v_dot = np.zeros_like(v)
    v[...] = np.reshape(y[n * n:], (n, n))
    v_dot[...] = np.reshape(y_dot[n * n:], (n, n))
    du = np.empty((n, n))
    du_dot = np.zeros_like(du)
    du[...] = np.reshape(dy[:n * n], (n, n))
    du_dot[...] = np.reshape(dy_dot[:n * n], (n, n))
    dv = np.empty((n, n))
    dv_dot = np.zeros_like(dv)
    dv[...] = np.reshape(dy[n * n:], (n, n))
    dv_dot[...] = np.reshape(dy_dot[n * n:], (n, n))
    du_dot[:, 1:] = v[:, :-1] * u_dot[:, 1:] + u[:, 1:] * v_dot[:, :-1]
    du[:, 1:] = u[:, 1:] * v[:, :-1]
    for i in range(n):
        for j in range(n):
            u_here = u[i, j]
            dv_dot[i, j] = 2.0 * u_here * u_dot[i, j] - du_dot[j, i]
            dv[i, j] = u_here ** 2 - du[j, i]
    assert position(n * n, dy.shape[0]) == n * n, (
        "shapes differ: a length of 1 repeats only where it is "
        "written, as in x[:, None] or x[:1], or an argument's"
    )
    dy[:n * n] = np.ravel(du)
    dy_dot[:n * n] = np.ravel(du_dot)
    assert max(dy.shape[0] - position(n * n, dy.shape[0]), 0) == position(n * n, dy.shape[0]), (
        "shapes differ: a length of 1 repeats only where it is "
        "written, as in x[:, None] or x[:1], or an argument's"
    )
    dy[n * n:] = np.ravel(dv)
    dy_dot[n * n:] = np.ravel(dv_dot)
