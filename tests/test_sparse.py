"""Sparse matrices of SciPy's in kernels, under both engines."""
from __future__ import annotations

import numpy as np
import pytest

import s2sad
from tests.harness.derivatives import check_derivatives
from tests.harness.engines import each, running
from tests.harness.seeds import generator

sparse = pytest.importorskip("scipy.sparse")
from scipy.sparse import coo_matrix, csc_array, csr_array, csr_matrix, diags, eye, identity, spdiags  # noqa: E402
from scipy.sparse.linalg import cg, factorized, splu, spsolve  # noqa: E402

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
    **{f: lambda r: (1.0 + r.random(4), 0.5 + r.random(4), 0.3) for f in OF_DIAGONALS},
}
COMPILED = (poisson, rows_of_diagonals)               # the others as the text for Numba, run by Python


@pytest.mark.parametrize(("kernel", "engine"), each(KERNELS))
def test_kernel(kernel, engine):
    names = kernel.__code__.co_varnames[:kernel.__code__.co_argcount]
    given, left = (KERNELS[kernel](generator(1)) for _ in range(2))
    kernel(*left)
    wrt = tuple(n for n, a in zip(names, given) if np.asarray(a).dtype.kind == "f")
    of = tuple(n for n, a, b in zip(names, given, left) if not np.array_equal(a, b))
    engine = "loops" if engine == "numba" and kernel not in COMPILED else engine
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


# -- matrices that are arguments, or stand outside --------------------------------------------------------------------

LAPLACE = diags([-2.0 * np.ones(4), np.ones(3), np.ones(3)], [0, 1, -1], format="csr")


def misfit(A, x, b):
    B = A.tocsr() + A
    r = A @ x - b
    return 0.5 * np.sum(r * r) + A.data[0] * x[0] + np.sum(B.T @ (B @ x))


@pytest.mark.parametrize("engine", ENGINES)
def test_a_matrix_is_an_argument(engine):
    random = generator(2)
    x, b, ones = random.random(4), random.random(4), np.ones(4)
    f = s2sad.differentiate(misfit, engine=engine)
    for A in [LAPLACE] if engine == "numba" else [LAPLACE, LAPLACE.tocsc(), csr_array(LAPLACE).tocoo()]:
        found = s2sad.gradient(f, wrt=("A", "x"))(A, x, b)
        r, B = A @ x - b, 2.0 * A
        expected = np.outer(r, x) + 2.0 * np.outer(B @ x, ones) + 2.0 * np.outer(B @ ones, x)
        expected = expected * (A.toarray() != 0.0) + np.diag([x[0], 0.0, 0.0, 0.0])
        assert type(found["A"]) is type(A)
        np.testing.assert_allclose(found["A"].toarray(), expected, rtol=1e-12, atol=1e-14)
        np.testing.assert_allclose(found["x"], A.T @ r + A.data[0] * np.eye(4)[0] + B.T @ (B @ ones), rtol=1e-12)
        change = A.copy()
        change.data = random.random(A.nnz)
        tangent = s2sad.jvp(f, (A, x, b), {"A": change})["return"]
        assert tangent == pytest.approx(np.sum(expected * change.toarray()), rel=1e-12)
        A_bar, x_bar = s2sad.make_zero(A), np.zeros(4)
        s2sad.autodiff(s2sad.Reverse, f, s2sad.Duplicated(A, A_bar), s2sad.Duplicated(x, x_bar), s2sad.Const(b))
        np.testing.assert_allclose(A_bar.toarray(), expected, rtol=1e-12, atol=1e-14)
        np.testing.assert_allclose(x_bar, found["x"], rtol=1e-12)


def test_a_gradient_has_places_of_its_own():
    x = np.ones(4)
    found = s2sad.gradient(misfit, wrt="A")(LAPLACE, x, x)
    assert not np.shares_memory(found.indices, LAPLACE.indices)
    text = s2sad.differentiate(misfit, wrt=("x",), engine="numpy").adjoint_source(LAPLACE, x, x)
    assert "sparse_gain" not in text and "A_data_bar" not in text


def test_a_shadow_has_its_entries_where_the_matrix_has_them():
    x, x_bar = np.ones(4), np.zeros(4)
    other = csr_matrix((np.ones(10), np.array([0, 1, 0, 1, 2, 1, 2, 3, 1, 3]), LAPLACE.indptr), shape=(4, 4))
    for shadow, said in ((other, "has its entries at other places"), (LAPLACE.tocsc(), "is of type csc_matrix")):
        with pytest.raises(s2sad.S2sadError, match=said):
            s2sad.autodiff(s2sad.Reverse, misfit, s2sad.Duplicated(LAPLACE, shadow), s2sad.Duplicated(x, x_bar),
                           s2sad.Const(x))


def scaled_in_place(A, x):
    y = A @ x
    A.data[:] *= x[0]
    x[:] = A @ y
    return np.sum(A.data ** 2) * A.nnz + A.indptr[1]


def test_the_entries_of_an_argument_are_written():
    A, x = LAPLACE.copy(), 1.0 + np.arange(4.0)
    found = s2sad.vjp(scaled_in_place, (A, x), {"return": 1.0, "x": np.ones(4), "A": LAPLACE})
    np.testing.assert_array_equal(A.data, LAPLACE.data)

    def value(data, x):
        B, u = A.copy(), x.copy()
        B.data = data.copy()
        result = scaled_in_place(B, u)
        return result + np.sum(u) + np.sum(B.data * LAPLACE.data)
    for gained, change in ((found["A"].data, np.eye(10)), (found["x"], np.eye(4))):
        for k, step in enumerate(1e-6 * change):
            steps = (step, 0.0) if len(step) == 10 else (0.0, step)
            slope = value(A.data + steps[0], x + steps[1]) - value(A.data - steps[0], x - steps[1])
            assert gained[k] == pytest.approx(slope / 2e-6, rel=1e-6)


def in_a_dict(p, x):
    return np.sum((p["K"] @ x) * x * p["c"]) + np.sum((LAPLACE @ x) ** 2)


def held_in_a_closure():
    K = LAPLACE.tocoo()

    def inner(u):
        return np.sum((K @ u) * u) + np.sum(spsolve(LAPLACE, u) ** 2) * K.shape[0]
    return inner


def test_matrices_in_structures_and_outside():
    x = 1.0 + np.arange(4.0)
    found = s2sad.gradient(in_a_dict, wrt="p")({"K": LAPLACE, "c": 2.0}, x)
    np.testing.assert_allclose(found["K"].toarray(), 2.0 * np.outer(x, x) * (LAPLACE.toarray() != 0.0))
    assert found["c"] == pytest.approx(x @ (LAPLACE @ x))
    check_derivatives(held_in_a_closure(), (x,), ("u",), ("return",))


def test_the_entries_of_a_matrix_outside_are_replaced():
    held, x = csr_matrix(np.array([[2.0, 1.0], [0.0, 3.0]])), np.array([0.5, 2.0])
    gradient = s2sad.gradient(s2sad.differentiate(lambda x: np.sum(held @ x), engine="numpy"))
    np.testing.assert_allclose(gradient(x), [2.0, 4.0])
    held.data = np.array([5.0, 7.0, 11.0])
    np.testing.assert_allclose(gradient(x), [5.0, 18.0])
    held.data *= 2.0
    np.testing.assert_allclose(gradient(x), [10.0, 36.0])


# -- an iterative solver of one's own --------------------------------------------------------------------------------

def remainder(r, x, v, b):
    r[:] = LAPLACE @ x - scaled(v) * x + b


def scaled(v):
    return 1.0 + v * v


@s2sad.rule(implicit=remainder, writes=("x",))
def iterated(x, v, b):
    x[:] = cg(diags(scaled(v)) - LAPLACE, b, rtol=1e-14)[0]


@s2sad.rule(implicit=remainder)
def solved_densely(x, v, b):
    x[:] = np.linalg.solve(np.diag(scaled(v)) - LAPLACE.toarray(), b)


def of_solutions(v, b):
    x, y = np.zeros(4), np.zeros(4)
    iterated(x, v, b)
    solved_densely(y, b, v)
    return np.sum((LAPLACE @ x) ** 2) + np.sum(x * y)


def test_implicit_functions_beside_sparse_matrices():
    random = generator(4)
    check_derivatives(of_solutions, (random.random(4), random.random(4)), ("v", "b"), ("return",))


# -- what is refused ---------------------------------------------------------------------------------------------------

def assigned(v, x):
    A = diags(v, format="csr")
    A[0, 1] = x[0]
    return np.sum(A @ x)


def sorted_by_scipy(v, x):
    A = coo_matrix((v, (np.array([2, 1, 0]), np.array([2, 1, 0]))), shape=(3, 3)).tocsr()
    return A.data[0] * x[0]


def of_two(v, x):
    A = diags(v)
    return np.sum((A @ A) @ x)


def elementwise(v, x):
    return np.sum(diags(v).multiply(x) @ x)


def iterative(v, x):
    y, info = cg(diags(v), x)
    return np.sum(y)


def built_by_scipy(v, x):
    return np.sum(sparse.kron(diags(v), identity(1)) @ x)


def of_no_shape(v, x):
    A = coo_matrix((v, (np.array([0, 1, 2]), np.array([0, 1, 2]))))
    return np.sum(A @ x)


def returned(v, x):
    return diags(v * x)


def factors_read(v, x):
    lu = splu(diags(v, format="csc"))
    return np.sum(lu.L @ x)


def used_whole(v, x):
    A = diags(v, format="csr")
    A *= 2.0
    return np.sum(A @ x)


def times_an_array(v, x):
    A = diags(v, format="csr")
    return np.sum((A * x) @ x)


def places_written(v, x):
    rows = np.arange(3)
    A = coo_matrix((v, (rows, rows)), shape=(3, 3))
    rows[0] = 1
    return np.sum((A @ x) ** 2)


def indices_written(v, x):
    j = np.arange(3)
    A = csr_matrix((v, j, np.arange(4)), shape=(3, 3))
    j[0] = 1
    return np.sum((A @ x) ** 2)


def indices_of_it_written(v, x):
    A = csr_matrix((v, np.arange(3), np.arange(4)), shape=(3, 3))
    A.indices[0] = 1
    return np.sum((A @ x) ** 2)


def either(v, x):
    if x[0] > 0.0:
        A = diags(v)
    else:
        A = diags(x)
    return np.sum(A @ x)


def columns_left_out(v, x):
    return np.sum(spdiags(x, 0) @ x)


REFUSED = {
    columns_left_out: ("no derivative rule for scipy.sparse.spdiags with these arguments", "spdiags(rows, [0, 1], "),
    assigned: ("an element of 'A', a sparse matrix, has no derivative rule", "build it from its entries: coo_matrix"),
    sorted_by_scipy: ("the attribute 'data' of 'A' has no derivative rule here: 'A' is a sparse matrix (csr)",
                      "SciPy sorts and joins the entries here"),
    of_two: ("this operation with a sparse matrix has no derivative rule", "sparse matrices have A @ x"),
    elementwise: ("the method 'multiply' of the sparse matrix has no derivative rule", "sparse matrices have A @ x"),
    iterative: ("no derivative rule for scipy.sparse.linalg.cg", "@s2sad.rule(implicit=residual)"),
    built_by_scipy: ("no derivative rule for scipy.sparse.kron", "build it from its entries"),
    of_no_shape: ("no derivative rule for scipy.sparse.coo_matrix with these arguments", "shape=(m, n)"),
    returned: ("a sparse matrix is returned", "return its entries"),
    factors_read: ("the attribute 'L' of 'lu' has no derivative rule here", "a factorization has lu.solve(b)"),
    used_whole: ("'A' is a sparse matrix (csr), which is used as a whole here", "sparse matrices have A @ x"),
    times_an_array: ("a sparse matrix times something that is no number", "A @ x is the product with a vector"),
    places_written: ("an array is written that NumPy shares with another one", "take a copy"),
    indices_written: ("the indices or the indptr of a sparse matrix are written after it was made", "copy them before"),
    indices_of_it_written: ("the places of the entries of a sparse matrix are written", "build another matrix"),
    either: ("'A' is one thing on one way to here and another on another", "give the two different names"),
}


@pytest.mark.parametrize("kernel", REFUSED, ids=lambda kernel: kernel.__name__)
def test_refused(kernel):
    message, help = REFUSED[kernel]
    with pytest.raises(s2sad.S2sadError) as caught:
        s2sad.vjp(kernel, (1.0 + np.arange(3.0), np.ones(3)), {"return": 1.0})
    found = str(caught.value)
    assert message in found and help in found and "test_sparse.py:" in found


def test_other_formats_are_refused():
    with pytest.raises(s2sad.S2sadError, match=r"'A' is a dia_matrix\n  help: give it in another format: A.tocsr\(\)"):
        s2sad.gradient(misfit, wrt="x")(sparse.dia_matrix(LAPLACE), np.ones(4), np.ones(4))


# -- what shows when a kernel runs ------------------------------------------------------------------------------------

def singular(v, x):
    return np.sum(splu(diags(v - 1.0, format="csc")).solve(x))


def nan_of(v, x):
    return np.sum(spsolve(diags(v - 1.0, format="csc"), x))


def of_another_size(v, x):
    return np.sum(diags(v) @ x[:2])


def outside(v, x):
    return np.sum(coo_matrix((v, (np.array([0, 1, 3]), np.array([0, 1, 2]))), shape=(3, 3)) @ x)


def out_of_order(v, x):
    return np.sum(csr_matrix((v, np.array([1, 0, 2]), np.array([0, 2, 3, 3])), shape=(3, 3)) @ x)


def one_column(v, x):
    return np.sum(spsolve(diags(v, format="csc"), np.outer(x, x[:1])))


def not_square(v, x):
    return np.sum(spsolve(diags([v], [0], shape=(3, 4), format="csc"), x))


RAISES = {singular: "exactly singular", of_another_size: "differ in size", outside: "outside of its shape",
          out_of_order: "not in order", one_column: "one column", not_square: "differ in size"}


@pytest.mark.parametrize("engine", ("numpy", "loops"))
def test_what_raises(engine):
    given = 1.0 + np.arange(3.0), np.ones(3)
    with running(engine) as run_under:
        for kernel, said in RAISES.items():
            f = s2sad.differentiate(kernel, engine=run_under)
            with pytest.raises((ValueError, RuntimeError), match=said):
                s2sad.vjp(f, given, {"return": 1.0})
    assert np.all(np.isnan(s2sad.vjp(nan_of, given, {"return": 1.0})["x"]))


def test_compiled_code_raises():
    with pytest.raises(RuntimeError, match="exactly singular"):
        s2sad.vjp(s2sad.differentiate(singular, engine="numba"), (np.ones(3), np.ones(3)), {"return": 1.0})
