"""Adjoint over Numba primal: the generated adjoint, called bare, against the user's kernel under plain `numba.njit`."""
from __future__ import annotations

from functools import partial

from benchmarks.calls import adjoint_arguments, differentiated, fresh, plain_numba
from benchmarks.kernels.cases import CASES, Case
from benchmarks.tables import Table, seconds, verdict
from s2sad.report.timing import Prepare, interleaved

TARGETS = {"brusselator": 2.5, "integrate": 4.0, "jacobi": 6.0, "seidel": 2.0, "advect": 13.0, "thomas": 4.0,
           "nbody": 4.0, "spmv": 4.0, "mixture": 4.0}


def tables(quick: bool, kernels: list[str]) -> list[Table]:
    """One line for each kernel."""
    table = Table("Adjoint over Numba primal, large size", ("kernel", "primal", "adjoint", "ratio", "target", ""))
    table.notes = ['primal: the kernel under numba.njit(error_model="numpy"); adjoint: f.compiled("adjoint", ...)']
    for name in kernels or TARGETS:
        taken = measured(CASES[name], 0.3 if quick else 4.0)
        ratio = taken["adjoint"] / taken["primal"]
        table.rows.append((name, seconds(taken["primal"]), seconds(taken["adjoint"]), f"{ratio:.2f}",
                           f"{TARGETS[name]:g}", verdict(ratio, TARGETS[name])))
    return [table]


def measured(case: Case, budget: float) -> dict[str, float]:
    """Median times of primal and adjoint; every run has fresh copies of what it overwrites."""
    arguments = case.arguments("large")
    return interleaved({"primal": primal_run(case, arguments), "adjoint": adjoint_run(case, arguments)}, budget)


def primal_run(case: Case, arguments: tuple) -> Prepare:
    primal = plain_numba(case.function)
    return lambda: partial(primal, *fresh(arguments))


def adjoint_run(case: Case, arguments: tuple) -> Prepare:
    adjoint = differentiated(case).compiled("adjoint", *adjoint_arguments(case, arguments))
    return lambda: partial(adjoint, *adjoint_arguments(case, arguments))
