"""The kernels with inputs: a builder of fresh arguments for a size ("small" for errors, "large" for
times, a number for growth at a fixed number of steps), the names to differentiate with respect to,
and the outputs ("return", or an argument's final content)."""
from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from benchmarks.kernels import arrays, brusselator, loops


Size = str | int


@dataclass(frozen=True)
class Case:
    name: str
    function: Callable[..., Any]
    arguments: Callable[[Size], tuple[Any, ...]]
    wrt: tuple[str, ...]
    of: tuple[str, ...]


def _random() -> np.random.Generator:
    return np.random.default_rng(7)


def _size(size: Size, small: Any, large: Any) -> Any:
    return {"small": small, "large": large}[size] if isinstance(size, str) else size


def _steps(size: Size, small: int, large: int, fixed: int) -> int:
    return _size(size, small, large) if isinstance(size, str) else fixed


def field(n: int) -> np.ndarray:
    """The Brusselator's usual start, a tenth of it, with noise."""
    x = np.linspace(0.0, 1.0, n)
    u = np.empty((n, n, 2))
    u[:, :, 0] = 22.0 * (x[None, :] * (1.0 - x[None, :])) ** 1.5
    u[:, :, 1] = 27.0 * (x[:, None] * (1.0 - x[:, None])) ** 1.5
    return 0.1 * u + 0.1 * _random().random(u.shape)


def _brusselator(size: Size) -> tuple[Any, ...]:
    n = _size(size, 7, 512)
    return np.zeros((n, n, 2)), field(n), np.array([3.4, 1.0, 10.0, 1.0 / n]), 1.2


def _integrate(size: Size) -> tuple[Any, ...]:
    n = _size(size, 6, 32)
    dt = 1e-5 if isinstance(size, str) else 0.01 / n ** 2      # stable however fine the grid
    return field(n), np.array([3.4, 1.0, 10.0, 1.0 / n]), dt, _steps(size, 5, 100, 20)


def _seidel(size: Size) -> tuple[Any, ...]:
    n = _size(size, 8, 100)
    return _random().random((n, n)), _steps(size, 3, 20, 10)


def _jacobi(size: Size) -> tuple[Any, ...]:
    n = _size(size, 8, 150)
    return _random().random((n, n)), np.zeros((n, n)), _steps(size, 3, 50, 20)


def _advect(size: Size) -> tuple[Any, ...]:
    n = _size(size, 24, 2000)
    x = np.linspace(0.0, 1.0, n, endpoint=False)
    u = np.sin(2 * np.pi * x) + (np.abs(x - 0.5) < 0.1) + 0.05 * _random().standard_normal(n)
    return u, 0.4, _steps(size, 4, 100, 50)


def _upwind(size: Size) -> tuple[Any, ...]:
    n = _size(size, 9, 401)
    return np.zeros(n), _random().random(n), 1.3


def _thomas(size: Size) -> tuple[Any, ...]:
    n = _size(size, 8, 100_000)
    random = _random()
    return random.random(n), 4.0 + random.random(n), random.random(n), random.random(n)


def _cholesky(size: Size) -> tuple[Any, ...]:
    n = _size(size, 6, 200)
    a = _random().random((n, n))
    return (np.tril(a @ a.T + n * np.eye(n)),)


def _spmv(size: Size) -> tuple[Any, ...]:
    n = _size(size, 10, 100_000)
    random = _random()
    indptr = np.concatenate([[0], np.cumsum(random.integers(0, 6, n))])
    indices = random.integers(0, n, indptr[-1])
    return np.zeros(n), random.random(indices.size), indices, indptr, random.random(n)


def _assemble(size: Size) -> tuple[Any, ...]:
    n = _size(size, 10, 100_000)
    random = _random()
    left, right = random.integers(0, n, 3 * n), random.integers(0, n, 3 * n)
    return np.zeros(n), random.random(3 * n), left, right, random.random(n)


def _newton(size: Size) -> tuple[Any, ...]:
    n = _size(size, 6, 100_000)
    return np.zeros(n), 0.5 + 5.0 * _random().random(n), 1e-12


def _falling(size: Size) -> tuple[Any, ...]:
    return 2.0, 0.5, _size(size, 0.05, 1e-6), 0.1


def _nbody(size: Size) -> tuple[Any, ...]:
    n = _size(size, 4, 60)
    random = _random()
    return (random.standard_normal((n, 3)), 0.1 * random.standard_normal((n, 3)), np.zeros((n, 3)),
            0.5 + random.random(n), 0.01, _steps(size, 3, 100, 10), 0.1)


def _mixture(size: Size) -> tuple[Any, ...]:
    n, d, k = _size(size, (12, 3, 4), (1000, 10, 25)) if isinstance(size, str) else (size, 5, 10)
    random = _random()
    return (random.standard_normal(k), random.standard_normal((k, d)), 0.3 * random.standard_normal((k, d)),
            random.standard_normal((n, d)))


def _gray_scott(size: Size) -> tuple[Any, ...]:
    n = _size(size, 10, 256)
    random = _random()
    return (1.0 - 0.5 * random.random((n, n)), 0.3 * random.random((n, n)), _steps(size, 3, 100, 20), 0.14, 0.06,
            0.035, 0.065)


def _glacier(size: Size) -> tuple[Any, ...]:
    n = _size(size, 9, 128)
    x = np.linspace(-1.0, 1.0, n)
    thickness = 300.0 * np.maximum(1.2 - x[:, None] ** 2 - x[None, :] ** 2, 0.3)
    bed = 2000.0 - 400.0 * x[:, None] + 50.0 * _random().random((n, n))
    return thickness, bed, 2.0e-16, 0.5 + 0.1 * _random().random((n - 2, n - 2)), 1000.0, 0.01, _steps(size, 3, 200, 20)


def _neural(size: Size) -> tuple[Any, ...]:
    n, h = _size(size, (8, 3), (200, 16)) if isinstance(size, str) else (size, 16)
    random = _random()
    return (random.random(n), random.standard_normal((h, 1)), random.standard_normal(h),
            0.3 * random.standard_normal((1, h)), random.standard_normal(1), 1e-3, _steps(size, 3, 100, 20))


def _implicit(size: Size) -> tuple[Any, ...]:
    n = _size(size, 6, 100)
    random = _random()
    return random.random(n), 1.0 + random.random(n + 1), 0.05, _steps(size, 3, 50, 10)


def _attention(size: Size) -> tuple[Any, ...]:
    n, d = _size(size, (5, 3), (200, 32)) if isinstance(size, str) else (size, 16)
    random = _random()
    return np.zeros((n, d)), *(random.standard_normal((n, d)) for _ in range(3))


def _masked(size: Size) -> tuple[Any, ...]:
    n = _size(size, 6, 256)
    random = _random()
    return random.random((n, n)), random.random((n, n)), 0.1 * random.random((n, n)), _steps(size, 3, 50, 20)


def _lattice(size: Size) -> tuple[Any, ...]:
    n = _size(size, 5, 128)
    return 1.0 / 9.0 + 0.02 * _random().random((9, n, n)), 1.2, _steps(size, 3, 50, 10)


LOOPS = (
    Case("brusselator", brusselator.brusselator, _brusselator, ("u", "p"), ("du",)),
    Case("integrate", brusselator.integrate, _integrate, ("u", "p"), ("return",)),
    Case("jacobi", loops.jacobi, _jacobi, ("a", "b"), ("a",)),
    Case("seidel", loops.seidel, _seidel, ("a",), ("return",)),
    Case("advect", loops.advect, _advect, ("u", "c"), ("u",)),
    Case("upwind", loops.upwind, _upwind, ("u", "v"), ("du",)),
    Case("thomas", loops.thomas, _thomas, ("lower", "diagonal", "upper", "rhs"), ("rhs",)),
    Case("cholesky", loops.cholesky, _cholesky, ("a",), ("a",)),
    Case("newton", loops.newton, _newton, ("a",), ("x",)),
    Case("first_crossing", loops.first_crossing, _falling, ("height", "velocity", "dt", "ground"), ("return",)),
    Case("nbody", loops.nbody, _nbody, ("position", "velocity", "mass"), ("return", "position")),
    Case("spmv", loops.spmv, _spmv, ("data", "x"), ("y",)),
    Case("assemble", loops.assemble, _assemble, ("conductivity", "x"), ("y",)),
    Case("mixture", loops.mixture, _mixture, ("alphas", "means", "scales"), ("return",)),
)
ARRAYS = (
    Case("gray_scott", arrays.gray_scott, _gray_scott, ("u", "v", "feed", "kill"), ("u", "v")),
    Case("glacier", arrays.glacier, _glacier, ("thickness", "bed", "rate", "balance"), ("thickness",)),
    Case("neural_diffusion", arrays.neural_diffusion, _neural, ("u", "w1", "b1", "w2", "b2"), ("return",)),
    Case("implicit_heat", arrays.implicit_heat, _implicit, ("u", "conductivity"), ("u",)),
    Case("attention", arrays.attention, _attention, ("q", "k", "v"), ("out",)),
    Case("masked_flow", arrays.masked_flow, _masked, ("head", "depth", "conductance"), ("return",)),
    Case("lattice", arrays.lattice, _lattice, ("f", "omega"), ("f",)),
)
CASES = {case.name: case for case in LOOPS}
