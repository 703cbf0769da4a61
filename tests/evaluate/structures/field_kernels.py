"""Small kernels that try to mislead what takes structures apart: aliases, snapshots, fields given new values, exits."""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

A = np.array


@dataclass
class S:
    u: np.ndarray
    t: float


@dataclass
class Outer:
    a: S
    b: S
    items: list = field(default_factory=list)


class P(NamedTuple):
    a: float
    b: float


def S1():
    return S(A([1.0, 2.0]), 0.5)


def q1(o):
    # swap via tuple of fields
    o.a.t, o.b.t = o.b.t, o.a.t
    return o.a.t * 2.0 + o.b.t


def q2(o):
    s = o.a
    for _ in range(3):
        s.t *= o.b.t
        o.a.u[0] += s.t
    return o.a.u[0] * o.a.t


def q3(p, n):
    q = p
    for _i in range(n):
        p = P(p.b, p.a * q.b)
    return p.a * q.a + p.b


def q4(p, n):
    for _i in range(n):
        p, q = P(p.b * 2.0, p.a), p
    return p.a * q.a


def h5(s, x):
    s.t += x
    return s.t * 2.0


def q5(s, x):
    y = h5(s, x) + s.t
    z = s.t + h5(s, x)
    return y * z


def q6(s, flag):
    p = P(s.t, 1.0)
    if flag > 0.0:
        p = P(p.b, p.a * s.u[0])
    return p.a + 2.0 * p.b


def h7(s, v):
    return v * s.t


def q7(s):
    t = s.t
    s.t = 3.0 * t
    old = (s.t, t)
    s.t = h7(s, s.t)
    return old[0] * s.t + old[1]


def q8(o):
    total = 0.0
    for s in (o.a, o.b):
        for k in range(s.u.size):
            if s.u[k] > 1.5:
                break
            total += s.u[k] * s.t
        s.t += 1.0
    return total * o.a.t * o.b.t


def h9(d):
    d["x"] *= 2.0
    return d


def q9(d):
    e = h9(d)
    e["x"] += 1.0
    return d["x"] * e["x"]


def q10(s, w):
    x = s.t
    x += w
    s.t -= x
    return x * s.t


def q11(items):
    acc = items[0]
    for it in items[1:]:
        acc = acc + it * 2.0
    return acc


def q12(items):
    acc = 0.0
    for k, it in enumerate(items):
        if k == 0:
            acc = it * 3.0
        elif k == len(items) - 1:
            acc += it * it
        else:
            continue
        acc *= 1.5
    return acc


def q13(s, o=None, c=2.0):
    r = o if o is not None else s
    r.t += c
    return s.t * c


def q14(p):
    x = p[0] if len(p) > 1 else 0.0
    y = max(p)
    z = sum(p)
    return x * y * z


def q15(d):
    return d["a"] * d.get("b", 2.0) if "a" in d and d["a"] > 0.0 else 0.0


def q16(s):
    while s.t < 10.0:
        s.t *= 1.7
        if s.t > 5.0:
            s.u[0] = s.t
            break
    return s.u[0] * s.t


CASES = [
    (q1, lambda: (Outer(S1(), S(A([3.0]), 0.7)),)),
    (q2, lambda: (Outer(S1(), S(A([3.0]), 0.7)),)),
    (q3, lambda: (P(1.1, 1.2), 3)),
    (q4, lambda: (P(1.1, 1.2), 3)),
    (q5, lambda: (S1(), 1.3)),
    (q6, lambda: (S1(), 1.0)),
    (q6, lambda: (S1(), -1.0)),
    (q7, lambda: (S1(),)),
    (q8, lambda: (Outer(S1(), S(A([1.2]), 0.7)),)),
    (q9, lambda: ({'x': 1.5},)),
    (q10, lambda: (S1(), 0.3)),
    (q11, lambda: ([1.0, 2.0, 3.0],)),
    (q12, lambda: ([1.0, 2.0, 3.0],)),
    (q13, lambda: (S1(),)),
    (q13, lambda: (S1(), S1())),
    (q14, lambda: ((1.0, 2.0),)),
    (q15, lambda: ({'a': 2.0, 'b': 3.0},)),
    (q15, lambda: ({'a': 2.0},)),
    (q15, lambda: ({'b': 2.0},)),
    (q16, lambda: (S1(),)),
]
