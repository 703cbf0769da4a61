"""Stores at once into the items of a list that is written out: all values are read before the first store."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case


def bump(v):
    v[0] += 1.0
    return v[0] * 2.0


def swapped(x):
    t = [x[0], x[1]]
    t[0], t[1] = t[1], t[0]
    u = [x[0], x[1]]
    u[0], u[-1] = u[1] * 1.0, u[0] * 1.0
    return t[0] ** 2 * t[1] + u[0] ** 3 * u[1]


def rotated(x):
    t = [x[0], x[1], x[2]]
    t[0], t[1], t[2] = t[2], t[0], t[1]
    u = [x[0], x[1]]
    u[0], a = u[1] * 2.0, u[0]
    return t[0] ** 2 * t[1] * u[0] ** 3 * a


def arrays(x):
    t = [x * 2.0, x * 1.0, x * 3.0]
    t[0], t[1], t[2] = t[2], t[0], t[1]
    u = [x * 2.0, x * 1.0]
    u[0], u[1] = u[1], u[0] + u[1]
    return t[0][0] ** 2 * t[1][0] + u[0][0] ** 3 * u[1][0]


def in_a_loop(x):
    b = [0.0, 1.0]
    c = [x[0], x[1], x[2]]
    t = [x * 2.0, x * 1.0]
    for k in range(3):
        b[0], b[1] = b[1], b[0] + x[k]
        c[0], c[1], c[2] = c[1], c[2], c[0] * c[1]
        t[0], t[1] = t[1], t[0] * t[1]
    return b[0] ** 2 * b[1] + c[0] ** 2 * c[1] + t[0][0] ** 2 * t[1][0]


def beside_a_call(x):
    t = [x[0], x[1], x[2]]
    t[0], t[1] = t[1], bump(x) * t[0]
    t[2] += t[0]
    return t[0] ** 2 * t[1] * t[2]


class Gain:
    def __init__(self, value):
        self.value = value


def weighted(gain, x, scale):
    gain.value = gain.value + scale
    ahead, behind = 0.0 * scale, 0.0 * scale
    a, b = scale, (0.0, 1.0)
    for k in range(len(x)):
        ahead, behind = x[k] + gain.value * ahead - scale * behind, ahead
        a, b = a * x[k] + 1.0, (a, b[0])
    return ahead - behind + a * b[0] * b[1]


def where_it_is_called(x):      # twice: names of the caller's are other ones than the text's
    gain = Gain(x[0])
    return weighted(gain, x, 0.4) * weighted(gain, x, 0.2)


def cases():
    # values are read before the first store
    for kernel in (swapped, rotated, arrays, in_a_loop, beside_a_call, where_it_is_called):
        yield Case(kernel, (np.array([0.7, 1.2, 0.4]),), ("x",))
