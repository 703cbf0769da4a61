"""inlining: functions of numbers with transcendental values are written where loops call them."""
from __future__ import annotations

import inspect
import re

import numpy as np
import pytest

from s2sad import differentiate
from tests.corpus.loops.inlining import (
    X, Y, in_front_of_loops, layers, of_itself, of_what_is_stored, swapped, until_small, where_it_is_asked,
)
from tests.harness.engines import running


def cube(x):
    return x * x * x


def cubes(x):
    for i in range(x.size):
        x[i] = cube(x[i])


@pytest.mark.parametrize("kernel, arguments, called", [
    (swapped, (X, Y), set()), (of_itself, (X,), set()), (of_what_is_stored, (X, Y), set()), (until_small, (X,), set()),
    (in_front_of_loops, (X,), {"sigmoid", "sigmoid_adjoint"}), (layers, (X, Y, np.ones((3, 5))), {"sigmoid", "step"}),
    (where_it_is_asked, (X, Y), {"chosen", "chosen_adjoint"}), (cubes, (X,), {
        "cube_adjoint"})])
def test_what_is_called_still(kernel, arguments, called):
    """What is called nowhere any more is not in the file."""
    with running("loops"):
        made = differentiate(kernel, engine="numba")
        given = [y for x in arguments for y in (x.copy(), np.zeros_like(x))]
        found = made.compiled("adjoint", *given, *[1.0] * ("return" in inspect.getsource(kernel)))
    module = inspect.getmodule(getattr(found, "function", found))
    assert module is not None
    defined = set(re.findall(r"^def (\w+)", inspect.getsource(module), re.M))
    own = {f"{kernel.__name__}_adjoint", f"{kernel.__name__}_adjoint_taped", "step_adjoint"}
    assert defined - own == called
