"""Products of vectors with parts of matrices, in triangles and otherwise: loops add what they give where they can."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case
from tests.harness.seeds import generator

RNG = generator(12)


def covariance(data):
    data -= np.mean(data, axis=0)
    cov = np.zeros((data.shape[1], data.shape[1]))
    for i in range(data.shape[1]):
        cov[i:, i] = data[:, i] @ data[:, i:] / (data.shape[0] - 1.0)
        cov[i, i:] = cov[i:, i]
    return cov


def arnoldi(a, q):
    h = np.zeros((q.shape[1], q.shape[1]))
    for k in range(1, q.shape[1]):
        w = a @ q[:, k - 1]
        h[:k, k - 1] = w @ q[:, :k]
        w -= q[:, :k] @ h[:k, k - 1]
        q[:, k] += w * 0.5
    return h


def counted_from_the_end(x, a, y):
    for k in range(1, 4):
        y[k] += np.sum((x @ a[:, -k:]) ** 2) + np.sum(x[::-1] @ a[:, 3:-k:-1])
        y[k] -= np.sum(x @ a[:, ::2]) * np.sum(x[k:] @ a[k:, 1:k])


def of_itself(a, k):
    for i in range(a.shape[0]):
        a[i, k:] = 0.1 * (a[:, i] @ a[:, k:])
        a[k:, i] += 0.1 * (a[i, k:] @ a[k:, k:])


def picked(x, a, places, y):
    for k in range(3):
        y[k] += np.sum((x[places] @ a[:, k:]) ** 2)
        z = x[x > 0.0]
        y[k] += np.sum(z @ a[:z.size, 1:k + 1])


def of_a_stack(x, a):
    total = 0.0
    for s in range(a.shape[0]):
        v = x[s] @ a[s, :, s:]
        v -= x[s] @ a[s, 1:, s:][[0, 1, 1, 0]] if s > 5 else 0.0
        total += np.sum(v * v)
    return total


def rounded(x, a):
    total = np.float32(0.0)
    for k in range(3):
        total += np.sum(x @ a[:, k:])
    return total


A, X = RNG.standard_normal((4, 4)), RNG.standard_normal(4)
CASES = [
    (covariance, (RNG.random((7, 5)),), ("data",), ("data", "return")),
    (covariance, (RNG.random((3, 0)),), ("data",), ("return",)),
    (covariance, (np.asfortranarray(RNG.random((6, 4)))[::-1],), ("data",), ("return",)),
    (arnoldi, (A, RNG.standard_normal((4, 3))), ("a", "q"), ("q", "return")),
    (counted_from_the_end, (X, A, np.zeros(4)), ("x", "a"), ("y",)),
    (of_itself, (A, 1), ("a",), ("a",)), (of_itself, (A, 4), ("a",), ("a",)), (of_itself, (A, -3), ("a",), ("a",)),
    (picked, (X, A, np.array([3, 0, 3, 1]), np.zeros(3)), ("x", "a"), ("y",)),
    (of_a_stack, (RNG.random((3, 4)), RNG.random((3, 4, 5))), ("x", "a"), ("return",)),
]


def cases():
    for kernel, arguments, wrt, of in CASES:
        yield Case(kernel, arguments, wrt, of)
    single = [RNG.random(4).astype(np.float32), RNG.random((4, 5)).astype(np.float32)]
    yield Case(rounded, tuple(single), ("x", "a"), options={"rtol": 1e-2, "dot_tol": 1e-4})
