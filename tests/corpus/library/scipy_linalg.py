"""Functions of scipy.linalg that are NumPy's with other options, and matrices of a certain form."""
from __future__ import annotations

import numpy as np
from scipy import linalg as scipy_linalg
from scipy.linalg import block_diag, eigh, qr, solve, solveh_banded, svd, toeplitz  # noqa: E402

from tests.corpus import Case
from tests.harness.seeds import generator


def solutions(a, b, x):
    """Symmetric matrices are known by one triangle."""
    y = solve(a + 0.1 * b, x, assume_a="pos") + solve(a + 0.1 * b, x, True, assume_a="sym")
    b[...] = solve(b, a, check_finite=False) * solve(a, b, assume_a="gen")
    return np.sum(y ** 2) + np.sum(scipy_linalg.solve(b, x, transposed=True)) + np.sum(solve(b, x, assume_a="her") ** 2)


def orthogonal(a, b, x):
    q, r = qr(b)
    p, s = qr(b[:, :2], mode="economic")
    (t,) = qr(a, mode="r")
    return np.sum(q ** 3 @ x) + np.sum(r) + np.sum(p ** 3) + np.sum(s ** 2) + np.sum(t ** 2) + np.sum(
        qr(b[:2], mode="full")[0] ** 3)


def eigenvalues(a, b, x):
    w, v = eigh(a, driver="evd")
    x *= eigh(b, eigvals_only=True) + scipy_linalg.eigvalsh(a + b, lower=False) + eigh(
        b, lower=False, eigvals_only=True, driver="evr")
    return np.sum(w * v[0] * x) + np.sum(v ** 3)


def singular_values(a, b, x):
    u, s, vt = svd(b)
    p, d, qt = svd(b[:2], full_matrices=False)
    s = s + svd(b, compute_uv=False)
    return np.sum((u[:, 0] * s) @ vt) + np.sum(p[0] ** 3) * d[0] + np.sum(s * x) + np.sum(qt ** 4)


def of_diagonals(a, b, x):
    t = toeplitz(x) @ b
    b[...] = b * toeplitz(x * x, a[0])
    wide, tall = toeplitz(x[:2], c := x + 1.0), toeplitz(c, r=x[:1])
    return np.sum(t) + np.sum(wide[1] ** 2) + np.sum(tall ** 3) + np.linalg.det(toeplitz(x))


def of_blocks(a, b, x):
    c = block_diag(a, b[:2], x)
    return np.sum(c[3] ** 2) + np.sum(c[5] ** 3) + np.sum(block_diag(x, x) @ np.arange(6.0)) + np.sum(
        c[:, 3:6] @ b)


def in_bands(a, b, x):
    y = solveh_banded(a[:2] + np.array([[0.0], [6.0]]), x)
    z = solveh_banded(a + np.array([[9.0], [0.0], [0.0]]), b, lower=True)
    return np.sum(y ** 2) + np.sum(z ** 2 @ solveh_banded(a[:1], x, False, False, True))


KERNELS = (solutions, orthogonal, eigenvalues, of_diagonals, of_blocks, singular_values, in_bands)


def arguments():
    random = generator(5)
    a = random.random((3, 3))
    b = 0.5 + random.random((3, 3)) + np.diag([1.0, 2.0, 4.0])
    return a @ a.T + np.diag([1.0, 2.0, 3.5]), b, 0.5 + random.random(3)


def outputs(kernel, given):
    left = tuple(map(np.copy, given))
    kernel(*left)
    return (*(n for n, a, b in zip("abx", given, left) if not np.array_equal(a, b)), "return")


def of_any_size(a, x):
    t, c = toeplitz(x), block_diag(a, x)
    return np.sum(t * t) + np.sum(c ** 3) + np.sum(solveh_banded(a, x, lower=True))


def nothing(a, x):
    return np.sum(toeplitz(x)) + np.sum(toeplitz(a[0], x)) + np.sum(block_diag(a, a))


def cases():
    # kernel
    for kernel in KERNELS:
        yield Case(kernel, arguments(), ("a", "b", "x"), outputs(kernel, arguments()))
    # single precision
    for kernel in (solutions, of_blocks):
        given = tuple(g.astype(np.float32) for g in arguments())
        yield Case(kernel, given, ("a", "b", "x"), outputs(kernel, given))
    # short axes
    for shape in ((1, 1), (3, 1), (1, 4), (4, 2)):
        a = np.full(shape, 0.1)
        a[0] = 3.0
        x = np.arange(1.0, shape[1] + 1.0)
        yield Case(of_any_size, (a, x), ("a", "x"))
        yield Case(of_any_size, (a.astype(np.float32), x.astype(np.float32)), ("a", "x"))
    # no elements
    yield Case(nothing, (np.ones((2, 3)), np.ones(0)), ("a", "x"))
