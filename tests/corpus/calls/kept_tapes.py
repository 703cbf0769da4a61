"""Calls whose tapes lie from one sweep to the other: what the reverse sweep of a helper reads of its arguments is as
the call left it, whatever is stored there before it, behind it and by the helper itself."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case
from tests.harness.seeds import generator


def advance(u, w, n):
    for k in range(n):
        for i in range(u.shape[0]):
            u[i] = u[i] + 0.1 * np.sin(u[i]) * w[i] * (k + 1)


def overwritten_behind(x, w, n):
    u, v = x.copy(), w.copy()
    advance(u, v, n)
    for i in range(v.shape[0]):
        v[i] = v[i] * u[i]
    return np.sum(u ** 2) + np.sum(v ** 3)


def overwritten_in_a_loop(x, w, n):
    u, v = x.copy(), w.copy()
    advance(u, v, n)
    for k in range(n):
        for i in range(v.shape[0]):
            v[i] = v[i] * u[i] + 0.1 * k
    return np.sum(u ** 2) + np.sum(v ** 3)


def read_in_front(x, w, n):
    u = x.copy()
    total = 0.0
    for i in range(u.shape[0]):
        total += u[i] ** 3 * w[i]
    advance(u, w, n)
    for i in range(u.shape[0]):
        total += u[i] ** 3
    return total


def twice(x, w, n):
    u = x.copy()
    advance(u, w, n)
    u *= u
    advance(u, w, n)
    return np.sum(u ** 2)


def many(x, w, n):
    u = x.copy()
    advance(u, w, n)
    advance(u, w, n)
    advance(u, w, n)
    advance(u, w, n)
    advance(u, w, n)
    return np.sum(u ** 2)


def in_a_branch(x, w, n):
    u = x.copy()
    if w[0] > 0.0:
        advance(u, w, n)
    else:
        advance(u, x, 2)
    return np.sum(u ** 2)


def inner_part(u, w, n):
    advance(u, w, n)
    for i in range(u.shape[0]):
        w[i] = u[i] * w[i]


def nested(x, w, n):
    u, v = x.copy(), w.copy()
    inner_part(u, v, n)
    return np.sum(u * v)


def norm_of(u, n):
    total = 0.0
    for k in range(n):
        for i in range(u.shape[0]):
            total = 0.9 * total + u[i] ** 2 * total + u[i] * (k + 1)
    return total


def result_used_twice(x, w, n):
    u = x.copy()
    size = norm_of(u, n)
    for i in range(u.shape[0]):
        u[i] = u[i] * size * w[i]
    return np.sum(u ** 2) + size ** 2


def until(u, w, limit):
    count = 0
    while True:
        for i in range(u.shape[0]):
            u[i] = u[i] * (1.0 + 0.1 * w[i] * u[i])
        count += 1
        if u[0] > limit or count > 20:
            break
    return count


def left_by_break(x, w, n):
    u = x.copy()
    trips = until(u, w, 0.3 * n)
    return np.sum(u ** 2) * trips


def half(u, w):
    for _k in range(3):
        for i in range(1, u.shape[0] // 2):
            u[i] = u[i - 1] * w[i] + 0.3 * u[i] ** 2


def a_part_is_stored(x, w, n):
    u = x.copy()
    half(u, w)
    total = u[u.shape[0] - 1] * u[1]
    for _k in range(n):
        u[u.shape[0] - 1] = u[u.shape[0] - 1] ** 2 * u[1]
    return np.sum(u ** 2) + total


def restores_in_the_loop_alone(u, w, n):
    for _k in range(n):
        u[...] = u * w
    for _k in range(2):
        w[...] = w * u


def no_trips(x, w, n):
    u, v = x.copy(), w.copy()
    restores_in_the_loop_alone(u, v, n)
    u[...] = u * v
    return np.sum(u ** 2) + np.sum(v)


def with_work_array(u, n):
    work = np.empty_like(u)
    for k in range(n):
        for i in range(u.shape[0]):
            work[i] = u[i] ** 2 + 0.1 * k
        for i in range(u.shape[0]):
            u[i] = 0.5 * u[i] + work[u.shape[0] - 1 - i] * work[i]


def a_work_array(x, w, n):
    u = x * w
    with_work_array(u, n)
    u *= w
    with_work_array(u, n)
    return np.sum(u)


def in_steps(x, w, n):
    u = x.copy()
    for _k in range(n):
        nested_step(u, w)
    return np.sum(u ** 2)


def nested_step(u, w):
    advance(u, w, 2)
    u *= w
    with_work_array(u, 2)


def in_place(u, w, n):
    advance(u, w, n)
    w *= u


def one_array_twice(x, w, n):
    u = x * w
    advance(u, u, n)
    return np.sum(u ** 2)


def parts_of_arrays(x, w, n):
    u = np.zeros((2, x.shape[0]))
    u[0] = x
    u[1] = w
    advance(u[0], u[1], n)
    advance(u[1], u[0], n)
    return np.sum(u ** 2)


def placed(u, w):
    n = u.shape[0]
    s = np.sum(u * w)
    u[int(abs(s) * 7.3) % n] = 0.6 * (2.5 + s) ** -0.5
    for i in range(n):
        u[i] *= w[i]


def at_a_computed_place(x, w, n):
    """The remainder by an integer of the tape's is one of integers."""
    u = x * n
    placed(u, w)
    return np.sum(u ** 2)


def cases():
    x, w = generator(17).random((2, 6))
    for kernel in (overwritten_behind, overwritten_in_a_loop, read_in_front, twice, many, in_a_branch, nested,
                   result_used_twice, left_by_break, a_part_is_stored, no_trips, a_work_array, in_steps,
                   one_array_twice, parts_of_arrays, at_a_computed_place):
        for n in (0, 3):
            yield Case(kernel, (x.copy(), w.copy(), n), ("x", "w"))
    yield Case(in_place, (x.copy(), w.copy(), 3), ("u", "w"), ("u", "w"))
