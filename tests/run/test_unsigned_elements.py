"""Which indices are unsigned where some arrays have no negative element: those that come out of these, and are never
negative."""
from __future__ import annotations

import ast
import re

import numpy as np
import pytest

import s2sad
from s2sad.run.unsigned_elements import Known, unsigned_elements

GIVEN = {"x": Known(1), "n": Known(0), "k": Known(1, True, True), "table": Known(2, True, True), "starts": Known(
    1, True, True), "signed": Known(1)}


def unsigned(text, entry="f"):
    """The indices of a text that become unsigned."""
    tree = unsigned_elements(ast.parse(text), [entry], GIVEN)
    calls = [n for n in ast.walk(tree) if isinstance(n, ast.Call) and ast.unparse(n.func) == "_uintp"]
    marked = [ast.unparse(n.args[0]) for n in calls]
    return [re.sub(r"_uintp\((\w+)(\[n\])?\)", r"\1\2", m) for m in marked]


@pytest.mark.parametrize(("body", "found"), [
    ("x[k[n]] = x[k[0]]", ["k[n]", "k[0]"]),
    ("x[3 * k[0] + 1] = x[k[0] - 1]", ["3 * k[0] + 1"]),
    ("x[signed[0]] = x[n]", []),
    ("x[signed[k[0]]] = 1.0", ["k[0]"]),
    ("x[table[n, 1]] = x[table[k[n], 0] // 2]", ["table[n, 1]", "table[k[n], 0] // 2", "k[n]"]),
    ("x[table[0]] = 1.0", []),
    ("x[table[0, :2]] = 1.0", []),
    ("x[min(k[0], x.shape[0] - 1)] = x[max(n, k[1])]", ["max(n, k[1])"]),
    ("a = k[0]\n    x[a] = x[a + n]", ["a"]),
    ("a = k[0]\n    a = n\n    x[a] = 1.0", []),
    ("a = k[0]\n    a += n\n    x[a] = 1.0", []),
    ("a = k[0]\n    a, b = n, n\n    x[a] = 1.0", []),
    ("k = signed\n    x[k[0]] = 1.0", []),
    ("for i in range(starts[n], starts[n + 1]):\n        x[i] = x[i - 1]", ["i"]),
    ("for i in range(starts[n] - 1, starts[n + 1]):\n        x[i] = 1.0", []),
    ("for i in range(starts[n + 1] - 1, starts[n] - 1, -1):\n        x[i] = x[i + k[i]]", ["i", "i", "i + k[i]"]),
    ("for i in range(starts[n], starts[n + 1], -1):\n        x[i] = 1.0", []),
    ("for i in range(starts[n], -1, -1):\n        x[i] = 1.0", ["i"]),
    ("for i in range(starts[n], n, 2):\n        x[i] = 1.0", ["i"]),
    ("a = 0\n    while x[a] > 0.0:\n        a = a + k[a]\n    x[a] = 1.0", []),
])
def test_what_is_unsigned(body, found):
    assert sorted(unsigned(f"def f(x, n, k, table, starts, signed):\n    {body}")) == sorted(found)


HELPER = """def g(y, i, picked):
    y[i] = y[picked[i]]


"""


@pytest.mark.parametrize(("calls", "found"), [
    (["g(x, k[0], k)"], {"i", "picked[i]"}),
    (["g(x, k[0], table[n])"], {"i", "picked[i]"}),
    (["g(x, k[0], k)", "g(x, n, k)"], {"picked[i]"}),
    (["g(x, k[0], k)", "g(x, k[1], signed)"], {"i"}),
    (["g(x, k[0], k)", "g(x, unknown, k)"], set()),
])
def test_functions_that_are_called(calls, found):
    body = "".join(f"    {c}\n" for c in calls)
    assert set(unsigned(f"{HELPER}def f(x, n, k, table, starts, signed):\n{body}")) == found


def gathered(y, x, places):
    for i in range(places.shape[0]):
        y[places[i]] += x[i] * x[places[i] - 1]


def test_bare_functions_take_places_from_the_end():
    pytest.importorskip("numba")
    f = s2sad.differentiate(gathered, wrt="x", of="y", engine="numba")
    x, seeds = np.array([1.0, 2.0, 3.0]), np.array([1.0, 10.0, 100.0])

    def arguments(places):
        return np.zeros(3), seeds.copy(), x, np.zeros(3), np.array(places)
    bare = f.compiled("adjoint", *arguments([1, 2, 1]))
    for places in ([1, 2, 1], [-1, 0, -2], [2, 0, 1]):
        called, other, plain = arguments(places), arguments(places), arguments(places)
        f.adjoint(*called)
        bare(*other)
        s2sad.differentiate(gathered, wrt="x", of="y", engine="numpy").adjoint(*plain)
        np.testing.assert_array_equal(called[3], plain[3])
        np.testing.assert_array_equal(other[3], plain[3])
