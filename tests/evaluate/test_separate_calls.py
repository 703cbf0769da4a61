"""Functions that stay functions when they are called: values, derivatives, and which they are."""
from __future__ import annotations

import pytest

from s2sad import tree
from s2sad.diagnostics import Diagnostic, S2sadError
from s2sad.dispatch import compiler
from s2sad.evaluate.specialize import specialize
from s2sad.infer.types import array
from s2sad.live_objects.unwrap import python_function
from s2sad.program import DemandedFacts
from tests.evaluate.objects import separate_calls
from tests.harness.derivatives import check_derivatives

CASES = [pytest.param(case, id=case.kernel.__name__) for case in separate_calls.cases()]


@pytest.fixture
def evaluated(monkeypatch):
    """Every function is evaluated, also where reading knows it."""
    monkeypatch.setattr(compiler, "program", lambda function, methods=(), varying=(): compiler.waiting(
        python_function(function), S2sadError(Diagnostic("S201", "evaluated")), varying))


@pytest.mark.parametrize("engine", ["numpy", "loops"])
@pytest.mark.parametrize("case", CASES)
def test_derivatives(evaluated, case, engine):
    check_derivatives(case.kernel, case.arguments, (case.wrt,), case.of, engine, **case.options)


def residual(kernel, **options):
    """The residual function of a kernel of one vector, and the titles of the functions that stay."""
    facts = {}
    while True:
        try:
            made = specialize(kernel, {"x": array("float64", 1)}, facts, **options).captured()
        except DemandedFacts as demanded:
            facts |= dict.fromkeys(demanded.facts, (4,))
            continue
        found = []

        def visit(block, made=made, found=found):
            for n in tree.walk(block):
                name = n.func.id if isinstance(n, tree.Call) and isinstance(n.func, tree.Name) else ""
                if name.startswith("separate.") and name not in found:
                    found.append(name)
                    visit(made.scope.names[name].handle.tree.body)
        visit(made.tree.body)
        return made, [made.scope.names[n].handle.tree for n in found]


@pytest.mark.parametrize("kernel", separate_calls.STAYS, ids=lambda k: k.__name__)
def test_what_stays(kernel):
    found = [f.name for f in residual(kernel)[1] if f.name != "made"]
    assert found == separate_calls.STAYS[kernel]


@pytest.mark.parametrize("kernel", separate_calls.STAYS, ids=lambda k: k.__name__)
def test_everything_is_written_out_where_that_is_asked_for(kernel):
    assert not residual(kernel, inlines=True)[1]


@pytest.mark.parametrize("kernel", separate_calls.REFUSED, ids=lambda k: k.__name__)
def test_what_is_refused_where_it_is_written_out(kernel):
    with pytest.raises(S2sadError, match=separate_calls.REFUSED[kernel]):
        residual(kernel)
