"""What a structure is made of is computed in the order of the text, as Python does it, not in that of its fields."""
from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from tests.corpus import Case


class Point(NamedTuple):
    x: float
    y: float


@dataclass
class Scaled:
    x: float
    y: float
    z: float = 2.0


class Segment(NamedTuple):
    p: Point
    w: float


def up(v):
    v[0] *= 2.0
    return v[0]


def pure(v):
    return v[0] * 2.0


def made(x):
    return Point(y=up(x), x=x[0])


def f(a, b):
    return a * b + 2.0 * a


def h(p):
    return p.x + p.y * p.y


def turned_fields(x):
    p = Point(y=up(x), x=x[0])
    return p.x + 10.0 * p.y


def replaced(x):
    p = Point(1.0, 1.0)._replace(y=up(x), x=x[0])
    return p.x + 10.0 * p.y


def of_a_dataclass(x):
    q = Scaled(z=up(x), y=x[0], x=up(x))
    r = Scaled(y=x[0] * q.x, x=up(x))
    return q.x + 10.0 * q.y * q.z + r.x * r.y * r.z


def replaced_in_a_loop(x):
    p = Point(x[1], x[2])
    s = 0.0
    for _ in range(2):
        p = p._replace(y=up(x) + p.y, x=x[0] * p.x)
        s += p.x * p.y
    return s


def replaced_behind(x):
    p = Point(x[0], x[0])._replace(x=up(x))
    return p.x + 10.0 * p.y


def by_a_helper(x):
    p = made(x)
    q = made(x)
    return p.x * q.y + q.x * p.y * p.y


def in_another_one(x):
    s = Segment(w=up(x), p=Point(y=x[1], x=x[0]))
    return s.w * s.p.x + s.p.y * s.p.x


def in_another_one_that_is_turned(x):
    s = Segment(w=x[0], p=Point(y=up(x), x=x[0]))
    return s.w * s.p.x + s.p.y * s.p.x


def by_a_call(x):
    return f(b=up(x), a=x[0]) + f(b=x[0], a=up(x))


def in_the_order_of_the_fields(x):
    p = Point(y=pure(x), x=x[0])
    q = Point(x=up(x), y=x[0])
    return p.x * p.y + q.x * 3.0 * q.y


def of_dictionaries(x):
    d = dict(y=up(x), x=x[0])  # noqa: C408
    e = {"b": up(x), "a": x[0]}
    return d["x"] * e["b"] + d["y"] * e["a"] * 7.0


def given_to_a_helper(x):
    return h(Point(y=up(x), x=x[0]))


def inside_alone(x):
    s = Segment(p=Point(y=up(x), x=x[0]), w=x[0])
    return s.w * s.p.x + s.p.y * s.p.x


def replaced_twice(x):
    p = Point(x[0], x[1])
    q = p._replace(y=up(x), x=p.x * x[0])._replace(x=up(x))
    return q.x * q.y * p.x


EVERY = (
    turned_fields, replaced, of_a_dataclass, replaced_in_a_loop, replaced_behind, by_a_helper, in_another_one,
    in_another_one_that_is_turned, by_a_call, in_the_order_of_the_fields, of_dictionaries, given_to_a_helper,
    inside_alone, replaced_twice)


def in_a_sum(x):
    s = 1.0
    s += Point(y=up(x), x=x[0]).x
    return s


def in_a_test(x):
    while Point(y=up(x), x=x[0]).x < 30.0:
        x[1] += x[0]
    return x[1]


def in_a_tuple(x):
    p, q = Point(y=up(x), x=x[0]), Point(y=up(x), x=x[0])
    return p.x + p.y * q.x


def beside_others(x):
    return h(Point(y=up(x), x=x[0])) + 1.0


def cases():
    # values are computed in the order of the text
    for kernel in EVERY:
        yield Case(kernel, [np.array([2.0, 3.0, 4.0])], ("x",), ("x", "return"))
    for kernel in (in_a_sum, in_a_test, in_a_tuple, beside_others):
        yield Case(kernel, (np.array([2.0, 3.0, 4.0]),), "x", of=("x", "return"))
    # what cannot be put in order is refused
