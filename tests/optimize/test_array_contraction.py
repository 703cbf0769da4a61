"""Arrays that several nests fill anew become numbers in each, and arrays that hand anything on stay."""
from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import s2sad
from s2sad.emit import layout
from s2sad.infer.types import Type
from s2sad.liveness import base_name
from s2sad.naming import Names
from s2sad.optimize.loop_fusion import fused
from s2sad.tree import AST, Subscript, rename, statements, walk
from tests.corpus.loops.array_contraction import of_flags, of_integers, of_one_integer
from tests.harness.seeds import generator
from tests.optimize.test_levels import SPELLING

TAKEN = {"range": "builtins.range", "empty": "numpy.empty", "zeros": "numpy.zeros", "sum_of": "numpy.sum"}
KEPT = {
    "filled in each of two loops": (False, """
def f(u, v, n):
    w = empty(n)
    for k in range(3):
        for i in range(n):
            w[i] = u[i] + k
            v[i] += w[i] * w[i]
    for k in range(2, -1, -1):
        for i in range(n):
            w[i] = v[i] * k
            u[i] += w[i]
"""),
    "filled in each of two loops by two nests": (False, """
def f(u, v, n):
    w = empty(n)
    for k in range(3):
        for i in range(n):
            w[i] = u[i] + k
        for i in range(n):
            v[i] += w[i] * w[i]
    for k in range(2, -1, -1):
        for i in range(n):
            w[i] = v[i] * k
        for i in range(n):
            u[i] += w[i]
"""),
    "filled at other elements in the second loop": (False, """
def f(u, v, n):
    w = empty(n + 1)
    for i in range(n):
        w[i] = u[i]
        v[i] += w[i]
    for i in range(n - 1):
        w[i + 1] = v[i + 1]
        u[i] += w[i + 1]
"""),
    "read by a nest that does not fill it": (True, """
def f(u, v, n):
    w = empty(n)
    for k in range(3):
        for i in range(n):
            w[i] = u[i] + k
            v[i] += w[i] * w[i]
    for k in range(2):
        for i in range(n):
            u[i] += w[i]
"""),
    "read before it is filled": (True, """
def f(u, v, n):
    w = zeros(n)
    for k in range(3):
        for i in range(n):
            w[i] = u[i] + k
            v[i] += w[i] * w[i]
    for k in range(2):
        for i in range(n):
            u[i] += w[i]
            w[i] = u[i]
"""),
    "added to first": (True, """
def f(u, v, n):
    w = zeros(n)
    for k in range(3):
        for i in range(n):
            w[i] = u[i] + k
            v[i] += w[i] * w[i]
    for k in range(2):
        for i in range(n):
            w[i] += u[i]
            u[i] += w[i]
"""),
    "filled by some iterations": (True, """
def f(u, v, n):
    w = zeros(n)
    for k in range(3):
        for i in range(n):
            w[i] = u[i] + k
            v[i] += w[i] * w[i]
    for k in range(2):
        for i in range(n):
            if u[i] > 1.0:
                w[i] = 2.0 * u[i]
            u[i] += w[i]
"""),
    "read at the element before": (True, """
def f(u, v, n):
    w = empty(n)
    for k in range(3):
        for i in range(n):
            w[i] = u[i] + k
            v[i] += w[i]
    for i in range(1, n):
        w[i] = v[i]
        u[i] += w[i - 1]
"""),
    "at a place that moves": (True, """
def f(u, v, n):
    w = zeros(n + 4)
    for k in range(3):
        for i in range(n):
            w[i] = u[i] + k
            v[i] += w[i]
    for i in range(n):
        m = i
        w[m] = v[i]
        m = m + 1
        u[i] += w[m]
"""),
    "one element read behind the loops": (True, """
def f(u, v, n):
    w = empty(n)
    for k in range(3):
        for i in range(n):
            w[i] = u[i] + k
            v[i] += w[i]
    u[0] = w[1]
"""),
    "read as a whole": (True, """
def f(u, v, n):
    w = empty(n)
    for k in range(3):
        for i in range(n):
            w[i] = u[i] + k
            v[i] += w[i]
    u[0] = sum_of(w)
"""),
}
NUMBERS = {n: Type("number", "int64") for n in ("n", "k", "i", "m")}


def run(text: str) -> list[np.ndarray]:
    space: dict[str, Any] = {"numpy": np, "empty": np.empty, "zeros": np.zeros, "sum_of": np.sum, "np": np}
    exec(text, space)
    rng = generator(5)
    u, v = rng.random(6) + 0.6, rng.random(6)
    space["f"](u, v, 6)
    return [u, v]


def mentions(tree: AST) -> int:
    return sum(isinstance(n, Subscript) and base_name(n) == "w" for n in walk(tree))


@pytest.mark.parametrize("kind", KEPT)
def test_what_hands_nothing_on(kind):
    kept, text = KEPT[kind]
    arrays = {n: Type("array", "float64", rank=1) for n in ("u", "v", "w")}
    made = fused(rename(statements(text)[0], TAKEN), set(), {**arrays, **NUMBERS}, Names({"u", "v", "w", *NUMBERS}))
    after = layout.text(made, {**SPELLING, "numpy.sum": "sum_of", "numpy.empty": "empty", "numpy.zeros": "zeros"})
    assert bool(mentions(made)) == kept, after
    for ours, theirs in zip(run(after), run(text)):
        np.testing.assert_array_equal(ours, theirs)


def test_elements_of_another_type_stay():
    """A number of the function's would not round as the array's elements do."""
    text = KEPT["filled in each of two loops"][1]
    types = {"u": Type("array", "float64", rank=1), "v": Type("array", "float64", rank=1),
             "w": Type("array", "float32", rank=1), **NUMBERS}
    assert mentions(fused(rename(statements(text)[0], TAKEN), set(), types, Names({"u", "v", "w", *NUMBERS})))


@pytest.mark.parametrize("kernel", [of_integers, of_one_integer, of_flags])
def test_an_element_is_a_float_whatever_is_stored(kernel):
    """Compiled, for a number that held an integer would have an integer's powers."""
    rng = generator(5)
    given = rng.random((4, 5)) + 0.5, rng.random((4, 5)) + 0.5
    found = [s2sad.vjp(s2sad.differentiate(kernel, wrt=("u", "v"), of="v", engine=e), given, {"v": np.ones((4, 5))})
             for e in ("numba", "numpy")]
    for name in ("u", "v"):
        np.testing.assert_allclose(found[0][name], found[1][name], rtol=1e-13)
        assert np.all(found[0][name])
