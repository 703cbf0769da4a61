"""What is refused of structures, and where."""
from __future__ import annotations

import numpy as np
import pytest

from s2sad import S2sadError, differentiate, vjp
from tests.evaluate.structures.arguments import U, Orbit, State, params, state_of
from tests.harness.refusals import refused


def field_that_is_not_there(s):
    return s.uu[0]


def key_that_is_not_there(s):
    return s["kk"]


def item_that_is_not_there(s):
    return s[2]


def assigned_to_a_named_tuple(s):
    s.k = 2.0


def attribute_of_an_array(s):
    s.a = 1.0


def none_used(s, w):
    return s["k"] * w


def used_as_a_whole(s):
    return np.exp(s)


def array_as_a_list(s):
    return np.sum(s) / s.size


def logged(s):
    return s.log[0]


def unknown_method(s):
    return s.norm()


def membership(s):
    return 1.0 if "x" in s.u else 0.0


def data_of_an_array(s):
    return np.sum(s) if s.strides == (8,) else s[0]


def whose_array(s):
    return np.sum(s) if s.base is None else s[0]


REFUSED = [
    (data_of_an_array, (U,), "s.strides", "S201", "the attribute .strides is not supported in a kernel",
     "read it outside, and give it to the kernel as an argument"),
    (whose_array, (U,), "s.base", "S201", "the attribute .base is not supported in a kernel",
     "read it outside, and give it to the kernel as an argument"),
    (field_that_is_not_there, (state_of(),), "s.uu", "S202",
     "'s', an object of class State, has no attribute 'uu' here", "it has u, v, t, n, log"),
    (key_that_is_not_there, ({"k": 1.0},), 's["kk"]', "S202", "'s' has no key 'kk'", "its keys are k"),
    (item_that_is_not_there, ((1.0, 2.0),), "s[2]", "S203", "'s' has 2 items, and no item 2", ""),
    (assigned_to_a_named_tuple, (params(),), "s.k", "S201", "'s' is a tuple, to which nothing can be assigned",
     "return the new value, or make it a list"),
    (attribute_of_an_array, (U,), "s.a", "S201", "an assignment to the attribute .a is not supported in a kernel",
     "return the value, or write it to an element of an array argument"),
    (used_as_a_whole, ({"k": 1.0},), "np.exp(s)", "S201",
     "'s', a dict, is used as a whole by what is computed at run time", "give the arrays and numbers that it holds"),
    (used_as_a_whole, (state_of(),), "np.exp(s)", "S201",
     "'s', an object of class State, is used as a whole by what is computed at run time",
     "give the arrays and numbers that it holds"),
    (array_as_a_list, ([1.0, 2.0],), "s.size", "S203", "'s', a list, has no attribute 'size' here",
     "pass numpy.array(s, dtype=float)"),
    (logged, (State(U, U, 0.0, log=print),), "s.log", "S201", "an item of a function of a library", ""),
    (logged, (state_of(),), "s.log", "S203", "'s.log' is None here", "test it before: if s.log is not None: ..."),
    (unknown_method, (Orbit(1.0, 2.0),), "s.norm()", "S201",
     ".norm of 's', which is a named tuple of class Orbit, is not supported in a kernel",
     "write what it does with the items"),
    (membership, (state_of(),), '"x" in s.u', "S201", "whether an array has an element that is no number is asked",
     "compare numbers"),
]


@pytest.mark.parametrize(("kernel", "arguments", "marked", "code", "message", "help"), REFUSED,
                         ids=[f"{r[0].__name__}{n}" for n, r in enumerate(REFUSED)])
def test_refused(kernel, arguments, marked, code, message, help):
    with pytest.raises(S2sadError) as caught:
        vjp(differentiate(kernel, engine="numpy"), arguments, {"return": 1.0})
    found = caught.value.diagnostics[0]
    assert (found.code, found.message, found.help) == (code, message, help)
    assert found.span is not None
    assert found.span.source.line(found.span.line)[found.span.column:].startswith(marked)


def test_a_refusal_in_full():
    line = none_used.__code__.co_firstlineno + 1
    refused(f"{__file__}:{line}:21: error[S203]: 'w' is None here\n  {line} |     return s[\"k\"] * w\n"
            f"  {' ' * len(str(line))} |                     ^\n  help: test it before: if w is not None: ...",
            vjp, differentiate(none_used, engine="numpy"), ({"k": 1.0}, None), {"return": 1.0})


def last_above(x):
    place = None
    for k in range(x.size):
        if x[k] > 0.5:
            place = k
    return 2.0 * x[place]


def test_a_place_that_is_not_found():
    f = differentiate(last_above, engine="numpy")
    assert vjp(f, (np.array([0.7, 0.9, 0.1]),), {"return": 1.0})["x"].tolist() == [0.0, 2.0, 0.0]
    with pytest.raises(TypeError, match="^'place' is None here$"):
        vjp(f, (np.zeros(3),), {"return": 1.0})
