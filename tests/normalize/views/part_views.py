"""Kernels with views of parts, in branches and loops, with arguments."""
from __future__ import annotations

import numpy as np

from tests.normalize.views.whole_views import given


def bound_anew(u):
    s = 0.0
    for i in range(u.shape[0]):
        r = u[i].reshape(2, -1)
        r[0] += r[1] ** 2
        r = u[:, i].reshape(-1, 2)
        r[:, 1] *= r[:, 0]
        s += r[0, 0]
    r = u.T
    r[0] *= s


def left_early(u, k):
    f = u.ravel()
    f[1] *= f[0]
    if k > 2:
        return u[0, 1] ** 2
    f[2] = u[0, 1] * f[1]
    for i in range(f.size):
        f[i] *= 1.5
        if f[i] > 1.2:
            return np.sum(u)
        f[i] += 0.1
    return np.sum(u * u)


def branches(u, c):
    t = u.T
    if c > 0:
        t[0] = t[1] ** 2
    else:
        u[1] = u[0] * u[2]
    if t[0, 1] > 0.0:
        u[0] *= t[0]
        if c > 1:
            t[:, 1] += u[1] ** 2
    return np.sum(u ** 2) + t[1, 0]


def of_a_local(x, n):
    w = np.zeros((n, n))
    f = w.reshape(-1)
    for k in range(n):
        f[k::4] = x[k] ** 2
        w[k] += f[:n]
    t = w.T
    s = 0.0
    while s < 3.0:
        t[0] += 0.5 * w[:, 1]
        s += 1.0
        if w[0, 0] > 1e3:
            break
        w[1] *= 1.1
    return np.sum(w * w)


def sections(x):
    a, b = np.split(x, 2)
    a *= 2.0
    b += a ** 2
    c, d, e = np.split(x, [2, 3])
    c[0] = d[0] * e[0]
    x[1] *= b[0]
    return a[1] * np.sum(e)


def three_fields(dy, y, n):
    N = n * n
    u, v, w = y[:N].reshape(n, n), y[N:2 * N].reshape(n, n), y[2 * N:].reshape(n, n)
    du, dv, dw = dy[:N].reshape(n, n), dy[N:2 * N].reshape(n, n), dy[2 * N:].reshape(n, n)
    for i in range(1, n - 1):
        for j in range(1, n - 1):
            du[i, j] = u[i, j + 1] * v[i, j]
            dv[i, j] = v[i, j - 1] - w[i, j] ** 2
            dw[i, j] += u[i + 1, j] * du[i, j]
    du[0] = du[-1] = 0.0
    dv[:, 0] = u[:, 1] ** 2


def interleaved(dy, y):
    u, v = y[::2].reshape(2, -1), y[1::2].reshape(2, -1)
    du, dv = dy[::2].reshape(2, -1), dy[1::2].reshape(2, -1)
    for i in range(2):
        for j in range(u.shape[1]):
            du[i, j] = u[i, j] * v[i, j]
            dv[i, j] = u[i, j] ** 2


def rhs(dy, y, n):
    u, v = y[:n * n].reshape(n, n), y[n * n:].reshape(n, n)
    du, dv = dy[:n * n].reshape(n, n), dy[n * n:].reshape(n, n)
    du[1:-1, 1:-1] = u[2:, 1:-1] * v[1:-1, 1:-1]
    dv[:] = u * u - v


def integrate(y, n, steps):
    dy = np.zeros_like(y)
    for _ in range(steps):
        rhs(dy, y, n)
        y += 0.1 * dy
    return np.sum(y ** 2)


def one_in_each_branch(u, c):
    if c > 0:
        r = u.T
        r[0] *= r[1]
    else:
        r = u.ravel()
        r[1:] *= r[:-1]
    return np.sum(u ** 2 * np.arange(4.0))


def size_changes(y, n):
    f = y[:n].reshape(1, -1)
    n += 1
    f[0, 0] = y[n] ** 2
    y[1] *= f[0, 0]
    n = 2
    f[0] *= y[2]
    return np.sum(y ** 2)


def index_array(y, idx):
    k = idx[0]
    f = y[k:].reshape(2, -1)
    idx[0] = 0
    f[0] *= f[1]
    y[1] *= 2.0
    return np.sum(f)


def negative_bound(y, k):
    a = y[:k].reshape(-1, 1)
    b = y[k:].reshape(-1, 1)
    a *= b[0, 0]
    b += a[0]
    return np.sum(y ** 2)


def parts_that_overlap(y, k):
    a = y[:4].reshape(2, 2)
    b = y[2:].reshape(2, 2)
    a *= b
    b += a.T
    a[0] = b[1]
    return np.sum(y ** 2)


def while_test(u):
    f = u.ravel()
    k = 0
    while f[k] < 2.0:
        u *= 1.2
        f[3] += 0.1 * u[1, 1]
        if u[0, 3] > 1.9:
            k = 3
    return f[2]


def in_loops(u, n):
    f = u.ravel()
    for _ in range(n):
        for i in range(1, f.size):
            f[i] += 0.1 * f[i - 1]
        for i in range(u.shape[0]):
            if i == 2:
                break
            u[i] *= f[0]
            if f[1] > 1.5:
                f[2] *= u[1, 1]
                continue
            f[3:5] += 1.0
        if u[0, 1] > 50.0:
            break
    return np.sum(f * f)


def parts_of_a_cube(x, n):
    c = x.reshape(n, n, n)
    for k in range(n):
        p = c[k].reshape(-1)
        p[1:] += p[:-1] * x[0]
        q = c[:, k].T
        q[0] *= 2.0
    return np.sum(x ** 2)


def kept_part(u, k):
    w = u * 1.5
    for s in range(k):
        r = w[s].reshape(2, 2)
        c = r.T
        c[0] += r[1] ** 2
        for i in range(2):
            r[i, i] *= c[0, 1]
        w[s - 1] *= 1.1
    return np.sum(w ** 2)


def branches_in_a_loop(u, c):
    f = u.ravel()
    for i in range(3):
        if u[0, i] > 0.5:
            f[i] *= 2.0
            if c > 0:
                u[1, i] *= f[i]
        elif c > 5:
            break
        else:
            u[2] *= 1.1
    return f[1] * f[5]


def two_of_three_axes(q, n):
    u = q.reshape(2, n, n)
    rho, e = u[0], u[1]
    for i in range(1, n):
        for j in range(n):
            rho[i, j] += e[i - 1, j] * rho[i - 1, j]
    q *= 2.0
    e[0] = rho[1] ** 2
    return np.sum(q * q)


def views_of_parts(u):
    top, bottom = u[:2], u[2:]
    f = top.ravel()
    g = bottom.ravel()
    for i in range(f.size):
        f[i] *= g[i]
        g[i] += f[i] ** 2
    top[0] = bottom[1]
    return np.sum(u * f[1])


SQUARE = (bound_anew, while_test, views_of_parts)
CASES = {
    left_early: (given(4, 4), 1), branches: (given(4, 4), 2), of_a_local: (given(4), 4), sections: (given(8),),
    three_fields: (given(27), 0.9 * given(27), 3), interleaved: (given(12), 0.9 * given(12)),
    integrate: (given(18), 3, 2), one_in_each_branch: (given(4, 4), 1), size_changes: (given(8), 4),
    index_array: (given(9), np.array([1])), negative_bound: (given(4), -2), parts_that_overlap: (given(6), 1),
    in_loops: (given(4, 4), 2), parts_of_a_cube: (given(8), 2), kept_part: (given(4, 4), 2),
    branches_in_a_loop: (given(3, 4), 1), two_of_three_axes: (given(18), 3),
    **{kernel: (given(4, 4),) for kernel in SQUARE}}
