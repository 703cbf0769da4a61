"""What is refused of sparse matrices, and what shows when a kernel with them runs."""
from __future__ import annotations

import numpy as np
import pytest
from scipy import sparse
from scipy.sparse import coo_matrix, csr_matrix, diags, identity, spdiags
from scipy.sparse.linalg import cg, splu, spsolve

import s2sad
from tests.harness.engines import running


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
    return np.sum(np.exp(A) @ x)


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


def view_written(v, x):
    rows = np.array([0, 1, 2], dtype=np.int32)
    A = coo_matrix((v, (rows[::-1], rows)), shape=(3, 3))
    part = rows[1:]
    part[0] = 2
    return np.sum(A @ x)


def rows_written_in_a_loop(v, x):
    rows = np.arange(3)
    A = coo_matrix((v, (rows, rows)), shape=(3, 3))
    s = 0.0
    for k in range(x.size):
        s += np.sum(A @ x)
        rows[k] = 0
    return s


def compared(v, x):
    A, B = diags(v), diags(x)
    return np.sum(A @ x) if A == B else np.sum(B @ x)


def gone_through(v, x):
    return sum(np.sum(row @ x) for row in diags(v, format="csr"))


def entries_assigned(v, x):
    A = csr_matrix((v, np.arange(3), np.arange(4)), shape=(3, 3))
    A.data = x
    return np.sum(A @ x)


def columns_left_out(v, x):
    return np.sum(spdiags(x, 0) @ x)


REFUSED = {
    columns_left_out: ("no derivative rule for scipy.sparse.spdiags with these arguments", "spdiags(rows, [0, 1], "),
    assigned: ("an element of 'A', a sparse matrix, has no derivative rule", "build it from its entries: coo_matrix"),
    sorted_by_scipy: ("the attribute 'data' of 'A' has no derivative rule here: 'A' is a sparse matrix (csr)",
                      "SciPy sorts and joins the entries here"),
    of_two: ("this operation with a sparse matrix has no derivative rule", "sparse matrices have A @ x"),
    elementwise: ("the attribute 'multiply' of the sparse matrix has no derivative rule", "sparse matrices have A @ x"),
    iterative: ("no derivative rule for scipy.sparse.linalg.cg", "@s2sad.rule(implicit=residual)"),
    built_by_scipy: ("no derivative rule for scipy.sparse.kron", "build it from its entries"),
    of_no_shape: ("no derivative rule for scipy.sparse.coo_matrix with these arguments", "shape=(m, n)"),
    returned: ("a sparse matrix is returned", "return its entries"),
    factors_read: ("the attribute 'L' of 'lu' has no derivative rule here", "a factorization has lu.solve(b)"),
    used_whole: ("'A' is a sparse matrix (csr), which is used as a whole here", "sparse matrices have A @ x"),
    times_an_array: ("a sparse matrix times something that is no number", "A @ x is the product with a vector"),
    places_written: ("the places of the entries of a sparse matrix are written after it was made", "copy them before"),
    indices_written: ("the places of the entries of a sparse matrix are written after it was made", "copy them before"),
    indices_of_it_written: ("the places of the entries of a sparse matrix are written", "build another matrix"),
    view_written: ("the places of the entries of a sparse matrix are written after it was made", "copy them before"),
    rows_written_in_a_loop: ("the places of the entries of a sparse matrix are written", "build another matrix"),
    compared: ("'A' is a sparse matrix, which is used as a whole here", "sparse matrices have A @ x"),
    gone_through: ("this is a sparse matrix (csr), which is used as a whole here", "sparse matrices have A @ x"),
    entries_assigned: ("an attribute of a sparse matrix (csr) is assigned", "A.data[:] = ..."),
    either: ("'A' is a sparse matrix of one shape on one way and of another on another", ""),
}


@pytest.mark.parametrize("kernel", REFUSED, ids=lambda kernel: kernel.__name__)
def test_refused(kernel):
    message, help = REFUSED[kernel]
    with pytest.raises(s2sad.S2sadError) as caught:
        s2sad.vjp(kernel, (1.0 + np.arange(3.0), np.ones(3)), {"return": 1.0})
    found = str(caught.value)
    assert message in found and help in found and "test_sparse_refusals.py:" in found


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
