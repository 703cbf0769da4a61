"""The kernels with arguments: what is differentiated, the outputs, and why there is no version in JAX where there is
none. Sizes are "small", at which errors are measured, and "large", at which times are."""
from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from benchmarks.published import learning, linear_algebra, physics, stencils


@dataclass(frozen=True)
class Case:
    """A kernel; `loops`: it goes through elements, so NumPy's own time would be that of the interpreter."""
    function: Callable[..., Any]
    arguments: Callable[[str], tuple[Any, ...]]
    wrt: tuple[str, ...]
    of: tuple[str, ...]
    loops: bool = False
    no_jax: str = ""

    @property
    def name(self) -> str:
        return self.function.__name__


Sizes = tuple[int, int] | tuple[tuple[int, ...], tuple[int, ...]]


def _made(function: Callable[..., Any], wrt: str, of: str, sizes: Sizes, build: Callable[..., tuple[Any, ...]],
          loops: bool = False, no_jax: str = "") -> Case:
    """A case whose `build` takes a seeded generator and the sizes."""
    def arguments(size: str) -> tuple[Any, ...]:
        chosen = sizes[size == "large"]
        return build(np.random.default_rng(7), *(chosen if isinstance(chosen, tuple) else (chosen,)))
    return Case(function, arguments, tuple(wrt.split()), tuple(of.split()), loops, no_jax)


def _square(r: np.random.Generator, n: int, count: int) -> list[np.ndarray]:
    return [r.random((n, n)) for _ in range(count)]


def _definite(r: np.random.Generator, n: int) -> np.ndarray:
    a = r.random((n, n))
    return a @ a.T + n * np.eye(n)


def _dominant(r: np.random.Generator, n: int) -> np.ndarray:
    return r.random((n, n)) + n * np.eye(n)


def _gas(r: np.random.Generator, n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A shock tube with noise: density, momentum and energy."""
    left = np.arange(n) < n // 2
    rho = np.where(left, 1.0, 0.125) + 0.01 * r.random(n)
    p, u = np.where(left, 1.0, 0.1) + 0.01 * r.random(n), 0.1 * r.random(n)
    return rho, rho * u, p / 0.4 + 0.5 * rho * u * u


def _fluid(r: np.random.Generator, n: int) -> tuple[np.ndarray, float]:
    """Particles around the places of a cubic lattice, and their box."""
    side = int(np.ceil(n ** (1 / 3)))
    lattice = np.stack(np.meshgrid(*[np.arange(side)] * 3), axis=-1).reshape(-1, 3)[:n]
    return 1.3 * lattice + 0.2 * r.random((n, 3)), 1.3 * side


def _shared(r: np.random.Generator, *shape: int) -> tuple[np.ndarray, np.ndarray]:
    a = r.random(shape)
    return a, a.copy()


ORDER = "each element reads neighbours that are new already: a chain over all elements"
PIVOTS = "jax.scipy.linalg.lu pivots and gives other factors"
TRIPS = "the number of steps depends on the flow: while_loop has no reverse mode"
SHRINKS = "rows and columns of changing length; jnp.linalg has no such function"

LINEAR_ALGEBRA = (
    _made(linear_algebra.gemm, "C A B", "C", (7, 300), lambda r, n: (1.5, 1.2, *_square(r, n, 3))),
    _made(linear_algebra.k2mm, "A B C D", "D", (7, 240), lambda r, n: (1.5, 1.2, *_square(r, n, 4))),
    _made(linear_algebra.k3mm, "A B C D", "return", (7, 240), lambda r, n: (*_square(r, n, 4),)),
    _made(linear_algebra.gemver, "A u1 v1 u2 v2 w x y z", "A w x", (8, 700),
          lambda r, n: (1.5, 1.2, r.random((n, n)), *(r.random(n) / n for _ in range(8)))),
    _made(linear_algebra.gesummv, "A B x", "return", (8, 800), lambda r, n: (1.5, 1.2, *_square(r, n, 2), r.random(n))),
    _made(linear_algebra.atax, "A x", "return", (8, 900), lambda r, n: (r.random((n, n)), r.random(n))),
    _made(linear_algebra.bicg, "A p r", "return", (8, 900), lambda r, n: (r.random((n, n)), r.random(n), r.random(n))),
    _made(linear_algebra.mvt, "x1 x2 y1 y2 A", "x1 x2", (8, 900),
          lambda r, n: (*(r.random(n) for _ in range(4)), r.random((n, n)))),
    _made(linear_algebra.syrk, "C A", "C", (7, 160), lambda r, n: (1.5, 1.2, *_square(r, n, 2))),
    _made(linear_algebra.syr2k, "C A B", "C", (7, 130), lambda r, n: (1.5, 1.2, *_square(r, n, 3))),
    _made(linear_algebra.trmm, "A B", "B", (7, 160), lambda r, n: (1.5, *_square(r, n, 2))),
    _made(linear_algebra.symm, "C A B", "C", (7, 130), lambda r, n: (1.5, 1.2, *_square(r, n, 3))),
    _made(linear_algebra.doitgen, "A C4", "A", (5, 60), lambda r, n: (r.random((n, n, n)), r.random((n, n)) / n)),
    _made(linear_algebra.cholesky, "A", "A", (6, 220), lambda r, n: (_definite(r, n),)),
    _made(linear_algebra.lu, "A", "A", (6, 160), lambda r, n: (_dominant(r, n),), no_jax=PIVOTS),
    _made(linear_algebra.ludcmp, "A b", "return", (6, 160), lambda r, n: (_dominant(r, n), r.random(n)),
          no_jax=PIVOTS),
    _made(linear_algebra.trisolv, "L b", "x", (7, 900),
          lambda r, n: (np.tril(_dominant(r, n)), np.zeros(n), r.random(n))),
    _made(linear_algebra.durbin, "r", "return", (7, 900), lambda r, n: (0.3 * r.random(n) / np.arange(1.0, n + 1.0),),
          no_jax=SHRINKS),
    _made(linear_algebra.gramschmidt, "A", "return", (6, 110), lambda r, n: (_dominant(r, n) + r.random((n, n)),)),
    _made(linear_algebra.floyd_warshall, "path", "path", (7, 150), lambda r, n: (1.0 + 9.0 * r.random((n, n)),)),
)
STENCILS = (
    _made(stencils.jacobi_1d, "A B", "A B", ((4, 9), (200, 2000)), lambda r, t, n: (t, *_shared(r, n))),
    _made(stencils.jacobi_2d, "A B", "A B", ((4, 7), (40, 150)), lambda r, t, n: (t, *_shared(r, n, n))),
    _made(stencils.heat_3d, "A B", "A B", ((3, 6), (15, 34)), lambda r, t, n: (t, *_shared(r, n, n, n))),
    _made(stencils.seidel_2d, "A", "A", ((3, 7), (15, 150)), lambda r, t, n: (t, r.random((n, n))), no_jax=ORDER),
    _made(stencils.fdtd_2d, "ex ey hz fict", "ex ey hz", ((4, 7), (40, 150)),
          lambda r, t, n: (*(r.random((n, n)) for _ in range(3)), r.random(t))),
    _made(stencils.adi, "u", "u", ((3, 7), (10, 120)), lambda r, t, n: (t, r.random((n, n)))),
    _made(stencils.deriche, "alpha image", "return", (7, 300), lambda r, n: (0.25, r.random((n, n + 2)))),
    _made(stencils.hdiff, "field coefficient", "return", ((8, 3), (68, 20)),
          lambda r, n, k: (r.random((n, n, k)), r.random((n - 4, n - 4, k)))),
    _made(stencils.vadv, "utens u w", "utens", ((4, 6), (50, 40)),
          lambda r, n, k: (*(r.random((n, n, k)) for _ in range(3)), 0.15)),
    _made(stencils.crank_nicolson, "u r", "u", ((9, 3), (2000, 100)), lambda r, n, t: (r.random(n), 0.4, t),
          loops=True),
    _made(stencils.tvd, "u c", "u", ((11, 3), (2000, 100)),
          lambda r, n, t: (np.sin(np.arange(n) * 6.3 / n) + 0.2 * r.random(n), 0.4, t)),
)
LEARNING = (
    _made(learning.covariance, "data", "return", ((9, 5), (500, 160)), lambda r, n, m: (r.random((n, m)),)),
    _made(learning.correlation, "data", "return", ((9, 5), (500, 160)), lambda r, n, m: (r.random((n, m)),)),
    _made(learning.azimint_naive, "data", "return", ((60, 4), (40000, 40)), lambda r, n, k: (
        r.random(n), r.random(n), k), no_jax="masks of changing size; jnp has where, which is another algorithm"),
    _made(learning.arc_distance, "theta_1 phi_1 theta_2 phi_2", "return", (9, 100_000),
          lambda r, n: tuple(r.random(n) for _ in range(4))),
    _made(learning.go_fast, "a", "return", (7, 600), lambda r, n: (r.random((n, n)),)),
    _made(learning.softmax, "x", "return", ((4, 5), (500, 400)), lambda r, n, m: (r.standard_normal((n, m)),)),
    _made(learning.mlp, "x w1 b1 w2 b2 w3 b3", "return", ((3, 4), (64, 200)), lambda r, n, m: (
        r.standard_normal((n, m)), *(w for k, j in ((m, 2 * m), (2 * m, m), (m, 10)) for w in (
            r.standard_normal((k, j)) / np.sqrt(k), r.standard_normal(j))))),
    _made(learning.conv2d_bias, "x weights bias", "return", ((2, 6, 2), (4, 24, 6)), lambda r, n, w, c: (
        r.standard_normal((n, w, w, c)), r.standard_normal((3, 3, c, 2 * c)), r.standard_normal(2 * c))),
    _made(learning.batch_norm, "x gamma beta", "return", ((6, 4), (1000, 200)), lambda r, n, m: (
        r.standard_normal((n, m)), r.random(m), r.random(m))),
    _made(learning.soft_dtw, "D", "return", (6, 200), lambda r, n: (r.random((n, n)), 0.5), loops=True),
    _made(learning.hmm_forward, "start moves emits", "return", ((3, 7), (12, 2000)), lambda r, k, t: (
        np.full(k, 1.0 / k), r.random((k, k)) + 0.1, r.random((k, 5)) + 0.1, r.integers(0, 5, t))),
)
PHYSICS = (
    _made(physics.lennard_jones, "position", "return", (9, 300), _fluid, loops=True),
    _made(physics.lj_forces, "position", "force", (9, 120), lambda r, n: (
        _fluid(r, n)[0], np.zeros((n, 3)), _fluid(r, n)[1]), loops=True),
    _made(physics.boris, "x v E B q", "x v", ((3, 4), (200, 50)), lambda r, n, t: (
        r.random((n, 3)), r.random((n, 3)), r.random(3), r.random(3), 1.0 + r.random(n), 0.1, t), loops=True),
    _made(physics.two_body_pairs, "pos mass", "acc", (6, 300), lambda r, n: (
        r.standard_normal((n, 3)), 1.0 + r.random((n, 1)), np.zeros((n, 3)), 1.0, 0.1)),
    _made(physics.hll, "rho m E", "rho m E", ((9, 3), (800, 60)), lambda r, n, t: (*_gas(r, n), 0.2, t), loops=True),
    _made(physics.roe, "q", "q", ((9, 3), (1500, 60)), lambda r, n, t: (np.stack(_gas(r, n)), 0.2, t)),
    _made(physics.cavity_flow, "u v p", "u v p", ((2, 3, 7), (20, 10, 61)), lambda r, t, k, n: (
        t, k, 0.1 * r.random((n, n)), 0.1 * r.random((n, n)), 1e-3, 2.0 / (n - 1), 2.0 / (n - 1), r.random((n, n)), 1.0,
        0.1)),
    _made(physics.channel_flow, "u v p", "u p", ((3, 7), (10, 61)), lambda r, k, n: (
        k, np.pad(0.005 + 0.005 * r.random((n - 2, n)), ((1, 1), (0, 0))), 0.01 * r.random((n, n)), 1e-3, 2.0 / (n - 1),
        2.0 / (n - 1), 1e-3 * r.random((n, n)), 1.0, 0.1, 1.0, 0.02), no_jax=TRIPS),
)
CASES = {case.name: case for group in (LINEAR_ALGEBRA, STENCILS, LEARNING, PHYSICS) for case in group}
