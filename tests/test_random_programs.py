"""Generated kernels: that they are what they promise, and that their derivatives are right."""
from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings

from tests.harness.bulk import outcome
from tests.harness.derivatives import UnreliableDifferences, check_derivatives
from tests.programs import SHAPES, kernels, lists_of_the_run, names_of_arrays, random_kernel
from tests.harness.seeds import seeded


def numbered(first: int, count: int, engine: str) -> None:
    """Programs by number: all of them are different. A failure names its number for `python -m tests.harness.bulk`."""
    found = [outcome(random_kernel(seed), engine, seed) for seed in range(seeded(first), seeded(first) + count)]
    failures = [f for f in found if f.failed]
    assert not failures, "\n".join(f"seed {f.seed}: {f.kind}\n{f.source}\n{f.text}" for f in failures)
    assert sum(f.kind == "ok" for f in found) >= 0.9 * count


@pytest.mark.parametrize("first", range(0, 240, 30))
def test_numbered_programs_under_numpy(first):
    numbered(first, 30, "numpy")


@pytest.mark.parametrize("first", range(0, 8, 4))
def test_numbered_programs_under_numba(first):
    pytest.importorskip("numba")
    numbered(first, 4, "numba")


@pytest.mark.parametrize(("generator", "least"), [(names_of_arrays, 0.5), (lists_of_the_run, 0.85)])
@pytest.mark.parametrize("engine", ["numpy", "loops"])
def test_names_and_lists(generator, least, engine):
    """Of these much is refused; `python -m tests.harness.bulk --programs names` (or `lists`) runs more of them."""
    found = [outcome(generator.random_program(seed), engine, seed) for seed in range(seeded(0), seeded(0) + 20)]
    failures = [f for f in found if f.kind in ("wrong", "crash") or "S9" in f.where]
    assert not failures, "\n".join(f"seed {f.seed}: {f.kind}\n{f.source}\n{f.text}" for f in failures)
    assert sum(f.kind == "ok" for f in found) >= least * len(found)


@settings(max_examples=25)
@given(kernels())
def test_drawn_programs(program):
    """The same generator under Hypothesis, which makes a failure smaller by itself."""
    try:
        check_derivatives(program.load(), program.arguments(), program.wrt, program.of, "numpy", coordinates=8)
    except UnreliableDifferences:
        assume(False)


@pytest.mark.parametrize("first", range(0, 300, 50))
def test_programs_keep_their_promises(first):
    """They run, end, stay bounded, and their arguments are the same each time."""
    for seed in range(seeded(first), seeded(first) + 50):
        program = random_kernel(seed)
        assert program == random_kernel(seed)
        arguments = program.arguments()
        result = program.load()(*arguments)
        assert result is None or np.all(np.isfinite(result))
        for (name, kind), value in zip(program.parameters, arguments):
            if kind in SHAPES and name != "acc":
                assert np.all(np.abs(value) <= 2.3), (seed, name)


def test_programs_differ():
    assert len({random_kernel(seed).source for seed in range(seeded(0), seeded(330))}) == 330


def test_outcome_of_a_program_that_fails():
    program = random_kernel(0).with_source("def kernel(*given):\n    return 1 / 0\n")
    assert outcome(program, "numpy").kind == "invalid"
