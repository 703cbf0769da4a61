"""Methods, partials and objects that are called, as kernels and within kernels."""
from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np

from s2sad.live_objects.unwrap import python_function
from tests.corpus import Case


class Base:
    exponent = 2

    def weight(self, k, scale=1.0):
        return self.weights[k] ** self.exponent * scale

    @classmethod
    def shifted(cls, x):
        return x + cls.exponent

    @staticmethod
    def bent(x):
        return x * x if x > 0.5 else 0.25 * x


class Model(Base):
    def __init__(self, weights, rate):
        self.weights, self.rate = weights, rate
        self.options = {"order": 3}

    def run(self, u, steps=2):
        for _ in range(steps):
            for k in range(u.size):
                u[k] += self.rate * self.weight(k, scale=0.5) * self.bent(u[k])
        return self.shifted(np.sum(u) ** self.options["order"])

    def __call__(self, u, out):
        for k in range(u.size):
            out[k] = self.rate * u[k] * self.weights[k]

    def keeps(self, u):
        self.weights[0] = u[0]
        return self.weights[0]


@dataclass
class Line:
    slope: float
    offset: float

    def __call__(self, x):
        return self.slope * x + self.offset


MODEL = Model(np.array([1.0, 0.5, 0.25]), 0.3)
LINE = Line(2.0, 0.5)


def through_objects(u):
    total = 0.0
    for k in range(u.size):
        total += LINE(u[k]) * MODEL.weight(k) + LINE.slope
    return total


def scaled(u, c, *, power=2):
    total = 0.0
    for k in range(u.size):
        total += c * u[k] ** power
    return total


cubes = functools.partial(scaled, power=3)


def by_a_partial(u):
    return cubes(u, 2.0) * u[0]


def values():
    return np.array([0.3, 0.6, 0.9])


class Scaled:
    def __init__(self, a):
        self.a = a

    def scaled(self, k, v, off=0.0):
        return self.a * k * v + off

    double = functools.partialmethod(scaled, 2.0)
    triple = functools.partialmethod(scaled, 3.0, off=1.0)


def partial_methods(u):
    class Other(Scaled):
        def scaled(self, k, v, off=0.0):
            return self.a

        fourfold = functools.partialmethod(Scaled.scaled, k=4.0)
    one, other = Scaled(u[0]), Other(u[1])
    return one.double(u[2]) * other.triple(u[3]) + other.fourfold(v=u[1]) ** 2 + other.double(u[0])


def partial_method_of_a_class(u):
    return Scaled.double(Scaled(u[0]), u[1])


def cases():
    yield Case(partial_methods, (np.array([0.7, 1.3, 0.4, 0.9]),), ("u",))
    yield Case(partial_method_of_a_class, (values(),), refused="S201 at `Scaled.double`: a partialmethod that is no "
               "object's, or of what is no function of the class: write it as a method that calls the other one")
    yield Case(MODEL.run, (values(),), ("u",), ("u", "return"))
    yield Case(MODEL, (values(), np.zeros(3)), ("u",), ("out",))
    yield Case(python_function(functools.partial(scaled, c=2.0, power=3)), (values(),), ("u",))
    yield Case(through_objects, (values(),), ("u",))
    yield Case(by_a_partial, (values(),), ("u",))
