"""Jacobians and products with Hessians: in calls of the compiled primal and in gradients, taken in turns."""
from __future__ import annotations

from statistics import median
from time import perf_counter
from typing import Any

import numpy as np

import s2sad
from benchmarks.kernels.brusselator import brusselator
from benchmarks.kernels.cases import field
from benchmarks.tables import Table


def in_turns(ways: dict[str, Any], rounds: int) -> dict[str, float]:
    """The median seconds of each way, called one after the other in each round."""
    taken: dict[str, list[float]] = {name: [] for name in ways}
    for _ in range(rounds):
        for name, way in ways.items():
            start = perf_counter()
            way()
            taken[name].append(perf_counter() - start)
    return {name: median(times) for name, times in taken.items()}


def tables(quick: bool, kernels: list[str]) -> list[Table]:
    """Sparse Jacobians of the Brusselator, and products with the Hessian of a sum of squares behind 20 steps."""
    sparse = Table("Sparse Jacobians of the Brusselator, in calls of its compiled primal",
                   ("n", "matrix", "products", "evaluation", "unchecked", "plan"),
                   [_of_the_brusselator(n, 10 if quick else 200) for n in (8, 32, 128)])
    hessian = Table("A product with the Hessian, in gradients", ("u", "gradient", "product", "ratio"),
                    [_with_the_hessian(n, 10 if quick else 100) for n in (100, 1000, 10_000)])
    return [sparse, hessian]


def _of_the_brusselator(n: int, rounds: int) -> tuple[str, ...]:
    u = field(n)
    args = np.zeros_like(u), u, np.array([3.4, 1.0, 10.0 * (n - 1) ** 2 / 961, 1.0 / n]), 0.0
    f = s2sad.differentiate(brusselator, engine="numba", wrt="u", of="du")
    primal, J = f.compiled("primal", *args), s2sad.jacobian(f, sparse=True)
    unchecked, plan = s2sad.jacobian(f, sparse=True, check=False), J.plan(*args)
    unchecked(*args)
    found = in_turns({"primal": lambda: primal(*args), "checked": lambda: J(*args),
                      "unchecked": lambda: unchecked(*args)}, rounds)
    made = in_turns({"plan": lambda: J.plan(*args)}, 3)["plan"]
    return (str(n), f"{plan.shape[0]} x {plan.shape[1]}", str(plan.colors), *(
        f"{found[way] / found['primal']:.0f}" for way in ("checked", "unchecked")), f"{1e3 * made:.1f} ms")


def _with_the_hessian(n: int, rounds: int) -> tuple[str, ...]:
    u, v = np.linspace(0.5, 1.5, n), np.ones(n)
    f = s2sad.differentiate(_diffused, engine="numba", wrt="u")
    gradient = s2sad.gradient(f)
    found = in_turns({"gradient": lambda: gradient(u, 0.1, 20),
                      "product": lambda: s2sad.hvp(f, (u, 0.1, 20), {"u": v})}, rounds)
    return (str(n), *(f"{1e6 * found[way]:.0f} us" for way in ("gradient", "product")),
            f"{found['product'] / found['gradient']:.2f}")


def _diffused(u, dt, steps):
    v = u.copy()
    for _ in range(steps):
        for i in range(1, v.size - 1):
            v[i] = v[i] + dt * (v[i - 1] - 2.0 * v[i] + v[i + 1] + v[i] ** 2 - v[i] ** 3)
    return np.sum(v ** 2)
