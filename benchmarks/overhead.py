"""What a call costs beyond the compiled function: `f.adjoint(...)` with its checks, `vjp` with its copies and dicts."""
from __future__ import annotations

import numpy as np

import s2sad
from benchmarks.calls import adjoint_arguments, differentiated
from benchmarks.kernels.cases import CASES
from benchmarks.tables import Table, verdict
from s2sad.report.timing import interleaved, repeated

TARGETS = {"f.adjoint": 8.0, "vjp": 15.0}
TIMES = 200


def tables(quick: bool, kernels: list[str]) -> list[Table]:
    """The Brusselator with one cell and its 7 (adjoint) or 4 (vjp) arguments."""
    case = CASES["brusselator"]
    arguments = (np.zeros((1, 1, 2)), np.ones((1, 1, 2)), np.array([3.4, 1.0, 10.0, 1.0]), 1.2)
    f, shadowed = differentiated(case), adjoint_arguments(case, arguments)
    seeds = {"du": np.ones((1, 1, 2))}
    bare = f.compiled("adjoint", *shadowed)
    calls = {"bare": lambda: bare(*shadowed), "f.adjoint": lambda: f.adjoint(*shadowed),
             "vjp": lambda: s2sad.vjp(f, arguments, seeds, wrt=case.wrt)}
    taken = interleaved({name: lambda call=call: repeated(call, TIMES) for name, call in calls.items()},
                        0.5 if quick else 4.0)
    table = Table("A call of the Brusselator's adjoint, one cell", ("call", "time", "over bare", "target", ""))
    micro = {name: value / TIMES * 1e6 for name, value in taken.items()}
    table.rows.append(("bare", f"{micro['bare']:.2f} us", "", "", ""))
    for name, target in TARGETS.items():
        over = micro[name] - micro["bare"]
        table.rows.append((name, f"{micro[name]:.2f} us", f"{over:.2f} us", f"{target:g} us", verdict(over, target)))
    return [table]
