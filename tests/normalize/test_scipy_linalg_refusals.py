"""Functions of scipy.linalg that are NumPy's with other options, and matrices of a certain form."""
from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import eigh, qr, solve, toeplitz  # noqa: E402

import s2sad
from tests.corpus.library.scipy_linalg import scipy_linalg


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
