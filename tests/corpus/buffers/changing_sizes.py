"""Sizes and numbers that are bound more than once, and what must not be taken from their first value."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case
from tests.harness.seeds import generator


def ring_shrinks(u, v, steps):
    n = u.size
    m = n
    w = np.zeros(n)
    total = 0.0
    for _ in range(steps):
        for i in range(n):
            w[i] = u[i] * u[(i + 1) % m]
        total += np.sum(w * w)
        m -= 1
    return total


def loops_of_other_lengths(u, v, steps):
    n = u.size
    m = n
    a, b = np.zeros(n), np.zeros(n)
    for _ in range(steps):
        for i in range(m):
            a[i] = 0.3 * u[i]
        for i in range(n):
            b[i] = 0.2 * v[i]
        for i in range(n):
            u[i] += a[i] * 0.5
            v[i] += b[i]
        m -= 1
    n = n - 1
    for i in range(n):
        v[i] = np.sin(v[i]) * u[i]
    return np.sum(u * v)


def counted_by_what_changes(u, v, steps):
    mask = np.zeros(u.size, dtype=bool)
    count = np.array([1, 2, 0])
    for _ in range(steps):
        where = np.flatnonzero(u > 1.0)
        u[where] *= u[where]
        mask[:] = v > 0.5
        for j in range(np.count_nonzero(mask)):
            v[j] *= v[j] * 1.2
        for j in range(np.argmin(count), np.argmax(count) + 1):
            u[j] *= v[j]
        count[:] = count[::-1]
        count[0] += 1
        for j in range(int(count.sum()) - 3):
            u[j % u.size] *= 1.1
    return np.sum(u)


def a_row_or_all(u, v, steps):
    a, b = np.outer(u, v), np.outer(v, u)
    w = a[:1] * 3.0
    if steps > 2:
        w = a * 2.0
    b *= w
    return np.sum(b)


def three_or_five(u, v, steps):
    c = np.array([u[0], u[1], v[0]])
    if steps > 2:
        c = np.array([v[0], v[1], v[2], u[0], u[3]])
    c *= u[0]
    return np.sum(c * c)


CASES = [(kernel, steps) for kernel in (ring_shrinks, loops_of_other_lengths, counted_by_what_changes, a_row_or_all,
                                        three_or_five) for steps in (3, 2)]
CASES.remove((a_row_or_all, 2))     # a length of 1 that is not written repeats only behind a guard


def last_row(u, v):
    for k in range(2):
        row = u[k:k + 2]
    return np.sum(row * v[:2])


def searched_row(u, v):
    rows = np.outer(u, v)
    for row in rows:
        if row[0] > 0.5:
            break
    return row[1] * u[0]


def cases():
    # kernel
    for kernel, steps in CASES:
        random = generator(2)
        given = 0.4 + random.random(5), 0.3 + random.random(5), steps
        left = given[0].copy(), given[1].copy(), steps
        kernel(*left)
        of = tuple(n for n, a, b in zip("uv", given, left) if not np.array_equal(a, b))
        yield Case(kernel, given, ("u", "v"), (*of, "return"))
    # a part at a counter ends with its loop
    yield Case(last_row, (np.ones(4), np.ones(4)), "u", refused=(
        "S201 at `row`: 'row' may stand for different arrays here: copy into one array with x[...] = ..., or use two "
        "names"))
    yield Case(searched_row, (np.array([0.1, 0.3, 0.8, 0.9]), np.arange(1.0, 5.0)), "u")
