"""A list under a name that stands in a tuple or a list: where a write would tell that it is a copy, it is refused."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case

X = np.array([2.0, 3.0, 4.0])


def by_name(x):
    us = [x[0], x[1]]
    t = (us, 2.0)
    us[0] = x[2]
    return t[0][0] * x[1]


def through_another(x):
    us = [x[0], x[1]]
    t = [us, us]
    t[0][0] = x[2]
    return t[1][0] * us[0] * x[1]


def one_level_down(x):
    us = [x[0], x[1]]
    t = (2.0, (us, 1.0))
    us[0] *= x[2]
    return t[1][0][0] * x[1]


def in_a_loop(x):
    us = [x[0], x[1]]
    s = 0.0
    for k in range(3):
        t = (us, 2.0)
        us[0] = us[0] * x[k]
        s += t[0][0] * x[1]
    return s


def bound_on_one_way(x):
    us = [x[0], x[1]]
    t = (us, 2.0)
    if x[0] > 100.0:
        us = [x[1], x[2]]
    us[0] = x[2]
    return t[0][0] * x[1]


def unpacked(x):
    us = [x[0], x[1]]
    t = (us, x)
    us[0], c = x[2], x[1]
    return t[0][0] * c


def appended(x):
    us = [x[0], x[1]]
    z = []
    for k in range(2):
        z.append((us, 2.0))
        us[0] = us[0] * x[k]
    return z[0][0][0] * x[1]


def comprehended(x):
    us = [x[0], x[1]]
    z = [(us, k) for k in range(2)]
    us[0] = x[2]
    return z[0][0][0] * x[1]


def as_good_as_a_copy(x):
    us = [x[0], x[1]]
    us[0] = x[2] * us[1]
    t = (us, x * 1.0)
    s = t[0][0] * x[1]
    t[1][0] = x[2]
    for k in range(3):
        us = [x[0], x[k]]
        us[1] = us[0] * x[k]
        q = (us, 2.0)
        s += us[1] * t[0][0] + q[0][1]
    vs = [x[0], x[1]]
    r = ([vs[0], vs[1]], 3.0)
    y = np.array([vs, vs])
    vs[0] = x[2]
    return s * r[0][0] + vs[0] * r[1] + t[1][0] + y[0, 0] * y[1, 1]


def cases():
    for kernel in (by_name, through_another, one_level_down, in_a_loop, unpacked, appended, comprehended):
        yield Case(kernel, (X,), "x")
    # the message
    yield Case(by_name, (X,), "x")
    for kernel in [as_good_as_a_copy, bound_on_one_way]:
        yield Case(kernel, (X,), ("x",))
