"""A loop over a structure that is given, and that the loop writes, reads each item when its round comes."""
from __future__ import annotations

import copy

import numpy as np
import pytest

import s2sad
from tests.harness.engines import each, running
from tests.evaluate.loops_over_given_lists import GIVEN, Held


def leaves(value):
    """The floats in a value, in order."""
    if isinstance(value, np.ndarray):
        return list(value.ravel())
    if isinstance(value, (float, int)):
        return [value] if isinstance(value, float) else []
    parts = vars(value).values() if isinstance(value, Held) else value.values() if isinstance(value, dict) else value
    return [f for p in parts for f in leaves(p)]


def moved(value, steps):
    """A copy of a value whose floats have moved by the next of these steps."""
    if isinstance(value, np.ndarray):
        return value + np.reshape([next(steps) for _ in range(value.size)], value.shape)
    if isinstance(value, Held):
        return Held(**moved(vars(value), steps))
    if isinstance(value, dict):
        return {k: moved(v, steps) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return type(value)(moved(v, steps) for v in value)
    return value + next(steps) if isinstance(value, float) else value


@pytest.mark.parametrize(("kernel", "given", "engine"), each(GIVEN))
def test_a_structure_that_is_given_is_read_in_each_round(kernel, given, engine):
    parameters = kernel.__code__.co_varnames[:len(given)]
    with running(engine) as name:
        function = s2sad.differentiate(kernel, engine=name)
        for k, (parameter, argument) in enumerate(zip(parameters, given)):
            count = len(leaves(argument))
            if not count:
                continue
            value, found = s2sad.value_and_gradient(function, wrt=parameter)(*copy.deepcopy(given))

            def at(steps, k=k):
                return kernel(*[moved(a, iter(steps)) if j == k else copy.deepcopy(a) for j, a in enumerate(given)])
            shifts = 1e-5 * np.eye(count)
            assert value == pytest.approx(kernel(*copy.deepcopy(given)))
            assert leaves(found) == pytest.approx([(at(h) - at(-h)) / 2e-5 for h in shifts], rel=1e-6, abs=1e-6)
