"""What a name stands for in the first iteration alone: a number that a sum begins with, or an array of another name."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case


def modes(x, w, n):
    """Two sums in one loop, one of them nested; the bound is lost in the loop, and a counter is used again after it."""
    field, weight = 0.0, 0
    for k in range(n):
        n = w.shape[1]
        weight = weight + w[k] ** 2
        for j in range(n):
            field += w[k, j] * np.sin((k + 1) * x)
        x[k] *= field[0]
    for k in range(2):
        field = field * x[k]
    return np.sum(field ** 2) * np.sum(weight)


def backwards(x, w):
    """A sum in each trip of another loop; a matrix product; steps down."""
    for i in range(2):
        total = 0
        for k in range(2, -1, -2):
            total += w[k] @ w.T * x[i] + w[k, i]
        w[i] += total[:2] * 0.1
    s = 0.0
    for row in w:
        s = s + row * x[:2]
    return np.sum(s * s)


def smooth(u, taps):
    out = 0.0
    for k, tap in enumerate(taps):
        out += tap * u[k:u.size - 2 + k]
    return out


def in_a_helper(x, w):
    x[1:-1] = smooth(x, w[0, :2]) + smooth(x, w[:, 1])
    start = 1.0
    start += x[1:3]
    start *= start
    return np.sum(start)


def left_early(x, n):
    total = 0.0
    for k in range(n):
        total += k * x
        if total[0] > 1.0:
            break
    return np.sum(total)


def under_a_test(x, n):
    total = 0.0
    for k in range(n):
        if x[k] > 0.0:
            total += x
    return np.sum(total)


def spread(x, w):
    points = x[:3]
    for k in range(w.shape[1]):
        points = np.hstack((points, x[:3] + 0.3 * w[:, k]))
    return points


def bent(points):
    for i in range(points.size):
        points[i] = np.sin(points[i])
    return points


def shared_at_first(x, w):
    """A helper writes what another one begins as a part of its argument."""
    for k in range(2):
        points = bent(spread(x, w))
        x[k] = points[0] * points[-1]
    return np.sum(points ** 2)


def shared_with_what_is_stored_into(x, w):
    """The first iteration alone reads and writes what the argument holds; bounds are computed."""
    y = x
    for k in range(w.size - 4, w.size + 1, 2):
        before = y
        y = y * x + k
        x[0] = 3.0 * before[1]
        before[2] = 0.5
    y += 1.0
    return np.sum(y ** 2) + y[0] * x[0]


def shared_in_every_trip(x, w):
    """The outer loop's array is shared again whenever the inner loop begins."""
    y = x * 2.0
    z = y
    for i in range(2):
        for j in range(3):
            z = z * x + w[j, i]
            z[j] = y[0]
        y += z
        z = y
    z -= 1.0
    return np.sum(z ** 2) + z[0] * y[1]


def shared_without_trips(x, n):
    y = x
    for _ in range(n):
        y = y * x
    y[0] = 2.0 * y[1]
    return np.sum(y)


def cases():
    x = np.array([0.5, 0.8, 1.2, 0.9, 0.4])
    w = np.array([[0.3, 0.7], [1.1, 0.6], [0.2, 0.9]])
    for kernel, rest, of in ((modes, (2,), ("x", "return")), (backwards, (), ("w", "return")),
                             (in_a_helper, (), ("x", "return"))):
        yield Case(kernel, (x, w, *rest), ("x", "w"), of)
    yield Case(shared_at_first, (x, w), ("x", "w"), ("x", "return"))
    yield Case(shared_with_what_is_stored_into, (x[:3], w), ("x", "w"), ("x", "return"))
    yield Case(shared_in_every_trip, (x[:3], w), ("x", "w"))
    yield Case(shared_without_trips, (x, 2), "x")
    # no trip
    yield Case(shared_without_trips, (x, 0), "x", refused=(
            "S501 at `for _ in range(n):`: a loop that binds an array anew has no trip, and the array from before it "
            "is written: n is 0: bind the name to a copy before the loop: u = u.copy()"))
    yield Case(modes, (np.ones(3), np.ones((2, 2)), 0), "x", refused=(
            "S501 at `for k in range(n):`: a loop in which a number becomes an array has no trip: stop is 0: start "
            "with an array, np.zeros(...), not with a number"))
    # what need not become an array
    for kernel, refused in (
            (left_early,
             "S203 at `total += k * x`: 'total' is bound to float64 and to float64[:]: start with an array: "
             "np.zeros_like(...); or give the second one another name"),
            (under_a_test,
             "S203 at `total += x`: 'total' is bound to float64 and to float64[:]: start with an array: "
             "np.zeros_like(...); or give the second one another name")):
        yield Case(kernel, (np.ones(3), 3), "x", refused=refused)
