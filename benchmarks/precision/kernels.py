"""Errors of the gradients of the benchmarks' kernels, by norm."""
from __future__ import annotations

import inspect

import s2sad
from benchmarks.calls import seed_like
from benchmarks.kernels.cases import ARRAYS, LOOPS, Case
from benchmarks.precision import reference
from benchmarks.tables import Table

UNIT = 2.0 ** -53


def table() -> Table:
    """Each kernel at its small size."""
    made = Table("Gradients of kernels: errors by norm, in units of 2**-53",
                 ("kernel", "error", "reference: adjoint and tangent part by", "tangent and differences part by"))
    for case in (*LOOPS, *ARRAYS):
        honest, other = reference.mismatch(case.function, case.arguments("small"), case.wrt, case.of)
        made.rows.append((f"`{case.name}`", f"{error(case) / UNIT:.2g}", f"{honest:.0e}", f"{other:.0e}"))
    made.notes = ["At small sizes, of the largest element of each gradient. Differences are of the kernel's own text "
                  "with 113 bits, extrapolated five times.",
                  "`lattice` loses its digits to cancellation: by omega it sums the differences to the equilibrium. "
                  "That gradient's condition in the weights 4/9, 1/9 and 1/36, which are no doubles, is 2.5e3; against "
                  "a reference that has the doubles in their place it errs by 3.7e2. The adjoint by hand "
                  "(`benchmarks/peers/by_hand_arrays.py`) errs by 1.8e3."]
    return made


def error(case: Case) -> float:
    """The largest error of any of the case's gradients."""
    arguments = case.arguments("small")
    given = dict(zip(inspect.signature(case.function).parameters, arguments))
    seeds = {o: 1.0 if o == "return" else seed_like(given[o]) for o in case.of}
    exact = reference.gradient(case.function, arguments, case.wrt, case.of, seeds)
    function = s2sad.differentiate(case.function, wrt=case.wrt, of=case.of, engine="numpy")
    found = s2sad.vjp(function, arguments, seeds, wrt=case.wrt)
    return max(reference.relative_error(found[n], exact[n]) for n in case.wrt)
