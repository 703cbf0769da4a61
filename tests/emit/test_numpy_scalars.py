"""What the NumPy engine's scalars cost and are, where flags and complex numbers go in."""
from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import s2sad
from tests.harness.kernel_files import kernel_file


def test_flags_that_are_made_of_flags_are_asked_about_once(tmp_path: Path):
    """Each flag reads the one before it three times: 3 ** 40 ways lead from the last one to the first."""
    lines = ["a0 = x[0] > 0.5"]
    lines += [f"a{k + 1} = (a{k} and x[1] > {k}) or (a{k} and x[0] > 0.01 * {k}) or a{k}" for k in range(40)]
    kernel = kernel_file(tmp_path / "flags.py", "flags(x)", lines, "x[0] ** (1 if a40 else 2) / (1 + a40)")
    value, gradient = s2sad.value_and_gradient(s2sad.differentiate(kernel, engine="numpy"))(np.array([0.7, 0.3]))
    assert value == 0.35
    np.testing.assert_allclose(gradient, [0.5, 0.0])


def test_numbers_that_are_made_of_numbers_are_asked_about_once(tmp_path: Path):
    lines = ["a0 = p", *(f"a{k + 1} = min(a{k}, abs(a{k}), a{k} if p > 0 else -a{k}) * 1.0" for k in range(40))]
    kernel = kernel_file(tmp_path / "numbers.py", "numbers(p)", lines, "1.0 / a40")
    value, gradient = s2sad.value_and_gradient(s2sad.differentiate(kernel, engine="numpy"))(2.0)
    assert (value, gradient) == (0.5, -0.25)


@pytest.mark.parametrize("engine", ("numpy", "numba"))
def test_a_complex_constant_is_bound_before_a_loop(engine: str, tmp_path: Path):
    lines = ("p = 2j", "for _ in range(3):", "    p = p * x[0] + 1.0")
    kernel = kernel_file(tmp_path / "spiral.py", "spiral(x)", lines, "abs(p) ** 2 / abs(p + 1)")
    x = np.array([0.7, 0.3])
    value, gradient = s2sad.value_and_gradient(s2sad.differentiate(kernel, engine=engine))(x)
    assert value == pytest.approx(kernel(x))
    slope = (kernel(x + [1e-6, 0]) - kernel(x - [1e-6, 0])) / 2e-6
    np.testing.assert_allclose(gradient, [slope, 0.0], rtol=1e-7)
