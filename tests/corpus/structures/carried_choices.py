"""Loops that carry one of several things, of which each way has another one: under names that only some ways bind, in
one another, exchanged."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case


class Particle:
    def __init__(self, v, m):
        self.v, self.m = v, m


def the_tuple_before(x):
    best = None
    s = 0.0
    for i in range(x.size):
        old = best
        if x[i] > 0.4:
            best = (x[i], i)
        if old is not None and best is not None:
            s += old[0] * best[0] * (best[1] - old[1])
    return s


def best_and_second(x):
    best, second = None, None
    for i in range(x.size):
        if best is None or x[i] > best[0]:
            second = best
            best = (x[i], i)
        elif second is None or x[i] > second[0]:
            second = (x[i], i)
    return best[0] * 2 + second[0] * second[1]


def made_on_one_way(x):
    d = {"k": None}
    s = 0.0
    for i in range(x.size):
        d["k"] = (x[i], i) if x[i] > 0.6 else None
        if d["k"] is not None:
            a, j = d["k"]
            s += a * a * j
    return s


def read_before_it_is_made(x):
    d = {"k": None}
    s = 0.0
    for i in range(x.size):
        if d["k"] is not None:
            s += d["k"][0] * x[i]
        d["k"] = (x[i] ** 2, i) if x[i] > 0.6 else None
    return s


def made_on_two_of_three_ways(x):
    s = 0.0
    last = None
    for i in range(x.size):
        a = x[i] ** 2
        if x[i] > 0.6:
            last = (a, i)
        elif x[i] > 0.4:
            last = (x[i], 2 * i)
        else:
            last = None
        if last is not None:
            s += last[0] * (1 + last[1])
    return s


def swapped(x):
    a, b = None, None
    s = 0.0
    for i in range(x.size):
        if x[i] > 0.6:
            a = (x[i] ** 2, i)
        elif x[i] < 0.4:
            b = (x[i] ** 3, 2 * i)
        a, b = b, a
        if a is not None:
            s += a[0] * (1 + a[1])
        if b is not None:
            s -= 0.5 * b[0] * s
    return s


def rotated(x):
    a, b, c = None, None, None
    s = 0.0
    for i in range(x.size):
        n = (x[i], i) if x[i] > 0.4 else None
        a, b, c = n, a, b
        if c is not None:
            s += c[0] * x[i] * (c[1] + 1)
        elif b is not None:
            s += b[0] ** 3
    return s


def the_arrays_before(x):
    best = old = None
    s = 0.0
    for i in range(x.size):
        v = np.sin(x * (i + 1))
        if x[i] > 0.4:
            old = best
            best = (v, x[i])
        if old is not None:
            s += np.sum(old[0] ** 2) * old[1]
    if best is not None:
        s += np.sum(best[0])
    return s


def left_by_a_break(x):
    last = None
    prev = None
    i = 0
    s = 0.0
    while i < x.size:
        prev = last
        if x[i] > 1.0:
            last = (x[i], s)
            if prev is not None:
                break
        elif x[i] > 0.4:
            last = (x[i] ** 2, x[i])
        else:
            last = None
        s += 1.0 if last is None else last[0] * last[1]
        i += 1
    if prev is not None:
        s += 10 * prev[0]
    return s + (last[0] if last is not None else 0.0)


def the_object_before(x):
    d = {"best": None, "prev": None}
    for i in range(x.size):
        p = Particle(x[i] ** 2, i + 1.0) if x[i] > 0.4 else None
        if p is not None:
            d["prev"] = d["best"]
            d["best"] = p
    r = 0.0
    for k, w in (("best", 1.0), ("prev", 2.0)):
        if d[k] is not None:
            r += w * d[k].v * d[k].m
    return r


def in_nested_loops(x):
    best = None
    total = 0.0
    for i in range(x.size):
        old = best
        for j in range(3):
            d = x[i] * (j - 0.7)
            if d > 0.5 and (best is None or d > best[0]):
                best = (d, x[i], j)
        if old is not None:
            total += old[0] * old[1]
        if best is not None:
            total += best[1] * best[2]
    return total


def a_tuple_a_number_or_none(x):
    r = None
    s = 0.0
    for i in range(x.size):
        if x[i] > 1.0:
            r = (x[i], x[i - 1])
        elif x[i] > 0.6:
            r = x[i] ** 2
        else:
            r = None
        q = r
        if q is None:
            s += 1.0
        elif isinstance(q, tuple):
            s += q[0] * q[1]
        else:
            s += 3 * q
    return s


def one_in_another(x):
    hold = None
    s = 0.0
    for i in range(x.size):
        if hold is not None:
            if hold[0] is not None:
                s += hold[0] ** 2 * x[i]
            s += hold[1]
        inner = x[i] if x[i] > 0.8 else None
        if x[i] > 0.4:
            hold = (inner, x[i] * 2)
        elif x[i] < 0.15:
            hold = None
    return s


def one_in_an_object(x):
    cur = None
    s = 0.0
    for i in range(x.size):
        if cur is not None:
            s += cur.v * x[i]
            if cur.m is not None:
                s += cur.m[0] * cur.m[1]
        if x[i] > 0.25:
            cur = Particle(x[i] ** 2, (x[i], i) if x[i] > 0.6 else None)
        elif x[i] < 0.15:
            cur = None
    if cur is not None and cur.m is not None:
        s += 5 * cur.m[0]
    return s


def one_in_a_tuple(x):
    cur = (0.1, None)
    s = 0.0
    for i in range(x.size):
        a, b = cur
        s += a * x[i]
        if b is not None:
            s += b
        if x[i] > 0.6:
            cur = (x[i], a ** 2)
        elif x[i] > 0.25:
            cur = (s * 0.1, None)
    return s


def three_deep(x):
    h = None
    s = 0.0
    for i in range(x.size):
        if h is not None:
            s += h[0]
            if h[1] is not None:
                s += h[1][0] * 2
                if h[1][1] is not None:
                    s += h[1][1] * x[i]
        if x[i] > 0.15:
            h = (x[i], (x[i] ** 2, x[i] ** 3 if x[i] > 0.6 else None) if x[i] > 0.25 else None)
        else:
            h = None
    return s


def not_asked_whether_it_is_there(x):
    """What Python raises where it is None, a run raises that comes there."""
    last, on, s = None, False, 0.0
    for i in range(x.size):
        if not on and x[i] > 0.8:
            on = True
            if last is not None:
                s += (x[i] - last[1]) * (i - last[0])
            last = (i, x[i])
        elif on and (x[i] < 0.4 or last[1] < 0.1):
            on = False
            before, last = last, (i, x[i] * x[i])
            s -= before[1] * last[1]
        s += x[i] if on else 0.1 * x[i]
    return s


def a_state_with_its_number(x):
    mode, info, s = "idle", None, 0.0
    for i in range(x.size):
        if mode == "idle" and x[i] > 0.4:
            mode, info = "run", x[i]
        elif mode == "run":
            if x[i] < info:
                mode, info = "idle", None
            else:
                info = x[i] * 0.5 + info
        s += info ** 2 if info is not None else 0.1 * x[i]
    return s


def bound_on_some_ways(x):
    last, s = None, 0.0
    for i in range(x.size):
        if x[i] > 0.55:
            t = (x[i], i) if x[i] > 0.8 else None
        if last is not None:
            s += last[0] * x[i]
        last = t
    return s


class Well:
    def __init__(self, at, depth):
        self.at, self.depth = at, depth


def each_with_each_other(x):
    """Four of six things: 6 ** 4 combinations."""
    wells = [Well(0.2 * k, x[0] * (k + 1)) for k in range(6)]
    a = min(wells, key=lambda w: (w.at - x[0]) ** 2)
    b = min(wells, key=lambda w: (w.at - x[1]) ** 2)
    c = max(wells, key=lambda w: (w.at - x[0]) ** 2)
    d = max(wells, key=lambda w: (w.at - x[1]) ** 2)
    return a.depth * b.depth + c.depth * d.depth


def none_within_a_dictionary(x):
    """What is new in a round is another dictionary, and `break` is within a branch of a branch."""
    best, bad = {"loss": float("inf"), "w": None, "at": -1}, 0
    for k in range(20):
        v = (x[k % x.size] - 0.9) ** 2 + 0.02 * k
        if v < best["loss"]:
            best = {"loss": v, "w": x * k, "at": k}
            bad = 0
        else:
            bad += 1
            if bad >= 3:
                break
    return best["loss"] + np.sum(best["w"] ** 2) * 0.1 + best["at"]


def none_within_a_tuple(x):
    state = (0.0, None)
    s = 0.0
    for k in range(20):
        if state[1] is not None and state[1] > 1.0:
            s += state[0] * state[1]
            state = (state[0] * 0.5, None)
            if s > 4.0:
                break
        else:
            state = (state[0] + x[k % x.size], x[k % x.size] * (1.0 if state[1] is None else 1.5 + state[1]))
    return s + state[0]


def until_there_is_one(x):
    best, k = None, 0
    while best is None or best[0] < 2.0:
        s = x[k % x.size] * (1 + 0.3 * k)
        if best is None or s > best[0]:
            best = (s, x * s)
        k += 1
    return best[0] * np.sum(best[1])


def until_it_stays(x):
    previous, k, s = None, 0, 0.0
    while previous is None or abs(previous - s) > 1e-3:
        k += 1
        if k % 3 == 2:
            s += 0.01 * x[0]
            continue
        previous = s
        s = 0.5 * s + x[0] * x[1]
        if k > 30:
            break
    return s + previous


EVERY = (
    until_there_is_one, until_it_stays,
    not_asked_whether_it_is_there, a_state_with_its_number,
    the_tuple_before, best_and_second, made_on_one_way, read_before_it_is_made, made_on_two_of_three_ways,
    swapped, rotated, the_arrays_before, left_by_a_break, the_object_before,
    in_nested_loops, a_tuple_a_number_or_none, one_in_another, one_in_an_object, one_in_a_tuple,
    three_deep, none_within_a_dictionary, none_within_a_tuple)


def cases():
    for kernel in EVERY:
        yield Case(kernel, (np.array([0.91, 0.3, 0.5, 0.2, 0.7, 1.2, 0.1]),), "x")
    yield Case(the_tuple_before, (np.array([0.1, 0.7, 1.2, 0.2, 0.5, 0.3, 0.91]),), "x")
    yield Case(one_in_another, (np.array([0.1, 0.7, 1.2, 0.2, 0.5, 0.3, 0.91]),), "x")
    yield Case(bound_on_some_ways, (np.array([0.9, 0.5]),), refused=(
        "S201 at `t`: 't' is bound on one way only: bind it before the branch or the loop, too"))
    yield Case(each_with_each_other, (np.array([0.9, 0.5]),), refused=(
        "S201 at `d`: statements that read one of several things would be evaluated over 1000 times, once for each "
        "combination: read of each what is needed into arrays or numbers first"))
