"""Functions of matrices that are given stacks of these."""
from __future__ import annotations

import numpy as np
import pytest
import scipy.linalg

import s2sad
from tests.derivatives import check_derivatives
from tests.engines import each
from tests.seeds import generator

_NEW = np.lib.NumpyVersion(np.__version__) >= "2.0.0"


# -- a, b: stacks of 3 x 3, x: 3; what is returned is a number -----------------------------------------------------

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


@pytest.mark.parametrize(("kernel", "engine"), each(KERNELS))
def test_kernel(kernel, engine):
    check_derivatives(kernel, arguments(), ("a", "b", "x"), outputs(kernel, arguments()), engine)


@pytest.mark.parametrize("engine", ("numpy", "loops"))
@pytest.mark.parametrize(("count", "n"), ((1, 3), (0, 3), (3, 1)))
@pytest.mark.parametrize("kernel", (inverses, solutions, determinants), ids=lambda kernel: kernel.__name__)
def test_short_stacks(kernel, count, n, engine):
    given = arguments(count, n)
    check_derivatives(kernel, given, ("a", "b", "x"), outputs(kernel, given), engine)


@pytest.mark.parametrize("kernel", (inverses, solutions, singular_vectors), ids=lambda kernel: kernel.__name__)
def test_single_precision(kernel):
    check_derivatives(kernel, tuple(g.astype(np.float32) for g in arguments()), ("a", "b", "x"), ("return",), "loops")


@pytest.mark.parametrize("engine", ("numpy", "loops"))
def test_complex_stacks(engine):
    def kernel(z, b):
        y = np.linalg.solve(z, b)
        return np.sum(np.abs(y @ np.linalg.inv(z)) ** 2)
    a, b, _ = arguments()
    check_derivatives(kernel, (a + 1j * b, b - 0.5j * a), ("z", "b"), ("return",), engine)


def test_right_sides_of_one_matrix_are_solved_at_once():
    def kernel(a, b):
        return np.sum(np.linalg.solve(a, b) ** 2)
    text = s2sad.differentiate(kernel, engine="numpy").adjoint_source(np.eye(3), np.ones((4, 3, 2)))
    assert "for " not in text
    check_derivatives(kernel, (arguments()[0][0], np.ones((0, 3, 2))), ("a", "b"), ("return",))


def of_more_axes(a, b):
    return np.sum(np.linalg.solve(a, b[None]))


def of_integers(a, b):
    return np.sum(np.linalg.inv(b))


@pytest.mark.parametrize(("kernel", "message"), (
    (of_more_axes, "error[S301]: no derivative rule for numpy.linalg.solve\n"),
    (of_integers, "error[S301]: no derivative rule for numpy.linalg.inv\n")), ids=("axes", "integers"))
def test_refused(kernel, message):
    with pytest.raises(s2sad.S2sadError) as raised:
        s2sad.differentiate(kernel).adjoint_source(arguments()[0], np.ones((2, 3, 3), int))
    assert message in str(raised.value)
    assert ("help: give both the same leading axes" in str(raised.value)) == (kernel is of_more_axes)


def test_stacks_of_different_sizes():
    def kernel(a, b):
        return np.sum(np.linalg.solve(a, b))
    for engine in ("numpy", "numba"):
        gradient = s2sad.gradient(s2sad.differentiate(kernel, engine=engine))
        with pytest.raises(s2sad.S2sadError) as raised:
            gradient(np.ones((1, 3, 3)) + np.eye(3), np.ones((2, 3, 3)))
        found = raised.value.diagnostics[0]
        assert (found.code, found.message, found.note) == (
            "S501", "stacks of different sizes", "a.shape[0] is 1, b.shape[0] is 2")
        assert found.help == "repeat the matrices of the shorter one, np.repeat(a, n, axis=0)"


# -- SciPy's options, of each matrix ---------------------------------------------------------------------------------

def turned(a, x):
    return np.sum(scipy.linalg.solve(a, x, transposed=True) * x)


def upper_triangles(a, x):
    values = scipy.linalg.eigvalsh(a, lower=False) + scipy.linalg.eigh(a, lower=False, eigvals_only=True)
    return np.sum(values * x)


def upper_factors(a, x):
    return np.sum(scipy.linalg.cholesky(a @ np.swapaxes(a, -1, -2)) @ x)


@pytest.mark.parametrize("engine", ("numpy", "loops"))
@pytest.mark.parametrize("kernel", (turned, upper_triangles, upper_factors))
@pytest.mark.parametrize("shape", [(3, 3, 3), (2, 3, 3), (3, 3), (1, 1)])
def test_of_scipy(kernel, shape, engine):
    a = generator(5).normal(size=shape) + 3.0 * np.eye(shape[-1])
    check_derivatives(kernel, (a, np.array([0.4, -1.3, 0.8])[:shape[-1]]), ("a", "x"), ("return",), engine)


def triangle_alone(a):
    return np.sum(scipy.linalg.qr(a, mode="r")[0])


def test_a_tuple_of_one_is_no_result_for_stacks():
    check_derivatives(triangle_alone, (np.eye(3) + 0.1 * np.arange(9.0).reshape(3, 3) ** 2,), ("a",), ("return",))
    with pytest.raises(s2sad.S2sadError) as refused:
        s2sad.gradient(triangle_alone)(np.ones((2, 3, 3)))
    assert refused.value.diagnostics[0].message == "no derivative rule for scipy.linalg.qr.triangular"
