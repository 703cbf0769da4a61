"""Small kernels that hand structures to helpers and keep what these return, in branches and loops."""
from __future__ import annotations

import numpy as np

from tests.evaluate.structures.field_kernels import A, P, S


def inner(s, x):
    s.t += x
    return P(s.t, x)


def r1(s):
    # two specialisations of one helper, one with a cell
    a = inner(s, 1.0)
    b = inner(s, a.a)
    return a.a * b.b + b.a


def plain(u, s):
    for i in range(u.size):
        u[i] *= s.t


def r2(s):
    # same array twice through a structure
    plain(s.u, s)
    s.t = s.u[0]
    plain(s.u, s)
    return np.sum(s.u)


def add2(a, b):
    a.t += b.t
    a.u[0] += b.u[0]


def r3(s):
    # the same structure twice
    add2(s, s)
    return s.t * s.u[0]


def r4(d, n):
    # dict of structures, by key in loops
    tot = 0.0
    for name in d:
        s = d[name]
        for i in range(n):
            tot += s.u[i] * s.t
    for _, s in d.items():
        s.u[0] = tot
    for s in d.values():
        tot += s.u[0]
    return tot


def r5(layers, x):
    # nested lists of dicts
    h = x
    for layer in layers:
        h = layer["w"] @ h
        if layer["bias"] is not None:
            h = h + layer["bias"]
        h = np.maximum(h, 0.0) if layer["act"] == "relu" else np.tanh(h)
    return np.sum(h * h)


def r6(s):
    # augmented array field
    s.u += s.t
    s.u *= s.u
    w = s.u
    w -= 1.0
    return np.sum(s.u)


def maybe(s, p=None):
    if p is None:
        return s.t
    return s.t * p.a


def r7(s, p):
    return maybe(s) + maybe(s, p) + maybe(p=P(s.t, 1.0), s=s)


def r8(state, dt):
    # whole array updates with slices
    u, v = state.u, state.t
    state.u[1:-1] = u[1:-1] + dt * (u[2:] - 2.0 * u[1:-1] + u[:-2]) * v
    state.t = np.sum(state.u) * 0.1


def r9(s, k):
    if k == 0:
        return P(s.t, 2.0)
    return P(s.t * s.t, s.u[0])


def t1(s, p):
    # alias of number through names then store
    x = s.t
    q = P(x, s.t)
    s.t = 5.0 * p.a
    r = q
    s.t += r.a * r.b
    return s.t * x


def t2(items):
    # list number stores while iterating
    total = 0.0
    for _k, x in enumerate(items):
        items[0] = items[0] + 1.0
        total += x * items[0]
    return total


def t3(p, n):
    # snapshot inside a loop
    best = p
    for _i in range(n):
        p = P(p.b, p.a + 1.0)
        if p.a > best.a:
            best = p
    return best.a * p.b


def t4(s):
    # early return with structure
    for _i in range(3):
        s.t *= 2.0
        if s.t > 3.0:
            return P(s.t, s.u[0])
    return P(0.0, s.t)


def stepper(p, dt):
    if p.a > 1.0:
        return P(p.b, p.a)
    return p


def t5(p, dt):
    for _i in range(3):
        p = stepper(p, dt)
    return p.a * 2.0 + p.b * dt


def t6(d, x):
    # two names for the same dict, in branches
    e = d
    if x > 0.0:
        e["k"] *= x
    else:
        d["k"] += x
    return d["k"] * e["k"]


def t7(s, k):
    # while with structure in test and else
    n = 0
    while s.t < k:
        s.t += 1.0
        n += 1
    s.t *= 2.0
    return s.t * n


def swap2(p):
    a, b = p
    return b, a


def t8(p):
    q = swap2(p)
    a, b = swap2(q)
    p = swap2((a, b))
    return p[0] * 2.0 + p[1] * a


def t9(s):
    # nested function results used in expressions
    return swap2((s.t, s.u[0]))[0] * s.t


def t10(o):
    # tuple with structure and numbers in for
    tot = 0.0
    for s, c in ((o["a"], 1.0), (o["b"], o["c"])):
        tot += s.t * c
        s.t = tot
    return tot * o["a"].t * o["b"].t


CASES = [
    (r1, lambda: (S(A([1.0, 2.0]), 0.5),)),
    (r2, lambda: (S(A([1.0, 2.0]), 0.5),)),
    (r3, lambda: (S(A([1.0, 2.0]), 0.5),)),
    (r4, lambda: ({'x': S(A([1.0, 2.0]), 0.5), 'y': S(A([3.0, 2.0]), 0.7)}, 2)),
    (r5, lambda: ([
        {'w': A([[1.0, 0.2], [0.3, 0.4]]), 'bias': None, 'act': 'relu'},
        {'w': A([[0.1, 0.2], [0.3, 0.4]]), 'bias': A([0.1, 0.2]), 'act': 'tanh'}], A([1.0, 2.0]))),
    (r6, lambda: (S(A([1.0, 2.0]), 0.5),)),
    (r7, lambda: (S(A([1.0, 2.0]), 0.5), P(2.0, 3.0))),
    (r8, lambda: (S(A([1.0, 2.0, 4.0, 3.0]), 0.5), 0.1)),
    (r9, lambda: (S(A([1.0, 2.0]), 0.5), 0)),
    (r9, lambda: (S(A([1.0, 2.0]), 0.5), 1)),
    (t1, lambda: (S(A([1.0, 2.0]), 0.5), P(2.0, 3.0))),
    (t2, lambda: ([1.0, 2.0, 3.0],)),
    (t3, lambda: (P(1.0, 2.0), 3)),
    (t4, lambda: (S(A([1.0, 2.0]), 0.5),)),
    (t4, lambda: (S(A([1.0, 2.0]), 0.1),)),
    (t5, lambda: (P(1.5, 0.7), 0.3)),
    (t6, lambda: ({'k': 2.0}, 0.5)),
    (t6, lambda: ({'k': 2.0}, -0.5)),
    (t7, lambda: (S(A([1.0, 2.0]), 0.5), 3.0)),
    (t8, lambda: (P(1.5, 0.7),)),
    (t9, lambda: (S(A([1.0, 2.0]), 0.5),)),
    (t10, lambda: ({'a': S(A([1.0, 2.0]), 0.5), 'b': S(A([1.0, 2.0]), 0.7), 'c': 2.0},)),
]
