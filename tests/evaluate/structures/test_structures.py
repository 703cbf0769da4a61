"""Structures: dataclasses, named tuples, dicts, tuples and lists as arguments, inside kernels and as results."""
from __future__ import annotations

import pytest

from s2sad import check
from tests.evaluate.structures import field_kernels, helper_kernels
from tests.evaluate.structures.kernels import CASES


@pytest.mark.parametrize(("kernel", "arguments"), CASES, ids=[f"{k.__name__}{n}" for n, (k, _) in enumerate(CASES)])
def test_derivatives(kernel, arguments):
    found = check(kernel, *arguments(), engine="numpy")
    assert found, str(found)


@pytest.mark.parametrize("case", [0, 4, 8, 10, 13, 15, 17, 18], ids=lambda n: CASES[n][0].__name__)
def test_derivatives_compiled(case):
    kernel, arguments = CASES[case]
    found = check(kernel, *arguments(), engine="numba")
    assert found, str(found)


MISLEADING = [*field_kernels.CASES, *helper_kernels.CASES]


@pytest.mark.parametrize(("kernel", "arguments"), MISLEADING, ids=[
    f"{k.__name__}{n}" for n, (k, _) in enumerate(MISLEADING)])
def test_kernels_that_mislead(kernel, arguments):
    found = check(kernel, *arguments(), engine="numpy")
    assert found, str(found)
