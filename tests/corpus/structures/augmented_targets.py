"""`target op= value`, where the value's call gives the target, or what shares its number, something else first: what
was there before is changed, and becomes the target again."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case

X = np.array([1.5, 2.0])


class Part:
    def __init__(self, w, t):
        self.w, self.t = w, t


class Shown:
    """What is read is another object's, what is assigned is kept apart."""

    def __init__(self, part):
        self.part, self.log = part, 0.0

    @property
    def t(self):
        return self.part.t

    @t.setter
    def t(self, value):
        self.log = value


def doubled(part):
    part.t += part.t
    return part.t


def replaced(part, w):
    part.w = w
    return 2.0


def one_number_of_two(x):
    parts = [Part(x, x[0]), Part(x, 0.0)]
    parts[-1].t = doubled(parts[0])
    for part in parts:
        part.t *= doubled(parts[0])
    return parts[-1].t + parts[0].t * x[1]


def an_array(x):
    part = Part(x * 3.0, 0.0)
    kept = part.w
    part.w += replaced(part, x * 2.0)
    return np.sum(part.w * x) + np.sum(kept)


def in_a_dict(x):
    d = {"t": x[0], "u": x[1]}

    def change():
        d["u"] = d["t"]
        d["t"] = x[1] * 3.0
        return d["t"]
    d["t"] *= change()
    return d["t"] + 10.0 * d["u"]


def in_a_list(x):
    items = [x[0], x[1]]

    def change():
        items[1] = items[0]
        items[0] = 5.0 * x[1]
        return 2.0
    items[-2] *= change()
    return items[0] + 10.0 * items[1]


def of_a_closure(x):
    t, u = x[0] * 1.0, 0.0

    def change():
        nonlocal t, u
        u = t
        t = x[1] * 7.0
        return 3.0
    t *= change()
    return t + 10.0 * u


def by_a_property(x):
    shown = Shown(Part(x, x[0] * 2.0))
    shown.t *= x[1]
    return shown.t + 10.0 * shown.log


def a_list(x):
    rows = [[x[0]], [x[1]]]

    def change():
        rows[0] = [x[1] * 3.0]
        return [4.0 * x[0]]
    rows[0] += change()
    return rows[0][0] + 10.0 * rows[0][1]


def of_two_objects(x):
    a, b = Part(x, x[0]), Part(x, x[0])
    b.t = a.t

    def change():
        a.t = a.t + 1.0
        return a.t
    a.t += change()
    b.t += change()
    return a.t + 10.0 * b.t


def stiffness(part, k):
    part.t *= 2.0
    made = np.zeros((2, 2))
    for i in range(2):
        made[i, i] = part.t
        k[0, i] += part.t
    return made


def picked_places(x):
    k, part, places = np.ones((3, 3)) * x[0], Part(x, x[1]), np.array([[0], [2]]).flatten()
    k[np.ix_(places, places)] += stiffness(part, k)         # what was there before is read first
    k[[0, 1], [0, 1]] *= stiffness(part, k)[:, 0]
    k[:, [0, 1]] -= stiffness(part, k)[:, 0].sum()
    return np.sum(k ** 2) * part.t


def cases():
    for kernel in (one_number_of_two, an_array, in_a_dict, in_a_list, of_a_closure, by_a_property, a_list,
                   of_two_objects, picked_places):
        yield Case(kernel, (X.copy(),), "x")
