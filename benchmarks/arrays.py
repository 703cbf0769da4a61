"""Adjoint over primal of kernels of whole arrays, each engine against itself: the generated adjoint, called bare,
against the compiled primal, or under NumPy against the kernel as it is written.

The compiled primal is the kernel with its statements turned into loops, as s2sad compiles it; `njit` is what a user has
who compiles the kernel as it is written, where Numba takes it."""
from __future__ import annotations

from functools import partial

from numba.core.errors import NumbaError

from benchmarks.calls import adjoint_arguments, differentiated, fresh, plain_numba
from benchmarks.kernels.cases import ARRAYS, Case
from benchmarks.tables import Table, seconds, verdict
from s2sad.report.timing import interleaved

TARGETS = {"gray_scott": 4.0, "glacier": 4.0, "neural_diffusion": 3.0, "implicit_heat": 2.5, "attention": 3.0,
           "masked_flow": 4.0, "lattice": 4.0}


def tables(quick: bool, kernels: list[str]) -> list[Table]:
    """One table for each engine, one line for each kernel."""
    made = []
    for engine, title in (("numba", "Numba"), ("numpy", "NumPy")):
        table = Table(f"Whole arrays: adjoint over primal under {title}, large size",
                      ("kernel", "primal", "njit", "adjoint", "ratio", "target", ""))
        for case in ARRAYS:
            taken = measured(case, engine, 0.3 if quick else 4.0)
            ratio = taken["adjoint"] / taken["primal"]
            njit = seconds(taken["njit"]) if "njit" in taken else "-"
            table.rows.append((case.name, seconds(taken["primal"]), njit, seconds(taken["adjoint"]), f"{ratio:.2f}",
                               f"{TARGETS[case.name]:g}", verdict(ratio, TARGETS[case.name])))
        made.append(table)
    return made


def measured(case: Case, engine: str, budget: float) -> dict[str, float]:
    """Median times of primal and adjoint; every run has fresh copies of what it overwrites."""
    arguments = case.arguments("large")
    function = differentiated(case, engine)
    primal = function.compiled("primal", *arguments)
    adjoint = function.compiled("adjoint", *adjoint_arguments(case, arguments))
    runs = {"primal": lambda: partial(primal, *fresh(arguments)),
            "adjoint": lambda: partial(adjoint, *adjoint_arguments(case, arguments))}
    if engine == "numba":
        written = plain_numba(case.function)
        try:
            written(*fresh(arguments))
        except NumbaError:
            return interleaved(runs, budget)
        runs["njit"] = lambda: partial(written, *fresh(arguments))
    return interleaved(runs, budget)
