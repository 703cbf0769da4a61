"""Zeros, choices, kinks, published failures and long runs: the cases of benchmarks/robustness in both modes."""
from __future__ import annotations

import numpy as np
import pytest

import s2sad
from benchmarks.robustness import published, runs, zeros
from benchmarks.robustness.cases import apart, gradients
from tests.harness.engines import running

CASES = [*zeros.CASES, *zeros.EXTREMES, *zeros.KINKS, *published.CASES]


@pytest.mark.parametrize("case", CASES, ids=[f"{c.function.__name__}-{k}" for k, c in enumerate(CASES)])
def test_case(case):
    """Python's own numbers raise where arrays give inf: kernels of numbers run under NumPy, others as loops, too."""
    for engine in ("numpy", "loops") if np.ndim(case.arguments[0]) else ("numpy",):
        with running(engine) as run_under:
            adjoint, tangents = gradients(case, run_under)
        assert max(apart(adjoint, case.expected), apart(tangents, case.expected)) <= case.limit, (adjoint, tangents)


@pytest.mark.parametrize("case", [c for c in CASES if c.kink], ids=lambda c: c.function.__name__)
def test_explain_lists_the_kink(case):
    explained = str(s2sad.explain(s2sad.differentiate(case.function, engine="numpy"), *case.arguments))
    assert case.kink in explained.partition("not differentiable")[2]


@pytest.mark.parametrize("name, steps, limit", [
    ("lorenz", 500, 1e-11), ("pendulum", 300, 1e-11), ("robertson", 100, 1e-11), ("brusselator", 2000, 1e-11),
    ("shock", 12, 1e-13), ("relaxation", 5000, 1e-12)])
def test_adjoint_and_tangent_agree_over_a_long_run(name, steps, limit):
    with running("loops") as run_under:
        adjoint, tangents = runs.both(name, steps, run_under)
    assert np.all(np.isfinite(adjoint)) and runs.disagreement(adjoint, tangents) <= limit


def gradient(function, **options):
    return s2sad.gradient(s2sad.differentiate(function, engine="numpy"), **options)


def weighted_eigenvalues(a):
    return np.sum(np.arange(1.0, 4.0) * np.linalg.eigvalsh(a))


def part_of_a_vector(a):
    values, vectors = np.linalg.eigh(a)
    return vectors[0, 0] * values[2]


def test_repeated_eigenvalues():
    """Each has the derivative along the vector that LAPACK gives it; vectors of equal ones do not turn into another."""
    np.testing.assert_array_equal(gradient(weighted_eigenvalues)(np.eye(3)), np.diag([1.0, 2.0, 3.0]))
    np.testing.assert_array_equal(gradient(part_of_a_vector)(np.eye(3)), np.diag([0.0, 0.0, 1.0]))


def variance(x):
    return np.var(x)


def test_the_variance_of_large_numbers():
    x = 1e8 + np.array([1.0, 2.0, 4.0, 9.0])
    np.testing.assert_allclose(gradient(variance)(x), [-1.5, -1.0, 0.0, 2.5], rtol=1e-15)


def solved(a, b):
    return np.sum(np.linalg.solve(a, b))


def test_solutions_are_as_wrong_as_their_condition_says():
    """The matrix [[1, 1], [1, 1 + 1 / c]] has about the condition 4 c."""
    for c in (1e3, 1e6, 1e9, 1e12):
        a, b = np.array([[1.0, 1.0], [1.0, 1.0 + 1.0 / c]]), np.array([1.0, 2.0])
        e = a[1, 1] - 1.0       # as it is rounded: then the gradient by b is that of the sum of the inverse
        found = gradient(solved, wrt="b")(a, b)
        np.testing.assert_allclose(found, [1.0, 0.0], atol=32.0 * np.finfo(float).eps / e)
