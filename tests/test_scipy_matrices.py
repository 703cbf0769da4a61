"""Functions of scipy.linalg that are NumPy's with other options, and matrices of a certain form."""
from __future__ import annotations

import numpy as np
import pytest

import s2sad
from tests.derivatives import check_derivatives
from tests.engines import each
from tests.seeds import generator

scipy_linalg = pytest.importorskip("scipy.linalg")
from scipy.linalg import block_diag, eigh, qr, solve, solveh_banded, svd, toeplitz  # noqa: E402


# -- a: symmetric and positive, b: 3 x 3, x: 3; what is returned is a number -----------------------------------------

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


@pytest.mark.parametrize(("kernel", "engine"), each(KERNELS))
def test_kernel(kernel, engine):
    check_derivatives(kernel, arguments(), ("a", "b", "x"), outputs(kernel, arguments()), engine)


@pytest.mark.parametrize("kernel", (solutions, of_blocks), ids=lambda kernel: kernel.__name__)
def test_single_precision(kernel):
    given = tuple(g.astype(np.float32) for g in arguments())
    check_derivatives(kernel, given, ("a", "b", "x"), outputs(kernel, given), "loops")


def of_any_size(a, x):
    t, c = toeplitz(x), block_diag(a, x)
    return np.sum(t * t) + np.sum(c ** 3) + np.sum(solveh_banded(a, x, lower=True))


@pytest.mark.parametrize("engine", ("numpy", "loops"))
@pytest.mark.parametrize("shape", ((1, 1), (3, 1), (1, 4), (4, 2)))
def test_short_axes(shape, engine):
    a = np.full(shape, 0.1)
    a[0] = 3.0
    x = np.arange(1.0, shape[1] + 1.0)
    check_derivatives(of_any_size, (a, x), ("a", "x"), ("return",), engine)
    check_derivatives(of_any_size, (a.astype(np.float32), x.astype(np.float32)), ("a", "x"), ("return",), engine)


def nothing(a, x):
    return np.sum(toeplitz(x)) + np.sum(toeplitz(a[0], x)) + np.sum(block_diag(a, a))


@pytest.mark.parametrize("engine", ("numpy", "loops"))
def test_no_elements(engine):
    check_derivatives(nothing, (np.ones((2, 3)), np.ones(0)), ("a", "x"), ("return",), engine)


def vectors_of_another_driver(a, x):
    w, v = eigh(a)
    return np.sum(v[:, 0] * x) + w[0]


def with_pivoting(a, x):
    q, r, p = qr(a, pivoting=True)
    return np.sum(r[0])


def schur(a, x):
    return np.sum(scipy_linalg.schur(a)[0])


def pseudoinverse(a, x):
    return np.sum(scipy_linalg.pinv(a))


def least(a, x):
    return np.sum(scipy_linalg.lstsq(a, x)[0])


def a_band(a, x):
    return np.sum(solve(a, x, assume_a="banded"))


def option_in_a_variable(a, x):
    low = x[0] > 0.5
    return np.sum(solve(a, x, lower=low, assume_a="sym"))


def several_toeplitz(a, x):
    return np.sum(toeplitz(a))


_OTHERS = "write it with functions that have a rule, or give it one: s2sad.rule, s2sad.nondifferentiable"
REFUSED = {
    vectors_of_another_driver: ("eigh", "write w, v = np.linalg.eigh(a), or driver='evd' with lower=True: others turn "
                                "vectors round; the values alone are eigvalsh(a)"),
    with_pivoting: ("qr", "write mode='full' or mode='economic', without pivoting"),
    schur: ("schur", _OTHERS), several_toeplitz: ("toeplitz", _OTHERS),
    pseudoinverse: ("pinv", "write np.linalg.pinv(a), which takes other singular values for zero"),
    least: ("lstsq", "write np.linalg.lstsq(a, b, rcond=None), which takes other singular values for zero"),
    **dict.fromkeys((a_band, option_in_a_variable), ("solve", "write assume_a as 'gen', 'sym' or 'pos', and lower and "
                                                     "transposed as True or False"))}


@pytest.mark.parametrize("kernel", REFUSED, ids=lambda kernel: kernel.__name__)
def test_refused(kernel):
    function, help = REFUSED[kernel]
    with pytest.raises(s2sad.S2sadError) as raised:
        s2sad.differentiate(kernel).adjoint_source(np.eye(3), np.ones(3))
    found = raised.value.diagnostics
    assert (found[0].code, found[0].message, found[0].help) == (
        "S301", f"no derivative rule for scipy.linalg.{function}", help)
