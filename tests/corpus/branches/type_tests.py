"""Questions after types: of an argument, before the types of branches are joined, or of what is calculated."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case

X, M = np.array([0.3, 1.1, 0.7]), np.arange(1.0, 7.0).reshape(2, 3) / 7


def spread(x, p):
    if np.isscalar(p):
        p = np.full(x.size, p)
    return (x * p).sum() * p[0]


def classes(x, p):
    if isinstance(p, float):
        return (x * p).sum()
    if isinstance(p, (np.ndarray, int)):
        return x @ p
    return x[0]


def axes(x, p):
    if np.ndim(p) == 0:
        p = p * np.ones(3)
    elif p.ndim == 2:
        p = p.sum(axis=0)
    if x.ndim > 1:
        x = x[0]
    return x @ p


def mixed(x, p):
    s = 0.0
    for i in range(3):
        if not isinstance(p, np.ndarray) and i != 1:
            s += p * x[i]
        elif isinstance(p, np.ndarray):
            s += p[i] ** 2 * x[i]
    return s


def weighted(x, p):
    if isinstance(p, (int, float)):
        return (x * p).sum()
    return x @ p


def by_a_function(x, p):
    return weighted(x, p) * weighted(x, 2.0 * x)


def several(x, p):
    if np.isscalar(p) and isinstance(p, float):
        return x.sum() * p
    if not (isinstance(p, np.ndarray) and p.ndim == 1 and x.ndim == 1):
        raise ValueError
    if isinstance(p, np.ndarray) and p.ndim == 2 or x.ndim == 2:
        return x[0]
    assert x.ndim == 1 and x.ndim != 2 and p.size == 3
    return x @ p if p.ndim == 1 and p[0] > 0.0 else x[1]


KERNELS = [several, spread, classes, axes, mixed, by_a_function]


def of_nothing(x, p=None):
    if isinstance(p, np.ndarray) and p.ndim == 1:
        return x @ p
    if not isinstance(p, (float, int, np.ndarray)):
        return x @ x
    return x.sum() * p


def nothing_is_a_class(x, p=None):
    w = x * 2.0 if isinstance(p, type(None)) else x * p
    given = isinstance(p, np.ndarray)
    if given:
        w[0] *= 3.0
    return np.sum(w ** 2 if not np.isscalar(p) else w)


def nothing_for_a_function(x, p=None):
    return of_nothing(x) + of_nothing(x, p) * nothing_is_a_class(x ** 2, p)


def whole(x, p):
    return x[0] if isinstance(p, int) else x[1]


def anew(x, p):
    p = p * x
    if isinstance(p, np.ndarray):
        p = p.sum()
    return p * x[0]


def cases():
    # nothing
    for kernel in [of_nothing, nothing_is_a_class, nothing_for_a_function]:
        yield Case(kernel, (X,), ("x",))
        yield Case(kernel, (X, None), ("x",))
        for p in (1.3, X[::-1] * 2.0):
            yield Case(kernel, (X, p), ("x", "p"))
    # types asked
    for kernel in KERNELS:
        for p in (1.3, X[::-1] * 2.0):
            yield Case(kernel, (X, p), ("x", "p"))
    # other arguments
    yield Case(axes, (X, M), ("x", "p"))
    yield Case(axes, (M, 0.5), ("x", "p"))
    yield Case(spread, (X[:1], 0.5), ("x", "p"))
    yield Case(spread, (X.astype("float32"), X.astype("float32")), ("x", "p"))
    # of what is calculated
    yield Case(anew, (X, 2), ("x",))
    yield Case(whole, (X, 2), "x")
