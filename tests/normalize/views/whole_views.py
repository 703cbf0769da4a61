"""Kernels with views of whole arrays, written and read beside what they are views of, with arguments."""
from __future__ import annotations

import numpy as np

from tests.harness.seeds import generator


def given(*shape):
    return generator(3).uniform(0.3, 1.1, shape)


def written_in_turn(u):
    f = u.reshape(-1)
    for _ in range(3):
        u[0] = u[0] * f[1:5]
        f[2:] = f[2:] * u[1, 0] + f[:-2] ** 2
        u *= 0.9
    return f[3] * u[0, 1]


def two_views(u):
    f, t = u.ravel(), u.T
    f[1:] += f[:-1] ** 2
    t[0] *= t[1]
    f[0] = t[2, 1] * u[1, 1]
    u[0, 0] *= 3.0
    return f[0] * t[0, 0]


def view_of_view(u):
    f = u.reshape(-1)
    g = f.reshape(2, -1)
    g[0] += g[1] ** 2
    f[0] *= f[1]
    g[1, 0] = g[0, 0] * u[0, 1]
    u[1, 1] *= g[0, 1]
    return np.sum(g * g)


def step(p, q):
    for i in range(p.shape[0]):
        for j in range(p.shape[1]):
            p[i, j] = p[i, j] * q[j] + q[i] ** 2


def helper_view(y, q):
    step(y.reshape(4, -1), q)
    r = y.reshape(2, -1)
    step(r.T[:4], q)
    y[0] *= r[1, 1]
    step(r[:, :4], q[::-1])


def total(a):
    return np.sum(a ** 2)


def helper_base(u, q):
    f = u.ravel()
    step(u, q)
    f[1:] *= f[:-1]
    step(u, f[:4] * 1.0)
    return total(u) * total(f.reshape(2, -1))


def flat(z):
    return z.ravel()


def returned_view(u):
    f = flat(u)
    f[1:3] *= f[:2]
    w = u.copy()
    g = flat(w)
    g[0] = u[0, 1] ** 2
    return np.sum(w ** 2)


def input_only(u, v):
    w = u * 2.0
    f = w.ravel()
    f += v.ravel() * f[::-1]
    turned = v.T
    x = turned.copy()
    x *= 2.0
    return np.sum(w * x)


def element_mix(u):
    f = u.ravel()
    t = u.transpose(1, 0)
    for k in range(f.size - 1):
        f[k] += f[k + 1] * u[0, 0]
    for i in range(t.shape[0]):
        for j in range(t.shape[1]):
            t[i, j] *= u[i, j]
    f[-1] = u[-1, -2] ** 2


def squeezed(u):
    s = np.expand_dims(u, 0)
    q = np.squeeze(s, axis=0)
    q[0] *= q[1]
    m = np.moveaxis(u, 0, 1)
    m[1, 0] = u[0, 1] * q[1, 1]
    z = np.atleast_2d(u[0])
    z[0, 1:] += z[0, :-1] ** 2
    w = np.swapaxes(s, 0, 2)
    w[0] *= w[1]
    return np.sum(q * u)


def alias(u):
    a = np.asarray(u)
    b = np.asarray(a, dtype=float)
    c = np.ascontiguousarray(b)
    c[0] = a[1] ** 2
    u[1] *= b[0]
    return np.sum(c * b)


def bound_by_itself(u):
    s = np.sum(u)
    u = u.ravel()
    u[1:] *= u[:-1]
    u = u.reshape(2, -1)
    u[0] += s * u[1]
    return np.sum(u)


def three_axes(u):
    t = u.transpose(2, 0, 1)
    t[0] += t[1] ** 2
    f = u.ravel()
    for k in range(f.size):
        f[k] *= u[0, 0, 0]
    t[1, 0] = u[0, :, 1] * t[2, 1]


def ravelled(p):
    f = p.ravel()
    f[0] *= f[1]


def pass_row(u):
    ravelled(u[1])
    ravelled(u)
    return np.sum(u ** 2)


def self_overlap(u):
    t = u.T
    u += t
    t += u
    u[:] = t
    t -= 0.5 * u


def by_masks(u):
    f = u.reshape(-1)
    f[f > 0.7] = 0.5 * f[0]
    u[u < 0.5] *= f[1]
    f[np.array([1, 3])] += u[1, 1]
    return np.sum(u * u)


def in_a_tuple(u):
    pair = (u.ravel(), u)
    f, w = pair
    f[1] = w[0, 0] ** 2
    return np.sum(w)


def of_any_size(u):
    f = u.ravel()
    f *= 2.0
    u += f.reshape(u.shape) ** 2
    t = u.T
    t *= u[:1, :1].sum()
    return np.sum(f)


def lines_of_a_transpose(u):
    t = u.T
    t[0] += t[1, ::-1] ** 2 * u[0, 0]
    for i in range(1, t.shape[0]):
        t[i] *= t[i - 1]
        t[i, 1:] -= u[i, :-1]
        for j in range(3):
            t[-1, j] += t[i, j + 1] * u[1, 2]
    u[:, 1] = t[0]
    t[:, 2] = u[2]


SQUARE = (
    written_in_turn, two_views, view_of_view, returned_view, element_mix, squeezed, alias, bound_by_itself, pass_row,
    self_overlap, by_masks, in_a_tuple, of_any_size, lines_of_a_transpose)
CASES = {
    helper_view: (given(16), given(4)), helper_base: (given(4, 4), given(4)),
    input_only: (given(4, 4), 1.3 * given(4, 4)), three_axes: (given(3, 2, 4),),
    **{kernel: (given(4, 4),) for kernel in SQUARE}}
