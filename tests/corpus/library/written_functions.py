"""Functions of NumPy's that are read as Python: of functions, of polynomials, reductions of what a mask picks."""
from __future__ import annotations

import itertools
import math
import operator

import numpy as np

from tests.corpus import Case

X = np.array([0.7, 0.2, 1.4, 0.35, 0.9])
A = np.array([[0.3, -0.9, 0.7], [0.5, 0.2, -0.6]])


def pieces(x, a):
    first = np.piecewise(x, [x < 0.5, x > 0.8], [lambda v: v ** 2, lambda v: 1.0 / v, 2.0])
    return np.sum(first * x) + np.sum(np.piecewise(a, [a < 0.0], [np.sin, np.exp]) ** 2) + np.sum(
        np.piecewise(x, x < 0.5, [0.0, lambda v: 1.0 / v]))


def along_axes(x, a):
    def unit(v):
        return v / np.linalg.norm(v)
    total = np.sum(np.apply_along_axis(lambda v: v @ v, 1, a) ** 2) + np.apply_along_axis(np.sum, 0, x)
    return total + np.sum(np.apply_along_axis(unit, 0, a) ** 3)


def grids(x, a):
    field = np.fromfunction(lambda i, j: i + 2.0 * j, (2, 3)) * a
    first, second = np.broadcast_arrays(a, a[0])
    total = np.sum(field ** 2 * second) + np.sum(first * np.expand_dims(x, (0, 2))[0, 3:])
    total += np.sum(np.append(a, field[:1], axis=0)[-1]) + np.sum(np.linspace(a[0], a[1], 4)[1] ** 2)
    total += np.sum(np.rollaxis(np.stack([a, field]), 2)[0] ** 2)
    return total * a[np.unravel_index(np.argmax(a), a.shape)]


def series(x, a):
    p = np.polynomial
    total = p.chebyshev.chebval(0.3, x) + np.sum(p.legendre.legval(a, x[:3]) ** 2) + p.hermite.hermval(x[0], x)
    total += p.hermite_e.hermeval(0.2, x) + p.laguerre.lagval(0.7, [1.0, x[0], x[1]]) + p.Polynomial(x)(x[1])
    return total + np.sum(np.polyadd(x, x[:3]) * np.polysub(x[:2], x))


def polynomial(x, a):
    p = np.poly1d(x)
    q = p.deriv() * p + 2.0 * np.poly1d([1.0, x[0]]) - p
    return q(0.4) + p.integ()(x[1])


def quadrature(x, a):
    nodes, weights = np.polynomial.legendre.leggauss(3)
    points = 0.5 * (x[1] - x[0]) * nodes + 0.5 * (x[0] + x[1])
    total = 0.0
    for w, p in zip(weights, points):
        total += w * np.exp(-x[2] * p * p)
    return total + np.sum(weights * points ** 2)


def signals(x, a):
    windows = np.lib.stride_tricks.sliding_window_view(x, 3)
    total = np.sum(windows.mean(axis=1) ** 2) + np.sum(np.ediff1d(x, to_begin=0.5, to_end=a[0]) ** 2)
    return total + np.sum(np.unwrap(9.0 * x) ** 2) + np.sum(np.unwrap(6.0 * a, period=3.0))


def masked(x, a):
    some = a > -0.7
    total = np.mean(a, where=some) + np.std(a, axis=1, where=some).sum() + a.mean(axis=1, where=some)[0]
    total += np.max(a, axis=1, keepdims=True, initial=0.6).sum() + x.min(initial=0.3)
    total += a.max(where=a < 0.6, initial=0.0)
    return total + np.var(a, where=some, ddof=1) * x[0]


def classes_of_polynomials(x, a):
    make, p = np.poly1d, np.poly1d([x[0], 1.0])
    known = isinstance(p, np.poly1d) and type(p) is make and not isinstance(p, np.polynomial.Polynomial)
    return (make([x[1], 2.0]) * p)(x[2]) * (a[0, 0] if known else a[0, 1]) + np.sum(np.polysub(x[0], x[1:]) ** 2)


def several_points(x, a):
    return np.sum(np.polynomial.legendre.leggauss(100)[0]) * x[0]


def windows_of_axes(x, a, n):
    windows = np.lib.stride_tricks.sliding_window_view(a, (2, n))
    columns = np.lib.stride_tricks.sliding_window_view(a, n, axis=1)
    total = np.sum(windows.mean(axis=(2, 3)) * windows[:, :, 1, 0]) + np.max(windows[0, 0])
    return total + np.sum(columns[..., 0] * columns[..., n - 1]) * x[0]


def window_written_behind(x, a, n):
    y = x * 1.0
    windows = np.lib.stride_tricks.sliding_window_view(y, n)
    y[0] = 5.0 * x[0]
    return np.sum(windows ** 2)


def windows_that_do_not_fit(x, a, n):
    return np.sum(np.lib.stride_tricks.sliding_window_view(x, n + 9))


@np.vectorize
def opacity(v):
    if v < 0.5:
        return 0.2 + v ** 2
    return 0.45 + 0.1 * np.log(2 * v)


power = np.vectorize(lambda v, n: v ** n if v > 0.5 else 0, otypes=[float])
truncated = np.vectorize(lambda v: v if v > 0.5 else 0)


def element_by_element(x, a):
    @np.vectorize
    def ratio(v, w):
        quotient = v / w
        return x[0] * quotient
    inner = np.vectorize(lambda v: math.exp(-x[1] * v) if v > 0.45 else 1.0 / (1.0 + v * v))
    total = np.sum(opacity(a + 1.0) * inner(a)) + opacity(x[0] + 1.0) + np.sum(power(x, 3) * ratio(x, x[::-1]))
    return total + np.sum(power(x[:, None], x) ** 2)


def of_the_type_of_the_first(x, a):
    return np.sum(truncated(x) ** 2)


SPRINGS = [("a", 2.0, 1), ("b", 1.0, 2), ("a", 3.0, 0)]


def sorted_and_grouped(x, a):
    s = 0.0
    for _, stiffness, k in sorted(SPRINGS, key=operator.itemgetter(1)):
        s = s * 0.5 + stiffness * x[k]
    for name, group in itertools.groupby(sorted(SPRINGS), key=operator.itemgetter(0)):
        for _, stiffness, k in group:
            s += x[k] ** 2 * stiffness * (1.0 if name == "a" else x[0])
    for k, group in itertools.groupby([2, 2, 0, 1, 1]):
        s += x[k] * len(list(group))
    k, stiffness = operator.itemgetter(2, 1)(max(SPRINGS, key=lambda spring: spring[1]))
    return s + stiffness * x[k] + operator.methodcaller("sum")(a * a)


def items_in_their_turn(x, a):
    us, s = [x[0], x[1], x[2]], 0.0
    for v, w in itertools.zip_longest(us, [1.0, 2.0], fillvalue=0.5):
        us[2] = x[3] * 7.0
        s += v * w
    for _, group in itertools.groupby(us, key=lambda v: 0):
        for v in group:
            us[1] = a[0, 0] * s
            s += v * us[0]
    return s


def groups_that_are_gone(x, a):
    s = 0.0
    for k, group in list(itertools.groupby([0, 0, 1, 2])):
        s += x[k] + sum(x[v] ** 2 for v in group)
    for k, group in itertools.groupby([0, 0, 1, 0, 0]):
        s += x[next(group)] * x[1] + k * x[2]
    return s


def of_different_lengths(x, a):
    return sum(v * w for v, w in itertools.zip_longest(x, x[:1] * 2.0, fillvalue=0.5)) + sum(
        v for (v,) in itertools.zip_longest(a[0])) * x[0]


def on_the_diagonal(x, a):
    k = np.outer(x, x)
    k[np.diag_indices_from(k)] += a[0, 0]
    k[np.triu_indices_from(k, 1)] *= 2.0
    return np.sum(k ** 2) + np.sum(a[np.tril_indices_from(a)] * a[1, 2])


def letters(x, word):
    places = ["-abc".index(letter) for letter in word]
    return x[places].sum() * x[0] + sum(x["abc".index(letter)] for letter in word)


def cases():
    for kernel in (pieces, along_axes, grids, series, polynomial, quadrature, signals, masked, classes_of_polynomials):
        yield Case(kernel, (X.copy(), A.copy()), ("x", "a"))
    yield Case(several_points, (X.copy(), A.copy()), ("x",), refused=(
        "S201 at `np.polynomial.legendre.leggauss(100)`: a quadrature of 100 points: take 64 at most"))
    yield Case(windows_of_axes, (X.copy(), A.copy(), 2), ("x", "a"))
    yield Case(window_written_behind, (X.copy(), A.copy(), 2), ("x",), refused=(
        "S201 at `y[0] = 5.0 * x[0]`: an array is written that NumPy shares with another one, which is a view of it by "
        "a function: write into the array itself, or take a copy: np.copy(...)"))
    yield Case(windows_that_do_not_fit, (X.copy(), A.copy(), 2), ("x",), refused=(
        "S501 at `np.lib.stride_tricks.sliding_window_view(x, n + 9)`: a window that is longer than its axis, or has "
        "no elements"))
    yield Case(element_by_element, (X.copy() + 1.0, A.copy()), ("x", "a"))
    yield Case(of_the_type_of_the_first, (X.copy(), A.copy()), ("x",), refused=(
        "S201 at `truncated`: np.vectorize gives all results the type of the first one, which is not seen to be a "
        "float: say the type, np.vectorize(f, otypes=[float]), or write a comprehension: np.array([f(v) for v in x])"))
    yield Case(sorted_and_grouped, (X.copy(), A.copy()), ("x", "a"))
    yield Case(items_in_their_turn, (X.copy(), A.copy()), ("x", "a"))
    yield Case(groups_that_are_gone, (X.copy(), A.copy()), ("x",))
    yield Case(of_different_lengths, (X.copy(), A.copy()), ("x", "a"))
    yield Case(on_the_diagonal, (X.copy(), A.copy()), ("x", "a"))
    yield Case(letters, (X.copy(), "abcb"), ("x",))
