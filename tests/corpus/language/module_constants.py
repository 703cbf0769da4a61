"""Constants of dictionaries, objects and classes that a kernel's module holds."""
from __future__ import annotations

from collections import namedtuple
from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np

from tests.corpus import Case

Grid = namedtuple("Grid", "n spacing")


@dataclass
class Physics:
    gravity: float
    weights: np.ndarray

    def drag(self, u):
        return u * self.gravity


class Constants:
    scale = 1.5
    table = np.array([0.5, 2.0, 1.0, 3.0])


class Settings(Constants):
    cutoff = 0.3

    def __init__(self, order):
        self.order = order


CONFIG = {"dt": 0.1, "steps": 2, "solver": {"relaxation": 0.7, "method": "sor"}, "time scale": 3.0, "w": np.ones(4)}
PHYSICS = Physics(9.81, np.array([1.0, 2.0, 3.0, 4.0]))
SPACE = SimpleNamespace(damping=0.25, inner=PHYSICS)
GRID = Grid(3, (0.5, 0.25))
SETTINGS = Settings(3)


def step(u, v):
    for _ in range(CONFIG["steps"]):
        for i in range(GRID.n):
            u[i] += CONFIG["dt"] * v[i] * PHYSICS.weights[i] - CONFIG["solver"]["relaxation"] * u[i] * SPACE.damping
            if CONFIG["solver"]["method"] == "sor" and abs(v[i]) > SETTINGS.cutoff:
                v[i] *= Constants.table[i] * Constants.scale ** SETTINGS.order
    return np.sum(u * CONFIG["w"]) * SPACE.inner.gravity / CONFIG["time scale"] + Settings.scale * SETTINGS.scale * v[0]


def unknown_item(x):
    return np.sum(x) * CONFIG["stepz"]


def unknown_field(x):
    return np.sum(x) * PHYSICS.gravitas


def handed_on(x):
    return np.sum(x) * len(CONFIG)


def written(x):
    CONFIG["dt"] = 0.3
    x[0] *= CONFIG["dt"]


MANY = tuple(float(k) for k in range(100))


def repeated(x):
    return np.sum(x) * len(MANY * 2)


class Doubled(dict):
    def __getitem__(self, key):
        return 2.0 * dict.__getitem__(self, key)


DOUBLED = Doubled(dt=0.1)
COUNTS, GRADES = [0, 0], [[0, 0], [0, 0]]


def items_of_its_own(x):
    return np.sum(x) * DOUBLED["dt"]


def stored_in_a_list(x):
    for k in range(2):
        COUNTS[k] = x[k]
    return COUNTS[0] * x[1]


def stored_in_a_row(x):
    for i in range(2):
        for j in range(2):
            GRADES[i][j] += x[i] * x[j]
    return GRADES[0][1] * x[0]


class Hidden:
    def __init__(self):
        self.__dict__["scale"] = 100.0

    @property
    def scale(self):
        return 3.0


class Metres(float):
    def __mul__(self, other):
        return Metres(2.0 * float(self) * other)

    __rmul__ = __mul__


HIDDEN, LENGTH, TABLE, MASKED, HALF = (
    Hidden(), Metres(1.5), np.matrix([[1.0, 2.0], [3.0, 4.0]]), np.ma.masked_array([1.0, 2.0, 3.0]), np.float16(0.5))


def property_before_a_field(x):
    return x[0] * HIDDEN.scale


def float_of_its_own(x):
    return x[0] * LENGTH


def matrix(x):
    return np.sum(TABLE * TABLE * x[0])


def masked(x):
    return np.sum(MASKED * x)


def half(x):
    return x[0] * HALF


def cases():
    u, v = np.array([0.3, 0.6, 0.9, 1.2]), np.array([0.2, 0.7, 0.4, 0.5])
    yield Case(step, (u, v), ("u", "v"), ("u", "v", "return"))
    for kernel in (handed_on, repeated):
        yield Case(kernel, (np.ones(3),), "x")
    for kernel, refused in (
            (unknown_item,
             'S202 at `CONFIG["stepz"]`: \'CONFIG\' has no \'stepz\': did you mean \'CONFIG[\'steps\']\'?'),
            (unknown_field,
             "S202 at `PHYSICS.gravitas`: 'PHYSICS' has no 'gravitas': did you mean 'PHYSICS.gravity'?"),
            (written,
             "S201 at `CONFIG`: 'CONFIG' cannot be used in a kernel: it is a dict: name the number or array that is "
             "in it, or pass it as an argument")):
        yield Case(kernel, (np.ones(3),), of=None, refused=refused)
    yield Case(property_before_a_field, (np.ones(3),), "x")
    # what is not taken for its numbers
    for kernel, refused in (
            (float_of_its_own,
             "S201 at `LENGTH`: 'LENGTH' cannot be used in a kernel: it is a Metres: pass it as an argument, or make "
             "it a number or a NumPy array"),
            (matrix,
             "S201 at `TABLE`: 'TABLE' cannot be used in a kernel: it is a matrix: make it a plain array: "
             "np.array(...)"),
            (masked,
             "S201 at `MASKED`: 'MASKED' cannot be used in a kernel: it is a MaskedArray: make it a plain array: "
             "np.array(...)"),
            (half,
             "S201 at `HALF`: 'HALF' cannot be used in a kernel: it is a float16: pass it as an argument, or make it "
             "a number or a NumPy array"),
            (items_of_its_own,
             'S201 at `DOUBLED["dt"]`: \'DOUBLED\' cannot be used in a kernel: it is a Doubled: pass it as an '
             "argument, or make it a number or a NumPy array"),
            (stored_in_a_list,
             "S201 at `COUNTS`: 'COUNTS' cannot be used in a kernel: it is a list or tuple of the module, and "
             "written: pass it as an argument, an array"),
            (stored_in_a_row,
             "S201 at `GRADES`: 'GRADES' cannot be used in a kernel: it is a list or tuple of the module, and "
             "written: pass it as an argument, an array")):
        yield Case(kernel, (np.ones(3),), of=None, refused=refused)
