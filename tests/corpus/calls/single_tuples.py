"""Functions that return a tuple or a list of one value, as the derivatives that s2sad writes do."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case


def alone(x):
    return (x * x,)


def listed(x):
    return [x * x]


def named(x):
    result = (x * x,)
    return result  # noqa: RET504


def chosen(x):
    return (x * x,) if x[0] > 0.0 else (x,)


def passed_on(x):
    return alone(x)


def tangent(x, x_dot):
    """As a written tangent of a sum of squares."""
    total_dot = 0.0
    for i in range(x.size):
        total_dot += 2.0 * x[i] * x_dot[i]
    return (total_dot,)


def unpacked(x):
    (y,) = alone(x)
    (z,) = named(2.0 * x)
    return np.sum(y * z * x)


def picked(x):
    found = listed(x)
    return np.sum(alone(x)[0] * passed_on(x)[-1] * found[0])


def nested(x):
    (y,) = alone(alone(x)[0])
    passed_on(x)
    return np.sum(y + chosen(x)[0])


def branches(x, other):
    if other:
        found = alone(x)
    else:
        found = alone(3.0 * x)
    for y in chosen(x):
        x = x * y
    return np.sum(found[0] * x) + len(found)


def slopes(x):
    out = np.zeros(2)
    (out[0],) = tangent(x, np.array([1.0, 0.0]))
    (out[1],) = tangent(x, np.array([0.0, 1.0]))
    return out[0] ** 2 * out[1]


def cases():
    # of one
    for kernel in (unpacked, picked, nested, slopes):
        yield Case(kernel, (np.array([0.3, 0.9]),), ("x",))
    # in branches and loops
    for other in (True, False):
        yield Case(branches, (np.array([0.3, 0.9]), other), ("x",))
