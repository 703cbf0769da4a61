"""Plain dataclasses whose names are bound anew in loops: nobody assigns to their fields, so none can tell."""
from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from tests.corpus import Case

X = np.array([0.3, 1.1, 0.7])


@dataclass
class State:
    u: np.ndarray
    t: float = 0.0


@dataclass
class Pair:
    a: float
    b: float = 1.0


@dataclass(frozen=True)
class Fixed:
    u: np.ndarray
    t: float = 0.0


class Named(NamedTuple):
    u: np.ndarray
    t: float = 0.0


def replaced_in_a_loop(x):
    s, f, n = State(x), Fixed(x * 2.0, x[1]), Named(x, x[2])
    for _ in range(3):
        s = replace(s, t=s.t + s.u[0] * x[1])
        f = dataclasses.replace(f, u=np.sin(f.u) * s.t, t=f.t * 1.5)
        n = n._replace(t=f.t * n.t)
    return s.u.sum() * s.t + f.u.sum() * f.t * n.t


def replaced_and_assigned(x):
    """What is made of another one shares its arrays, and has numbers of its own."""
    s = State(x * 1.0, x[0])
    r = replace(s, t=s.t * x[1])
    same = replace(s, u=x * 2.0)
    s.t = 3.0 * x[2]
    s.u[0] *= r.t
    same.t += r.t
    return np.sum(s.u) * s.t + r.u[0] * r.t + same.t * same.u[1]


def replaced_in_a_helper(x):
    s = later(State(x, x[0]), 0.5)
    return later(s, dt=x[1]).t * s.t * s.u[2]


def later(s, dt):
    return replace(s, t=s.t + dt * s.u[1])


def numbers(x):
    s = Pair(x[0])
    for _ in range(3):
        s = Pair(s.b * s.a, s.b + x[1])
    return s.a * s.b


def arrays(x):
    s = State(x)
    for _ in range(3):
        s = State(np.sin(s.u) + s.t, s.t + s.u[0])
    return s.u.sum() * s.t


def other_names(x):
    s = Pair(x[0])
    t = first = s
    for i in range(3):
        t = s
        s = Pair(s.a * x[i], s.b + s.a)
    return s.a * s.b + t.a * first.a


def shared_array(x):
    s = State(x * 1.0, x[1])
    kept = s
    for i in range(2):
        v = s.u * 2.0
        v[0] = s.t * x[i]
        s = State(v, s.t + s.u[0])
    return (s.u * kept.u).sum() + kept.t * s.t


def stepped(s, dt):
    return State(s.u + dt * np.cos(s.u), s.t + dt)


def by_a_function(x):
    s = State(x, 0.5)
    while s.t < 1.0:
        s = stepped(s, 0.2)
    return (s.u ** 2).sum() * s.t


def in_branches(x):
    s = Pair(x[0], x[1])
    for i in range(3):
        if i == 1:
            s = Pair(s.b, s.a)
        elif x[i] > 0.5:
            s = Pair(s.a * x[i])
    return s.a * s.b


def of_two(x):
    best, last = Pair(x[0]), Pair(x[1])
    for i in range(3):
        best, last = last, Pair(best.a * last.a, x[i])
    return best.a * last.b + last.a


KERNELS = [numbers, arrays, other_names, shared_array, by_a_function, in_branches, of_two, replaced_in_a_loop,
           replaced_and_assigned, replaced_in_a_helper]


def assigned(x):
    s = Pair(x[0])
    for i in range(3):
        t = s
        t.b = x[i]
        s = Pair(s.a * s.b, x[0])
    return s.a


def assigned_before(x):
    s = Pair(x[0])
    s.b = x[1]
    t = s
    t.a = s.b * x[2]
    s = Pair(s.b, s.a)
    return s.a * s.b


class Vector:
    def __init__(self, x, y):
        self.x, self.y = x, y

    def __add__(self, other):
        return Vector(self.x + other.x, self.y + other.y)

    def __mul__(self, factor):
        return Vector(self.x * factor, self.y * factor)

    __rmul__ = __mul__


def scaled_from_the_left(x, n):
    v, scale = Vector(x[0], x[1]), 1.0
    for _ in range(n):
        v = v + 0.5 * scale * v
        scale = scale * x[2]
    return v.x * v.y * scale


def scaled_by_the_least(x):
    v, least = Vector(x[0], x[1]), 1e9
    for k in range(len(x)):
        distance = math.sqrt(x[k] ** 2 + 0.1)
        if distance < least:
            least = distance
    v = least * v + max(x[0], x[1]) * v
    return v.x * v.y


def scaled_by_what_becomes_an_array(x, n):
    v, scale = Vector(x[0], x[1]), 1.0
    for _ in range(n):
        v = scale * v
        scale = x[:2] * scale
    return np.sum(v.x * v.y * scale)


def cases():
    # bound anew
    for kernel in KERNELS:
        yield Case(kernel, (X,), ("x",))
    # what is refused
    yield Case(assigned, (X,), "x")
    # without a loop
    yield Case(assigned_before, (X,), ("x",))
    for n in (0, 3):
        yield Case(scaled_from_the_left, (np.array([0.7, 1.2, 0.4]), n), ("x",))
    yield Case(scaled_by_the_least, (np.array([0.7, 1.2, 0.4]),), ("x",))
    yield Case(scaled_by_what_becomes_an_array, (np.array([0.7, 1.2, 0.4]), 3), ("x",), refused=(
        "S201 at `scale * v`: an operator with an object on its right, and on its left what may be a number or an "
        "array of NumPy's, which would not ask its class: put the object on the left"))
