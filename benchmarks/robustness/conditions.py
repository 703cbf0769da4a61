"""Errors against conditions: linear systems, large means, nearly dependent vectors, long sums."""
from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction
from typing import Any

import numpy as np

import s2sad
from benchmarks.robustness.cases import EPS


def solved(a, b, weight):
    return np.sum(weight * np.linalg.solve(a, b))


def variance(x):
    return np.var(x)


def by_squares(x):
    return np.mean(x * x) - np.mean(x) ** 2


def orthogonal(a):
    """Gram and Schmidt, as modified: each vector is freed of those before it, one after the other."""
    q = a.copy()
    n = q.shape[1]
    for j in range(n):
        for k in range(j):
            q[:, j] -= np.sum(q[:, k] * q[:, j]) * q[:, k]
        q[:, j] /= np.sqrt(np.sum(q[:, j] * q[:, j]))
    return np.sum(q[0] * np.arange(1.0, n + 1.0))


def scaled_sum(u, c):
    return np.sum(c * u)


def scaled_loop(u, c):
    total = 0.0
    for i in range(u.size):
        total += c * u[i]
    return total


def _gradient(function: Callable[..., Any], wrt: str, *arguments: Any, engine: str = "numpy") -> np.ndarray:
    return np.asarray(s2sad.gradient(s2sad.differentiate(function, engine=engine), wrt=wrt)(*arguments))


def _exact_solution(matrix: np.ndarray, right: np.ndarray) -> np.ndarray:
    """The solution by Gauss's elimination of fractions, which are exact; rounded at the end."""
    n = right.size
    rows = [[Fraction(float(v)) for v in row] + [Fraction(float(r))] for row, r in zip(matrix, right)]
    for k in range(n):
        pivot = max(range(k, n), key=lambda i: abs(rows[i][k]))
        rows[k], rows[pivot] = rows[pivot], rows[k]
        for i in range(n):
            if i != k:
                factor = rows[i][k] / rows[k][k]
                rows[i] = [v - factor * w for v, w in zip(rows[i], rows[k])]
    return np.array([float(row[n] / row[k]) for k, row in enumerate(rows)])


def systems(powers: range) -> list[dict[str, float]]:
    """Errors of the gradient by the right-hand side and by the matrix, of systems whose condition is a power of ten."""
    random, found, n = np.random.default_rng(5), [], 8
    left, right = (np.linalg.qr(random.standard_normal((n, n)))[0] for _ in range(2))
    b, weight = random.standard_normal(n), random.standard_normal(n)
    for power in powers:
        a = left @ np.diag(np.logspace(0.0, -float(power), n)) @ right
        by_b, by_a = _exact_solution(a.T, weight), None
        by_a = -np.outer(by_b, _exact_solution(a, b))
        errors = [float(np.max(np.abs(_gradient(solved, name, a, b, weight) - exact)) / np.max(np.abs(exact)))
                  for name, exact in (("b", by_b), ("a", by_a))]
        found.append({"condition": float(np.linalg.cond(a)), "b": errors[0], "a": errors[1]})
    return found


def means(powers: range) -> list[dict[str, float]]:
    """Errors of the gradient of a variance, as NumPy has it and by squares, of numbers around a mean."""
    found = []
    for power in powers:
        x = 10.0 ** power + np.random.default_rng(6).random(100)
        exact_mean = sum(map(Fraction, map(float, x))) / x.size
        exact = np.array([float(2 * (Fraction(float(v)) - exact_mean) / x.size) for v in x])
        errors = [float(np.max(np.abs(_gradient(f, "x", x) - exact)) / np.max(np.abs(exact)))
                  for f in (variance, by_squares)]
        found.append({"mean": 10.0 ** power, "var": errors[0], "squares": errors[1]})
    return found


def dependent(powers: range) -> list[dict[str, float]]:
    """How far adjoint and tangent are apart for vectors that are nearly dependent, over the gradient."""
    random, found = np.random.default_rng(7), []
    base, noise, along = (random.standard_normal((5, 3)) for _ in range(3))
    for power in powers:
        a = base.copy()
        a[:, 1] = a[:, 0] + 10.0 ** -power * noise[:, 1]
        gradient = _gradient(orthogonal, "a", a)
        function = s2sad.differentiate(orthogonal, engine="numpy")
        tangent = float(s2sad.jvp(function, (a,), {"a": along})["return"])
        size = float(np.sum(np.abs(gradient * along)))
        found.append({"condition": float(np.linalg.cond(a)), "gradient": float(np.max(np.abs(gradient))),
                      "apart": abs(float(np.sum(gradient * along)) - tangent) / size})
    return found


def sums(count: int) -> list[dict[str, Any]]:
    """Errors of a long sum and of its derivative by a factor, in units of the dtype's rounding."""
    found: list[dict[str, Any]] = []
    for dtype in (np.float64, np.float32):
        u = (0.1 + np.random.default_rng(3).random(count)).astype(dtype)
        exact = math.fsum(u)
        unit = EPS if dtype is np.float64 else float(np.finfo(np.float32).eps)
        for name, function, engine in (("np.sum", scaled_sum, "numpy"), ("np.sum", scaled_sum, "numba"),
                                       ("a loop", scaled_loop, "numba")):
            differentiated = s2sad.differentiate(function, engine=engine)
            value, gradient = s2sad.value_and_gradient(differentiated, wrt="c")(u, 1.0)
            found.append({"dtype": np.dtype(dtype).name, "sum": name, "engine": engine,
                          "value": abs(float(value) - exact) / exact / unit,
                          "gradient": abs(float(gradient) - exact) / exact / unit})
    return found
