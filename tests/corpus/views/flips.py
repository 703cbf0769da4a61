"""Arrays backwards, which are views: written, overlapping, empty, of parts, along several axes."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case
from tests.harness.seeds import generator


def durbin(r):
    # parts of a growing length, and one that overlaps what it is added to
    y = np.empty_like(r)
    alpha, beta = -r[0], 1.0
    y[0] = -r[0]
    for k in range(1, r.shape[0]):
        beta *= 1.0 - alpha * alpha
        alpha = -(r[k] + np.dot(np.flip(r[:k]), y[:k])) / beta
        y[:k] += alpha * np.flip(y[:k])
        y[k] = alpha
    return y


def written(x, y):
    # writes through the name and to what it is a view of
    b = np.flip(x)
    b[1:] = b[1:] * y[1:]
    x[0] = x[0] * b[0]
    x *= b
    np.flip(y)[:2] = x[:2] * y[:2]


def in_itself(x):
    for k in range(x.size):
        x[k:] = np.flip(x[k:]) * x[k]
        x += np.flip(np.flip(x))[::-1] * 0.25


def along_axes(a, u):
    a += np.flip(a, axis=0) * np.flip(u, axis=(1,)) + np.flip(a, (0, 1)) * np.fliplr(u)
    np.flip(a, -1)[1:, 0] += np.flipud(u)[1:, 1]
    return np.sum(np.flip(a[1], axis=0) * np.flip(u[::-2, 1:], axis=None)[0, 0])


def of_what_has_no_name(x, y):
    return np.flip(x * y) * np.flip(x[x > 0.6])[0]


def parts(x, lo, hi, step):
    for i in range(3):
        x[lo:hi:step] *= np.flip(x[lo:hi:step]) + i
        b = np.flip(x[lo:hi])
        b += x[lo:hi]
    return np.flip(x[hi:lo]).sum()


def scaled(w, f):
    w *= f
    return np.flip(w)


def given_to_helpers(a, x):
    # a view that a helper writes, shapes of a view, picks of a view, integers
    y = scaled(np.flip(x), 1.5) * x
    places = np.flip(np.argsort(x))
    z = np.flip(a).T @ np.flip(a, axis=1).reshape(a.shape)
    for row in np.flip(a, axis=0):
        y += row[0] * np.flip(row)[:x.size]
    return np.flip(y[places]), np.flip(z)[[0, 2, 0]]


def for_each_element(x):
    f = np.flip(x)
    for i in range(1, 4):
        f[i] += 2.0 * f[i - 1] * x[0]


def returned(x):
    x *= x
    return np.flip(x)


def cases():
    rng = generator(19)

    def some(*shape):
        return rng.uniform(0.4, 1.2, shape)

    for n in (1, 2, 6):
        yield Case(durbin, (0.2 * some(n),), ("r",), ("return",))
    yield Case(written, (some(5), some(5)), ("x", "y"), ("x", "y"))
    yield Case(in_itself, (some(4),), ("x",), ("x",))
    yield Case(along_axes, (some(4, 3), some(4, 3)), ("a", "u"), ("a", "return"))
    yield Case(of_what_has_no_name, (some(6), some(6)), ("x", "y"), ("return",))
    yield Case(given_to_helpers, (some(4, 4), some(4)), ("a", "x"), ("x", "return"))
    yield Case(for_each_element, (some(6),), ("x",), ("x",))
    yield Case(returned, (some(4),), ("x",), ("return",))
    for bounds in ((1, 5, 1), (4, 2, 1), (-4, 9, 2), (0, 0, 1)):
        yield Case(parts, (some(6), *bounds), ("x",), ("x", "return"))
