"""Fifty published kernels as their authors write them: every one is read, and its derivatives are right."""
from __future__ import annotations

import numpy as np
import pytest

import s2sad
from benchmarks.published.cases import CASES


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("case", CASES.values(), ids=lambda c: c.name)
def test_derivatives(case):
    arguments = case.arguments("small")
    assert np.all([np.array_equal(a, b) for a, b in zip(arguments, case.arguments("small"))])
    report = s2sad.check(case.function, *arguments, wrt=case.wrt, of=case.of, engine="numpy")
    assert report and not report.unsure, str(report)
