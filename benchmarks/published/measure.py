"""One kernel: times at the large size, in turns, and errors of the gradients at the small one."""
from __future__ import annotations

import importlib
import importlib.util
import inspect
from collections.abc import Callable, Sequence
from dataclasses import asdict
from functools import partial
from time import process_time
from typing import Any

import numpy as np
from numba.core.errors import NumbaError

import s2sad
from benchmarks.calls import fresh, plain_numba, seed_like
from benchmarks.published.cases import Case
from s2sad import S2sadError
from s2sad.report.measured_call import MeasuredCall
from s2sad.report.timing import Prepare, Times, sampled


def measured(case: Case, budget: float) -> dict[str, Any]:
    """Times, errors and remarks as JSON; where s2sad refuses the kernel, its message as `refused`."""
    try:
        found: dict[str, Any] = {"errors": errors(case), "times": times(case, budget)}
    except S2sadError as refusal:
        return {"refused": str(refusal)}
    return found


def jax_of(case: Case) -> Any:
    """JAX, where it is installed and has a version of the kernel; None else."""
    if case.no_jax or importlib.util.find_spec("jax") is None:
        return None
    jax = importlib.import_module("jax")
    jax.config.update("jax_enable_x64", True)
    return jax


# -- s2sad ----------------------------------------------------------------------------------------------------------

class Ours:
    """A case's derivative by s2sad at one size."""

    def __init__(self, case: Case, size: str):
        self.case, self.arguments = case, case.arguments(size)
        self.measured = MeasuredCall.for_call(case.function, self.arguments, case.wrt, case.of, "numba")
        values = dict(zip(self.measured.values, fresh(self.arguments)))
        values["return"] = self.measured.primal(self.measured.values)(*values.values())
        self.seeds = {name: _seed(values[name]) for name in case.of}
        self.function = s2sad.differentiate(case.function, wrt=case.wrt, of=case.of, engine="numba")
        self.call = partial(s2sad.vjp, self.function, self.arguments, self.seeds)
        self.reverse = self.measured.reverse()
        self.gradients = self.reverse.vjp(self.arguments, self.seeds)

    def primal(self) -> Callable[[], Any]:
        return self.measured.bare(dict(zip(self.measured.values, fresh(self.arguments))))

    def adjoint(self) -> Callable[[], Any]:
        values, shadows, seeds = self.reverse.bind_values(self.arguments, self.seeds)
        outside = self.measured.state.private_outside_arrays(self.measured.types)
        return partial(self.reverse.rv.function, *self.reverse.rv.assemble(values, shadows, seeds, outside))


def _seed(value: Any) -> Any:
    if isinstance(value, tuple):
        return tuple(map(_seed, value))
    return seed_like(value) if isinstance(value, np.ndarray) else 1.0


# -- times ----------------------------------------------------------------------------------------------------------

def times(case: Case, budget: float) -> dict[str, Any]:
    """Quartiles by what is timed."""
    ours = Ours(case, "large")
    runs: dict[str, Prepare] = {"generated": ours.primal, "adjoint": ours.adjoint, "vjp": lambda: ours.call}
    written = plain_numba(case.function)
    try:
        written(*fresh(ours.arguments))
        runs["njit"] = lambda: partial(written, *fresh(ours.arguments))
    except NumbaError:
        pass
    if not case.loops:
        runs["numpy"] = lambda: partial(case.function, *fresh(ours.arguments))
    jax = jax_of(case)
    if jax is not None:
        value, gradient = jitted(case, ours.arguments, ours.seeds, jax)
        runs["jax primal"] = lambda: lambda: jax.block_until_ready(value())
        runs["jax gradient"] = lambda: lambda: jax.block_until_ready(gradient())
    return {name: asdict(Times.of(taken)) for name, taken in sampled(runs, budget, clock=process_time).items()}


def jitted(case: Case, arguments: Sequence[Any], seeds: dict[str, Any], jax: Any
           ) -> tuple[Callable[[], Any], Callable[[], Any]]:
    """JAX's compiled version and its compiled gradient, each as a call without arguments."""
    function = getattr(importlib.import_module("benchmarks.published.in_jax"), case.name)
    given = dict(zip(inspect.signature(case.function).parameters, arguments))
    taken = list(inspect.signature(function).parameters)
    inputs = {n: jax.device_put(given[n]) for n in taken if n in case.wrt}
    fixed = {n: given[n] for n in taken if n not in case.wrt}
    weights = jax.device_put(seeds[case.of[0]] if len(case.of) == 1 else tuple(seeds[n] for n in case.of))

    def plain(inputs: dict[str, Any]) -> Any:
        return function(**inputs, **fixed)

    value = jax.jit(plain)
    pulled = jax.jit(lambda inputs, weights: jax.vjp(plain, inputs)[1](weights)[0])
    return lambda: value(inputs), lambda: pulled(inputs, weights)


# -- errors ---------------------------------------------------------------------------------------------------------

def errors(case: Case) -> dict[str, Any]:
    """Errors against 113 bits, and of both gradients against each other; why there is none where there is none."""
    ours = Ours(case, "small")
    jax = jax_of(case)
    theirs = jitted(case, ours.arguments, ours.seeds, jax)[1]() if jax is not None else {}
    theirs = {n: np.asarray(theirs[n]) for n in case.wrt if n in theirs}
    found: dict[str, Any] = {"apart": max(_apart(ours.gradients[n], g) for n, g in theirs.items())} if theirs else {}
    if importlib.util.find_spec("numpy_quaddtype") is None:
        return {**found, "no reference": "numpy-quaddtype is not installed"}
    reference = importlib.import_module("benchmarks.precision.reference")
    try:
        expected = reference.gradient(case.function, ours.arguments, case.wrt, case.of, ours.seeds)
    except reference.NoReference as why:
        return {**found, "no reference": str(why)}
    for name, gradients in (("s2sad", ours.gradients), ("jax", theirs)):
        if gradients:
            found[name] = max(reference.relative_error(gradients[n], expected[n]) for n in gradients)
    return found


def _apart(found: Any, expected: Any) -> float:
    """The largest difference over the largest magnitude."""
    return float(np.max(np.abs(found - expected)) / (np.max(np.abs(expected)) or 1.0))
