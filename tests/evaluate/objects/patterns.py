"""match over structures, dataclasses taken apart, wrapped functions: what is known of them before the run."""
from __future__ import annotations

import functools
import math
from collections import defaultdict
from dataclasses import asdict, dataclass
from typing import NamedTuple

import numpy as np

from tests.corpus import Case

X = np.array([3.0, 4.0, 5.0])


@dataclass
class Circle:
    r: float


@dataclass
class Rectangle:
    w: float
    h: float
    tag: str = ""


class Triangle(NamedTuple):
    a: float
    b: float
    c: float


def _area(shape):
    match shape:
        case Circle(r):
            return np.pi * r ** 2
        case Rectangle(w, h, tag="square"):
            return w * w
        case Rectangle(w=w, h=h):
            return w * h
        case Triangle(a, b, c):
            s = (a + b + c) / 2
            return math.sqrt(s * (s - a) * (s - b) * (s - c))
        case ["polygon", first, *others, last]:
            return first * last + sum(others)
        case {"kind": "disc", "r": r} | {"kind": "ring", "r": r}:
            return 3 * r ** 2
        case {"kind": k}:
            return 1.0 * len(k)
        case None:
            return 0.0
        case str(name):
            return float(len(name))
        case (x, y):
            return x * y


def patterns_of_every_kind(x):
    shapes = [Circle(x[0]), Rectangle(x[0], x[1]), Rectangle(x[1], 5.0, "square"), Triangle(*x[:3]),
              ["polygon", x[0], x[1], x[2], x[1]], {"kind": "disc", "r": x[2]}, {"kind": "ring", "r": x[0], "q": 1},
              {"kind": "abc"}, None, "four", (x[0], x[2])]
    return sum((i + 1) * _area(s) for i, s in enumerate(shapes))


@dataclass
class Material:
    k: np.ndarray
    layers: list
    options: dict


def dataclasses_as_dicts(x):
    material = Material(x.copy(), [Circle(x[0])], {"scale": x[1]})
    d = asdict(material)
    d["k"][0] = 100.0
    d["layers"][0]["r"] *= x[2]
    d["options"]["scale"] = 2.0
    return np.sum(material.k) * np.sum(d["k"]) + d["layers"][0]["r"] + material.layers[0].r * material.options["scale"]


def totals_by_kind(x):
    total, count = defaultdict(float), defaultdict(int)
    for kind, v in zip(("a", "b", "a"), x):
        total[kind] += v ** 2
        count[kind] += 1
    return sum(total[k] / count[k] for k in total) + total["none"]


def _reported(function):
    @functools.wraps(function)
    def wrapper(*args, **keywords):
        found = function(*args, **keywords)
        print(f"{function.__name__}: {found}")
        return found
    return wrapper


@_reported
def _misfit(x, power=2):
    return np.sum(x ** power)


def functions_that_are_wrapped(x):
    return _misfit(x) * _misfit(2.0 * x, power=3)


_WEIGHTS = np.array([0.5, 0.3, 0.2])


def shapes_of_what_is_reduced(x):
    f = np.ones((3, *x.shape)) * _WEIGHTS[:, None] * x
    rho = np.sum(f, axis=0)
    u = np.einsum("i,ix->x", _WEIGHTS, f) / rho.mean()
    g = np.zeros((2, *rho.shape))
    g[0], g[1] = u, rho * x
    h = np.ones(np.max(f, axis=1).shape)
    return np.sum(np.ones((2, *f.max(axis=1).shape)) @ g.T[:3, :]) + np.sum(g) * np.sum(h)


def cases():
    for kernel in (patterns_of_every_kind, dataclasses_as_dicts, totals_by_kind, functions_that_are_wrapped,
                   shapes_of_what_is_reduced):
        yield Case(kernel, (X,), "x")
