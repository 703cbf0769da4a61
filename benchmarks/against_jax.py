"""The Brusselator's vjp against JAX's: `jax.jit` of `jax.vjp` of a rewrite with `jnp.roll`, same layout, one thread.

XLA allocates its results and temporaries at every call. Whether the C library keeps that memory or gives it back and
takes it anew, page by page, changes JAX's time several times over, from one process to the next. So it is measured in
two processes: with the memory kept, which is what the target is held against, and as the library's defaults have it.
`python -m benchmarks.against_jax SECONDS` is one such process.
"""
from __future__ import annotations

import importlib
import importlib.util
import json
import os
import resource
import subprocess
import sys
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.calls import adjoint_arguments, differentiated, fresh
from benchmarks.kernels.cases import CASES
from benchmarks.tables import Table, seconds, verdict
from s2sad.report.timing import interleaved

TARGET = 8.0
KEPT = {"MALLOC_ARENA_MAX": "1", "MALLOC_MMAP_THRESHOLD_": "1000000000", "MALLOC_TRIM_THRESHOLD_": "2000000000",
        "MALLOC_TOP_PAD_": "268435456"}


def tables(quick: bool, kernels: list[str]) -> list[Table]:
    """One line for each way to allocate, and how far the two gradients agree."""
    table = Table("vjp of the Brusselator, n = 512, (n, n, 2), float64: bare adjoint against jitted JAX",
                  ("allocation", "s2sad", "JAX", "page faults", "factor", "target", ""))
    if importlib.util.find_spec("jax") is None:
        table.notes.append("JAX is not installed: pip install jax")
        return [table]
    for words, environment in (("memory kept (glibc)", KEPT), ("defaults", {})):
        done = subprocess.run([sys.executable, "-m", "benchmarks.against_jax", "2" if quick else "8"], check=True,
                              env={**os.environ, **environment}, stdout=subprocess.PIPE, text=True,
                              cwd=Path(__file__).resolve().parent.parent)
        found = json.loads(done.stdout.splitlines()[-1])
        factor = found["jax"] / found["s2sad"]
        table.rows.append((words, seconds(found["s2sad"]), seconds(found["jax"]), f"{found['faults']:.0f} a call",
                           f"{factor:.1f}", f">= {TARGET:g}", verdict(factor, TARGET, least=True)))
        table.notes = [f"JAX {found['version']}; largest relative difference of the gradients: {found['apart']:.1e}"]
    return [table]


def main(budget: float) -> None:
    """Measures both in this process and prints what was found as JSON."""
    jax = importlib.import_module("jax")
    case = CASES["brusselator"]
    prepared = adjoint_arguments(case, case.arguments("large"))
    _, seed, u, _, p, _, t = prepared
    adjoint = differentiated(case).compiled("adjoint", *prepared)
    vjp = jitted(jax)
    device = [jax.device_put(a) for a in (u, p, seed)]
    taken = interleaved({"s2sad": lambda: partial(adjoint, *fresh(prepared)),
                         "jax": lambda: lambda: jax.block_until_ready(vjp(*device, t))}, budget)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
    for _ in range(20):
        jax.block_until_ready(vjp(*device, t))
    faults = (resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before) / 20
    ours = fresh(prepared)
    adjoint(*ours)
    apart = max(float(np.max(np.abs(mine - np.asarray(theirs))) / np.max(np.abs(mine)))
                for mine, theirs in zip((ours[3], ours[5]), vjp(*device, t)))
    print(json.dumps({**taken, "faults": faults, "apart": apart, "version": jax.__version__}))


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


if __name__ == "__main__":
    main(float(sys.argv[1]))
