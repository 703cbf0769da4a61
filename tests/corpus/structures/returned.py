"""Structures that a kernel makes and gives to functions that return them."""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tests.corpus import Case

X = np.array([0.3, 0.7, 1.1, 2.5, 0.9])


@dataclass
class S:
    u: np.ndarray
    k: float


def in_array(s, x):
    s.u[0] = s.u[1] * x[0]
    return s


def in_field(s, x):
    s.k = s.k * x[0]
    return s


def twice(x):
    s = S(x.copy(), 1.5)
    s = in_array(s, x)
    t = in_array(s, x[1:])
    return np.sum(s.u) * s.k * t.u[0] * t.k


def in_a_loop(x):
    s = S(x.copy(), 1.5)
    for _ in range(3):
        s = in_array(s, x)
        in_array(s, x)
    return np.sum(s.u) * s.k


def field_of_its_own(x):
    s = S(x.copy(), 1.5)
    s = in_field(s, x)
    in_field(s, x)
    return np.sum(s.u) * s.k


def without_a_name(x):
    s = in_array(S(x.copy(), 2.0 * x[1]), x)
    return np.sum(s.u) * s.k


def of_parts_of_another(x):
    s = in_array(S(x[:3], 2.0 * x[4]), x[3:])
    t = in_array(S(k=s.k * x[1], u=s.u[1:]), x=x * 1.0)
    x[1] *= 2.0
    s.u[0] *= t.u[0]
    return np.sum(x * x) * t.k * s.k


def one_in_another(x):
    s = in_array(in_array(S(x, 2.0), x * 1.0), x[2:] * 1.0)
    x = 3.0 * x
    return np.sum(s.u ** 2) * s.k + np.sum(x)


def written(x):
    x[0] = 2.0 * x[1]
    return x[0]


def scaled(c, s):
    s.u[0] *= c
    return s


def beside_a_call(x):
    s = scaled(written(x), S(x * 1.0, 1.0))
    return np.sum(s.u)


def moved(s, v):
    s.u += 0.1 * v * s.k
    s.u %= 2.0


def added_in_place(x):
    """What is added to an array is added in place, and so to the array that the caller has, and to its argument."""
    s = S(x * 2.0, 1.5)
    t = S(x, x[1])
    for _ in range(2):
        moved(s, x)
        moved(t, s.u[0])
    moved(S(s.u[1:], 0.5), t.u[:-1])
    return np.sum(s.u ** 2) * t.k


def added_to_a_number(x):
    s = S(x[0], 1.5)
    moved(s, x[1])
    return s.u


def _first_above(s, x):
    """A number out of a loop that changes a field."""
    for v in x:
        s.k = s.k * 0.9 + 0.3 * v
        if s.k > 1.2:
            return s.k
    return 0.1 * s.k


def _halved(s, x):
    while s.k > 0.5:
        s.k = 0.5 * s.k * x[0]
        if s.k < 0.2:
            return 3.0 * s.k
        for v in x:
            s.k += 0.1 * v
            if v > 1.0:
                return s.k * v
    return s.k


def _pair(s, x):
    for v in x:
        s.k = s.k * 0.9 + 0.3 * v
        if s.k > 0.8:
            return s.k, v
    return s.k, 0.1


def out_of_loops_in_rounds(x):
    """A loop around the call, of which it is not known when it ends, goes on with what the call left."""
    s, n = S(x.copy(), 0.5), 0
    while s.k < 2.0:
        n += 1
        if n > 3:
            break
        s.k = s.k * 0.9 + _first_above(s, x)
    return s.k * np.sum(x)


def out_of_two_loops_in_rounds(x):
    s, total = S(x.copy(), 0.9), 0.0
    while total < 4.0:
        s.k = s.k + 0.4
        total += _halved(s, x) + 0.2 * _first_above(s, x)
        if s.k > 2.0:
            break
        _halved(s, x)
    return s.k * total


def pairs_out_of_loops_in_rounds(x):
    s, total = S(x.copy(), 0.2), 0.0
    for v in x:
        a, b = _pair(s, x)
        s.k = 0.4 * a * v
        total += a * b
        if _first_above(s, x) > 2.0:
            break
    return s.k * total


def cases():
    # out of loops
    for kernel in (out_of_loops_in_rounds, out_of_two_loops_in_rounds, pairs_out_of_loops_in_rounds):
        yield Case(kernel, (X,), "x")
    # added in place
    yield Case(added_in_place, (X,), ("x",), ("x", "return"))
    yield Case(added_in_place, (X[:2].astype(np.float32),), ("x",), ("x", "return"))
    # derivatives
    for kernel in (twice, in_a_loop, without_a_name, of_parts_of_another, one_in_another):
        yield Case(kernel, (X,), ("x",))
    yield Case(field_of_its_own, (X,), "x")
    yield Case(beside_a_call, (X,), "x", of=("x", "return"))
    # what is refused
    # a number in a field for an array is refused
    yield Case(added_to_a_number, (X,), "x")
