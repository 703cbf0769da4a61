"""Elements picked by integer arrays and masks, where a statement must not be taken apart carelessly."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case
from tests.harness.seeds import generator


def mask_changed_in_while(a, x):
    while np.sum(x) > 1.0:
        high = x > 0.5 * np.max(x)
        x[high] *= 0.5 * x[high] / np.max(x[high])
        a[high] *= np.max(x[high])


def places_from_data(a, x):
    order = np.array([[0, 2], [1, 1]])
    x[order[0]] *= a[0, order[1]]
    x[order[:, 1]] += x[0] * a[1, order[1, ::-1]]


def places_of_two_axes(a, x):
    order = np.array([[0, 2], [1, 1]])
    b = x[order] * x[order]
    x[0] = np.sum(b[1] * b[0])
    a[order[0], order[1]] += b[0]


def allocated_by_what_an_array_holds(a, x):
    count = np.array([1, 2, 3])
    for k in range(3):
        w = np.zeros(int(np.sum(count)))
        w[-1] = x[k] ** 2
        count[k] = count[k] + 1
        x[0] += np.sum(w) * w.size + w[w.size - 1] * a[0, k]


def mask_and_row_of_one_matrix(a, x):
    high = x > 0.8
    a[high] += 0.1 * (np.sin(a[1]) - a[high])
    a[:, high] *= a[:, high] - a[:1, high] * a[0, 0]


def column_by_number(a, x):
    for k in range(2):
        last = k
    a *= (x[:, None] * a[:, last:last + 1]) * np.std(a, axis=0)


KERNELS = (mask_and_row_of_one_matrix, column_by_number, mask_changed_in_while, places_from_data, places_of_two_axes,
           allocated_by_what_an_array_holds)


def sizes_that_do_not_hold(x, k):
    picked = x[x > 9.0]
    if picked.size > 1:
        picked[1:] *= picked[:-1] + picked[1:]
    if k > 0:
        w = np.ones(x.size // k)
        w *= x[0]
        x[1] += np.sum(w * w)
    for _ in range(k - 1):
        v = np.zeros(k - 1)
        v += x[2]
        x[2] *= np.sum(v)
    x[x > 9.0] = picked
    x *= x


def products_of_integers(a, x):
    signs = np.array([[1, 0, -2], [0, 3, 1], [1, 1, 1]])
    b = (signs - 1).T @ x
    a[0] = b * (signs @ np.linalg.solve(signs, x))
    x[:] = a @ signs[1]


def functions_into_picked_elements(a, x, y):
    where = np.array([2, 0])
    high = y > 0.8
    x[where] = np.mean(a[:, :2], axis=0)
    y[where] += np.max(a[:2], axis=1)
    x[where] *= np.cumsum(y[:2])
    y[where] -= a[:2] @ x
    a[where] = np.roll(a[:2], 1, axis=1) * x
    a[where, 1] = np.sum(a * a, axis=0)[1:]
    x[high] += np.sum(a, axis=1)[high]
    a[where[0]] = np.prod(a, axis=0)


def flip(m):
    for k in range(m.size):
        m[k] = not m[k]


def masks_that_change(x, y):
    m = x > 0.8
    x[m] = y[m] ** 3
    m[0] = False
    x[m] = y[m] ** 2
    flip(m)
    x[m] *= y[m]
    m ^= True
    x[m] *= y[m]
    return np.sum(x * x)


def masks_that_change_between(x, y):
    m = x > 0.8
    a = x[m] * 2.0
    m[0] = False
    x[m] = y[m]
    b = x[m] * y[m]
    flip(m)
    x[m] = y[m] * 3.0
    return np.sum(a) * np.sum(x) + np.sum(b)


def cases():
    # kernel
    for kernel in KERNELS:
        random = generator(3)
        given = 0.3 + random.random((3, 3)), np.array([0.9, 1.2, 0.7])
        left = given[0].copy(), given[1].copy()
        kernel(*left)
        of = tuple(n for n, p, q in zip("ax", given, left) if not np.array_equal(p, q))
        yield Case(kernel, given, ("a", "x"), of)
    # sizes of blocks that do not run
    for k in (0, 2):
        # A work array leaves its block only in a size that is possible where the block does not run.
        for x in (np.array([0.9, 1.2, 0.7]), np.array([9.9, 10.2, 9.7])):
            yield Case(sizes_that_do_not_hold, (x, k), ("x",), ("x",))
    # products of integers
    random = generator(3)
    yield Case(products_of_integers, (random.random((3, 3)), random.random(3)), ("a", "x"), ("a", "x"))
    # functions into picked elements
    random = generator(3)
    given = 0.5 + random.random((3, 3)), random.random(3), np.array([0.9, 0.5, 1.2])
    yield Case(functions_into_picked_elements, given, ("a", "x", "y"), ("a", "x", "y"))
    # masks that change
    for kernel in (masks_that_change, masks_that_change_between):
        # What is stored through a mask before it changes is not stored through it later.
        x, y = np.array([0.9, 0.31, 1.4, 0.55, 1.13]), np.array([0.7, 1.1, 0.8, 1.4, 1.3])
        yield Case(kernel, (x, y), ("x", "y"), ("return", "x"))
