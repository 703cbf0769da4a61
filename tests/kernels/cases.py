"""The kernels of this folder with inputs: `for case in LOOPS: ...`.

A case gives the function, a builder of fresh arguments for a size ("small" for correctness,
"large" for speed), the names to differentiate with respect to, and the outputs ("return" is the
returned value, any other name an argument's final content).
"""
from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from tests.kernels import brusselator, loops


@dataclass(frozen=True)
class Case:
    name: str
    function: Callable
    arguments: Callable[[str], tuple]
    wrt: tuple[str, ...]
    of: tuple[str, ...]


def _rng():
    return np.random.default_rng(7)


def _size(size, small, large):
    return {"small": small, "large": large}[size]


def _field(n):
    x = np.linspace(0.0, 1.0, n)
    u = np.empty((n, n, 2))
    u[:, :, 0] = 22.0 * (x[None, :] * (1.0 - x[None, :])) ** 1.5
    u[:, :, 1] = 27.0 * (x[:, None] * (1.0 - x[:, None])) ** 1.5
    return 0.1 * u + 0.1 * _rng().random(u.shape)


def _brusselator(size):
    n = _size(size, 7, 512)
    return np.zeros((n, n, 2)), _field(n), np.array([3.4, 1.0, 10.0, 1.0 / n]), 1.2


def _integrate(size):
    n = _size(size, 6, 32)
    return _field(n), np.array([3.4, 1.0, 10.0, 1.0 / n]), 1e-5, _size(size, 5, 100)


def _seidel(size):
    n = _size(size, 8, 100)
    return _rng().random((n, n)), _size(size, 3, 20)


def _jacobi(size):
    n = _size(size, 8, 150)
    return _rng().random((n, n)), np.zeros((n, n)), _size(size, 3, 50)


def _advect(size):
    n = _size(size, 24, 2000)
    x = np.linspace(0.0, 1.0, n, endpoint=False)
    return np.sin(2 * np.pi * x) + (np.abs(x - 0.5) < 0.1) + 0.05 * _rng().standard_normal(n), 0.4, _size(size, 4, 100)


def _upwind(size):
    n = _size(size, 9, 401)
    return np.zeros(n), _rng().random(n), 1.3


def _thomas(size):
    n = _size(size, 8, 100_000)
    rng = _rng()
    return rng.random(n), 4.0 + rng.random(n), rng.random(n), rng.random(n)


def _cholesky(size):
    n = _size(size, 6, 200)
    a = _rng().random((n, n))
    return (np.tril(a @ a.T + n * np.eye(n)),)


def _csr(n):
    rng = _rng()
    degree = rng.integers(0, 6, n)
    indptr = np.concatenate([[0], np.cumsum(degree)])
    return rng, indptr, rng.integers(0, n, indptr[-1])


def _spmv(size):
    n = _size(size, 10, 100_000)
    rng, indptr, indices = _csr(n)
    return np.zeros(n), rng.random(indices.size), indices, indptr, rng.random(n)


def _assemble(size):
    n = _size(size, 10, 100_000)
    rng = _rng()
    left, right = rng.integers(0, n, 3 * n), rng.integers(0, n, 3 * n)
    return np.zeros(n), rng.random(3 * n), left, right, rng.random(n)


def _newton(size):
    n = _size(size, 6, 100_000)
    return np.zeros(n), 0.5 + 5.0 * _rng().random(n), 1e-12


def _nbody(size):
    n = _size(size, 4, 60)
    rng = _rng()
    return (rng.standard_normal((n, 3)), 0.1 * rng.standard_normal((n, 3)), np.zeros((n, 3)), 0.5 + rng.random(n),
            0.01, _size(size, 3, 100), 0.1)


def _mixture(size):
    n, d, k = _size(size, (12, 3, 4), (1000, 10, 25))
    rng = _rng()
    return (rng.standard_normal(k), rng.standard_normal((k, d)), 0.3 * rng.standard_normal((k, d)),
            rng.standard_normal((n, d)))


LOOPS = [
    Case("brusselator", brusselator.brusselator, _brusselator, ("u", "p"), ("du",)),
    Case("integrate", brusselator.integrate, _integrate, ("u", "p"), ("return",)),
    Case("seidel", loops.seidel, _seidel, ("a",), ("return",)),
    Case("jacobi", loops.jacobi, _jacobi, ("a", "b"), ("a",)),
    Case("advect", loops.advect, _advect, ("u", "c"), ("u",)),
    Case("upwind", loops.upwind, _upwind, ("u", "v"), ("du",)),
    Case("thomas", loops.thomas, _thomas, ("lower", "diagonal", "upper", "rhs"), ("rhs",)),
    Case("cholesky", loops.cholesky, _cholesky, ("a",), ("a",)),
    Case("spmv", loops.spmv, _spmv, ("data", "x"), ("y",)),
    Case("assemble", loops.assemble, _assemble, ("conductivity", "x"), ("y",)),
    Case("newton", loops.newton, _newton, ("a",), ("x",)),
    Case("first_crossing", loops.first_crossing, lambda size: (2.0, 0.5, _size(size, 0.05, 1e-6), 0.1),
         ("height", "velocity", "dt", "ground"), ("return",)),
    Case("nbody", loops.nbody, _nbody, ("position", "velocity", "mass"), ("return", "position")),
    Case("mixture", loops.mixture, _mixture, ("alphas", "means", "scales"), ("return",)),
]
