"""Fourier transforms: the adjoints of the runtime against matrices, and derivatives of kernels."""
from __future__ import annotations

import numpy as np
import pytest

import s2sad
from s2sad import runtime
from tests.runtime import transform_kernels as kernels
from tests.corpus.library.fft import CASES, RNG

NORMS = (None, "backward", "ortho", "forward")


def real_matrix(function, size, is_complex):
    """The matrix of a function that is linear over the reals, with real and imaginary parts one after the other."""
    columns = []
    for unit in (1.0, 1j) if is_complex else (1.0,):
        for row in np.eye(size):
            found = function(row * unit if is_complex else row)
            columns.append(np.concatenate([found.real, found.imag]) if np.iscomplexobj(found) else found)
    return np.array(columns).T


@pytest.mark.parametrize("norm", NORMS)
@pytest.mark.parametrize("size", [1, 2, 3, 4, 5])
@pytest.mark.parametrize("n", [None, 1, 2, 3, 4, 6, 7])
def test_adjoints_are_transposed_matrices(n, size, norm):
    count = size if n is None else n
    half = count // 2 + 1
    for forward, back in ((runtime.fft, runtime.fft_adjoint), (runtime.ifft, runtime.ifft_adjoint)):
        matrix = real_matrix(lambda x, f=forward: f(x, n, -1, norm), size, True)
        adjoint = real_matrix(lambda g, f=back: f(g, size, -1, norm), count, True)
        np.testing.assert_allclose(adjoint, matrix.T, atol=1e-14)
    matrix = real_matrix(lambda x: runtime.rfft(x, n, -1, norm), size, False)
    adjoint = real_matrix(lambda g: runtime.rfft_adjoint(g, n, size, -1, norm), half, True)
    np.testing.assert_allclose(adjoint, matrix.T, atol=1e-14)
    if n is not None or size > 1:
        signal = 2 * (size - 1) if n is None else n
        matrix = real_matrix(lambda x: runtime.irfft(x, n, -1, norm), size, True)
        adjoint = real_matrix(lambda g: runtime.irfft_adjoint(g, size, -1, norm), signal, False)
        np.testing.assert_allclose(adjoint, matrix.T, atol=1e-14)


def test_adjoints_along_another_axis():
    g = RNG.normal(size=(4, 3)) + 1j * RNG.normal(size=(4, 3))
    for back, options in ((runtime.fft_adjoint, (5,)), (runtime.rfft_adjoint, (6, 5)), (runtime.ifft_adjoint, (2,)),
                          (runtime.irfft_adjoint, (3,))):
        operand = g.real if back is runtime.irfft_adjoint else g
        along = np.stack([back(column, *options, 0, None) for column in operand.T], axis=1)
        np.testing.assert_allclose(back(operand, *options, 0, None), along)
        np.testing.assert_allclose(back(operand.T, *options, 1, None), along.T)


def test_explain_names_what_the_interpreter_runs():
    pytest.importorskip("numba")
    said = str(s2sad.explain(kernels.burgers, *CASES[1][1], engine="numba"))
    section = said.partition("run by the interpreter, which Numba's code calls\n")[2].splitlines()
    assert [line.strip() for line in section] == ["line 20: slope = np.fft.irfft(1j * k * np.fft.rfft(u), n=u.size)"]
    assert "interpreter" not in str(s2sad.explain(kernels.burgers, *CASES[1][1], engine="numpy"))
