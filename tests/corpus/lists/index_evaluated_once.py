"""A place in a list that a call finds is found once, where Python finds it, also where it may count from the end."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case


def doubled(v):
    v[0] *= 2.0
    return 1


def moved_on(p):
    p[0] += 1
    return p[0]


def read(x, p, n):
    us = [x[k] for k in range(3)]
    s = us[doubled(x)] * x[0]
    vs = []
    for k in range(3):
        vs.append(x[k] * k)
    s += us[moved_on(p)] * us[p[0]] + x[0] * vs[moved_on(p) - 4] * us[-1 if p[0] > 1 else 0]
    return s * p[0] * x[0]


def stored(x, p, n):
    us = [0.0] * 3
    for _ in range(2):
        us[doubled(x)] = x[0]
    vs = [None] * n
    for k in range(n):
        vs[k] = x[k]
    vs[doubled(x) - 2] = x[0] * vs[doubled(x)]
    return us[1] + 2.0 * vs[2] * us[0] + x[0]


def updated(x, p, n):
    us = [x[k] * 1.0 for k in range(3)]
    us[moved_on(p)] *= 3.0
    us[moved_on(p) - 3] += us[doubled(x)] * us[doubled(x)]
    return us[0] + 2 * us[1] + 4 * us[2] * x[0]


def rows(x, p, n):
    us = [[x[k] * 1.0, x[0]] for k in range(3)]
    us[moved_on(p)][0] *= us[p[0]][0] * 3
    return us[0][0] + 2 * us[1][0] + 4 * us[2][0] + p[0]


def at_once(x, p, n):
    us = [x[k] for k in range(3)]
    us[moved_on(p)], us[p[0] - 1] = us[p[0]] * 2, us[0] * us[1]
    return us[0] + 2 * us[1] + 4 * us[2] + p[0]


def cases():
    # places are found once
    for kernel in (read, stored, updated, rows, at_once):
        yield Case(kernel, (np.array([0.7, 1.2, 0.4]), np.array([0, 1, 2]), 3), ("x",))
