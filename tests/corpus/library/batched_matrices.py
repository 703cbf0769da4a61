"""Functions of matrices that are given stacks of these."""
from __future__ import annotations

import numpy as np
import scipy.linalg

from tests.corpus import Case
from tests.harness.seeds import generator

_NEW = np.lib.NumpyVersion(np.__version__) >= "2.0.0"


def inverses(a, b, x):
    b[...] = np.linalg.inv(a) * b
    return np.sum(np.linalg.inv(b + a) ** 2 @ x)


def determinants(a, b, x):
    sign, size = np.linalg.slogdet(a)
    return np.sum(np.linalg.det(a * b)) * x[0] + np.sum(size * sign) * x[-1]


def solutions(a, b, x):
    y = np.linalg.solve(a, b)
    b[...] = np.linalg.solve(a, y * y)
    return np.sum(np.linalg.solve(b, x) ** 2)


def one_matrix_for_all(a, b, x):
    b[...] = np.linalg.solve(a[0], b * b)
    return np.sum(np.linalg.solve(a[0] + a[0].T, b)[:, 1] @ x)


def eigenvalues(a, b, x):
    w, v = np.linalg.eigh(a + np.swapaxes(a, 1, 2))
    return np.sum(w[:, 0] * v[:, 1, 0] ** 2) + np.sum(np.linalg.eigvalsh(b) ** 2 @ x)


def triangles(a, b, x):
    b[...] = np.linalg.cholesky(a @ np.swapaxes(a, 1, 2) + np.eye(3)) * b
    q, r = np.linalg.qr(a[:, :, :2])
    return np.sum(q ** 3) + np.sum(r) + np.sum(b @ x)


def singular_vectors(a, b, x):
    u, s, vt = np.linalg.svd(a[:, :2], full_matrices=False)
    return np.sum(u[:, 0, 0] ** 2 * s[:, 1]) + np.sum(vt ** 4) + np.sum(np.linalg.svd(b, compute_uv=False) @ x)


def powers(a, b, x):
    b *= np.linalg.matrix_power(a, 3)
    return np.sum(np.linalg.pinv(a[:, :2]) ** 2) + np.sum(np.linalg.matrix_power(a, -1) @ x)


def with_four_axes(a, b, x):
    c = np.stack([a, b], axis=0)
    d = np.linalg.solve(c, c * c)
    return np.sum(np.linalg.inv(c) * d) + np.sum(np.linalg.det(d)) + np.sum(np.linalg.solve(a[0], c) ** 2)


def in_a_loop(a, b, x):
    for _ in range(2):
        b[...] = np.linalg.solve(a, b) + b
        a += np.linalg.inv(b)
    return np.sum(np.linalg.det(a[1:]))


def one_right_side_for_all(a, b, x):
    return np.sum(np.linalg.solve(a, b[0] * b[0]) ** 3)


KERNELS = (inverses, determinants, solutions, one_matrix_for_all, eigenvalues, triangles, singular_vectors, powers,
           with_four_axes, in_a_loop, *([one_right_side_for_all] if _NEW else []))


def arguments(count=2, n=3):
    random = generator(3)
    a, b = random.random((2, count, n, n))
    return a + np.diag(2.0 + np.arange(n)), b + np.diag(3.0 + 2.0 * np.arange(n)), 0.5 + random.random(n)


def outputs(kernel, given):
    left = tuple(map(np.copy, given))
    kernel(*left)
    return (*(n for n, a, b in zip("abx", given, left) if not np.array_equal(a, b)), "return")


def of_more_axes(a, b):
    return np.sum(np.linalg.solve(a, b[None]))


def of_integers(a, b):
    return np.sum(np.linalg.inv(b))


def turned(a, x):
    return np.sum(scipy.linalg.solve(a, x, transposed=True) * x)


def upper_triangles(a, x):
    values = scipy.linalg.eigvalsh(a, lower=False) + scipy.linalg.eigh(a, lower=False, eigvals_only=True)
    return np.sum(values * x)


def upper_factors(a, x):
    return np.sum(scipy.linalg.cholesky(a @ np.swapaxes(a, -1, -2)) @ x)


def triangle_alone(a):
    return np.sum(scipy.linalg.qr(a, mode="r")[0])


def cases():
    # kernel
    for kernel in KERNELS:
        yield Case(kernel, arguments(), ("a", "b", "x"), outputs(kernel, arguments()))
    # short stacks
    for kernel in (inverses, solutions, determinants):
        for count, n in ((1, 3), (0, 3), (3, 1)):
            given = arguments(count, n)
            yield Case(kernel, given, ("a", "b", "x"), outputs(kernel, given))
    # single precision
    for kernel in (inverses, solutions, singular_vectors):
        yield Case(kernel, tuple(g.astype(np.float32) for g in arguments()), ("a", "b", "x"))
    # complex stacks

    def kernel(z, b):
        y = np.linalg.solve(z, b)
        return np.sum(np.abs(y @ np.linalg.inv(z)) ** 2)

    a, b, _ = arguments()
    yield Case(kernel, (a + 1j * b, b - 0.5j * a), ("z", "b"))
    # refused
    for kernel, refused in (
            (of_more_axes,
             "S301 at `np.linalg.solve(a, b[None])`: no derivative rule for numpy.linalg.solve: give both the "
             "same leading axes: stacks of as many matrices, or one matrix of two axes"),
            (of_integers,
             "S301 at `np.linalg.inv(b)`: no derivative rule for numpy.linalg.inv: write it as a loop over the "
             "elements")):
        yield Case(kernel, (arguments()[0], np.ones((2, 3, 3), int)), of=None, refused=refused)
    # of scipy
    for shape in ((3, 3, 3), (2, 3, 3), (3, 3), (1, 1)):
        for kernel in (turned, upper_triangles, upper_factors):
            a = generator(5).normal(size=shape) + 3.0 * np.eye(shape[-1])
            yield Case(kernel, (a, np.array([0.4, -1.3, 0.8])[:shape[-1]]), ("a", "x"))
    # a tuple of one is no result for stacks
    yield Case(triangle_alone, (np.ones((2, 3, 3)),), refused=(
        "S301 at `scipy.linalg.qr(a, mode=\"r\")`: no derivative rule for scipy.linalg.qr.triangular: of a "
        "stack write np.linalg.qr(a, mode='r'): SciPy gives it without a tuple"))
    yield Case(triangle_alone, (np.eye(3) + 0.1 * np.arange(9.0).reshape(3, 3) ** 2,), ("a",))
