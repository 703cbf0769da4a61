"""Functions that return lists: their items come back as those of a tuple do."""
from __future__ import annotations

import numpy as np
import pytest

import s2sad
from tests.derivatives import check_derivatives
from tests.engines import each

X = np.array([2.0, 3.0, 4.0])


def by_name(x):
    us = [x[0] * 2, x[1]]
    for k in range(3):
        us[0] = us[0] * x[k]
    if x[0] > 1.0:
        us = [us[1], us[0] * x[2]]
    return us


def in_a_tuple(x):
    us = [x[0] * x[1], x[1]]
    t = (x[0] * x[1], x * x)
    return us, t, x[2]


def spelled_out(x):
    if x[0] > 1.0:
        return [x[0] * x[1], [x[2], x[1] * x[0]]], x[2]
    return [x[0], [x[1], x[2]]], x[1]


def items_again(x):
    us = [[x[0], x[1]], x[2] * x[0]]
    us[0][1] = x[2] * x[1]
    return us


def made(x):
    return [x[0] * x[1], x[1]]


def made_by_name(x):
    us = [x[0] * x[1], x[1]]
    us[1] = us[0] * x[2]
    return us


def made_with_more(x):
    us = [x[0] * x[1], x[1]]
    return us, x[2]


def product(t):
    return t[0] * t[1]


def helpers(x):
    us = made(x)
    vs = made_by_name(x)
    s = us[0] * vs[1] * product(vs)
    ws, c = made_with_more(x)
    a, b = made_by_name(x)
    for w in made(x):
        s += w * w
    for k in range(2):
        us = [us[1], us[0] * x[k]]
    return s * product(made_by_name(x)) * made(x)[0] + a * b * c * ws[0] * product(ws) + us[0] * us[1]


@pytest.mark.parametrize("kernel, engine", each([by_name, in_a_tuple, spelled_out, items_again, helpers]))
def test_derivatives(kernel, engine):
    check_derivatives(kernel, (X,), ("x",), ("return",), engine=engine)


def in_a_dict(x):
    us = [x[0] * x[1], x[1]]
    return {"u": us, "c": x[2] * x[0]}


def test_seeds_and_tangents():
    def of(f, seed):
        f = s2sad.differentiate(f, engine="numpy")
        return s2sad.jvp(f, (X,), {"x": np.ones(3)})["return"], s2sad.vjp(f, (X,), {"return": seed})["x"].tolist()
    assert of(made, [1.0, 2.0]) == of(made, (1.0, 2.0)) == ((5.0, 1.0), [3.0, 4.0, 0.0])
    assert of(made_with_more, ([1.0, 2.0], 1.0)) == (((5.0, 1.0), 1.0), [3.0, 4.0, 1.0])
    assert of(in_a_dict, {"u": [1.0, 2.0], "c": 1.0}) == ({"u": [5.0, 1.0], "c": 6.0}, [7.0, 4.0, 2.0])
    with pytest.raises(s2sad.S2sadError, match="the seed of 'return' is a list of 3, the result is a tuple of 2"):
        of(made, [1.0, 2.0, 3.0])


def written(x):
    us = made(x)
    us[0] = x[2]
    return us[0] * us[1]


def grown(x):
    us = []
    for k in range(3):
        us.append(x[k] * x[0])
    return us


def array_of(x):
    return np.array(made(x))[0]


@pytest.mark.parametrize("kernel, said", [
    (written, "error[S201]: 'us' holds several results"), (grown, "error[S201]: the list 'us' is used as a list"),
    (array_of, "error[S201]: several results where one value is needed")])
def test_refused(kernel, said):
    with pytest.raises(s2sad.S2sadError) as refused:
        s2sad.gradient(s2sad.differentiate(kernel, engine="numpy"))(X)
    assert said in str(refused.value)
