"""Options of NumPy's functions: taken as NumPy takes them, or refused."""
from __future__ import annotations

import math

import numpy as np
from scipy import linalg

from tests.corpus import Case
from tests.harness.seeds import generator


def filled_where(x, y, a):
    """The array for a result is made in the call, a part, or one of two names."""
    z = np.divide(x, y, out=np.zeros_like(x), where=y > 0.5)
    e = np.exp(x, out=np.empty(5))
    w: np.ndarray = np.sin(y, out=np.empty(5))
    p = q = np.multiply(x, y, out=x.copy())
    p[0] = 3.0 * z[0]
    s = np.sum(a, axis=0, out=np.zeros(5))
    y[1:] = np.maximum(np.add(x[1:], y[1:], out=s[1:]), 0.1)
    return np.sum(z * w + e * q) + np.sum(np.divide(x, y, out=np.ones_like(x), where=x > 0.6) ** 2) + np.sum(s ** 2)


def returned(x, y, a):
    return np.divide(x, y, out=np.zeros_like(x), where=y > 0.5)


def positions(x, y, a):
    """Where `out` stands by position; options that are true and not written True."""
    b = np.zeros(2)
    np.max(a, 1, b)
    z = np.round(x * 10.0, 0, y)
    c = a / np.sum(a ** 2, axis=1, keepdims=1)
    return np.sum(b ** 2) + np.sum(z * x) + np.sum(c * np.linspace(x[0], x[1], 5, endpoint=1)) + np.sum(
        np.vander(x, 3, increasing=1))


def dtypes(x, y, a):
    """Results of integers that are floats."""
    k = np.array([3, 1, 4])
    w = np.full(5, round(x[0], 1)) + math.pow(2, -1)
    v, u = np.full(3, math.fmod(5, 3)), np.rint(k)
    v[0], u[1] = x[0] ** 2, x[1] ** 2
    h = np.hstack((k, x[2]))
    mask = (x > 0.7) * 2
    mask[0] += 3
    return np.sum(w * x) + np.sum(v * u) + np.sum(h ** 2) * np.sum(np.append(k, y[0])) + np.sum(mask * y) + np.sum(
        np.extract(np.array([2, 0, 1, 0, 3]), x))


def copied(x, y, a):
    """Powers and products of bools are numbers; a copy is one."""
    b = np.array(x, copy=True)
    b[0] = y[0] * x[1]
    m = (x > 0.7) ** 1 + (y > 0.5) ** 1
    return np.sum(b * x * m) + x[0] * (True * 1 + 1 * True)


def shifted(u, v, start, axis):
    u[...] = v + np.roll(v, 1, axis)


def one_array_twice(x, y, a):
    """The helper is made without its second parameter; its axis is still the last argument."""
    shifted(a, a, 0, 1)
    shifted(a, a, 0, 1)
    return a[0, 1] * a[1, 0]


CASES = [(copied, ("return",)), (one_array_twice, ("a", "return")),
         (filled_where, ("y", "return")), (returned, ("return",)), (positions, ("return",)), (dtypes, ("return",))]


def transposed(x, y, a):
    m = np.diag(x) + np.triu(np.outer(x, y), 1) + np.eye(5) * 2.0
    return np.sum(linalg.solve_triangular(m, y, 2) * x) + np.sum(linalg.solve_triangular(m, y, "T") ** 2)


def along_both(x, y, a):
    g, h = np.gradient(np.outer(x, y), axis=(0, 1))
    return np.sum(g * h)


def three_spacings(x, y, a):
    f, g, h = np.gradient(x[:, None, None] * y[:, None] * y, 1, 1, 1)
    return np.sum(f * g * h)


def own(x):
    x[0] *= 2.0
    return x[1]


def beside_a_call(x):
    return np.sum(np.multiply(own(x), x, out=x.copy(), where=x > 0.5))


def cases():
    # kernel
    for kernel, of in CASES:
        random = generator(3)
        given = 0.2 + random.random(5), 0.2 + random.random(5), 0.2 + random.random((2, 5))
        yield Case(kernel, given, ("x", "y", "a"), of)
    # a transposition by position
    given = 0.2 + np.arange(5.0) / 5.0, 1.0 - np.arange(5.0) / 7.0, np.ones(1)
    yield Case(transposed, given, ("x", "y"))
    # parts of a gradient along axes that are not told apart
    for kernel, refused in (
            (along_both,
             "S203 at `np.gradient(np.outer(x, y), axis=(0, 1))`: the type of 'gradient_0' cannot be inferred: "
             "what numpy.gradient gives with axis= is not known: bind each of the parts to a name: i, j = ...\n"
             "S203 at `np.gradient(np.outer(x, y), axis=(0, 1))`: the type of 'gradient_1' cannot be inferred: "
             "what numpy.gradient gives with axis= is not known: bind each of the parts to a name: i, j = ...\n"
             "S203 at `g, h = np.gradient(np.outer(x, y), axis=(0, 1))`: the type of 'g' cannot be inferred: "
             "write it with operations on numbers and arrays that are known\nS203 at `g, h = "
             "np.gradient(np.outer(x, y), axis=(0, 1))`: the type of 'h' cannot be inferred: write it with "
             "operations on numbers and arrays that are known"),
            (three_spacings,
             "S203 at `np.gradient(x[:, None, None] * y[:, None] * y, 1, 1, 1)`: the type of 'gradient_0' cannot "
             "be inferred: what numpy.gradient gives with spacing=, second=, third= is not known: bind each of "
             "the parts to a name: i, j = ...\nS203 at `np.gradient(x[:, None, None] * y[:, None] * y, 1, 1, "
             "1)`: the type of 'gradient_1' cannot be inferred: what numpy.gradient gives with spacing=, "
             "second=, third= is not known: bind each of the parts to a name: i, j = ...\nS203 at "
             "`np.gradient(x[:, None, None] * y[:, None] * y, 1, 1, 1)`: the type of 'gradient_2' cannot be "
             "inferred: what numpy.gradient gives with spacing=, second=, third= is not known: bind each of the "
             "parts to a name: i, j = ...\nS203 at `f, g, h = np.gradient(x[:, None, None] * y[:, None] * y, 1, "
             "1, 1)`: the type of 'f' cannot be inferred: write it with operations on numbers and arrays that "
             "are known\nS203 at `f, g, h = np.gradient(x[:, None, None] * y[:, None] * y, 1, 1, 1)`: the type "
             "of 'g' cannot be inferred: write it with operations on numbers and arrays that are known\nS203 at "
             "`f, g, h = np.gradient(x[:, None, None] * y[:, None] * y, 1, 1, 1)`: the type of 'h' cannot be "
             "inferred: write it with operations on numbers and arrays that are known")):
        yield Case(kernel, (np.ones(5), np.ones(5), np.ones(1)), "x", refused=refused)
    # an array that is made beside a call
    yield Case(beside_a_call, (np.ones(3),), "x", of=("x", "return"))
