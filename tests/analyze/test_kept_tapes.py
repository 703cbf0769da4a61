"""Which calls keep their tapes from one sweep to the other, as the text of the adjoint says."""
from __future__ import annotations

import re

import numpy as np
import pytest

import s2sad
from tests.corpus.calls import kept_tapes


def _called(kernel, engine: str) -> list[str]:
    """The functions that the adjoint of a kernel calls, in the order of its text."""
    given = np.linspace(0.1, 0.6, 6), np.linspace(0.2, 0.9, 6), 3
    text = s2sad.differentiate(kernel, wrt=("x", "w"), engine=engine).adjoint_source(*given)
    own = re.sub("#.*", "", text.partition(f"def {kernel.__name__}_adjoint(")[2])
    return re.findall(r"\b((?:advance|norm_of|inner_part|nested_step)\w*)\(", own)


@pytest.mark.parametrize("engine", ["numpy", "numba"])
@pytest.mark.parametrize(("kernel", "calls"), [
    (kept_tapes.nested, ["inner_part_augmented", "inner_part_reverse"]),
    (kept_tapes.result_used_twice, ["norm_of_augmented", "norm_of_reverse"]),
    (kept_tapes.overwritten_in_a_loop, ["advance_augmented", "advance_reverse"]),
    (kept_tapes.twice, [*["advance"] * 2, *["advance_adjoint"] * 2]),
    (kept_tapes.many, [*["advance"] * 5, *["advance_adjoint"] * 5]),
    (kept_tapes.in_steps, ["nested_step", "nested_step_adjoint"]),
], ids=lambda given: getattr(given, "__name__", ""))
def test_a_call_runs_once_and_several_again_where_tapes_would_add_up(kernel, calls, engine):
    assert _called(kernel, engine) == calls


def test_the_tapes_of_many_calls_do_not_add_up():
    """What is foreseen is no more than one tape and the state in front of each call."""
    x, w = np.linspace(0.1, 0.6, 600), np.linspace(0.2, 0.9, 600)
    one, five = (s2sad.gradient(s2sad.differentiate(k, engine="numpy"), wrt=("x", "w")).memory(x, w, 50).tape
                 for k in (kept_tapes.read_in_front, kept_tapes.many))
    assert five < 1.2 * one
