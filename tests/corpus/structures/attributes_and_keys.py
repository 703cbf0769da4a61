"""Attributes of classes that are assigned, the dictionary of an object's attributes, named tuples of a sequence, keys
that are compared by what is in them."""
from __future__ import annotations

import enum
from collections import namedtuple

import numpy as np

from tests.corpus import Case


class Kind(enum.Enum):
    ION = 1
    ATOM = 2


BONDS = {frozenset((Kind.ION, Kind.ATOM)): 2.0, (Kind.ION, "k"): 0.5}
Triple = namedtuple("Triple", "a b c")


class Body:
    count = 0
    total = 0.0

    def __init__(self, mass):
        type(self).count += 1
        self.number = self.count
        self.mass = mass
        Body.total = Body.total + mass * mass

    @classmethod
    def reset(cls):
        cls.count = 0

    def share(self):
        return self.mass / self.total


class Moon(Body):
    pass


def counted(x):
    Body.reset()
    Moon.count = 10
    Body.total = 0.0
    first = Body(x[0]).share()
    bodies = [Body(v) for v in x[1:3]]
    for k in range(len(x)):
        if x[k] > 0.5:
            Body.total += x[k] ** 3
    moon = Moon(x[1])
    return first + sum(b.share() * b.number for b in bodies) * moon.number + Body.count * Body.total


class Model:
    def __init__(self, **parameters):
        self.a = 1.0
        vars(self).update(parameters)
        self.__dict__["z"] = self.a * 2.0

    def log(self, value):
        self.__dict__.setdefault("records", []).append(value)

    def total(self):
        return sum(vars(self).values()) + sum(self.__dict__[k] * 2.0 for k in self.__dict__) + len(self.__dict__)


def by_the_dictionary(x):
    model = Model(a=x[0], b=x[1] ** 2)
    now = vars(model)
    model.a = x[2] * x[0]
    total = model.total() + now["a"] ** 2 + (1.0 if "b" in model.__dict__ else 2.0) * {**vars(model)}["b"]
    model.log(x[0])
    model.log(total)
    return model.records[0] * model.records[1] * dict(**now)["z"]


class Guarded:
    @property
    def a(self):
        return 1.0


def past_a_property(x):
    made = Guarded()
    made.__dict__["a"] = x[0]
    return made.a


def made_of_a_sequence(x):
    p = Triple._make(x[:3])
    q = Triple._make(2.0 * v for v in p)
    return q.a * q.b + Triple(**q._asdict()).c ** 2


def by_content(x):
    table = {frozenset(("a", "b")): x[0]}
    table[frozenset("b")] = x[1]
    total = table[frozenset(["b", "a"])] * 2.0 + (x[2] if frozenset(("b", "a")) in table else 0.0)
    if (Kind.ION, "k") in BONDS:
        total *= BONDS[Kind.ION, "k"] + x[1]
    return total * BONDS[frozenset((Kind.ATOM, Kind.ION))] + table[frozenset({"b"})] * len(table)


class Particles:
    def __init__(self, positions):
        self.positions = np.array(positions, dtype=float)

    def __len__(self):
        return len(self.positions)


def one_by_one(x):
    particles, kinds, energy = Particles(x), "ABA", 0.0
    for i in range(len(particles)):
        for j in range(i + 1, len(particles)):
            d = particles.positions[i] - particles.positions[j]
            energy += d ** 2 if kinds[i] == kinds[j] else 1.0 / (1.0 + d ** 2)
    return energy


class Filter:
    """As filters are published: what has no value yet is an array of None."""

    def __init__(self, x, size):
        self.x = x
        self.z = np.array([[None] * size]).T
        self.innovation = np.asarray([None, 0.0])
        self.gain = None

    def update(self, z, r):
        self.z = z
        self.gain = 1.0 / (1.0 + r * r)
        self.innovation = z - self.x
        self.x = self.x + self.gain * self.innovation


def none_until_then(x):
    found = Filter(x[:2] * 0.5, 2)
    for k in range(3):
        found.update(x[1:] * (k + 1.0), x[0])
    return found.x[0] * found.x[1] + np.sum(found.z * found.innovation)


def none_read(x):
    found = Filter(x[:2] * 0.5, 2)
    return found.x[0] * found.innovation[1]


class Wall:
    def __init__(self, u, kind):
        self.u, self.kind = u, kind

    def fill(self):
        getattr(self, "_" + self.kind)()

    def _outflow(self):
        self.u[0] = self.u[1]

    def _periodic(self):
        self.u[0] = self.u[-2]


def a_method_by_name(x, kind):
    wall = Wall(2.0 * x, kind)
    wall.fill()
    return wall.u[0] * wall.u[-1] * {"outflow_at_0": 2.0, "periodic_at_0": 3.0}[f"{kind}_at_" + "0"]


def among_known_keys(x):
    fixed, values, total = {0, 3}, {0: 1.5, 2: 2.0, "a": 0.0}, 0.0
    items = [v * v for v in x]
    for i in range(len(items)):
        if i in fixed:
            continue
        total += items[i] * (2.0 if i not in values else 3.0) + (1.0 if i in {} else 0.0)
    return total


def cases():
    for kind in ("outflow", "periodic"):
        yield Case(a_method_by_name, (np.array([0.7, 1.2, 0.4]), kind), ("x",))
    yield Case(among_known_keys, (np.array([0.7, 1.2, 0.4, 0.9]),), ("x",))
    for kernel in (counted, by_the_dictionary, made_of_a_sequence, by_content, one_by_one, none_until_then):
        yield Case(kernel, (np.array([0.7, 1.2, 0.4]),), ("x",))
    yield Case(past_a_property, (np.array([0.7, 1.2, 0.4]),), ("x",), refused=(
        "S201 at `made.__dict__[\"a\"]`: the class has 'a', or says what assigning it does, and it is assigned by the "
        "dictionary of the object's attributes: assign the attribute"))
    yield Case(none_read, (np.array([0.7, 1.2, 0.4]),), ("x",), refused=(
        "S201 at `found.innovation[1]`: an item of an array with None in it"))
