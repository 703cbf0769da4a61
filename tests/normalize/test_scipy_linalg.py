"""Solvers of scipy.linalg: in a file that is only read, and in single precision."""
from __future__ import annotations

import numpy as np

import s2sad
from tests.corpus.linear_algebra.decompositions import arguments, in_single_precision


def test_read_from_a_file(tmp_path):
    from s2sad.cli import main
    path = tmp_path / "kernel.py"
    path.write_text("import scipy.linalg as la\nfrom scipy.linalg import solve_triangular\n\n\n"
                    "def kernel(a, x):\n    x[:] = solve_triangular(a, x, lower=True)\n    return la.det(a)\n")
    assert main(["adjoint", f"{path}:kernel", "--types", "a: float64[:, :], x: float64[:]", "-o",
                 str(tmp_path / "made.py")]) == 0


def test_single_precision():
    gradient = s2sad.gradient(s2sad.differentiate(in_single_precision, engine="numpy"))
    exact = gradient(*arguments())
    for n, found in gradient(*(g.astype(np.float32) for g in arguments())).items():
        assert found.dtype == np.float32
        np.testing.assert_allclose(found, exact[n], atol=1e-4 * np.max(np.abs(exact[n])))
