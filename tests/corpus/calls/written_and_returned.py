"""Functions that write an argument and return it, in loops over time: `p = boundary(p)`."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case
from tests.harness.seeds import generator

RNG = generator(7)


def boundary(p):
    p[0] = p[1]
    p[-1] = 0.0
    return p


def relaxed(p, b, n):
    pn = np.empty_like(p)
    for _ in range(n):
        pn = p.copy()
        p[1:-1] = 0.5 * (pn[2:] + pn[:-2]) - b[1:-1] * pn[1:-1]
        p[0] = p[1] ** 2
    return p


def source(b, u):
    b[1:-1] = u[2:] * u[:-2]
    return b


def flow(u, p, nt):
    un = np.empty_like(u)
    b = np.zeros(u.size)
    for _ in range(nt):
        un = u.copy()
        b = source(b, u)
        p = relaxed(p, b, 2)
        u[1:-1] = un[1:-1] - 0.1 * (p[2:] - p[:-2])
        u[-1] = u[0] * p[1]
    return u, p


def in_a_branch(p, nt):
    for k in range(nt):
        p[1:-1] += 0.1 * (p[2:] - p[:-2]) * p[1:-1]
        if k % 2 == 0:
            p = boundary(p)
    return np.sum(p ** 2)


def stepped(p, n):
    for _ in range(n):
        p = boundary(p)
        p[1:] *= 1.1 * p[1]
    return p


def one_inside_another(p, nt):
    for _ in range(nt):
        p = stepped(p, 2)
    return np.sum(p ** 2)


def exchanged(u, v):
    u[1:] += v[:-1]
    v[0] = u[1] * v[1]
    return u, v


def deeper(u, v):
    u, v = exchanged(u, v)
    v, u = exchanged(v, u)
    return u, v


def two_of_them(u, v, nt):
    for _ in range(nt):
        u, v = deeper(u, v)
        u[0] += 0.1 * v[2]
    return u, v


def itself(p):
    return p


def nothing_left(p, nt):
    if nt > 2:
        p = itself(p)
    else:
        p[0] *= 2.0
    return p * p


def names_that_turn(p, r):
    p = exchanged_and_one(p, r)
    p = exchanged_and_one(r, p)
    return p * r


def exchanged_and_one(p, r):
    p = boundary(p)
    r[0] = p[1] * 2.0
    return p


X, Y = RNG.random(5) + 0.3, RNG.random(5) + 0.3
CASES = [
    (flow, (X, Y, 2), ("u", "p"), ("u", "p", "return")),
    (in_a_branch, (X, 3), ("p",), ("p", "return")),
    (one_inside_another, (X, 2), ("p",), ("p", "return")),
    (two_of_them, (X, Y, 2), ("u", "v"), ("u", "v", "return")),
    (nothing_left, (X, 3), ("p",), ("return",)),
    (names_that_turn, (X, Y), ("p", "r"), ("p", "r", "return")),
]


def cases():
    # derivatives
    for kernel, arguments, wrt, of in CASES:
        yield Case(kernel, arguments, wrt, of)
