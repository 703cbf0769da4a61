"""Kernels that loop over lists, dictionaries and objects that are given, and write them."""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np


# -- lists, dictionaries and objects that are given -----------------------------------------------------------------

@dataclass
class Held:
    items: list
    a: float


def doubled(us, v):
    us[1] *= 2.0
    return v


def push(us, v):
    us[2] += v


def added(us, v):
    us[2] += v
    return v * us[1]


def given(us):
    s = 0.0
    for v in us:
        us[1] *= 2.0
        s += v
    return s


def given_enumerated(us):
    s = 0.0
    for k, v in enumerate(us):
        us[1] *= 2.0
        if v > 7.0:
            continue
        us[2] += v
        s += v * (k + 1)
    return s + us[2]


def given_backwards(us):
    s = 0.0
    for v, w in zip(us, reversed(us)):
        us[1] *= 2.0
        us[0] += w
        if s > 1000.0:
            break
        s += v * w
    return s


def given_parts_left_early(us):
    s = 0.0
    for v in us[:]:
        us[1] *= 2.0
        if s > 1000.0:
            break
        s += v
    for v in us[1:]:
        us[2] *= 2.0
        if s > 1000.0:
            break
        s += v
    return s


def given_parts(us):
    s = 0.0
    for v in us[:]:
        us[1] *= 2.0
        s += v
    for v in us[1:]:
        us[2] *= 2.0
        s += v
    return s


def given_numbers_in_a_list(us):
    s = 0.0
    for v in [us[0], us[1], us[2]]:
        us[1] *= 2.0
        if s > 1000.0:
            break
        s += v
    return s


def given_and_summed(us):
    return sum(doubled(us, v) for v in reversed(us)) + sum([doubled(us, v) for v in us])


def given_to_a_helper(us):
    s = 0.0
    for v in us:
        s += doubled(us, v)
        if s > 1000.0:
            break
    return s


def values_of_a_dictionary(x):
    d = {"a": x[0], "b": x[1], "c": x[2]}
    s = 0.0
    for v in d.values():
        d["b"] *= 2.0
        if s > 100.0:
            continue
        s += v
    return s


def values_of_a_given_dictionary(d):
    s = 0.0
    for v in d.values():
        d["b"] *= 2.0
        if s > 100.0:
            continue
        s += v
    return s


def a_field(s):
    t = 0.0
    for v in s.items:
        s.items[1] *= 2.0
        if t > 100.0:
            break
        t += v * s.a
    return t


def given_arrays(us):
    s = 0.0
    for u in us:
        us[1][0] *= 2.0
        if s > 1e5:
            continue
        s += u[0] * u[1]
    return s


def given_rows(us):
    s = 0.0
    for u, v in us:
        us[1][0] *= 2.0
        if s > 1e5:
            break
        s += u * v
    return s


def given_turned(us):
    s = 0.0
    for v in us:
        us[0], us[1], us[2] = us[1], us[2], us[0]
        if s > 1e5:
            break
        s = 2.0 * s + v
    return s


def given_in_another_loop(us, x):
    s = 0.0
    for k in range(3):
        for v in us:
            us[1] *= 1.5
            if v > 5.0:
                break
            s += v * x[k]
    return s


def given_places(ks, x):
    s = 0.0
    for k in ks:
        ks[1] = 2
        if s > 1e5:
            break
        s += x[k] * x[k]
    return s


def given_bound_anew(us):
    s = 0.0
    for v in us:
        us = [s, v, 2.0 * v]
        s += v
    return s + us[0]


def given_beside_its_parts(us):
    s = 0.0
    for v, w, z in zip(us, [us[0], us[1], us[2]], us[:]):
        us[1] *= 2.0
        us[2] += v
        s += v * w * z
    for v, w, z in zip(us, [us[0], us[1], us[2]], us[:]):
        us[1] *= 2.0
        us[2] += v
        if s > 1e9:
            break
        s += v * w * z
    return s


def a_dictionary_beside_numbers(x):
    d = {"a": 1.0, "b": x[1], "c": x[2]}
    s = 0.0
    for v, w in zip(d.values(), (x[0], x[1], x[2])):
        d["c"] *= 2.0
        d["a"] = 3.0
        if s > 1e9:
            break
        s += v * w
    return s


def under_another_name(us):
    s = 0.0
    ws = us
    for v in us:
        ws[1] *= 2.0
        if s > 1e9:
            break
        s += v
    for v in us[:]:
        zs = us
        zs[2] *= 2.0
        s += v
    return s


def rows_in_rows(us):
    s = 0.0
    for r in us:
        for v in r:
            us[1][0] *= 2.0
            if v > 90.0:
                break
            s += v * v
        for v in r[:]:
            r[1] *= 2.0
            s += v * v
    return s


def a_helper_that_adds(us):
    s = 0.0
    for v in us:
        push(us, v)
        if s > 1e9:
            continue
        s += v * v
    for v in us[1:]:
        push(us, v)
        s += v * v
    return s


def summed_twice(us):
    return sum(added(us, v) * w for v in us for w in us)


def a_given_tuple_bound_anew(t):
    s = 0.0
    for v in t:
        t = (t[1], t[2], v * s)
        if s > 1e9:
            break
        s += v * t[0]
    return s


def given_with_else(us):
    s = 0.0
    for v in us:
        us[1] *= 2.0
        if s > 1e9:
            break
        s += v
    else:
        s *= us[1]
    return s


def objects_in_a_tuple(m):
    for s in (m["a"], m["b"], m["a"]):
        s.a *= 1.5
        m["b"].a += s.a
    for s in [m["a"], m["b"]][::-1]:
        m["b"].a += s.a
    for s, w in ((m["a"], m["a"].a), (m["b"], m["b"].a)):
        m["b"].a += s.a * w
        m["a"].a *= 2.0
        s.a += w
    return m["a"].a * m["b"].a


def rows_in_parts(us):
    s = 0.0
    for r in us[:]:
        us[1][0] *= 2.0
        s += r[0] * r[1]
    for r, v in zip(us[::-1], us[0]):
        us[1][0] *= 2.0
        us[0][1] += v
        s += r[0] * r[1] * v
    for r, v in zip(us[::-1], us[0][:]):
        us[1][0] *= 2.0
        us[0][1] += v
        s += r[0] * r[1] * v
    return s


X = np.array([2.0, 3.0, 4.0])
GIVEN = [
    (objects_in_a_tuple, ({"a": Held([], 2.0), "b": Held([], 3.0)},)),
    (rows_in_parts, ([[2.0, 3.0], [4.0, 5.0]],)),
    (given, ([2.0, 3.0, 4.0],)),
    (given_enumerated, ([2.0, 3.0, 4.0],)),
    (given_backwards, ([2.0, 3.0, 4.0],)),
    (given_parts_left_early, ([2.0, 3.0, 4.0],)),
    (given_parts, ([2.0, 3.0, 4.0],)),
    (given_numbers_in_a_list, ([2.0, 3.0, 4.0],)),
    (given_and_summed, ([2.0, 3.0, 4.0],)),
    (given_to_a_helper, ([2.0, 3.0, 4.0],)),
    (values_of_a_dictionary, (X,)),
    (values_of_a_given_dictionary, ({"a": 2.0, "b": 3.0, "c": 4.0},)),
    (a_field, (Held([2.0, 3.0, 4.0], 1.5),)),
    (given_arrays, ([np.array([2.0, 3.0]), np.array([4.0, 5.0]), np.array([1.5, 2.5])],)),
    (given_rows, ([[2.0, 3.0], [4.0, 5.0]],)),
    (given_turned, ([2.0, 3.0, 4.0],)),
    (given_in_another_loop, ([2.0, 3.0, 4.0], X)),
    (given_places, ([0, 1, 2], X)),
    (given_bound_anew, ([2.0, 3.0, 4.0],)),
    (given_beside_its_parts, ([2.0, 3.0, 4.0],)),
    (a_dictionary_beside_numbers, (X,)),
    (under_another_name, ([2.0, 3.0, 4.0],)),
    (rows_in_rows, ([[2.0, 3.0], [4.0, 5.0]],)),
    (a_helper_that_adds, ([2.0, 3.0, 4.0],)),
    (summed_twice, ([2.0, 3.0, 4.0],)),
    (a_given_tuple_bound_anew, ((2.0, 3.0, 4.0),)),
    (given_with_else, ([2.0, 3.0, 4.0],)),
]
