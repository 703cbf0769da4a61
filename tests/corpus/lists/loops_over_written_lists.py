"""A loop over a list that the loop writes reads each item when its round comes, as Python does; a part of a list, or a
list that is spelled out where the loop is, is made before the first round."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case


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


def written_and_bound_anew(x):
    vs = [x[0], x[1], x[2]]
    s = 0.0
    for v in vs:
        vs[1] *= 2.0
        vs = [x[1] * v, x[2], s]
        s += v
    return s


def cases():
    x = np.array([2.0, 3.0, 4.0])
    for kernel in (
            written_in_the_loop, enumerated, zipped, backwards, left_early, bound_anew, numbers_of_rows, rows, places,
            branches, arrays, in_another_loop, turned, its_own_target, with_else, made_before_the_loop, a_row,
            in_a_while_loop, numbers_that_are_written, a_part_beside_the_whole, summed_in_the_loop, grown):
        yield Case(kernel, (x,), ("x",))
    yield Case(written_and_bound_anew, (x,), "x")
