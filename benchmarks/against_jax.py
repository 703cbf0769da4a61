"""The Brusselator's vjp against JAX's: `jax.jit` of `jax.vjp` of a rewrite with `jnp.roll`, same layout, one thread."""
from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from benchmarks.calls import adjoint_arguments, differentiated, fresh
from benchmarks.kernels.cases import CASES
from benchmarks.measure import interleaved
from benchmarks.tables import Table, seconds, verdict

TARGET = 8.0


def tables(quick: bool, kernels: list[str]) -> list[Table]:
    """One line for each of the two, and how far they agree."""
    table = Table("vjp of the Brusselator, n = 512, (n, n, 2), float64", ("who", "time", "factor", "target", ""))
    try:
        import jax
    except ImportError:
        table.notes.append("JAX is not installed: pip install jax")
        return [table]
    case = CASES["brusselator"]
    arguments = case.arguments("large")
    prepared = adjoint_arguments(case, arguments)
    _, seed, u, _, p, _, t = prepared
    adjoint = differentiated(case).compiled("adjoint", *prepared)
    vjp = jitted(jax)
    device = [jax.device_put(a) for a in (u, p, seed)]
    taken = interleaved({
        "s2sad, bare adjoint": lambda: partial(adjoint, *fresh(prepared)),
        "JAX": lambda: lambda: jax.block_until_ready(vjp(*device, t)),
    }, 2.0 if quick else 10.0)
    ours = fresh(prepared)
    adjoint(*ours)
    apart = max(float(np.max(np.abs(mine - np.asarray(theirs))) / np.max(np.abs(mine)))
                for mine, theirs in zip((ours[3], ours[5]), vjp(*device, t)))
    factor = taken["JAX"] / taken["s2sad, bare adjoint"]
    table.rows = [("s2sad, bare adjoint", seconds(taken["s2sad, bare adjoint"]), "1", "", ""),
                  (f"JAX {jax.__version__}, jitted", seconds(taken["JAX"]), f"{factor:.1f}", f"{TARGET:g} or more",
                   verdict(factor, TARGET, least=True))]
    table.notes.append(f"largest relative difference between the two gradients: {apart:.1e}")
    return [table]


def jitted(jax: Any) -> Any:
    """The compiled vjp of the right-hand side as one writes it for JAX: (u, p, seed, t) to (u_bar, p_bar)."""
    jax.config.update("jax_enable_x64", True)
    jnp = jax.numpy

    def brusselator(u: Any, p: Any, t: Any) -> Any:
        a, b, alpha, dx = p
        n = u.shape[0]
        x = jnp.arange(n) * dx
        inside = (x[:, None] - 0.3) ** 2 + (x[None, :] - 0.6) ** 2 <= 0.01
        forcing = jnp.where(inside & (t >= 1.1), 5.0, 0.0)
        neighbours = jnp.roll(u, 1, 0) + jnp.roll(u, -1, 0) + jnp.roll(u, 1, 1) + jnp.roll(u, -1, 1)
        diffusion = alpha / dx ** 2 * (neighbours - 4.0 * u)
        first, second = u[:, :, 0], u[:, :, 1]
        reaction = first ** 2 * second
        return diffusion + jnp.stack([b + reaction - (a + 1.0) * first + forcing, a * first - reaction], axis=2)

    return jax.jit(lambda u, p, seed, t: jax.vjp(lambda u, p: brusselator(u, p, t), u, p)[1](seed))
