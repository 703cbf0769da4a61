"""A loop over a list that the loop writes reads each item when its round comes, as Python does; a part of a list, or a
list that is spelled out where the loop is, is made before the first round."""
from __future__ import annotations

import copy
from dataclasses import dataclass

import numpy as np
import pytest

import s2sad
from tests.derivatives import check_derivatives
from tests.engines import each, running


# -- lists of the kernel's own; x: (3,) -------------------------------------------------------------------------------

def written_in_the_loop(x):
    vs = [x[0], x[1], x[2]]
    s = 0.0
    for v in vs:
        vs[1] *= 2.0
        s += v
    return s


def enumerated(x):
    vs = [x[0], x[1], x[2]]
    s = 0.0
    for k, v in enumerate(vs):
        vs[1] *= 2.0
        s += v * (k + 1)
    return s


def zipped(x):
    vs = [x[0], x[1], x[2]]
    us = [x[1], x[2]]
    s = 0.0
    for u, v in zip(us, vs):
        vs[1] *= 2.0
        us[1] = us[0] * v
        s += v * u
    return s


def backwards(x):
    vs = [x[0], x[1], x[2]]
    s = 0.0
    for v in reversed(vs):
        vs[1] *= 2.0
        vs[0] += v
        s += v
    return s


def left_early(x):
    vs = [x[0], x[1], x[2]]
    s = 0.0
    for v in vs:
        vs[1] *= 2.0
        if v > 7.0:
            continue
        vs[2] += v
        s += v
        if s > 100.0:
            break
    return s


def bound_anew(x):
    vs = [x[0], x[1], x[2]]
    s = 0.0
    for v in vs:
        vs = [x[1] * v, x[2], s]
        s += v
    return s + vs[0]


def numbers_of_rows(x):
    rows = [[x[0], x[1]], [x[1], x[2]]]
    s = 0.0
    for u, v in rows:
        rows[1][0] *= 2.0
        s += u * v
    return s


def rows(x):
    rows = [[x[0], x[1]], [x[1], x[2]]]
    s = 0.0
    for u, v in rows:
        rows[1] = [v * v, u]
        s += u * v
    return s


def places(x):
    ks = [0, 1, 2, 0, 1]
    s = 0.0
    for k in ks:
        ks[4] = 2
        ks[3] = k
        s += x[k] * x[k]
    return s


def branches(x):
    bs = [True, True, False]
    s = 0.0
    for b in bs:
        bs[1] = not b
        if b:
            s += x[0] * (s + 1.0)
    return s


def arrays(x):
    us = [x * 1.0, x * 2.0, x * 3.0]
    s = 0.0
    for u in us:
        us[1] = us[1] + u
        us[2][0] *= 2.0
        s += u[0] * u[1]
    return s


def in_another_loop(x):
    vs = [x[0], x[1], x[2]]
    s = 0.0
    for k in range(2):
        for v in vs:
            vs[1] *= 1.5
            s += v * (k + 1.0)
            for w in vs:
                vs[2] += 0.5 * w
    return s


def turned(x):
    vs = [x[0], x[1], x[2]]
    s = 0.0
    for v in vs:
        vs[0], vs[1], vs[2] = vs[1], vs[2], vs[0]
        s = 2.0 * s + v
    return s


def its_own_target(x):
    vs = [x[0], x[1], x[2]]
    s = 0.0
    for vs[1] in vs:  # noqa: B020
        s = 2.0 * s + vs[1]
    return s


def with_else(x):
    vs = [x[0], x[1], x[2]]
    s = 0.0
    for v in vs:
        vs[1] *= 2.0
        if v > 100.0:
            break
        s += v
    else:
        s *= vs[1]
    return s


def made_before_the_loop(x):
    vs = [x[0], x[1], x[2]]
    s = 0.0
    for v in vs[:]:
        vs[1] *= 2.0
        s += v
    for v in vs[1:]:
        vs[2] *= 2.0
        s += v
    for v in [vs[0], vs[1], vs[2]]:
        vs[2] *= 2.0
        s += v
    for v in (vs[0], vs[1], vs[2]):
        vs[2] *= 2.0
        s += v
    return s


def a_row(x):
    rows = [[x[0], x[1]], [x[1], x[2]]]
    s = 0.0
    for v in rows[0]:
        rows[0][1] *= 2.0
        s += v * v
    return s


def in_a_while_loop(x):
    vs = [x[0], x[1], x[2]]
    s = 0.0
    while s < 20.0:
        for v in vs:
            vs[1] *= 1.25
            s += v
            if s > 19.0:
                break
    return s


def numbers_that_are_written(x):
    vs = [1.0, 2.0, 3.0, 4.0, 5.0]
    s = 0.0
    for v in vs:
        vs[3] = x[0] * s
        s += v * x[1]
    return s


def a_part_beside_the_whole(x):
    vs = [x[0], x[1], x[2]]
    s = 0.0
    for a, b in zip(vs, vs[1:]):
        vs[1] *= 2.0
        s += a * b
    return s


def summed_in_the_loop(x):
    vs = [x[0], x[1], x[2]]
    s = 0.0
    for v in vs:
        vs[1] += 1.0
        s += sum(v * w for w in vs)
    return s


def grown(x):
    vs = [x[k] for k in range(3)]
    s = 0.0
    for v in vs:
        vs[1] *= 2.0
        s += v
    return s


OWN = (
    written_in_the_loop, enumerated, zipped, backwards, left_early, bound_anew, numbers_of_rows, rows, places,
    branches, arrays, in_another_loop, turned, its_own_target, with_else, made_before_the_loop, a_row,
    in_a_while_loop, numbers_that_are_written, a_part_beside_the_whole, summed_in_the_loop, grown)


@pytest.mark.parametrize(("kernel", "engine"), each(OWN))
def test_a_list_of_a_kernel_is_read_in_each_round(kernel, engine):
    with running(engine):
        check_derivatives(kernel, [np.array([2.0, 3.0, 4.0])], ("x",), ("return",), engine=engine)


def written_and_bound_anew(x):
    vs = [x[0], x[1], x[2]]
    s = 0.0
    for v in vs:
        vs[1] *= 2.0
        vs = [x[1] * v, x[2], s]
        s += v
    return s


def test_a_list_that_is_written_and_bound_anew_is_refused():
    with pytest.raises(s2sad.S2sadError, match="a loop over 'vs' writes items of the list, and binds the name to ano"):
        s2sad.gradient(written_and_bound_anew, "x")(np.array([2.0, 3.0, 4.0]))


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


def leaves(value):
    """The floats in a value, in order."""
    if isinstance(value, np.ndarray):
        return list(value.ravel())
    if isinstance(value, (float, int)):
        return [value] if isinstance(value, float) else []
    parts = vars(value).values() if isinstance(value, Held) else value.values() if isinstance(value, dict) else value
    return [f for p in parts for f in leaves(p)]


def moved(value, steps):
    """A copy of a value whose floats have moved by the next of these steps."""
    if isinstance(value, np.ndarray):
        return value + np.reshape([next(steps) for _ in range(value.size)], value.shape)
    if isinstance(value, Held):
        return Held(**moved(vars(value), steps))
    if isinstance(value, dict):
        return {k: moved(v, steps) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return type(value)(moved(v, steps) for v in value)
    return value + next(steps) if isinstance(value, float) else value


@pytest.mark.parametrize(("kernel", "given", "engine"), each(GIVEN))
def test_a_structure_that_is_given_is_read_in_each_round(kernel, given, engine):
    parameters = kernel.__code__.co_varnames[:len(given)]
    with running(engine) as name:
        function = s2sad.differentiate(kernel, engine=name)
        for k, (parameter, argument) in enumerate(zip(parameters, given)):
            count = len(leaves(argument))
            if not count:
                continue
            value, found = s2sad.value_and_gradient(function, wrt=parameter)(*copy.deepcopy(given))

            def at(steps, k=k):
                return kernel(*[moved(a, iter(steps)) if j == k else copy.deepcopy(a) for j, a in enumerate(given)])
            shifts = 1e-5 * np.eye(count)
            assert value == pytest.approx(kernel(*copy.deepcopy(given)))
            assert leaves(found) == pytest.approx([(at(h) - at(-h)) / 2e-5 for h in shifts], rel=1e-6, abs=1e-6)
