"""Parts of decompositions, orders of norms, and the solvers of scipy.linalg."""
from __future__ import annotations

import math

import numpy as np
import scipy.linalg as scipy_linalg
from scipy.linalg import cho_factor, cho_solve, lu_factor, lu_solve, solve_banded, solve_triangular

from tests.corpus import Case, outputs
from tests.harness.seeds import generator


# -- a: symmetric and positive, b: 3 x 3, x: 3; what is returned is a number -----------------------------------------

def orthogonal(a, b, x):
    q, r = np.linalg.qr(b)
    p, s = np.linalg.qr(b[:, :2])
    wide = np.linalg.qr(a[:2])
    return np.sum(q ** 3) + np.sum(r ** 2 * a) + np.sum(p[0] ** 3) + np.sum(s) + np.sum(wide[0] ** 3) + np.sum(
        wide[1] ** 2) + np.sum(np.linalg.qr(b, mode="r")[0] * x)


def singular_vectors(a, b, x):
    u, s, vt = np.linalg.svd(b, full_matrices=False)
    p, d, qt = np.linalg.svd(b[:2], full_matrices=False)
    rank_one = (u[:, :1] * s[0]) @ vt[:1]
    return np.sum(rank_one * a) + np.sum(p ** 2 @ d) + np.sum(qt ** 4) + np.sum(
        np.linalg.svd(a[:, 1:], full_matrices=False)[0] ** 4)


def norms(a, b, x):
    s = np.linalg.norm(b, "fro") + np.linalg.norm(b, 1) + np.linalg.norm(b, np.inf) + np.linalg.norm(x, 2)
    s += np.linalg.norm(b, 2) + np.linalg.norm(b, "nuc") + np.linalg.norm(b, -2) + np.linalg.norm(a, -1)
    s += np.linalg.norm(x, 3) + np.linalg.norm(x, -np.inf) + np.linalg.norm(x, 0.5) + np.linalg.norm(a, -np.inf)
    s += np.sum(np.linalg.norm(b, np.inf, axis=0) * x) + np.sum(np.linalg.norm(b, 3, axis=-1))
    return s + np.sum(np.linalg.multi_dot([a, b, a])) + np.sum(np.linalg.multi_dot((a, b, x)))


def triangles(a, b, x):
    lower = np.linalg.cholesky(a)
    b[...] = solve_triangular(lower, b, lower=True, check_finite=False)
    x[:] = solve_triangular(a, x) + scipy_linalg.solve_triangular(b, x, trans=1)
    return np.sum(solve_triangular(a, x, lower=True, trans="T", unit_diagonal=True) ** 2)


def cholesky_factors(a, b, x):
    c = cho_factor(a)
    f, low = cho_factor(a, lower=True)
    x[:] = cho_solve(c, x)
    b[...] = cho_solve((f, low), b) + cho_solve((np.linalg.cholesky(a), True), b)
    return np.sum(scipy_linalg.cholesky(a, lower=True)[1] * x) + np.sum(scipy_linalg.cholesky(a)[0] * x)


def triangular_factors(a, b, x):
    f = lu_factor(b)
    lu, piv = lu_factor(a)
    for _ in range(2):
        x[:] = lu_solve(f, x * x)
    return np.sum(lu_solve((lu, piv), x, trans=1) ** 2) + np.sum(lu_solve(lu_factor(b), a))


def bands(a, b, x):
    x[:] = solve_banded((1, 1), b, x)
    c = solve_banded((0, 1), b[1:], a) * solve_banded((1, 0), b[1:], a)
    return np.sum(c ** 2) + np.sum(solve_banded((0, 2), a, x)) + np.sum(solve_banded((2, 0), a, x))


def others(a, b, x):
    x[:] = scipy_linalg.solve(a, x) * scipy_linalg.det(a)
    b[...] = scipy_linalg.expm(b) + scipy_linalg.inv(a)
    return scipy_linalg.norm(x) + np.sum(scipy_linalg.expm(2.0 * a) * b) / 1e4 + np.sum(scipy_linalg.svdvals(a) * x)


def arguments():
    random = generator(5)
    a = random.random((3, 3))
    return a @ a.T + np.diag([1.0, 2.0, 3.5]), 0.5 + random.random((3, 3)) + np.eye(3), 0.5 + random.random(3)


def wide_bands(ab, x):
    x[:] = solve_banded((2, 1), ab, x)


def factor_read(a, b, x):
    c, low = cho_factor(a)
    return np.sum(c) + np.sum(cho_solve((c, low), x))


def own_triangle(a, b, x):
    """A factor's own triangle is read beside its solver: its diagonal, an entry of it, and all of it."""
    c, low = cho_factor(a)
    lower = cho_factor(2.0 * a, lower=True)
    x[:] = cho_solve((c, low), x) + np.log(np.diag(c)) * lower[0].diagonal()
    for i in range(len(x)):
        x[i] *= math.log(c[i, i])
    return np.sum(np.triu(c) * b) + np.sum(np.tril(lower[0]) * b)


def other_triangle(a, b, x):
    c, low = cho_factor(a)
    return np.sum(np.tril(c)) + np.sum(cho_solve((c, low), x))


def pivoted_diagonal(a, b, x):
    lu, pivots = lu_factor(a)
    return np.sum(np.log(np.abs(np.diag(lu)))) + np.sum(lu_solve((lu, pivots), x))


def factors_from_both_branches(a, b, x):
    if x[0] > 0.7:
        f = lu_factor(a)
    else:
        f = lu_factor(b)
    return np.sum(lu_solve(f, x))


def all_vectors(a, b, x):
    return np.sum(np.linalg.svd(b, hermitian=True)[0])


def in_single_precision(a, b, x):
    q, r = np.linalg.qr(b)
    y = solve_triangular(r, x) + solve_banded((1, 1), b, x) + lu_solve(lu_factor(a), x)
    return np.sum(q[0] * y) + np.sum(scipy_linalg.expm(b)[0] * y)


def cases():
    for kernel in (orthogonal, singular_vectors, norms, triangles, cholesky_factors, triangular_factors, bands, others,
                   own_triangle):
        yield Case(kernel, arguments(), ("a", "b", "x"), outputs(kernel, arguments()))
    # bands with row exchanges
    random = generator(2)
    ab = random.standard_normal((4, 7))
    ab[1] *= 0.1
    yield Case(wide_bands, (ab, random.random(7)), ("ab", "x"), ("x",))
    yield Case(wide_bands, (1.0 + random.random((4, 3)), random.random(3)), ("ab", "x"), ("x",))
    read_otherwise = ("a factorization that is read other than by its solver: write np.linalg.cholesky for the "
                      "triangle itself, np.linalg.slogdet for the determinant")
    for kernel, refused in (
            (factor_read, f"S301 at `c`: {read_otherwise}"),
            (other_triangle, f"S301 at `c`: {read_otherwise}"),
            (pivoted_diagonal, f"S301 at `lu`: {read_otherwise}"),
            (factors_from_both_branches,
             "S301 at `lu_factor(a)`: no derivative rule for scipy.linalg.lu_factor here: write factors = "
             "lu_factor(a), once, and give it to the solver as it is\nS301 at `lu_factor(b)`: no derivative rule for "
             "scipy.linalg.lu_factor here: write factors = lu_factor(a), once, and give it to the solver as it is\n"
             "S301 at `lu_solve(f, x)`: no derivative rule for scipy.linalg.lu_solve here: write factors = "
             "lu_factor(a), once, and give it to the solver as it is"),
            (all_vectors,
             "S301 at `np.linalg.svd(b, hermitian=True)`: no derivative rule for numpy.linalg.svd: write "
             "full_matrices=False: the vectors beyond the smaller size are not determined")):
        yield Case(kernel, arguments(), of=None, refused=refused)
