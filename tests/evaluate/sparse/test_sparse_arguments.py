"""Sparse matrices that are arguments, lie in structures or stand outside, and an iterative solver with them."""
from __future__ import annotations

import numpy as np
import pytest
from scipy import sparse
from scipy.sparse import csr_array, csr_matrix, diags
from scipy.sparse.linalg import cg, spsolve

import s2sad
from tests.harness.derivatives import check_derivatives
from tests.harness.seeds import generator

ENGINES = ("numpy", "numba")
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


def test_other_formats_are_refused():
    said = r"(?s)'A' is a dia_matrix.*  help: give it in another format: A.tocsr\(\)"
    with pytest.raises(s2sad.S2sadError, match=said):
        s2sad.gradient(misfit, wrt="x")(sparse.dia_matrix(LAPLACE), np.ones(4), np.ones(4))
