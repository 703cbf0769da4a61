"""Returns from loops, first rounds that differ, blocks that have an end of their own."""

from __future__ import annotations

import numpy as np

from tests.corpus import Case

X = np.array([0.3, 0.9, 1.4, 0.7])


class Points:
    def __init__(self, x):
        self.x = x
        self.n = 0

    def newton(self, a):
        v = a
        for _ in range(20):
            d = (v * v - a) / (2 * v)
            self.n += 1
            if abs(d) < 1e-10:
                return v - d
            v = v - d
        return v

    def first(self, t):
        for k in range(self.x.size):
            if self.x[k] > t:
                return k, self.x[k] * 2
        return -1, 0.0 * t

    def nested(self, t):
        for i in range(self.x.size):
            for j in range(self.x.size):
                if self.x[i] * self.x[j] > t:
                    return self.x[i] * 3 + j
        return self.x[0] * t


def newton(x):
    p = Points(x)
    return sum(p.newton(v) for v in x) + p.newton(x[0]) * p.n


def first(x):
    p = Points(x)
    k, v = p.first(0.8)
    _, w = p.first(99.0)
    return v * v + x[k] + w


def nested(x):
    p = Points(x)
    return p.nested(1.0) * p.nested(100.0)


def after(x):
    o = {"a": x}
    for k in range(x.size):
        v = o["a"][k] * 2
        if v > 1.5:
            best = v * v
            break
    return best * x[0]


class Timer:
    def __init__(self):
        self.n = 0

    def __enter__(self):
        return self

    def __exit__(self, *a):
        self.n += 1


def timed(x):
    t = Timer()
    with t:
        y = x * 2
    if x[0] > 0:
        with t:
            y = y * t.n

    def g(z):
        with t:
            return np.sum(z) * t.n

    return g(y) * t.n


def fin(x):
    o = [0]

    def g(z):
        try:
            if z[0] > 0:
                z = z * 2
            return z * o[0]
        finally:
            o[0] += 1

    return np.sum(g(x)) + np.sum(g(x))


def prev_none(x):
    o = {"s": 0.0}
    prev = None
    for v in x:
        if prev is not None:
            o["s"] += (v - prev) ** 2
        prev = v
    return o["s"]


def prev_none_while(x):
    o = {"s": 0.0, "prev": None}
    t = 0.0
    while t < 1.0:
        if o["prev"] is None:
            o["prev"] = x.copy()
        else:
            o["s"] += np.sum(o["prev"] * x) * t
            o["prev"] = o["prev"] * x + t
        t += 0.25
    return o["s"]


def prev_none_large(x):
    o = {"s": 0.0, "h": []}
    y = np.repeat(x, 100)
    prev = None
    for v in y:
        if prev is not None:
            o["s"] += (v - prev) ** 2
        else:
            o["s"] += 1.0
        prev = v * v
    return o["s"]


def prev_none_enum(x):
    o = {"s": 0.0}
    prev = None
    for k, (v, w) in enumerate(zip(x, x[1:])):
        if prev is None:
            prev = (v, w * 2)
            continue
        if v > 5:
            break
        o["s"] += (v - prev[0]) ** 2 * k + prev[1]
        prev = (v * v, prev[0])
    return o["s"]


def prev_none_obj(x):
    class S:
        def __init__(self):
            self.prev = None
            self.t = x[1] * 0

        def step(self, v):
            if self.prev is None:
                d = v
            else:
                d = 1.5 * v - 0.5 * self.prev
            self.prev = v
            self.t += 0.1 * np.sum(d)
            return d

    s = S()
    u = x.copy()
    while s.t < 1.0:
        u = u + 0.1 * s.step(u)
    return np.sum(u * u)


def peel_return(x):
    def g(y):
        best = None
        for k in range(y.size):
            if best is None or y[k] > best:
                best = y[k]
            if best * k > 1.3:
                return best * 3
        return best

    return g(x) * g(0.1 * x)


def peel_break(x):
    d = {"m": None}
    for k in range(2, x.size):
        if x[0] > 0.1 * k and d["m"] is not None:
            break
        d["m"] = x[k] if d["m"] is None else d["m"] * x[k]
    return x[0]


def jumps_in_else(x):
    p = [x[0], x[1], x[2]]
    z = 0.0
    for a in range(3):
        for b in range(3):
            if p[a] * x[b] > 1.0:
                z = p[a]
                break
            z += x[b]
        else:
            continue
        z *= 2.0
    for a in range(3):
        for b in (0, 1):
            if x[a] * p[b] > 0.6:
                break
            z += p[b] * x[a]
        else:
            z *= x[3]
            break
        z += x[0]
    return z


def cases():
    for kernel in (
        newton,
        first,
        nested,
        after,
        timed,
        fin,
        prev_none,
        prev_none_while,
        prev_none_large,
        prev_none_enum,
        prev_none_obj,
        peel_return,
        peel_break,
        jumps_in_else,
    ):
        yield Case(kernel, (X,), "x")
