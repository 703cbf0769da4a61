"""Parts and copies of lists whose length only the run knows are lists of their own."""
from __future__ import annotations

from collections import deque

import numpy as np

from tests.corpus import Case

X = np.array([0.3, 0.55, 0.8, 0.2, 0.7, 0.9])


def path(x):
    v = [x[0] * 1.0]
    k = 1
    while v[-1] < 2.0 and k < len(x):
        v.append(v[-1] * 1.2 + x[k] ** 2)
        k += 1
    return v


def copied(x):
    v = path(x)
    w = v[:]
    for i in range(1, len(v)):
        v[i] = v[i] * w[i - 1]
    return sum(v) + w[-1]


def by_list_and_copy(x):
    v = path(x)
    a, b = list(v), v.copy()
    v[0] = a[-1] * b[1]
    b[0] = v[0] ** 2
    return v[0] * a[0] + b[0] * b[1]


def bounds(x, m):
    v = path(x)
    late, early, inner, last, none, every = v[1:], v[:-1], v[m:m + 2], v[-m:], v[3:1], v[::2]
    s = 0.0
    for i in range(len(late)):
        s += late[i] * early[i]
    return s + inner[0] * inner[-1] + last[0] ** 3 + len(none) + every[1] ** 2 + len(every)


def backwards(x, m):
    v = path(x)
    a, b, c, d = v[::-1], list(reversed(v)), v[m::-1], v[:-m:-2]
    v[0] = 3.0
    s = 0.0
    for k in range(len(a)):
        s = s * 0.5 + a[k] * b[-1 - k]
    return s + c[0] * c[-1] ** 2 + d[0] ** 3 + len(c) + len(d)


def gone_through_backwards(x):
    v = path(x)
    s = 0.0
    for item in v[::-1]:
        s = s * 0.5 + item
    for item in v[-2::-1]:
        s = s * 0.7 + item ** 2
    for item in v[1::2]:
        s = s * 0.3 + item ** 3
    for k, (a, b) in enumerate(zip(v[::-1], v[1:])):
        s += k * a * b
    return s


def value_iteration(x, n):
    v = [0.0] * n
    for _ in range(20):
        old = v[:]
        for i in range(n):
            v[i] = x[i] + 0.5 * max(old[(i + 1) % n], old[i - 1])
        if max(abs(a - b) for a, b in zip(v, old)) < 1e-2:
            break
    return sum(v)


def bound_to_its_own_part(x):
    v = path(x)
    s = 0.0
    while len(v) > 1:
        s += v[0] * v[-1]
        v = v[1:]
        v[0] = v[0] * 1.5
    return s + v[0]


def total(items):
    s = 0.0
    for k in range(len(items)):
        s += (k + 1) * items[k] ** 2
    items.append(2.0)
    return s


def without_last(items):
    return items[:-1]


def given_and_returned(x):
    v = path(x)
    w = without_last(v)
    w[0] = w[0] * 2.0
    return total(v[1:]) + len(v) * v[0] + w[0] * w[-1]


def pairs(x):
    v = [(x[0] * 1.0, 2)]
    k = 1
    while v[-1][0] < 2.0 and k < len(x):
        v.append((v[-1][0] * 1.2 + x[k] ** 2, k))
        k += 1
    w = v[1:]
    v[1] = (2.0, 1)
    return sum(a * b for a, b in v) + w[0][0] * w[-1][1]


class Point:
    def __init__(self, position, weight):
        self.position, self.weight = position, weight


def objects(x):
    points = [Point(x[0] * 1.0, 2.0)]
    k = 1
    while points[-1].position < 2.0 and k < len(x):
        points.append(Point(points[-1].position * 1.2 + x[k] ** 2, x[k]))
        k += 1
    late = points[1:]
    late.append(Point(x[1], 1.0))
    s = 0.0
    for p in points:
        s += p.position * p.weight
    for p in late[::-1]:
        s = s * 0.5 + p.position * p.weight
    return s


def list_of_pairs(x):
    v = path(x)
    together = list(zip(v, v[1:]))
    counted = list(enumerate(v))
    v[1] = 1.0
    k, last = counted[-1]
    a, b = together[0]
    return sum(p * q for p, q in together) + k * last + a * b


def list_of_a_deque(x):
    recent = deque(maxlen=3)
    s = 0.0
    for k in range(len(x)):
        recent.append(x[k] ** 2)
        if x[k] > 0.5:
            kept = list(recent)
            kept.append(x[k])
            s += kept[0] * kept[-2] * len(kept)
    return s


def rows(x):
    v = [x * 1.0]
    while v[-1][0] < 2.0:
        v.append(v[-1] * 1.5 + x ** 2)
    w = v[1:]
    v.append(x * 3.0)
    return sum(np.sum(r ** 2) for r in w) + np.sum(v[-1] * w[0])


def row_is_written(x):
    v = [x * 1.0]
    while v[-1][0] < 2.0:
        v.append(v[-1] * 1.5 + x ** 2)
    w = v[:]
    w[0][1] = 3.0
    return np.sum(v[0]) + w[0][0]


def cases():
    for kernel in (copied, by_list_and_copy, gone_through_backwards, bound_to_its_own_part, given_and_returned, pairs,
                   objects, list_of_pairs, list_of_a_deque, rows):
        yield Case(kernel, (X,), "x")
    yield Case(bounds, (X, 2), "x")
    yield Case(backwards, (X, 2), "x")
    yield Case(value_iteration, (X, 6), "x")
    yield Case(row_is_written, (X,), "x", refused="S201 at `w[0][1] = 3.0`: the list 'w' holds views of an "
               "array, or one array several times, and what it holds is written: append a copy: .append(x.copy())")
