"""`any` and `all` of a generator stop at the first item that answers them, of a list or an array they ask every one."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case


def halved(x, k):
    x[k] *= 0.5
    return x[k] > 0.1


def halved_and_large(x, k):
    x[k] *= 0.5
    return x[k] > 1.2


def large(x):
    return any(v > 3.0 for v in x)


def left_at_the_first(x):
    s = 0.0
    if any(halved(x, k) for k in range(3)):
        s += 1.0
    return s + x[0] + 10.0 * x[1] + 100.0 * x[2]


def asked_as_far_as_need_be(x):
    if any(x[k] > 0.1 and x[k + 2] > 0.1 for k in range(3)):
        return x[0]
    return x[1]


def left_at_the_first_that_fails(x):
    s = 0.0
    if all(halved_and_large(x, k) for k in range(3)):
        s += 1.0
    return s + x[0] + 10.0 * x[1] + 100.0 * x[2]


def turned_around(x):
    s = 0.0
    if not all(halved_and_large(x, k) for k in range(3)):
        s += 1.0
    b = any(x[k] > 1.9 for k in range(3) if x[k] != 1.5)
    if b:
        s += x[2]
    return s + x[0] + 10.0 * x[1] + 100.0 * x[2]


def several_loops(x):
    s = 0.0
    if any(halved_and_large(x, k) for j in range(2) for k in range(j, 3)):
        s += 1.0
    if all(x[k] < x[j] * 3.0 for k in range(3) if x[k] > 0.7 for j in range(3)):
        s += x[1]
    return s + x[0] + 10.0 * x[1] + 100.0 * x[2]


def of_a_list(x):
    if any([halved(x, k) for k in range(3)]):  # noqa: C419
        return x[0] + x[1] * 2.0 + x[2]
    return x[1]


def of_a_list_under_a_name(x):
    m = [x[0] > 1.0, x[1] > 100.0]
    if any(m) and not all(m):
        return x[0]
    return x[1]


def of_integers(x):
    ks = np.array([0, 1, 0])
    if any(k for k in ks):
        return x[0]
    return x[1]


def of_floats(x):
    if any(v for v in x):
        return x[0]
    return x[1]


def of_nothing(x):
    if all(v > 0.0 for v in x[:0]):
        return x[0]
    return x[1]


def one_in_another(x):
    if any(any(v > w + 1.5 for w in x) for v in x):
        return x[0] * x[2]
    return x[1]


def in_a_loop(x):
    s = 0.0
    while s < 30.0:
        go = any(v * 2.0 > s for v in x)
        if not go:
            break
        s += x[0] * x[1]
    return s


def by_a_helper(x):
    return x[0] if large(x) else x[1]


def of_an_array(x):
    if any(x > 3.0):
        return x[0]
    return x[1]


def what_was_asked_is_kept(x):
    asked = []

    def exceeds(v):
        asked.append(v * x[0])
        return v > 2.5
    found = any(exceeds(v) for v in x)
    return sum(asked) * (2.0 if found else 3.0) * len(asked)


EVERY = (
    left_at_the_first, asked_as_far_as_need_be, left_at_the_first_that_fails, turned_around, several_loops,
    of_a_list, of_a_list_under_a_name, of_integers, of_floats, of_nothing, one_in_another, in_a_loop, by_a_helper,
    of_an_array, what_was_asked_is_kept)


def cases():
    # generators are asked as far as python asks them
    for kernel in EVERY:
        given = [np.array([2.0, 3.0, 4.0])]
        changed = np.array(given[0])
        kernel(changed)
        of = ("return",) if np.array_equal(changed, given[0]) else ("x", "return")
        yield Case(kernel, given, ("x",), of)
