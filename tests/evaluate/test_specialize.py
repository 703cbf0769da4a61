"""The evaluator: kernels with objects, lists, dicts and functions as values have right values and derivatives."""
from __future__ import annotations

import pytest

from tests.harness.derivatives import check_derivatives
from tests.evaluate.objects import control, gathered, generators, identity, loop_exits, plain_python, solvers

CASES = [(f"{module.__name__.rpartition('.')[2]}.{case.kernel.__name__}", case)
         for module in (identity, control, gathered, generators, loop_exits, plain_python, solvers)
         for case in module.cases()]


@pytest.mark.parametrize("engine", ["numpy", "loops"])
@pytest.mark.parametrize("case", [pytest.param(case, id=name) for name, case in CASES])
def test_derivatives(case, engine):
    check_derivatives(case.kernel, case.arguments, (case.wrt,), case.of, engine, **case.options)
