"""Sparse matrices of SciPy's that kernels build, solve with and compute with, under both engines."""
from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse import coo_matrix, csc_array, csr_array, csr_matrix, diags, eye, identity, spdiags
from scipy.sparse.linalg import factorized, splu, spsolve

from tests.harness.derivatives import check_derivatives
from tests.harness.engines import each
from tests.harness.seeds import generator


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


def products(v, x, indices, indptr):
    A = csr_matrix((v ** 2, indices, indptr), shape=(3, 4))
    y = A @ x
    z = A.T @ y + x
    B = 2.0 * A - A / 3.0
    W = np.outer(x, x[:3])
    C = csc_array((v, indices, indptr), shape=(4, 3)).T
    s = np.sum(z * (y @ A)) + np.sum(A.toarray() ** 3) + np.sum(A.diagonal() ** 2)
    s += np.sum((B + A) @ (z * x)) + A.data[1] * x[0] + A.sum() * A.shape[1] + np.sum((W.T @ A.transpose()) ** 2)
    return s + np.sum((A @ W) ** 2) + np.sum((W.T @ csr_array(C).transpose()) ** 3) + np.sum(
        (-C.tocoo() @ x) ** 2) * A.nnz


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


def shared(v, x, indices, indptr):
    """What SciPy shares with the arrays that a matrix is made of, and what it copies."""
    i, j = np.array([0, 1, 2]), np.array([0, 2, 1])
    A = csr_matrix((v, indices, indptr), shape=(4, 4))
    C = coo_matrix((v[:3], (i, j)), shape=(4, 4))
    made = coo_matrix((2.0 * v[:3] + x[:3], (i, j)), shape=(4, 4))
    copies = C.tocsr() + A.tocsc() - A.copy()
    lu = splu((A + (identity(4) * 4.0 + identity(4))).tocsc())
    twice = splu((identity(4) * 0.1 + 3.0 * identity(4)).tocsc())
    v[0] = x[0] * 3.0
    v[1:] *= x[1]
    A.data[2] = x[2]
    s = np.sum((A @ x) ** 2) + np.sum((C @ x) * x) + np.sum((A.T @ x) ** 3)
    return s + np.sum((copies @ x) ** 2) + np.sum(lu.solve(x) ** 2) + np.sum(made @ twice.solve(x))


def solved_again(v, x, steps):
    """A factorization that some iterations renew, in a helper and here; a matrix that the loop carries."""
    n = x.size
    lu = splu(diags([v + 2.0, v[1:]], [0, 1], shape=(n, n), format="csc"))
    A = diags([v], [0], shape=(n, n))
    for step in range(steps):
        if step % 2 == 1:
            lu = splu(diags([x * x + 2.0, v[1:] * x[1:]], [0, 1], shape=(n, n), format="csc"))
        x[:] = solved_in_helper(lu, x) + 0.5 * v + A @ x
        A = diags([x / 3.0], [0], shape=(n, n))
    return np.sum(x ** 2) + np.sum(A @ x)


def solved_in_helper(lu, b):
    return lu.solve(b)


def assembled_again(v, x, steps):
    """Entries, rows and columns that every step writes anew."""
    n = v.size
    rows, cols, vals = np.zeros(n, dtype=np.int32), np.zeros(n, dtype=np.int32), np.zeros(n)
    for t in range(steps):
        for i in range(n):
            rows[i] = i
            cols[i] = (i + t) % n
            vals[i] = v[i] * x[i] + 2.0
        A = coo_matrix((vals, (rows, cols)), shape=(n, n)).tocsc()
        x[:] = spsolve(A, x) + A @ x
        vals[:] = 0.0
    return np.sum(x)


def laplacian(n):
    return diags([np.ones(n - 1), np.full(n, -2.0), np.ones(n - 1)], [-1, 0, 1])


def diagonals_in_the_call(c, x, h):
    n = x.size
    L = diags([np.ones(n - 1), np.full(n, -2.0), np.ones(n - 1)], [-1, 0, 1]).tocsc() / h ** 2
    x[:] = L @ x + laplacian(n) @ (c * x)
    return np.sum((diags([c[1:] * x[:-1], -c * x, 2.0], [1, 0, -1], shape=(n, n)) @ x) ** 2) + np.sum(
        diags(c * x).tocsr() @ x)


def rows_of_diagonals(c, x, h):
    """An element of a row is in the column of its place in the row; here in lists, there in an array."""
    n = x.size
    d = np.array([c, c * x, x * x])
    A = spdiags(d, [0, 1, -1], n, n) + spdiags([x, h * c], (1, -1), m=n, n=n, format="csr")
    B = spdiags(c * x, 0, n, n + 1) + spdiags(x, -1, n, n + 1)
    return np.sum((A @ x) ** 2) + np.sum((B.T @ x) ** 3)


def entries_in_lists(c, x, h):
    values, rows, columns = [], [], []
    n = x.size
    for i in range(n):
        values.append(x[i] * c[n - 1 - i])
        rows.append(i)
        columns.append(n - 1 - i)
    A = coo_matrix((values, (rows, columns)), shape=(n, n)).tocsr()
    return np.sum((A @ x) ** 3) * h


MATRICES = [csr_matrix(np.array([[2.0, 0.0, 1.0], [0.0, 0.0, 0.0], [0.5, 1.5, 0.0]])), identity(3, format="csc")]
ROWS, COLUMNS, ENDS = np.array([0, 1, 2]), np.array([1, 2, 0]), np.array([0, 1, 2, 3])


class Operator:
    def __init__(self, A, scale):
        self.A, self.scale = A, scale

    def __matmul__(self, x):
        return self.scale * (self.A @ x)


def in_objects_and_lists(v, x):
    op = Operator(coo_matrix((v, (ROWS, COLUMNS)), shape=(3, 3)).tocsr(), 2.0)
    y = op @ x
    op.A = op.A + op.A.T
    for A in [*MATRICES, *(coo_matrix((v * k, (ROWS, COLUMNS)), shape=(3, 3)) for k in (1.0, 2.0))]:
        y = A @ y + op @ x
    held = {"K": MATRICES[0], "D": diags(v)}
    return np.sum(y ** 2) + sum(np.sum((held[k] @ x) ** 2) for k in held)


def in_place(v, x):
    """`*=` writes the entries, which may be an argument's; `+=` makes another matrix."""
    A, B = coo_matrix((v, (ROWS, COLUMNS)), shape=(3, 3)).tocsr(), csr_matrix((v, COLUMNS, ENDS), shape=(3, 3))
    same = B
    A *= 2.0
    B *= x[0]
    A += B
    B /= 3.0
    B.data[1:] *= x[1]
    return np.sum((A @ x) ** 2) + np.sum((same @ x) ** 3) + np.sum(v)


def by_entries(v, x):
    """Entries at one place, no entries, a row without any; the loops that one writes over a matrix."""
    A = csr_matrix((v, np.array([1, 0, 2]), np.array([0, 1, 1, 3])), shape=(3, 3))
    y = np.zeros(3)
    for i in range(3):
        for k in range(A.indptr[i], A.indptr[i + 1]):
            y[i] += A.data[k] * x[A.indices[k]]
    C = coo_matrix((v, ([0, 0, 0], [1, 1, 0])), shape=(3, 3))
    N = csr_matrix((v[:0], (ROWS[:0], COLUMNS[:0])), shape=(3, 3))
    return np.sum(y * (C @ x)) + np.sum(C.toarray() ** 2) + np.sum((N + identity(3) - C) @ x * y) * A.nnz


def rows_written_between(v, x):
    """Rows that are written when a matrix has been used, and one whose rows were copied before."""
    rows, s = np.zeros(3, dtype=np.int32), 0.0
    for t in range(3):
        for i in range(3):
            rows[i] = (i + t) % 3
        A = coo_matrix((v, (rows, ROWS)), shape=(3, 3))
        s += np.sum((A @ x) ** 2)
        B = A.tocsr()
        rows[0] = 2
        s += np.sum((B @ x) ** 3)
    return s


def on_both_ways(v, x, n):
    if x[0] > 0.0:
        A = diags([v], [0], shape=(n, n), format="csr")
    else:
        A = diags([x], [0], shape=(n, n), format="csr")
    k, r = 0, A @ x
    while np.sum(r * r) > 0.05 and k < 5:
        A = A * 0.5
        r = A @ r
        k += 1
    return np.sum(r) + np.sum(A @ x)


def newton(v, x):
    def solved(J, r):
        nonlocal count
        count = count + J
        return factorized(J.tocsc())(r)
    count, u = identity(3), x.copy()
    u = u - solved(diags(3.0 * u ** 2 + v), u ** 3 + v * u - x)
    u = u - solved(diags(3.0 * u ** 2 + v), u ** 3 + v * u - x)
    return np.sum(u ** 2) + np.sum(count @ u)


HOSTILE = (in_objects_and_lists, in_place, by_entries, rows_written_between, newton)
OF_DIAGONALS = (diagonals_in_the_call, rows_of_diagonals, entries_in_lists)
KERNELS = {
    poisson: lambda r: (1.0 + r.random(6), r.random(5)),
    heat: lambda r: (1.0 + r.random(6), r.random(5), 0.1, 2),
    nonlinear_heat: lambda r: (1.0 + r.random(6), r.random(5), 0.1, 2),
    products: lambda r: (1.0 + r.random(5), r.random(4), np.array([0, 3, 1, 0, 2]), np.array([0, 2, 3, 5], np.int32)),
    in_helpers: lambda r: (1.0 + r.random(5), r.random(4), np.array([0, 3, 1, 2, 2]), np.array([0, 2, 3, 5])),
    shared: lambda r: (1.0 + r.random(5), 0.5 + r.random(4), np.array([0, 3, 1, 0, 2]), np.array([0, 2, 3, 5, 5])),
    solved_again: lambda r: (r.random(4), r.random(4), 3),
    assembled_again: lambda r: (1.0 + r.random(3), r.random(3), 3),
    on_both_ways: lambda r: (1.0 + r.random(3), 0.5 + r.random(3), 3),
    **{f: lambda r: (1.0 + r.random(3), 0.5 + r.random(3)) for f in HOSTILE},
    **{f: lambda r: (1.0 + r.random(4), 0.5 + r.random(4), 0.3) for f in OF_DIAGONALS},
}


@pytest.mark.parametrize(("kernel", "engine"), each(KERNELS))
def test_kernel(kernel, engine):
    names = kernel.__code__.co_varnames[:kernel.__code__.co_argcount]
    given, left = (KERNELS[kernel](generator(1)) for _ in range(2))
    kernel(*left)
    wrt = tuple(n for n, a in zip(names, given) if np.asarray(a).dtype.kind == "f")
    of = tuple(n for n, a, b in zip(names, given, left) if not np.array_equal(a, b))
    check_derivatives(kernel, given, wrt, (*of, "return"), engine)


@pytest.mark.parametrize("kernel", OF_DIAGONALS, ids=lambda kernel: kernel.__name__)
@pytest.mark.parametrize("size", [1, 2])
def test_small_and_single(kernel, size):
    c, x = 1.0 + np.arange(size) / 3.0, 0.5 + np.arange(size) / 4.0
    check_derivatives(kernel, (c, x, 0.3), ("c", "x", "h"), ("return",), "loops")
    check_derivatives(kernel, (c.astype(np.float32), x.astype(np.float32), 0.3), ("c", "x"), ("return",))


def single(v, x):
    A = coo_matrix((v, (np.arange(4), np.arange(4)[::-1])), shape=(4, 4))
    return np.sum(spsolve(A.tocsc(), A @ x + x) ** 2)


def test_single_precision():
    random = generator(1)
    given = (1.0 + random.random(4)).astype(np.float32), random.random(4).astype(np.float32)
    check_derivatives(single, given, ("v", "x"), ("return",))
