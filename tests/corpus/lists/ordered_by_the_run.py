"""sorted, min and max by what only the run knows: numbers, tuples, and objects, one of which a variable picks."""
from __future__ import annotations

import math

import numpy as np

from tests.corpus import Case


class Particle:
    def __init__(self, v, m):
        self.v, self.m = v, m


def an_array(x):
    s = sorted(x)
    return sum(i * v for i, v in enumerate(s)) + sorted(x, reverse=True)[0] * 2 + s[-1] ** 2


def numbers(x):
    s = sorted([x[0] ** 2, x[1] * x[2], x[3]])
    return s[0] + 2 * s[1] + 3 * s[2]


def by_a_key(x):
    s = sorted(x, key=lambda v: -v * v)
    t = sorted([x[0], x[1] * 2, x[2]], key=lambda v: abs(v - 0.6), reverse=True)
    return s[0] * 3 + s[-1] + t[0] * 10 + t[1] + max((x[0], x[1]), key=abs)


def equal_keys(x):
    """Of equal ones the first stays the first, also backwards."""
    up = sorted([x[0], x[1], x[2]], key=lambda v: 0.0 * v)
    down = sorted([x[0], x[1], x[2]], key=lambda v: 0.0 * v, reverse=True)
    first = max([x[3], x[4]], key=lambda v: 0.0 * v)
    return up[0] + 2 * up[1] ** 2 + 3 * down[0] ** 3 + first


def tuples(x):
    pairs = sorted([(x[0], 1), (x[1] ** 2, 2), (x[2], 3)], key=lambda p: -p[0])
    s = 0.0
    for k, (a, i) in enumerate(pairs):
        s += a * i * (k + 1)
    return s + pairs[0][0] ** 2


def the_extreme_objects(x):
    ps = [Particle(v, i + 1.0) for i, v in enumerate(x)]
    best = max(ps, key=lambda p: p.v * math.cos(p.m))
    worst = min(ps, key=lambda p: p.v * p.m)
    best.v *= 2
    return best.v * best.m + worst.v ** 2 * worst.m + sum(p.v for p in ps)


def objects(x):
    ps = [Particle(v, i + 1.0) for i, v in enumerate(x[:3])]
    ps.sort(key=lambda p: p.v)
    s = ps[0].v ** 2
    for i, p in enumerate(ps):
        s += p.v * p.m * (i + 1)
    return s


def a_population(x):
    pop = [x[0], x[1], x[2]]
    for _ in range(3):
        pop = sorted(pop, key=lambda v: (v - 0.617) ** 2)
        pop = [pop[0], 0.5 * (pop[0] + pop[1]), pop[1] * 1.1]
    return pop[0] + pop[1] * 2 + pop[2] * 3


def an_array_of_some(x):
    some = [x * 1.0, np.sin(x), x ** 2]
    b = min(some, key=lambda c: np.sum((c - 0.5) ** 2))
    b[0] = 3.0 * x[1]
    return np.sum(b ** 2) + some[0][0] + some[2][0] * 5


def a_name(x):
    losses, weights = {"a": x[0], "b": x[1] ** 2, "c": x[2]}, {"a": 1.0, "b": 2.0, "c": 3.0}
    k, v = min(losses.items(), key=lambda kv: kv[1])
    best = min(losses, key=losses.get)
    return v * weights[k] + (losses[best] * 2 if best == "a" else losses[best] * 3)


def by_tuples(x):
    return sorted([x[0], x[1]], key=lambda v: (v > 0.5, v))[0]


def backwards_in_a_generator(x):
    return sum(v * (i + 1) for i, v in enumerate(sorted(x, reverse=True)))


def many_objects(x):
    ps = [Particle(x[k % 5] * k, 1.0) for k in range(20)]
    return max(ps, key=lambda p: p.v).v


def five_objects(x):
    ps = sorted([Particle(v, 1.0) for v in x], key=lambda p: p.v)
    return sum(i * p.v for i, p in enumerate(ps))


def of_the_run(x):
    us = [v * v for v in x if v > 0.4]
    s = sum((k + 1) * u for k, u in enumerate(sorted(us)))
    s += sum((k + 1) * u ** 2 for k, u in enumerate(sorted(us, reverse=True)))
    us.sort(key=lambda v: (v - 0.6) ** 2, reverse=True)
    return s + us[0] * us[1]


def rows_of_the_run(x):
    us = [(v * v, np.sin(3 * v)) for v in x if v > 0.4]
    s = 0.0
    for k, (a, b) in enumerate(sorted(us, key=lambda p: p[1])):
        s += (k + 1) * a * b
    for k, (a, b) in enumerate(sorted(us)):
        s += (k + 1) * a * b ** 2
    return s + min(us)[0] * max(us)[1] + max(us, key=lambda p: p[1] - p[0])[0]


def equal_ones_of_the_run(x):
    us = [(k % 3, x[k % 5], k) for k in range(7) if x[k % 5] > 0.0]
    s = 0.0
    for j, (_, b, c) in enumerate(sorted(us, key=lambda u: u[0], reverse=True)):
        s += (j + 2) * b * (c + 1)
    for j, (_, b, c) in enumerate(sorted(us, reverse=True)):
        s += (j + 3) * b ** 2 * (c + 1)
    m, n = max(us, key=lambda u: u[0]), min(us, key=lambda u: (u[0], 1))
    us.sort(key=lambda u: u[0])
    return s + m[1] * m[2] + n[1] * (n[2] + 3) + sum((j + 1) * b for j, (_, b, _) in enumerate(us))


def objects_of_the_run(x):
    ps = []
    for k, v in enumerate(x):
        if v > 0.4:
            ps.append(Particle(v, k + x[0]))
    ps.sort(key=lambda p: p.m * p.v)
    best = min(ps, key=lambda p: (p.v - 0.5) ** 2)
    last = sorted(ps, key=lambda p: (-p.v, p.m))[-1]
    return sum((k + 1) * p.v ** 2 for k, p in enumerate(ps)) + best.m * best.v + last.m


def arrays_with_numbers(x):
    ps = []
    for v in x:
        if v > 0.4:
            ps.append((np.sum(np.cos(x * v)), x * v))
    ps.sort(key=lambda p: p[0])
    return np.sum(ps[0][1] ** 2) + ps[-1][0] + min(ps, key=lambda p: -p[0])[1][1]


def known_rows(x):
    ps = [(np.sin(3 * v), k, v) for k, v in enumerate(x)]
    a, b = min(ps), max((x[0], 1), (x[1], 2), (x[2], x[3]))
    c = sorted((np.cos(v), k) for k, v in enumerate(x))
    return a[0] * (a[1] + 1) + b[0] * b[1] + c[1][0] * c[2][1] + min(x, key=lambda v: (int(2 * v + 0.3), -v))


def simplex(x):
    """Nelder and Mead's."""
    def f(p):
        return (p[0] - x[0]) ** 2 + 2 * (p[1] - x[1] * p[0]) ** 2 + x[2] * p[0]
    at = [np.array([0.0, 0.0]), np.array([1.0, 0.1]), np.array([0.2, 1.0])]
    for _ in range(12):
        at.sort(key=f)
        middle = (at[0] + at[1]) / 2
        beyond = 2 * middle - at[2]
        if f(beyond) < f(at[0]):
            further = 3 * middle - 2 * at[2]
            at[2] = further if f(further) < f(beyond) else beyond
        elif f(beyond) < f(at[1]):
            at[2] = beyond
        else:
            inside = 0.5 * (middle + at[2])
            if f(inside) < f(at[2]):
                at[2] = inside
            else:
                at = [at[0]] + [0.5 * (at[0] + p) for p in at[1:]]
    return f(at[0])


def arrays_by_a_key(x):
    several = [x * 2.0, x[::-1] * 1.5, np.sin(x)]
    best = max(several, key=lambda p: p[0] - p[1])
    pairs = sorted([(np.sum((x - k) ** 2), x * k) for k in range(4)], key=lambda t: t[0])
    return np.sum(best ** 2) + min(several, key=np.sum)[0] + np.sum(pairs[0][1] ** 2) + pairs[-1][0]


def written_behind(x):
    several = [x * 2.0, x[::-1] * 1.5, np.sin(x)]
    several.sort(key=lambda p: p[0])
    several[0] *= 2.0
    return np.sum(several[0] * several[1])


EVERY = (simplex, arrays_by_a_key, of_the_run, rows_of_the_run, equal_ones_of_the_run, objects_of_the_run,
         arrays_with_numbers, known_rows, by_tuples, an_array, numbers, by_a_key, equal_keys, tuples,
         the_extreme_objects, objects, a_population, an_array_of_some, a_name)


def extremes_of_no_items(x, level):
    tops = [x[i] for i in range(1, len(x) - 1) if x[i - 1] < x[i] > x[i + 1] and x[i] > level]
    found = []
    for v in x:
        if v > level:
            found.append(v * v)
    some = min((v * v for v in x), default=1.0) + max([], default=x[1])
    return max(tops, default=0.5 * x[0]) + some * max(found, default=1.0) * min(found, default=x[2])


def cases():
    x = np.array([0.31, 0.93, 0.5, 1.2, 0.7])
    for kernel in EVERY:
        yield Case(kernel, (x,), "x")
    for kernel in (backwards_in_a_generator, many_objects, five_objects):
        yield Case(kernel, (x,), "x")
    yield Case(written_behind, (x,), refused=(
        "S201 at `several[0] *= 2.0`: an array is written that another name may stand for here, as it did before a "
        "loop or branch bound it anew: bind the name to a copy before the loop or branch: u = u.copy(); where names "
        "swap in a branch, swap what their arrays hold"))
    for level in (0.4, 9.0):
        yield Case(extremes_of_no_items, (x, level), "x")
