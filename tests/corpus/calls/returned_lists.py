"""Functions that return lists: their items come back as those of a tuple do."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case

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


def cases():
    # derivatives
    for kernel in (by_name, in_a_tuple, spelled_out, items_again, helpers):
        yield Case(kernel, (X,), ("x",))
    for kernel in (written, array_of):
        yield Case(kernel, (X,), "x")
    # refused
    yield Case(grown, (X,), refused="S201 at `us`: the list 'us' is used as a list: make it an array with np.array")
