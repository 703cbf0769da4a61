"""Every kernel of `benchmarks.kernels`, under both engines, against extrapolated differences."""
from __future__ import annotations

import pytest

from tests.harness.derivatives import check_derivatives
from benchmarks.kernels.cases import LOOPS


@pytest.mark.parametrize("engine", ["numpy", "numba"])
@pytest.mark.parametrize("case", LOOPS, ids=lambda case: case.name)
def test_derivatives(case, engine):
    if engine == "numba":
        pytest.importorskip("numba")
    measured = check_derivatives(case.function, case.arguments("small"), case.wrt, case.of, engine)
    assert measured.dot_product <= 1e-12
    assert max(measured.directional, measured.coordinates) <= 1e-7
