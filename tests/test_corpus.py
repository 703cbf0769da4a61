"""Every case of tests/corpus: right derivatives under NumPy and as the text for Numba, or the exact refusal."""
from __future__ import annotations

import pytest

import s2sad
from tests import corpus
from tests.harness.derivatives import check_derivatives
from tests.harness.engines import engines, located, running

CASES = dict(corpus.cases())
pytestmark = pytest.mark.filterwarnings("error:Casting complex values")


@pytest.mark.parametrize(("case", "engine"), [
    p for name, case in CASES.items() if not case.refused for p in engines(name, case)])
def test_derivatives(case, engine):
    check_derivatives(case.kernel, case.arguments, case.wrt, case.of, engine, **case.options)


@pytest.mark.parametrize("engine", ["numpy", "loops"])
@pytest.mark.parametrize("case", [pytest.param(case, id=name) for name, case in CASES.items() if case.refused])
def test_refusals(case, engine):
    with running(engine) as run_under, pytest.raises(s2sad.S2sadError) as caught:
        if case.of is None:
            s2sad.differentiate(case.kernel, wrt=case.wrt, engine=run_under).adjoint_source(*case.arguments)
        else:
            s2sad.gradient(s2sad.differentiate(case.kernel, engine=run_under), wrt=case.wrt)(*case.arguments)
    assert located(caught.value) == case.refused
