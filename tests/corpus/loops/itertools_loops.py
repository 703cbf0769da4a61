"""Loops through combinations of ranges, and elements by their number in the order of rows."""
from __future__ import annotations

import itertools
from itertools import combinations, product

import numpy as np

from tests.corpus import Case

A = np.array([[0.3, -0.9, 0.7], [0.5, 0.2, -0.6], [1.1, 0.4, -0.2]])


def products(a):
    total = 0.0
    for i, j in itertools.product(range(a.shape[0]), range(1, 3)):
        if a[i, j] < -0.8:
            continue
        total += a[i, j] ** 2 * (i + 2 * j)
    for i, j, k in product(range(2), repeat=3):
        if i + j + k == 3:
            break
        a[i, j] *= a[j, k] + 1.0
    found = sum(a[i, j] * a[j, k] for i, j, k in product(range(2), range(len(a)), range(1, 2)) if i < j)
    return total + i * j + k + found + np.sum(np.array([a[i, j] ** 2 for i, j in product(range(2), range(3))]) ** 2)


def pairs(a):
    total = 0.0
    for i, j in combinations(range(3), 2):
        total += (a[i, 0] - a[j, 0]) ** 2 * (i + 1)
    for k, m in itertools.combinations_with_replacement(range(1, 3), 2):
        total += a[k, 1] * a[m, 1] * (k + 2 * m)
    triples = sum(a[i, j] * a[k, 0] for i, j, k in itertools.combinations(range(3), 3))
    a[0, 1] *= 2.0
    return total + i * a[0, 0] + triples ** 2 + sum(a[i, 0] * a[j, 2] for i, j in combinations(range(3), 2))


def numbered(a):
    b = a * a
    b.flat[4] = a[0, 0]
    b.flat[-1] = b.flat[1] * a.flat[5]
    part = a.flat[1:3]
    part[0] = 5.0
    total = np.sum(b ** 2) + np.sum(part * a[0, :2]) + a.item(7) * b.item(-2) + a[1].item(2)
    for v in a.flat:
        total += v ** 3
    for k in range(3):
        a.flat[2 * k] = a.flat[k] * total
    return total + np.sum(a.T.copy())


def around(a):
    i = 2
    return sum(a[i, j] ** 2 for i, j in product(range(3), range(i))) * a[i, 0]


def of_a_view(a):
    b = a.T
    b.flat[1] = a[0, 0] ** 2
    return np.sum(a ** 2 * np.arange(9.0).reshape(3, 3))


def of_arrays(a):
    return sum(u * v for u, v in product(a[0], a[1]))


def left(a):
    total = 0.0
    for i, j in combinations(range(3), 2):
        if a[i, j] > 1.0:
            break
        total += a[i, j]
    return total


def of_an_element(a, k):
    total = 0.0
    for i, j in combinations(range(k[0]), 2):
        k[0] -= 1
        total += a[i, j]
    return total


def smoothed(values, share):
    it = iter(values)
    s = next(it)
    yield s
    for v in it:
        s = share * v + (1 - share) * s
        yield s


def rest_of_an_iterator(a):
    it, terms = iter(a[0]), iter([a[1, 0], a[1, 1] ** 2, a[2, 0]])
    first, s = next(it), next(terms)
    for k, (u, v) in enumerate(zip(it, a[1])):
        s += first * u * v * k
    return s * sum([v ** 2 for v in terms]) + sum(smoothed(a[2], 0.3)) * list(smoothed(a[1], 0.4))[-1]


def asked_behind_a_loop(a):
    it, s = iter(a[0]), 0.0
    for v in it:
        s += v
        if s > 0.5:
            break
    return s + next(it, 0.0)


def counted(a):
    y, n = a[0, 0] * 1.0, len(a)
    for k in itertools.count():
        y = y * 0.8 + a[1, k % 3] * k
        if y > 1.0 or k > 10:
            break
    for j in range(2):
        for m in itertools.count(j, 2):
            if m >= n:
                break
            if m == 1:
                continue
            y = y * 0.5 + a[m, j] ** 2
    return y * k


def returned_from(a):
    def last(y):
        for k in itertools.count(start=3):
            y = y * a[k - 3, 0] + k
            if k == 5:
                break
        return y * k
    return last(a[0, 0] * 1.0)


def asked_of_items(a):
    s = 0.0
    for v in a[0]:
        s += v if v.note is None else v * v
    return s


def tested_of_items(a):
    s = 0.0
    for v in a[0]:
        if v.note == 3 or not v.flag:
            s += v
    return s


def in_memory_order(a):
    total = 0.0
    for v in np.nditer(a):
        total += v
    return total


def written_in_memory_order(a):
    with np.nditer(a, op_flags=["readwrite"]) as elements:
        for v in elements:
            v[...] = 2.0 * v
    return np.sum(a)


def cases():
    for kernel in (products, pairs, numbered):
        yield Case(kernel, (A,), ("a",), ("a", "return"))
    yield Case(of_arrays, (A,), ("a",))
    # the bound is read around the generator
    yield Case(around, (A,), ("a",))
    # a view is written through
    yield Case(of_a_view, (A,), ("a",), ("a", "return"))
    yield Case(left, (A,), "a")
    yield Case(of_an_element, (A, np.array([3])), "a")
    yield Case(rest_of_an_iterator, (A,), "a")
    yield Case(counted, (A,), "a")
    yield Case(returned_from, (A,), "a")
    for kernel, place in ((asked_of_items, "v.note is None"), (tested_of_items, "v.note == 3")):
        yield Case(kernel, (A,), refused=f"S201 at `{place}`: no number and no array has an attribute .note: ask for "
                   "what there is, as .shape, .ndim and .size of an array")
    yield Case(asked_behind_a_loop, (A,), refused="S201 at `next(it, 0.0)`: an iterator is asked that something has "
               "gone through: make it a list: list(...)")
    for kernel, call in ((in_memory_order, "np.nditer(a)"),
                         (written_in_memory_order, 'np.nditer(a, op_flags=["readwrite"])')):
        yield Case(kernel, (A,), refused=f"S201 at `{call}`: np.nditer, which goes through an array as its elements "
                   "lie in memory: write for v in x.flat: to read them, for i in np.ndindex(x.shape): to write x[i]")
