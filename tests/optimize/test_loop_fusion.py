"""Nests that become one at the fast level, and nests that have to stay apart."""
from __future__ import annotations

import numpy as np
import pytest

from benchmarks.kernels.cases import ARRAYS, Case
from s2sad.naming import Names
from s2sad.optimize.loop_fusion import fused
from s2sad.emit import layout
from s2sad.tree import rename, statements, walk, For
from tests.optimize.test_levels import SPELLING, same

TAKEN = {**{f: f"builtins.{f}" for f in ("range", "max")}, "empty": "numpy.empty", "matmul": "numpy.matmul",
         "reshape": "numpy.reshape"}
PARTS = {
    "one region under two names": (2, """
def f(u, v, n):
    w = empty((max(n - 2, 0), u.shape[1]))
    assert u.shape == v.shape
    for i in range(w.shape[0]):
        for j in range(w.shape[1]):
            w[i, j] = u[i + 1, j] + u[i, j]
    for k in range(1, n - 1):
        for l in range(v.shape[1]):
            v[k, l] = w[k - 1, l] * v[k, l]
"""),
    "sizes that nothing says to be equal": (2, """
def f(u, v):
    for i in range(u.shape[0]):
        u[i] = 2.0
    for i in range(v.shape[0]):
        v[i] = 3.0
"""),
    "an assertion that has not been passed": (2, """
def f(u, v, taken):
    if taken:
        assert u.shape == v.shape
    for i in range(u.shape[0]):
        u[i] = 2.0
    for i in range(v.shape[0]):
        v[i] = 3.0
"""),
    "a neighbour's element read": (2, """
def f(u, v):
    for i in range(u.shape[0] - 1):
        u[i] = 2.0
    for i in range(u.shape[0] - 1):
        v[i] = u[i + 1]
"""),
    "an assertion in a loop that may not have run": (5, """
def f(u, v, steps, n):
    for s in range(steps):
        for k in range(n):
            assert u.shape == v.shape
    for k in range(n):
        for i in range(u.shape[0]):
            u[i] = 2.0
        for i in range(v.shape[0]):
            v[i] = 3.0
"""),
    "an assertion behind the end of a loop": (6, """
def f(u, v, steps, n, taken):
    for s in range(steps):
        if taken:
            break
        for k in range(n):
            assert u.shape == v.shape
    for s in range(steps):
        for k in range(n):
            for i in range(u.shape[0]):
                u[i] = 2.0
            for i in range(v.shape[0]):
                v[i] = 3.0
"""),
    "an element for all iterations": (2, """
def f(u, v):
    for i in range(u.shape[0]):
        u[i] = 2.0
        v[0] = u[i]
    for i in range(u.shape[0]):
        u[i] = v[0]
"""),
    "a number that the first leaves": (2, """
def f(u, v):
    t = 0.0
    for i in range(u.shape[0]):
        t = u[i]
    for i in range(u.shape[0]):
        v[i] = t
"""),
    "a number made anew for each": (1, """
def f(u, v):
    for i in range(u.shape[0]):
        t = u[i]
        v[i] = t * t
    for i in range(u.shape[0]):
        t = v[i]
        u[i] = t + 1.0
"""),
    "a size that changes": (2, """
def f(u, v, n):
    w = empty(n)
    n = n + 1
    for i in range(w.shape[0]):
        u[i] = 2.0
    for i in range(n):
        v[i] = 3.0
"""),
    "a negative end and one past it": (2, """
def f(u, v, n):
    w = empty(max(n - 2, 0))
    for i in range(w.shape[0] + 1):
        u[i] = 2.0
    for i in range(n - 1):
        v[i] = 3.0
"""),
    "an assertion that reads what the first one writes": (2, """
def f(u, v):
    for i in range(u.shape[0]):
        u[i] = 2.0
    assert u[1] > 1.0
    for i in range(u.shape[0]):
        v[i] = 3.0
"""),
    "an assertion that reads something else": (1, """
def f(u, v, w):
    for i in range(u.shape[0]):
        u[i] = 2.0
    assert w[u.shape[0]] > 1.0
    for i in range(u.shape[0]):
        v[i] = 3.0
"""),
    "an array under another name": (2, """
def f(u, v):
    w = u
    for i in range(v.shape[0] - 1):
        w[i] = v[i]
    for i in range(v.shape[0] - 1):
        v[i] = u[i + 1]
"""),
    "rows of other numbers": (1, """
def f(u, v):
    for i in range(v.shape[0]):
        u[0, i] = v[i]
        u[1, i] = 2.0
    for i in range(v.shape[0]):
        u[2, i] = 3.0 + u[2, i]
"""),
    "a row that may be one of the others": (2, """
def f(u, v, k):
    for i in range(v.shape[0]):
        u[0, i] = v[i]
    for i in range(v.shape[0]):
        v[i] = u[k, i] + u[1, i]
"""),
    "a row from the end, which may be one of the others": (2, """
def f(u, v):
    for i in range(v.shape[0]):
        u[0, i] = v[i]
    for i in range(v.shape[0]):
        u[-1, i] = 2.0
"""),
    "numbers of rows in other places": (2, """
def f(u, v):
    for i in range(v.shape[0]):
        u[0, i] = v[i]
    for i in range(v.shape[0]):
        u[i, 1] = 2.0
"""),
    "the column before, of a loop around that begins behind the first": (2, """
def f(u, v, n):
    for k in range(1, n):
        for i in range(v.shape[0]):
            u[i, k] = v[i]
        for i in range(v.shape[0]):
            v[i] = u[i, k - 1]
"""),
    "the column before, of a loop around that goes down": (2, """
def f(u, v, n):
    for k in range(n - 1, 0, -1):
        for i in range(v.shape[0]):
            u[i, k] = v[i]
        for i in range(v.shape[0]):
            v[i] = u[i, k - 1]
"""),
    "the column before, which may be the last": (3, """
def f(u, v, n):
    for k in range(n):
        for i in range(v.shape[0]):
            u[i, k] = v[i]
        for i in range(v.shape[0]):
            v[i] = u[i, k - 1]
"""),
    "the column before, of a counter that the loop around changes": (3, """
def f(u, v, n):
    for k in range(1, n):
        k = k - 1
        for i in range(v.shape[0]):
            u[i, k] = v[i]
        for i in range(v.shape[0]):
            v[i] = u[i, k - 1]
"""),
    "the column before, of another column": (3, """
def f(u, v, n, m):
    for k in range(1, n):
        for i in range(v.shape[0]):
            u[i, k] = v[i]
        for i in range(v.shape[0]):
            v[i] = u[i, m]
"""),
    "the element before, of a loop around with the same counter": (3, """
def f(u, v, n):
    for i in range(1, n):
        for i in range(1, v.shape[0]):
            u[i] = v[i]
        for i in range(1, v.shape[0]):
            v[i] = u[i - 1]
"""),
    "what has nothing to do with them in between": (3, """
def f(u, v, w, y):
    for i in range(u.shape[0]):
        u[i] = 2.0
    p = matmul(w, y)
    for i in range(w.shape[0]):
        for j in range(w.shape[1]):
            w[i, j] = y[i]
    for i in range(u.shape[0]):
        v[i] = u[i]
"""),
    "what reads the first one in between": (2, """
def f(u, v, w):
    for i in range(u.shape[0]):
        u[i] = 2.0
    p = matmul(w, u)
    for i in range(u.shape[0]):
        v[i] = u[i]
"""),
    "what writes an operand of the first one in between": (3, """
def f(u, v, w):
    for i in range(u.shape[0]):
        u[i] = w[0]
    for j in range(w.shape[0]):
        w[j] = 1.0
    for i in range(u.shape[0]):
        v[i] = u[i]
"""),
    "what writes the size of the first one in between": (2, """
def f(u, v, n):
    for i in range(n):
        u[i] = 2.0
    n = v.shape[0] + n - v.shape[0]
    for i in range(n):
        v[i] = u[i]
"""),
    "a part of the first one's array in between": (2, """
def f(u, v):
    for i in range(u.shape[0]):
        u[i] = 2.0
    w = u[1:]
    for i in range(u.shape[0]):
        v[i] = u[i]
"""),
    "what reads the first one's array under another name in between": (2, """
def f(u, v, y):
    w = reshape(u, (2, 2))
    for i in range(v.shape[0]):
        u[i] = v[i]
    p = matmul(w, y)
    for i in range(v.shape[0]):
        v[i] = 2.0
"""),
    "a number that the first one leaves, in between": (3, """
def f(u, v, w):
    t = 0.0
    for i in range(u.shape[0]):
        t = u[i]
    for j in range(w.shape[0]):
        w[j] = t
    for i in range(u.shape[0]):
        v[i] = 1.0
"""),
    "a call in between": (2, """
def f(u, v, w):
    for i in range(u.shape[0]):
        u[i] = 2.0
    t = helper(w)
    for i in range(u.shape[0]):
        v[i] = u[i]
"""),
    "a branch that leaves, in between": (3, """
def f(u, v, w):
    for k in range(u.shape[0]):
        for i in range(u.shape[0]):
            u[i] = 2.0
        if w[0] > 1.0:
            break
        for i in range(u.shape[0]):
            v[i] = u[i]
"""),
}


@pytest.mark.parametrize("kind", PARTS)
def test_what_is_joined(kind):
    loops, text = PARTS[kind]
    made = fused(rename(statements(text)[0], TAKEN), set(), {}, Names(set()))
    assert sum(isinstance(n, For) for n in walk(made)) == loops, layout.text(made, SPELLING)


@pytest.mark.parametrize("store, loops", [("{0}[j]", 4), ("{0}[0, j]", 4), ("{0}[j, 0]", 2)])
def test_how_many_arrays_meet_in_a_loop_with_vectors(store, loops):
    """Arrays of the function's own: in one loop they would be too many for the test whether they overlap, which a loop
    that stores along columns does not have."""
    arrays = [f"w{k}" for k in range(12)]
    text = "\n".join(["def f(u, n):", *(f"    {w} = empty((n, n))" for w in arrays), *(line for half in (
        arrays[:6], arrays[6:]) for line in ("    for i in range(n):", "        for j in range(n):", *(
            f"            {store.format(w)} = u[i, j]" for w in half)))])
    made = fused(rename(statements(text)[0], TAKEN), set(), {}, Names(set()))
    assert sum(isinstance(n, For) for n in walk(made)) == loops


def test_what_an_earlier_loop_has_asserted():
    text = """
def f(u, v, steps):
    for s in range(steps):
        assert u.shape == v.shape
    for s in range(steps - 1, -1, -1):
        for i in range(u.shape[0]):
            u[i] = 2.0
        for i in range(v.shape[0]):
            v[i] = 3.0
"""
    made = fused(rename(statements(text)[0], TAKEN), set(), {}, Names(set()))
    assert sum(isinstance(n, For) for n in walk(made)) == 3


@pytest.mark.parametrize("name", ["glacier", "masked_flow", "lattice"])
def test_levels_agree(name):
    same(next(c for c in ARRAYS if c.name == name))


def sums_of_two_numbers(u, v, a):
    u[1:-1] += a * v[1:-1]
    v[1:-1] *= a * u[1:-1]


def test_gains_of_a_number_from_joined_loops():
    same(Case("sums", sums_of_two_numbers, lambda _: (np.arange(1.0, 6.0), np.arange(2.0, 7.0), 0.5), ("u", "v", "a"),
              ("u", "v")))
