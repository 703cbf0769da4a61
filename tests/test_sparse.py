"""Sparse matrices of SciPy's in kernels, under both engines."""
from __future__ import annotations


import numpy as np
import pytest

from tests.derivatives import check_derivatives

sparse = pytest.importorskip("scipy.sparse")
from scipy.sparse import coo_matrix, csc_array, csr_array, csr_matrix, diags, eye, identity  # noqa: E402
from scipy.sparse.linalg import factorized, splu, spsolve  # noqa: E402

ENGINES = ("numpy", "numba")


# -- matrices that are built, and solved with ------------------------------------------------------------------------

def poisson(k, f):
    """-(k u')' = f on a line, assembled by loops into entries, whose duplicates add up."""
    n = f.size
    rows = np.empty(4 * n, dtype=np.int64)
    cols = np.empty(4 * n, dtype=np.int64)
    vals = np.zeros(4 * n + 2)
    c = 0
    for e in range(n + 1):
        for a in range(2):
            for b in range(2):
                i, j = e - 1 + a, e - 1 + b
                if 0 <= i < n and 0 <= j < n:
                    rows[c] = i
                    cols[c] = j
                    vals[c] = k[e] if a == b else -k[e]
                    c += 1
    A = coo_matrix((vals[:c], (rows[:c], cols[:c])), shape=(n, n)).tocsr()
    u = spsolve(A, f)
    f[:] = u
    return np.sum(u ** 2) + np.sum(spsolve(A.T.tocsc(), np.outer(u, f[:2])) ** 2)


def heat(c, u, dt, steps):
    """Implicit Euler steps with one factorization, and explicit ones with products."""
    n = u.size
    main = c[:-1] + c[1:]
    K = diags([main, -c[1:-1], -c[1:-1]], [0, -1, 1], shape=(n, n), format="csc")
    lu = splu(identity(n, format="csc") + dt * K)
    solve = factorized((identity(n) + dt ** 2 * K).tocsc())
    for _ in range(steps):
        u[:] = lu.solve(u)
        u[:] = u - dt * (K @ u) + 0.1 * solve(lu.solve(u * u, trans="T"))
    return np.sum(u ** 3)


def nonlinear_heat(c, u, dt, steps):
    """A tridiagonal matrix of coefficients that change in every step."""
    n = u.size
    for _ in range(steps):
        k = c[1:-1] * (1.0 + u[1:] ** 2)
        A = diags([1.0 + dt * c[:-1] * u, -dt * k, -dt * k[::-1], 0.1], [0, 1, -1, n - 1], shape=(n, n))
        b = A @ u
        A = A.tocsr() + eye(n) * 2.0
        u[:] = spsolve(A, b + A.dot(u))
    return np.sum(u ** 2)


# -- what is computed with matrices ----------------------------------------------------------------------------------

def products(v, x, indices, indptr):
    A = csr_matrix((v ** 2, indices, indptr), shape=(3, 4))
    y = A @ x
    z = A.T @ y + x
    B = 2.0 * A - A / 3.0
    W = np.outer(x, x[:3])
    C = csc_array((v, indices, indptr), shape=(4, 3)).T
    s = np.sum(z * (y @ A)) + np.sum(A.toarray() ** 3) + np.sum(A.diagonal() ** 2)
    s += np.sum((B + A) @ (z * x)) + A.data[1] * x[0] + A.sum() * A.shape[1] + np.sum((W.T @ A.transpose()) ** 2)
    return s + np.sum((A @ W) ** 2) + np.sum((W.T @ csr_array(C).transpose()) ** 3) + np.sum((-C.tocoo() @ x) ** 2) * A.nnz


def strength(data, rows, n):
    return coo_matrix((data, (rows, rows)), shape=(n, n)).tocsr()


def energy(A, u):
    return 0.5 * np.sum(u * (A @ u))


def in_helpers(v, x, indices, indptr):
    """A matrix that a helper makes, and another one reads; a list, and an array that is changed afterwards."""
    D = strength(v[:4], indices[:4], 4)
    held = coo_matrix((v[:2], ([0, 1], [1, 0])), shape=(4, 4))
    kept = held.tocsr()
    v[0] = v[0] * x[0]
    return energy(D, x) + energy(D + held, x * x) + energy(kept, x)


KERNELS = {
    poisson: lambda r: (1.0 + r.random(6), r.random(5)),
    heat: lambda r: (1.0 + r.random(6), r.random(5), 0.1, 2),
    nonlinear_heat: lambda r: (1.0 + r.random(6), r.random(5), 0.1, 2),
    products: lambda r: (1.0 + r.random(5), r.random(4), np.array([0, 3, 1, 0, 2]), np.array([0, 2, 3, 5], np.int32)),
    in_helpers: lambda r: (1.0 + r.random(5), r.random(4), np.array([0, 3, 1, 2, 2]), np.array([0, 2, 3, 5])),
}


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("kernel", KERNELS, ids=lambda kernel: kernel.__name__)
def test_kernel(kernel, engine):
    names = kernel.__code__.co_varnames[:kernel.__code__.co_argcount]
    given, left = (KERNELS[kernel](np.random.default_rng(1)) for _ in range(2))
    kernel(*left)
    wrt = tuple(n for n, a in zip(names, given) if np.asarray(a).dtype.kind == "f")
    of = tuple(n for n, a, b in zip(names, given, left) if not np.array_equal(a, b))
    check_derivatives(kernel, given, wrt, (*of, "return"), engine)
