"""Kernels of whole arrays: the gradients of both engines against those of JAX, for the rewrites of `jax_kernels`.

JAX compiles each rewrite twice, with all that a step computes kept for its gradient and with the steps run again
(`jax.checkpoint`); the faster counts. One thread, and the memory that XLA allocates at every call kept by the C library
(see `against_jax`), which is the best case for JAX. `python -m benchmarks.arrays_against_jax SECONDS` is the process in
which all are measured, in turns, after their values and gradients have been compared.
"""
from __future__ import annotations

import importlib
import importlib.util
import inspect
import json
import os
import subprocess
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path
from statistics import geometric_mean
from typing import Any

import numpy as np

from benchmarks.against_jax import KEPT
from benchmarks.calls import adjoint_arguments, differentiated, fresh
from benchmarks.jax_kernels import rewritten
from benchmarks.kernels.cases import ARRAYS, Case
from benchmarks.tables import Table, seconds, verdict
from s2sad.report.timing import interleaved

SLOWEST, MEAN, AGREE = 1.0, 3.0, 1e-8
ONE_THREAD = {"XLA_FLAGS": "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1", "OMP_NUM_THREADS": "1",
              "OPENBLAS_NUM_THREADS": "1", "JAX_PLATFORMS": "cpu"}


def tables(quick: bool, kernels: list[str]) -> list[Table]:
    """One line for each kernel, and the geometric mean of the factors."""
    table = Table("Whole arrays: gradients against jitted JAX, large size, float64",
                  ("kernel", "Numba", "NumPy", "JAX", "JAX, steps again", "JAX / Numba", "JAX / NumPy", "target", ""))
    if importlib.util.find_spec("jax") is None:
        table.notes.append("JAX is not installed: pip install jax")
        return [table]
    done = subprocess.run([sys.executable, "-m", "benchmarks.arrays_against_jax", "0.5" if quick else "5"], check=True,
                          env={**os.environ, **KEPT, **ONE_THREAD}, stdout=subprocess.PIPE, text=True,
                          cwd=Path(__file__).resolve().parent.parent)
    found = [json.loads(line) for line in done.stdout.splitlines() if line.startswith("{")]
    compiled, plain = [], []
    for taken in found:
        best = min(taken["jax"], taken["again"])
        compiled.append(best / taken["numba"])
        plain.append(best / taken["numpy"])
        table.rows.append((taken["name"], *(seconds(taken[k]) for k in ("numba", "numpy", "jax", "again")),
                           f"{compiled[-1]:.2f}", f"{plain[-1]:.2f}", f">= {SLOWEST:g}",
                           verdict(compiled[-1], SLOWEST, least=True)))
    mean = geometric_mean(compiled)
    table.rows.append(("geometric mean", "", "", "", "", f"{mean:.2f}", f"{geometric_mean(plain):.2f}", f">= {MEAN:g}",
                       verdict(mean, MEAN, least=True)))
    table.notes.append(f"JAX {found[0]['version']}; the faster of its two counts; largest relative difference of "
                       f"values and gradients: {max(t['apart'] for t in found):.1e}")
    return [table]


def main(budget: float) -> None:
    """Compares and measures every kernel in this process and prints a line of JSON for each."""
    jax = importlib.import_module("jax")
    jax.config.update("jax_enable_x64", True)
    for case in ARRAYS:
        print(json.dumps({"name": case.name, "version": jax.__version__, **measured(case, jax, budget)}), flush=True)


def measured(case: Case, jax: Any, budget: float) -> dict[str, float]:
    """The median times of the four gradients of one kernel, and how far they are apart."""
    arguments = case.arguments("large")
    prepared = adjoint_arguments(case, arguments)
    runs: dict[str, Callable[[], Callable[[], Any]]] = {}
    expected, apart = _reference(case, arguments), 0.0
    for engine in ("numba", "numpy"):
        adjoint = differentiated(case, engine).compiled("adjoint", *prepared)
        ours = fresh(prepared)
        apart = max(apart, _apart(expected[1], _gradients(case, ours, adjoint(*ours))))
        runs[engine] = partial(_prepared, adjoint, prepared)
    for name, remember in (("jax", lambda step: step), ("again", jax.checkpoint)):
        value, gradient = jitted(case, arguments, rewritten(jax, remember)[case.name], jax)
        apart = max(apart, _apart(expected[0], value()), _apart(expected[1], gradient()))
        runs[name] = partial(_ready, jax, gradient)
    if not apart <= AGREE:
        raise SystemExit(f"{case.name}: values or gradients differ by {apart:.1e}")
    return {**interleaved(runs, budget), "apart": apart}


def jitted(case: Case, arguments: tuple[Any, ...], function: Callable[..., Any], jax: Any
           ) -> tuple[Callable[[], Any], Callable[[], Any]]:
    """The compiled rewrite and its compiled gradient, each as a call without arguments."""
    given = dict(zip(inspect.signature(case.function).parameters, arguments))
    taken = list(inspect.signature(function).parameters)
    fixed = {n: given[n] for n in taken if n not in case.wrt}
    inputs = [jax.device_put(given[n]) for n in taken if n in case.wrt]
    seeds = [jax.device_put(s) for s in _seeds(case, arguments)]
    plain = partial(function, **fixed)

    def gradient(inputs: list[Any], seeds: list[Any]) -> Any:
        return jax.vjp(plain, *inputs)[1](tuple(seeds) if len(seeds) > 1 else seeds[0])

    value, pulled = jax.jit(plain), jax.jit(gradient)
    return lambda: _flat(value(*inputs)), lambda: _flat(pulled(inputs, seeds))


def _seeds(case: Case, arguments: tuple[Any, ...]) -> list[Any]:
    """The seeds of the outputs, as `adjoint_arguments` has them."""
    if case.of == ("return",):
        return [np.float64(1.0)]
    prepared = adjoint_arguments(case, arguments)
    return [shadow for name, shadow in _shadows(case, prepared).items() if name in case.of]


def _shadows(case: Case, prepared: list[Any]) -> dict[str, np.ndarray]:
    """The shadows of arrays among the arguments of an adjoint, by the array's name."""
    found: dict[str, np.ndarray] = {}
    position = 0
    for name in inspect.signature(case.function).parameters:
        if isinstance(prepared[position], np.ndarray) and name in {*case.wrt, *case.of}:
            position += 1
            found[name] = prepared[position]
        position += 1
    return found


def _gradients(case: Case, arguments: list[Any], returned: Any) -> list[Any]:
    """What an adjoint left in the shadows of inputs and returned for numbers, in the order of the parameters."""
    shadows = _shadows(case, arguments)
    numbers = iter(returned if isinstance(returned, tuple) else (returned,))
    return [shadows[n] if n in shadows else next(numbers)
            for n in inspect.signature(case.function).parameters if n in case.wrt]


def _reference(case: Case, arguments: tuple[Any, ...]) -> tuple[list[Any], list[Any]]:
    """The kernel's outputs as NumPy computes them, and the gradients of the adjoint for NumPy."""
    given = dict(zip(inspect.signature(case.function).parameters, fresh(arguments)))
    result = case.function(**given)
    prepared = adjoint_arguments(case, arguments)
    returned = differentiated(case, "numpy").compiled("adjoint", *prepared)(*prepared)
    return [result if n == "return" else given[n] for n in case.of], _gradients(case, prepared, returned)


def _prepared(adjoint: Callable[..., Any], prepared: list[Any]) -> Callable[[], Any]:
    return partial(adjoint, *fresh(prepared))


def _ready(jax: Any, gradient: Callable[[], Any]) -> Callable[[], Any]:
    return lambda: jax.block_until_ready(gradient())


def _flat(result: Any) -> list[Any]:
    return list(result) if isinstance(result, tuple) else [result]


def _apart(expected: list[Any], found: list[Any]) -> float:
    """The largest difference, relative to the largest element of each array."""
    assert len(expected) == len(found)
    return max(float(np.max(np.abs(np.asarray(a) - np.asarray(b))) / np.max(np.abs(a)))
               for a, b in zip(expected, found))


if __name__ == "__main__":
    main(float(sys.argv[1]))
