"""Arrays that a helper fills before it reads them, and those that only look so: a part is left, or stored by others, or
not the same one in each step."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case
from tests.harness.seeds import generator


def fill(u, work):
    for i in range(u.shape[0]):
        work[i] = u[i] ** 2
    for i in range(u.shape[0]):
        u[i] = 0.9 * u[i] + 0.03 * work[i] * work[u.shape[0] - 1 - i]


def fill_interior(u, work):
    for i in range(1, u.shape[0]):
        work[i] = u[i] ** 2
    for j in range(u.shape[0]):
        u[j] = 0.9 * u[j] + 0.03 * work[j] * work[u.shape[0] - 1 - j]


def filled(x, n):
    u, work = x.copy(), np.ones_like(x)
    for _k in range(n):
        fill(u, work)
    fill(u, work)
    return np.sum(u ** 2)


def read_around(x, n):
    u, work, total = x.copy(), np.ones_like(x), 0.0
    for _k in range(n):
        total += work[2] ** 2
        fill_interior(u, work)
        total += work[1] ** 3
    return np.sum(u ** 2) + work[1] ** 2 + total


def squares(u, work):
    for i in range(u.shape[0]):
        work[i] = u[i] ** 2


def flow(u, work):
    for i in range(u.shape[0]):
        u[i] = 0.9 * u[i] + 0.03 * work[i] * work[u.shape[0] - 1 - i]


def advance(u, work):
    squares(u, work)
    flow(u, work)


def read_by_another(x, n):
    u, work = x.copy(), np.ones_like(x)
    for _k in range(n):
        advance(u, work)
    return np.sum(u ** 2)


def stored_behind(x, n):
    u, work = x.copy(), np.ones_like(x)
    for k in range(n):
        fill_interior(u, work)
        work[0] = u[1] + k
    work[0] = 3.0
    return np.sum(u ** 2) + work[1] ** 2


def stored_between(x, n):
    u, work, total = x.copy(), np.ones_like(x), 0.0
    for _k in range(n):
        total += work[0] * work[1]
        fill(u, work)
        total += work[2] ** 2
        work[2] = 0.1 * total
        total += work[2] * work[1]
    return np.sum(u ** 2) + total


def in_two_loops(x, n):
    u, work = x.copy(), np.ones_like(x)
    for _k in range(n):
        for _m in range(2):
            fill_interior(u, work)
        work[0] += work[1] * 0.1
    return np.sum(u ** 2)


def refill(u, work, out):
    fill_interior(u, work)
    for i in range(u.shape[0]):
        work[i] = 2.0 * u[i]
    for i in range(u.shape[0]):
        out[i] = work[i] * work[0]


def filled_again_behind(x, n):
    u, work, out = x.copy(), np.ones_like(x), np.ones_like(x)
    for _k in range(n):
        refill(u, work, out)
        u[1] += 0.02 * out[0]
    return np.sum(u ** 2)


def square(v, work):
    for i in range(v.shape[0]):
        work[i] = v[i] ** 2


def slices_that_grow(x, n):
    u, work = x.copy(), np.ones_like(x)
    for k in range(n):
        square(u[:k % 3 + 1], work)
        for i in range(u.shape[0]):
            u[i] = 0.9 * u[i] + 0.03 * work[i] * work[u.shape[0] - 1 - i]
    return np.sum(u ** 2)


def until_one_is_large(u, work):
    for i in range(u.shape[0]):
        if u[i] > 0.9:
            break
        work[i] = u[i] ** 2


def left_in_the_middle(x, n):
    u, work = x.copy(), np.ones_like(x)
    for _k in range(n):
        until_one_is_large(u, work)
        for i in range(u.shape[0]):
            u[i] = 0.9 * u[i] + 0.3 * work[i] * work[u.shape[0] - 1 - i] + (0.2 if i == 0 else 0.0)
    return np.sum(u ** 2)


def fewer(u, work, m):
    m += int(u[0] * 3.0) % 2 - 1
    for i in range(m):
        work[i] = u[i] ** 2


def bound_that_is_rebound(x, n):
    u, work = x.copy(), np.ones_like(x)
    for _k in range(n):
        fewer(u, work, u.shape[0])
        for i in range(u.shape[0]):
            u[i] = 0.9 * u[i] + 0.3 * work[i] * work[u.shape[0] - 1 - i]
    return np.sum(u ** 2)


def span(u, work, first, end):
    for i in range(first, end):
        work[i] = u[i] ** 2


def spans_that_move(x, n):
    u, work = x.copy(), np.ones_like(x)
    for k in range(n):
        span(u, work, k % 2, 2 + k % 2)
        for i in range(u.shape[0]):
            u[i] = 0.9 * u[i] + 0.3 * work[i] * work[u.shape[0] - 1 - i]
    return np.sum(u ** 2)


def rows(u, work):
    for r in range(2):
        for i in range(u.shape[0]):
            work[r, i] = 0.5 * u[i] ** 2
        for i in range(u.shape[0]):
            u[i] += 0.02 * work[1 - r, i] * work[r, i]


def rows_of_others(x, n):
    u, work = x.copy(), np.ones((2, x.shape[0]))
    for _k in range(n):
        rows(u, work)
    return np.sum(u ** 2)


def behind_each(u, work):
    for _r in range(2):
        for i in range(1, u.shape[0]):
            work[i] = 0.5 * u[i] ** 2
        for i in range(u.shape[0]):
            u[i] += 0.02 * work[i] * work[0]
        work[0] = u[1]


def stored_behind_each(x, n):
    u, work = x.copy(), np.ones_like(x)
    for _k in range(n):
        behind_each(u, work)
    return np.sum(u ** 2)


def exchanged(x, n):
    u, work, other = x.copy(), np.ones_like(x), np.zeros_like(x)
    for k in range(n):
        if k % 2:
            refill(u, work, other)
        else:
            refill(u, other, work)
    return np.sum(u ** 2) + np.sum(work * other)


def as_many_as_its_copy_says(u, work):
    v = u.copy()
    for i in range(int(v.sum() * 7.0) % 3 + 1):
        work[i] = u[i] ** 2
    for i in range(u.shape[0]):
        u[i] = 0.8 * u[i] + 0.3 * np.sin(work[i] * work[u.shape[0] - 1 - i] + 0.4)


def of_what_is_stored_in_it(x, n):
    u, work = x.copy(), np.ones_like(x)
    for _k in range(n):
        as_many_as_its_copy_says(u, work)
    return np.sum(u ** 2)


def as_many_as_are_large(u, work):
    large = u[u > 0.9]
    for i in range(large.shape[0]):
        work[i] = large[i] ** 2
    for i in range(u.shape[0]):
        u[i] = 0.8 * u[i] + 0.3 * np.sin(work[i] * work[u.shape[0] - 1 - i] + 0.4)


def of_a_size_that_changes(x, n):
    u, work = x.copy(), np.ones_like(x)
    for _k in range(n):
        as_many_as_are_large(u, work)
    return np.sum(u ** 2)


def as_many_as_are_drawn(u, work, rng):
    for i in range(np.sum(rng.integers(0, 2, 3))):
        work[i] = u[i] ** 2
    for i in range(u.shape[0]):
        u[i] = 0.8 * u[i] + 0.3 * np.sin(work[i] * work[u.shape[0] - 1 - i] + 0.4)


def of_a_drawn_size(x, n):
    u, work, rng = x.copy(), np.ones_like(x), np.random.default_rng(3)
    for _k in range(n):
        as_many_as_are_drawn(u, work, rng)
    return np.sum(u ** 2)


def one(u, work, s):
    work[s] = u[s] ** 2
    for i in range(u.shape[0]):
        u[i] = 0.8 * u[i] + 0.3 * np.sin(work[i] * work[u.shape[0] - 1 - i] + 0.4)


def each(u, work):
    for s in range(u.shape[0]):
        one(u, work, s)


def of_others_before(x, n):
    u, work = x.copy(), np.ones_like(x)
    for _k in range(n):
        each(u, work)
    return np.sum(u ** 2)


REFILLED = (filled, read_around, read_by_another)       # whose work array needs no record
OTHERS = (filled_again_behind, stored_behind, stored_between, in_two_loops, slices_that_grow, left_in_the_middle,
          bound_that_is_rebound, spans_that_move, rows_of_others, stored_behind_each, exchanged,
          of_what_is_stored_in_it, of_a_size_that_changes, of_a_drawn_size, of_others_before)


def cases():
    for kernel in (*REFILLED, *OTHERS):
        yield Case(kernel, (generator(5).random(4) + 0.4, 5), ("x",), ("return",))
