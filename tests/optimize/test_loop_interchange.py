"""Loops that are distributed so that an inner one can change places, and loops that have to stay one."""
from __future__ import annotations

import re

import numpy as np
import pytest

from s2sad.report.measured_call import MeasuredCall
from tests.corpus import Case
from tests.corpus.loops import loop_interchange
from tests.corpus.loops.loop_interchange import DISTRIBUTED, MOVED, STAYING, TOGETHER, until_a_number_of_rows
from tests.harness.engines import running

CASES = {case.kernel: case for case in reversed([*loop_interchange.cases()])}     # the first of each
ROW = "_row"        # what one of the loops hands to the next ones


def adjoint(case: Case) -> str:
    with running("loops"):
        made = MeasuredCall.for_call(case.kernel, case.arguments, case.wrt, case.of, "numba")
        return made.reverse().rv.generated.text


@pytest.mark.parametrize("kernel", DISTRIBUTED)
def test_what_iterations_do_not_share(kernel):
    assert ROW in adjoint(CASES[kernel])


@pytest.mark.parametrize("kernel", TOGETHER)
def test_what_iterations_share(kernel):
    assert ROW not in adjoint(CASES[kernel])


def order(kernel) -> set[str]:
    """Which counter of two loops around the innermost one comes first, in all nests of the adjoint."""
    return {"".join(pair) for pair in re.findall(r"for ([ki]) in .*:\n *for ([ki]) in .*:\n *for j in ",
                                                 adjoint(CASES[kernel]))}


@pytest.mark.parametrize("kernel", MOVED)
def test_a_loop_that_goes_into_the_next_one(kernel):
    assert order(kernel) == {"ik"}


@pytest.mark.parametrize("kernel", [*STAYING, until_a_number_of_rows])
def test_a_loop_that_stays_around_the_next_one(kernel):
    assert "ki" in order(kernel)


def columns(a, c, n):
    for j in range(n):
        r = np.dot(c, a[:, j])
        a[:, j] = a[:, j] * r


def test_a_loop_of_few_iterations_stays():
    """Three iterations of an inner loop are no gain."""
    def three(a, c):
        for j in range(3):
            r = np.dot(c, a[:, j])
            a[:, j] = a[:, j] * r
    some = np.linspace(0.5, 1.5, 27).reshape(9, 3), np.linspace(0.2, 0.9, 9)
    assert ROW not in adjoint(Case(three, some, ("a", "c"), ("a",)))
    assert ROW in adjoint(Case(columns, (*some, 3), ("a", "c"), ("a",)))
