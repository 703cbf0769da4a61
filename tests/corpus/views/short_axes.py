"""Parts of axes that are too short for them are empty, as in NumPy: no size is negative."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case
from tests.harness.seeds import generator

X = np.array([0.3, 0.7, 1.1, 2.5, 0.9])
A = generator(1).normal(size=(4, 5))


def sizes_of_a_part(a):
    v = a[1:-1, 2:-2]
    return np.sum(a) * v.size + np.sum(v * v) * v.shape[0]


def laplacian(a):
    a[1:-1, 1:-1] += 0.1 * (a[2:, 1:-1] + a[:-2, 1:-1] - 2 * a[1:-1, 1:-1])


def backwards(x):
    return np.sum(x) * (x[3:1].size + 3)


def beyond(x):
    m = x[7:]
    return (m.size + 1) * np.sum(x) + len(x[4:2]) + np.sum(m * m)


def as_a_bound(x):
    t = 0.0
    for i in range(len(x[2:]) + 1):
        t += x[i] * x[i]
    return t * (1 + len(x[2:]))


def scaled(x):
    return np.sum(x[1:-1] * 2.0) + x[0]


def differences(x):
    return np.sum((x[2:] - x[:-2]) ** 2) + np.sum(np.diff(x, 2) ** 2) + x[0]


def functions(x):
    y = x[2:].copy()
    z = np.cumsum(x[2:])
    w = np.stack((x[2:], x[2:]))
    return np.sum(y) + np.sum(z) + np.sum(w) + x[0] + np.dot(x[2:], x[2:])


def allocated(x):
    w = np.zeros(len(x[2:]))
    w += x[2:] * x[:-2]
    for i in range(len(w)):
        w[i] *= x[i]
    return np.sum(w) + x[0]


def faces(x):
    f = 0.5 * (x[1:] + x[:-1])
    d = f[1:] - f[:-1]
    x[1:-1] += 0.3 * d
    return np.sum(x) * d.size


def joined(x):
    z = np.concatenate((x[1:-1], X))
    return np.sum(z * z) + x[0]


def with_a_number(x, a):
    return np.sum(x[2:] + a) + a * x[0]


CASES = [(f, (X[:k].copy(),), ("x",), ("return",)) for k in (5, 2, 1) for f in (
    backwards, beyond, as_a_bound, scaled, differences, functions, allocated, faces, joined)] + [
    (f, (a.copy(),), ("a",), ("return",) if f is sizes_of_a_part else ("a",)) for f in (sizes_of_a_part, laplacian)
    for a in (A, A[:2], A[:, :3], A[:1], A[:, :1], A[:0])] + [
    (with_a_number, (X[:k].copy(), 0.5), ("x", "a"), ("return",)) for k in (5, 2, 1)]


def last_counter(x, m, d):
    for j in range(3):      # noqa: B007
        pass
    last = j
    _ = m[:2, last:last + 1] * x[:2][:, None]
    return d * d


def cases():
    # gradients
    for kernel, arguments, wrt, of in CASES:
        yield Case(kernel, arguments, wrt, of)
    # a guard of a counter behind its loop
    # What nothing reads but a guard is bound.
    yield Case(last_counter, (np.ones(4), np.ones((4, 3)), 0.3), ("d",))
