"""Loops over written numbers: over arrays of them where that is the same, written out where a number must be known."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case
from tests.harness.seeds import generator

A, X = generator(1).random((5, 5)) + 0.2, np.array([0.9, 0.31, 1.4, 0.55, 1.13])
BARS = ((0, 1, 0.5), (1, 2, 0.7), (2, 3, 0.2), (3, 4, 0.9), (0, 4, 1.1))


def forces(a, x):
    f = np.zeros_like(a)
    for i, j, length in BARS:
        d = a[j] - a[i]
        now = np.sqrt(np.sum(d * d) + 0.1)
        pull = x[i] * (now - length) / length
        f[i] += pull * d / now
        f[j] -= pull * d / now
    return np.sum(f * f)


def stretch(x, i, j):
    return (x[i] - x[j]) ** 2


def counted_and_asked(a, x):
    total = 0.0
    best = -1
    for k, (i, j, w) in enumerate(BARS):
        if total > 9.0:
            break
        total += k * w * stretch(x, i, j) + 2 * i * x[(i + 1) % 5] ** j
        if w > 0.6:
            best = i
        for m in range(i, j):
            total += x[m] * a[m, i]
        if best >= 0:
            total -= x[best] ** 2
    for i, w, odd in ((0, 1, False), (1, 0.5, True), (2, 2, False), (3, 1.5, True)):
        if odd:
            total += w * x[i] ** w
        total *= 1.1
        total += np.exp(-w * a[i, i])
    return total * x[best]


def more_than_sixteen(a, x):
    total = 0.0
    for i in (0, 1, 2, 3, 4, 0, 1, 2, 3, 4, 0, 1, 2, 3, 4, 0, 1, 2, 3, 4):
        total += x[i] ** 2
    return total


def part(x, i):
    return np.sum(x[i:] ** 2)


def scaled(x, i, w):
    x[i] *= w


def written_out(a, x):
    total = 0.0
    kept = (x[0], x[1] * 2.0, np.sum(a))
    for dx, dy, w in ((0, 0, 0.4), (1, 0, 0.1), (-1, 0, 0.1), (0, 1, 0.1), (0, -1, 0.1)):
        for i in range(1, 4):
            total += w * a[i + dx, i + dy] ** 2
    for axis, k, w in ((0, 1, 0.4), (1, 0, 0.1), (0, 0, 0.1), (1, 2, 0.1)):
        total += w * np.sum(a, axis=axis)[k] ** 2
        total += kept[k] * a.shape[axis]
        total += np.sum(x[k:k + 2] ** 2) * part(x, k)
    for i, j, w in BARS:
        last = x[i] * w
        before = a[i]
        a[j] = before * w
        scaled(x, j, w)
        total += last * x[j]
    t = 0
    for w in (0.5, 0.2, 0.1, 1.0, 0.7):
        t = t + w * x
        t = t * np.sum(t * w)
        total += w
        total -= t[0]
    return total * last + i * np.sum(a) + np.sum(t)


def names_of_a_number(a, x):
    for i, j, w in BARS:
        first = x[i]
        moved = x[j] - first
        x[i] = first + w * moved
        x[j] -= w * moved * first
        x[i] *= x[j] * a[i, j]
    for n in (1, 2, 3, 1, 2):
        x[n] = x[n] ** n
        x[n - 1] *= n
        x[0] += 2.0 ** n
        x[0] *= 0.1
    return np.sum(x ** 2)


def cases():
    # derivatives
    for kernel in (forces, counted_and_asked, written_out, more_than_sixteen, names_of_a_number):
        yield Case(kernel, (A, X), ("a", "x"))
