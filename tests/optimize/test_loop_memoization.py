"""kept: what an exponential gave an iteration is kept in it, and only where it is the same later on."""
from __future__ import annotations

import inspect

import numpy as np
import pytest

from s2sad import differentiate
from tests.corpus.loops.loop_memoization import (
    X, argument_moves, at_the_top, at_the_top_of_what_moves, at_the_top_overwritten, hyperbolic, in_place_of_its_array,
    of_a_moving_name, one_more, only_inside, overwritten,
)
from tests.harness.engines import running


def _fast(kernel) -> str:
    """The text of an adjoint that runs."""
    with running("loops"):
        made = differentiate(kernel, engine="numba")
        arguments = [X.copy(), np.zeros_like(X), np.full(4, 0.5), np.zeros(4)]
        if "return" in inspect.getsource(kernel):
            arguments.append(1.0)
        found = made.compiled("adjoint", *arguments)
    return inspect.getsource(inspect.getmodule(getattr(found, "function", found)))


@pytest.mark.parametrize("kernel, allocated, read", [
    (overwritten, 1, 1), (hyperbolic, 1, 1), (in_place_of_its_array, 0, 0), (argument_moves, 0, 0), (one_more, 0, 0),
    (only_inside, 0, 0), (of_a_moving_name, 0, 0)])
def test_what_is_kept(kernel, allocated, read):
    text = _fast(kernel)
    assert text.count("_kept, top = allocate(") == allocated
    assert text.count("_kept[") == allocated + read


@pytest.mark.parametrize("kernel, computed", [
    (at_the_top, 1), (at_the_top_overwritten, 2), (at_the_top_of_what_moves, 5)])
def test_the_functions_own_block_has_no_buffers(kernel, computed):
    text = _fast(kernel)
    assert text.count(" exp(") == computed
    assert "_kept" not in text


def test_an_array_that_holds_it_still():
    assert _fast(in_place_of_its_array).count(" exp(") == 1
