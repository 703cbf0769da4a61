"""Derivatives are the same bit for bit without the passes that may not change rounding, and within what rounding does
without the others: those say so (`CHANGES_ROUNDING`)."""
from __future__ import annotations

import numpy as np
import pytest

from benchmarks.kernels.cases import ARRAYS, CASES
from tests.harness.documents import ROOT
from tests.harness.passes import (
    PASSES, ROUNDING, SAME, Task, changes_rounding, derivatives, differing, of_function, of_program,
    relative_difference, tasks,
)
from tests.programs import random_kernel
from tests.harness.seeds import seeded

KERNELS = [("seidel", "loops"), ("advect", "loops"), ("mixture", "loops"), ("brusselator", "loops"),
           ("masked_flow", "numpy"), ("glacier", "numpy"), ("lattice", "loops")]
BOUND = 1e-12


def task_of(name: str) -> Task:
    case = {**CASES, **{c.name: c for c in ARRAYS}}[name]
    return of_function(case.function, lambda: case.arguments("small"), case.wrt, case.of)


def compared(task: Task, engine: str) -> None:
    whole, _ = derivatives(task, engine, ())
    same, one = derivatives(task, engine, ROUNDING)
    bare, other = derivatives(task, engine, ROUNDING | SAME)
    assert one != other
    for name in same:
        np.testing.assert_array_equal(same[name], bare[name])
    assert relative_difference(whole, same) <= BOUND


@pytest.mark.parametrize(("name", "engine"), KERNELS)
def test_kernels(name, engine):
    compared(task_of(name), engine)


@pytest.mark.parametrize("engine", ["numpy", "loops"])
@pytest.mark.parametrize("number", range(8))
def test_generated_programs(number, engine):
    task = of_program(random_kernel(seeded(500 + number)))
    if task.of:
        compared(task, engine)


@pytest.mark.parametrize(("name", "task"), [pytest.param(*case, id=case[0]) for case in tasks("goldens", range(0))])
def test_goldens(name, task):
    assert not list(differing(task, "loops", ()))


def test_a_pass_that_changes_a_digit_is_found(monkeypatch):
    """The comparison sees one unit in the last place."""
    task = of_program(random_kernel(500))
    one, _ = derivatives(task, "numpy", ())
    other = {n: np.nextafter(v, np.inf) for n, v in one.items()}
    assert 0.0 < relative_difference(one, other) < 1e-15


def test_the_document_says_which_passes_may_change_rounding():
    text = (ROOT / "docs" / "writing-a-pass.md").read_text()
    names = [n for n in PASSES if changes_rounding(n)]
    assert f"| may change rounding | {', '.join(f'`{n}`' for n in names)} |" in text
