"""Products in place, and tuples that are put together where they are read: the values, and what is refused."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case

X = np.array([0.3, 0.9, 0.7, 0.62])
R = np.eye(4) * 0.8 + 0.1 * np.outer(X, X)


def turned(r, x):
    t = np.eye(4)
    for _ in range(3):
        t @= r
    w = x * 2.0
    w @= t
    s = r.copy()
    s @= s
    return np.trace(t) + np.sum(w ** 2) + np.sum(s * r)


def of_parts(r, x):
    a = np.stack([r, 2.0 * r])
    a[0] @= r
    a[-1][:, :3] @= r[:3, :3]
    a[:, 1:, 1:] @= r[1:, 1:]
    r[:2, :2] @= a[0, :2, :2]
    return np.sum(a ** 2 * x)


def of_items(r, x):
    a = r * 1.0
    both = [a, r * 2.0]
    both[0] @= r
    both[1] @= both[0]
    return np.sum(a * x) + np.sum(both[1])


def of_counted_parts(r, x):
    a = np.stack([r, 2.0 * r, 0.3 * r])
    i = 0
    pairs = np.stack([a, 2.0 * a])
    for k in range(3):
        a[k] @= r
        a[(k + 1) % 3][:2, :2] @= a[k, 1:3, 1:3]
        pairs[1, -k] @= r
    while i < 2:
        a[i] @= x[i] * r
        i += 1
    for k, row in enumerate(a):
        row[0] *= x[k]
        pairs[0, k] @= row
    return np.sum(a ** 2 * x) + np.sum(pairs * x)


def of_counted_items(r, x):
    both = [r * 1.0, r * 2.0]
    first, grown = both[0], []
    for k in range(3):
        grown.append(r * x[k])
        both[k % 2] @= r
    for k in range(3):
        grown[k] @= both[0]
    return np.sum(first * x) + np.sum(both[1]) + np.sum(grown[2] * grown[0])


def reduced(r, x):
    c, d = x[0], x[1] ** 2
    total = x[2] * sum((c,) + (d,)) + sum((c,) * 3) * d + max((c,) + (d, 0.1)) + min((c, d) * 2)
    return total * np.mean((c,) + (d,)) + np.sum((c, x[3]) * 2) * len((c,) * 3)


def with_stars(r, x):
    inner = (x[0], x[1])
    a = np.zeros((*r.shape, 2))
    a[..., 0] = r
    u = (*inner, 2.0)
    return np.sum(a * x[0]) + u[0] * u[2] * len(u)


def repeated(r, x):
    n = x.size - 1
    a = np.array([0.5] * n) * x[:n] + np.array([[2.0] * n] * 2)[1]
    b = np.array([1.0] + [-0.5] * n) * x
    c = np.sum([x[0]] + [x[1]]) + np.sum(x[[1] * 3] * x[[0, 1] + [2]])
    d = np.sum(np.sum([x, x * x[0]] + [x * 2.0], axis=0) ** 2)
    return np.sum(a ** 2) + np.sum(b ** 2) + c + d + len([1, x[0]] + [2.0]) * x[1]


def axes_in_lists(r, x):
    q = np.stack([r, r * x])
    a = np.moveaxis(q, [0, 2], [-1, 0]) * np.flip(np.roll(r, [1, 2], axis=[0, 1]), [0, 1])[..., None]
    return np.sum(a ** 2) + np.sum(np.searchsorted(np.cumsum(x), [1.0, 2.0]) * x[:2])


KERNELS = [turned, of_parts, of_items, of_counted_parts, of_counted_items, reduced, with_stars, repeated, axes_in_lists]


def starred_array(r, x):
    return np.sum((2.0, *x))


def starred_in_a_loop(r, x):
    s = 0.0
    for v in (1.0, *x):
        s += v
    return s


def picked(r, x):
    both = [r * 2.0, r * 3.0]
    both[x.size % 2] @= r
    return np.sum(both[0])


def picked_by_many(r, x):
    a, k = np.stack([r, 2.0 * r]), np.array([1, 0])
    a[k] @= r
    return np.sum(a[0])


def of_names(r, x):
    t = (x[0],) + (x[1],)
    return max(t + (x[2],))


def one_object_twice(r, x):
    a, b = [2.0 * x] * 2
    a[0] = x[1]
    return np.sum(b * b)


def one_row_twice(r, x):
    rows = [[x[0]] * 2] * 2
    rows[0][1] = x[1]
    return rows[1][1]


def one_copy_twice(r, x):
    places = np.array([2, 0, 1])
    both = [x[places]] * 2
    both[0][0] = x[0]
    return np.sum(both[1] ** 2)


def one_choice_twice(r, x):
    both = (x[x > 0.5],) * 2
    both[0][0] = x[0]
    return np.sum(both[1] ** 2)


def one_list_of_places_twice(r, x):
    both = [x[[0, 1]]] * 2
    both[1] += x[2]
    return np.sum(both[0] ** 2)


def asked_for(r, x):
    ks = [1, 2]
    return x[0] if ks == [1, 2] else x[1]


def turned_around(r, x):
    t = (x[0], x[1])
    return t[::-1][0] * x[0]


def cases():
    # derivatives
    for kernel in KERNELS:
        of = ("r", "return") if kernel is of_parts else ("return",)
        yield Case(kernel, (R.copy(), X.copy()), ("r", "x"), of)
    for kernel in (
            one_object_twice, one_row_twice, one_copy_twice, one_choice_twice, one_list_of_places_twice):
        yield Case(kernel, (R.copy(), X.copy()), "x")
    for kernel in (starred_array, starred_in_a_loop, picked_by_many):
        yield Case(kernel, (R.copy(), X.copy()), ("r", "x"))
    # one object is not made several times
    for kernel in (turned_around, picked, of_names, asked_for):
        yield Case(kernel, (R.copy(), X.copy()), "x")
