"""Kernels with what files have at module level: classes, enumerations, tables, objects. FILED lists them."""
import enum
from abc import ABC, abstractmethod
from collections import namedtuple
from dataclasses import dataclass, field, replace
from enum import Enum, IntEnum
from functools import partial
from typing import ClassVar, NamedTuple

import numpy as np

X = np.array([0.3, 0.7, 1.1, 1.9])
DT = 0.25
WEIGHTS = [0.5, 1.5, 2.5]
RULES = {"trapezoid": (0.5, 0.5), "simpson": (1.0, 4.0, 1.0)}
STEPS = np.linspace(0.0, 1.0, 4)
NESTED = {"a": {"k": 2.0, "names": ["u", "v"]}, "b": [(1.0, np.ones(4)), (3.0, np.full(4, 0.5))]}
Box = namedtuple("Box", "lo hi", defaults=(2.0,))


class Edge(Enum):
    PERIODIC = "periodic"
    REFLECT = "reflect"


class Order(IntEnum):
    FIRST = 1
    SECOND = 2


class Phase(Enum):
    LIQUID = enum.auto()
    SOLID = enum.auto()


@dataclass
class Material:
    density: float = 2.0
    modulus: float = 3.0
    kinds: ClassVar[int] = 4

    @property
    def speed(self):
        return self.modulus / self.density


@dataclass
class Layered(Material):
    depth: float = 0.5
    parts: list = field(default_factory=list)
    total: float = field(default=0.0, init=False)

    def __post_init__(self):
        self.total = self.depth * self.density


class Particle(NamedTuple):
    position: np.ndarray
    mass: float = 1.5

    def energy(self):
        return 0.5 * self.mass * np.sum(self.position ** 2)


class Scheme(ABC):
    order = Order.FIRST
    scale = 2.0

    def __init__(self, dt=DT, *, edge=Edge.PERIODIC):
        self.dt, self.edge = dt, edge
        self._width = 1.0
        self.log = []

    @abstractmethod
    def rate(self, u):
        """What u changes by."""

    @classmethod
    def standard(cls, **options):
        return cls(0.5, **options)

    @staticmethod
    def square(u):
        return u * u

    @property
    def width(self):
        return self._width * self.scale

    @width.setter
    def width(self, value):
        self._width = value

    def step(self, u):
        self.log.append(u)
        return u + self.dt * self.rate(u) * self.width


class Decay(Scheme):
    scale = 3.0

    def __init__(self, *args, k=1.0, **options):
        super().__init__(*args, **options)
        self.k = k

    def rate(self, u):
        return -self.k * (np.roll(u, 1) if self.edge is Edge.PERIODIC else u)


def doubled(f):
    def inner(*args):
        return 2.0 * f(*args)
    return inner


def scaled(by):
    def decorate(f):
        def inner(x):
            return by * f(x)
        return inner
    return decorate


@doubled
@scaled(by=3.0)
def wave(x):
    return np.sin(x)


def power(x, p):
    return x ** p


def weighted(u):
    return u * WEIGHTS[1]


SQUARE = partial(power, p=2)
ACTIVATIONS = {"sin": np.sin, "wave": wave, "square": SQUARE, "own": weighted}
STEEL = Material(density=4.0)
SCHEME = Decay(0.125, k=2.0, edge=Edge.REFLECT)


def tables(x):
    s = 0.0
    for name, weights in RULES.items():
        for w in weights:
            s += w * np.sum(x) if name == "simpson" else w * x[0]
    return s + WEIGHTS[-1] * sum(WEIGHTS) * np.sum(STEPS * x)


def nested(x):
    s = NESTED["a"]["k"] * x[0] if "v" in NESTED["a"]["names"] else 0.0
    for k, w in NESTED["b"]:
        s += k * np.sum(w * x)
    return s


def enumerations(x):
    s = 0.0
    for phase in Phase:
        s += x[phase.value] * (2.0 if phase is Phase.SOLID else 1.0)
    if Edge("reflect") is Edge.REFLECT and Edge.PERIODIC.name == "PERIODIC":
        s *= Order.SECOND + 1
    return s


def dataclasses_of_a_file(x):
    one, other = Layered(1.0, depth=2.0), Layered(modulus=5.0)
    one.parts.append(x)
    other.parts.append(x * x)
    more = replace(STEEL, modulus=x[1])
    same = Material(4.0) == STEEL
    return np.sum(one.parts[0] * one.total) + np.sum(other.parts[0]) * other.speed + more.speed + Material.kinds * same


def tuples_of_a_file(x):
    p, box = Particle(x), Box(lo=x[0])
    q = p._replace(mass=x[1])
    return p.energy() + q.energy() + box.hi * box.lo


def objects_of_a_file(x):
    a, b = Decay(k=2.0), Decay.standard(edge=Edge.REFLECT)
    b.width = x[2]
    u = b.step(a.step(x))
    return np.sum(Scheme.square(u)) + np.sum(b.log[0]) * (2.0 if isinstance(a, Scheme) and a.order == 1 else 1.0)


def decorated(x):
    return np.sum(wave(x)) + sum(np.sum(f(x)) for f in ACTIVATIONS.values())


def objects_from_outside(x):
    return np.sum(x) * SCHEME.k * SCHEME.dt + STEEL.speed * SCHEME.width


def in_a_loop(x, material: Material | None = None):
    s, speed = 0.0, STEEL.speed
    for k in range(x.size):
        if x[k] > 1.0:
            s += x[k] * speed * RULES["simpson"][1]
        else:
            s += power(x[k], 3) * WEIGHTS[0] * wave(x[k])
    return s


FILED = [tables, nested, enumerations, dataclasses_of_a_file, tuples_of_a_file, objects_of_a_file, decorated,
         objects_from_outside, in_a_loop]
