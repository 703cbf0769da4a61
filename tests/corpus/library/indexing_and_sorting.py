"""Functions that write an argument, and functions of places, of order and of selection, several in a kernel."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case
from tests.harness.seeds import generator


def results_in_place(a, x, y):
    w, m, s = np.empty(3), np.empty((3, 3)), np.empty(4)
    np.multiply(a, 2.0 * y, out=a)
    np.add(x, x * x, x)
    np.dot(a, y, w)
    np.matmul(a, a.T, out=m)
    np.sum(a, axis=0, out=s)
    z = np.multiply(y, y, out=(y,))
    np.divide(1.0, x, out=x, where=x > 1.1)
    np.copyto(a, y, where=a > 1.2)
    np.copyto(s, 0.5)
    return np.sum(w * w) + np.sum(m * m) + np.sum(s * z)


def stores_at_places(a, x, y):
    k = np.array([0, 2, 2, 1])
    np.add.at(x, k, y * y)
    np.subtract.at(x, k, x[k])
    np.multiply.at(y, k, y)
    np.add.at(a, (k, np.array([0, 3, 3, 1])), y)
    np.add.at(a, np.array([1, 1]), y)
    np.maximum.at(x, k, -y)
    np.add.at(x, 1, y[0])
    np.fill_diagonal(a[:, 1:], x)
    np.fill_diagonal(a, x[0] ** 2)
    y.sort()
    return np.sum(x ** 2) + np.sum(a ** 2) + np.sum(y * np.arange(4))


def ufuncs(a, x, y):
    b = np.add.reduce(a, axis=1) * np.multiply.reduce(a, axis=1) + np.add.accumulate(x) * np.maximum.accumulate(x)
    c = np.multiply.outer(x, y) * np.subtract.outer(x, y) + np.power.outer(x, y)
    d = np.maximum.reduce(a) * np.minimum.accumulate(a, axis=1)[2]
    c += np.hypot.outer(x, y) * np.logaddexp.outer(x, y) + np.arctan2.outer(x, y)
    d = d * np.logaddexp.reduce(a) + np.hypot.reduce(a, axis=0) * np.logaddexp.accumulate(a)[1]
    d *= np.logaddexp.reduce(x) * np.hypot.reduce(x, keepdims=True)[0] + np.sum(np.logaddexp.accumulate(a, axis=1))
    return np.add.reduce(y) + np.sum(b ** 2) + np.sum(c * a) + np.sum(d * np.multiply.accumulate(y))


def where_it_is(a, x, y):
    k = np.where(y > 0.8)[0]
    i, j = np.nonzero(a > 0.6)
    places = np.where(a < 0.5)
    s = np.sum(y[k] ** 2) + np.sum(a[i, j] ** 2) + np.sum(y[np.flatnonzero(y > 0.7)]) + np.sum(x[np.where(x > 9.0)])
    a[places] = 2.0 * a[places]
    p, q = np.unravel_index(np.argmax(a), a.shape)
    return s + np.sum(y[(y > 0.7).nonzero()[0]]) * a[p, q] + np.sum(a[np.arange(3), np.argmax(a, axis=1)] ** 3)


def ordered(a, x, y):
    k = np.argsort(a, axis=1)
    s = np.sum(np.take_along_axis(a, k, axis=1)[:, 1] * x) + np.sum(y[np.argsort(y)[::-1]] * np.arange(4))
    s += np.sum(np.sort(a, axis=0)[0] * y) + np.sum(np.sort(a)[:, 1] * x) + np.sum(np.sort(a, axis=None)[3:5])
    s += np.median(x) + np.median(y) ** 2 + np.sum(np.median(a, axis=-1) * x) + np.median(a)
    return s + np.percentile(y, 30.0) + np.quantile(x, 0.4) + np.sum(np.percentile(a, 55, axis=0) * y)


def sought(a, x, y):
    t = np.cumsum(y)
    s = np.sum(y[np.searchsorted(t, 2.0 * x)] * x) + y[np.searchsorted(t, t[0], side="right")] ** 2
    k = np.array([0, 1, 1, 2])
    b = np.bincount(k, weights=y * y, minlength=5)
    s += np.sum(np.bincount(k) * x) + np.sum(b ** 2) + np.sum(a[[0, 2], np.array([1, 1])])
    return s + np.sum(np.take(x, k)[1:] * x) + np.sum(np.take(a, [2, 0], axis=-1) ** 2) + np.take(a, 5) * a.take(k)[3]


def selected(a, x, y):
    z = np.select([y > 0.9, y > 0.7], [y * y, y ** 3], default=0.5)
    i, j = np.triu_indices(3, 1)
    s = np.sum(a[i, j] ** 2) + np.sum(a[np.tril_indices(3)] ** 3) + np.sum(a[np.diag_indices(3)] * x)
    return s + np.sum(z) + np.nansum(y * y) + np.sum(np.extract(y > 0.7, y)) + np.ptp(y) + np.sum(np.ptp(a, axis=0) * y)


def grids(a, x, y):
    across, down = np.meshgrid(x, y)
    u, v, w = np.meshgrid(x, y, x, indexing="ij")
    i, j = np.indices((3, 4))
    k = np.indices(a.shape)
    return np.sum(across * down ** 2) + np.sum(u * v * w) + np.sum(a * i + a ** 2 * j) + np.sum(k[0] * a ** 3 + k[1])


def sections(a, x, y):
    u, v = np.split(y, 2)
    p, q = np.split(a, 2, axis=1)
    r, s = np.array_split(x, 2)
    t, w = np.split(y, [1])
    c, d = np.hsplit(a, 2)
    e = np.block([[a, a * a], [a, 2.0 * a]])
    return np.sum(u * v) + np.sum(p * q) + np.sum(r) * np.sum(s) + np.sum(t) * np.sum(w) + np.sum(c * d) + np.sum(
        e[2:, 1:] * e[:-2, :-1])


def shapes(a, x, y):
    b = np.dstack((a, a * a))
    s = np.sum(b[:, :, 0] * b[:, :, 1]) + np.sum(np.atleast_1d(x[0]) * x) + np.sum(np.atleast_2d(y) * a)
    s += np.sum(np.rot90(a) * np.arange(12.0).reshape(4, 3)) + np.sum(np.rot90(a, -1)[0]) + np.sum(np.rot90(a, 2) * a)
    s += np.sum(np.hanning(x.size) * x) * np.sum(np.hamming(3) * x**2) + np.sum(np.blackman(3) * x * np.bartlett(3))
    s += np.hanning(1)[0] * x[0] + np.bartlett(1)[0] * x[1] + np.squeeze(np.max(a, keepdims=True)) * x[0]
    s += np.sum(np.tri(3, 4) * a) + np.sum(np.diagflat(x) * a[:, 1:]) + np.sum(a.flatten()[3:] ** 2)
    return s + np.sum((x * 9.0).astype(int) * x) + np.sum((x > 0.7).astype(float) * x * x.astype(np.float64))


def polynomials(a, x, y):
    s = np.polyval(y, x[0]) + np.sum(np.polyval(y, x) ** 2) + np.sum(np.vander(x) ** 2)
    s += np.sum(np.vander(x, 4, increasing=True) * a) + np.sum(np.cross(x, y[:3]) ** 2) + np.sum(np.cross(a.T, x) ** 2)
    s += np.sum(np.correlate(y, x) ** 2) + np.sum(np.correlate(x, y, mode="full") ** 2)
    along, across = np.gradient(a, 0.5, x[0])
    return s + np.sum(along * across) + np.gradient(y)[1] ** 2


def scattered_into(x, y):
    np.add.at(x, np.array([0, 0]), y[:2])
    return x[0]


def a_helper_that_stores_at_places(a, x, y):
    s = x[0] * a[0, 0] + scattered_into(x, y) * x[0]
    np.multiply(y, y, y)
    return s + np.sum(y)


KERNELS = (results_in_place, stores_at_places, ufuncs, where_it_is, ordered, sought, selected, grids, sections, shapes,
           polynomials, a_helper_that_stores_at_places)


def arguments():
    random = generator(7)
    return 0.3 + 0.7 * random.random((3, 4)), 0.5 + random.random(3), 0.5 + random.random(4)


def in_loops(a, x, y):
    for k in range(3):
        i = np.nonzero(a[k] > 0.5)[0]
        x[k] += np.sum(a[k, i] * y[i])
        np.add.at(y, i, x[k])
        y[:] = np.sort(y * a[k])
        u, v = np.split(y, 2)
        a[k, :2] = u * v + np.median(a[k])


def ends(x):
    s = np.sum(np.sort(x)) + np.median(x) + np.quantile(x, 0.7) + np.sum(np.take(x, [0, 0])) + np.ptp(x)
    return s + np.sum(x[np.where(x > 9.0)]) + np.sum(np.nonzero(x)[0]) + np.polyval(x, 2.0)


def nothing(x):
    np.add.at(x, np.nonzero(x)[0], 1.0)
    i = np.where(x > 0.0)[0]
    return np.sum(np.sort(x)) + np.sum(x[i]) + np.sum(np.add.outer(x, x)) + np.sum(np.take(x, i)) + np.polyval(x, 2.0)


def pairs_of(x, y):
    return np.sum(np.hypot.outer(x, y) * np.logaddexp.outer(x, y)) + np.sum(np.logaddexp.accumulate(x)) * (
        np.logaddexp.reduce(x) * np.hypot.reduce(y))


def running_integers(x, y):
    return np.sum(np.logaddexp.accumulate(np.arange(3)) * x)


def running_results(a):
    return (np.sum(np.cumsum(a, axis=0) * np.cumprod(a, axis=0))
            + np.sum(np.maximum.accumulate(a, axis=0) * np.cumsum(a, axis=1)))


def places_of_one_row(a):
    return np.sum(np.take_along_axis(a, np.array([[0, 2]]), axis=1))


def cases():
    # kernel
    for kernel in KERNELS:
        given, left = arguments(), arguments()
        kernel(*left)
        of = tuple(n for n, p, q in zip("axy", given, left) if not np.array_equal(p, q))
        yield Case(kernel, given, ("a", "x", "y"), (*of, "return"))
    # in loops
    yield Case(in_loops, arguments(), ("a", "x", "y"), ("a", "x", "y"))
    # sizes of one and none
    yield Case(ends, (np.array([1.5]),), ("x",))
    yield Case(nothing, (np.zeros(0),), ("x",), ("x", "return"))
    # ufuncs of pairs
    x, y = (np.array([0.3, 0.8, 1.2]), np.array([0.5, -0.9]))
    yield Case(running_integers, (x, y), refused=(
        "S301 at `np.logaddexp.accumulate(np.arange(3))`: no derivative rule for numpy.logaddexp.accumulate: "
        "write it as a loop over the elements"))
    yield Case(pairs_of, (x, y), ("x", "y"))
    yield Case(pairs_of, (x[:1], y[1:]), ("x", "y"))
    yield Case(pairs_of, (x.astype(np.float32), y), ("x", "y"))
    # running results of any size
    for shape in ((0, 3), (1, 3), (3, 2), (3, 0)):
        yield Case(running_results, (np.linspace(0.3, 1.4, shape[0] * shape[1]).reshape(shape),), ("a",))
    # places that are not repeated
    yield Case(places_of_one_row, (np.ones((3, 3)),), refused=(
        "S501 at `np.take_along_axis(a, np.array([[0, 2]]), axis=1)`: np.take_along_axis with places for "
        "another number of rows: array_value.shape[0] is 1, a.shape[0] is 3: repeat them"))
