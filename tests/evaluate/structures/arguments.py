"""Structures that kernels are given: dataclasses, named tuples, objects with methods, and values of them."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

array = np.array


@dataclass
class State:
    u: np.ndarray
    v: np.ndarray
    t: float
    n: int = 3
    log: Any = None


class Params(NamedTuple):
    k: float
    w: np.ndarray


class Orbit(NamedTuple):
    x: float
    v: float


@dataclass(frozen=True)
class Grid:
    n: int
    dx: float


@dataclass
class Model:
    grid: Grid
    fields: tuple
    opts: dict


GRAVITY = 2.0


@dataclass
class Spring:
    x: np.ndarray
    k: float
    t: float = 0.0

    @property
    def size(self):
        return self.x.size

    @staticmethod
    def square(v):
        return v * v

    def energy(self, c=1.0):
        e = 0.0
        for i in range(self.size):
            e += c * self.k * self.x[i] ** 2 * GRAVITY
        return e

    def advance(self, dt):
        for i in range(self.size):
            self.x[i] -= dt * self.k * self.x[i]
        self.t += dt


class Layer:
    def __init__(self, w, b):
        self.w, self.b = w, b

    def apply(self, x):
        return np.sum(self.w * x) + self.b


@dataclass
class Loss:
    total: float
    parts: dict


def state_of():
    return State(array([1.0, 2.0, 3.0]), np.zeros(3), 0.5)


def params():
    return Params(2.0, array([0.1, 0.2, 0.3]))


def model():
    return Model(Grid(3, 0.5), (array([1.0, 2.0, 3.0]), array([4.0, 5.0, 6.0])), {"c": array([2.0]), "d": 3.0})


LAYERS = [(array([[0.1, 0.2], [0.3, 0.4]]), array([0.1, 0.2])),
          (array([[0.5, 0.6], [0.7, 0.1], [0.2, 0.3]]), array([0.3, 0.2, 0.1]))]
X = array([0.5, 0.7])
U = array([1.0, 2.0])
