"""Sizes that are spelled as arrays were allocated, and allocations that nothing needs."""
from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from s2sad.emit import layout
from s2sad.infer.types import Type
from s2sad.optimize.shape_propagation import shape_propagation
from s2sad.tree import rename, statements

SPELLING = {f"numpy.{n}": n for n in ("empty", "zeros", "empty_like", "zeros_like")} | {"builtins.range": "range"}
FLOATS = dict.fromkeys("abcuvw", Type("array", "float64", 2))


def after(body: str, **types: Any) -> str:
    """The body of a function of two matrices and a number after the pass."""
    given = statements("def f(u, v, n):\n" + "".join(f"    {line}\n" for line in body.splitlines()))[0]
    context: Any = SimpleNamespace(types=FLOATS | {"n": Type("number", "int64")} | types, stacks=set(),
                                   writing=frozenset())
    made = shape_propagation(rename(given, {v: k for k, v in SPELLING.items()}), context)
    return layout.text(made, SPELLING).partition("\n")[2].replace("    ", "", 1).replace("\n    ", "\n")


@pytest.mark.parametrize("body, found", [
    ("a = empty_like(u)\na[0, 0] = a.shape[1]", "a = empty_like(u)\na[0, 0] = u.shape[1]"),
    ("a = empty((u.shape[0], n))\nb = zeros_like(a)\nb[0, 0] = b.shape[1] + a.shape[0]",
     "a = empty((u.shape[0], n))\nb = zeros((u.shape[0], n))\nb[0, 0] = n + u.shape[0]"),
    ("a = empty((u.shape[1], 3))\nb = zeros(a.shape)\nb[0, 0] = 1", "b = zeros((u.shape[1], 3))\nb[0, 0] = 1"),
    ("a = empty_like(u)\nb = zeros_like(a)\nb[0, 0] = b.shape[0]", "b = zeros_like(u)\nb[0, 0] = u.shape[0]")])
def test_sizes(body, found):
    assert after(body) == found


@pytest.mark.parametrize("body", [
    "a = empty((u.shape[1], 3))\nassert v.shape == a.shape",            # what a guard says is about the user's arrays
    "a = empty((n, n + 1))\nu[0, 0] = a.shape[1]",                      # a sum is computed once; -1 raises
    "a = empty_like(u)\na = empty_like(v)\nu[0, 0] = a.shape[0]",       # two sizes
    "u = empty((n, n))\nv[0, 0] = u.shape[0]",                          # a parameter that is bound anew
    "for n in range(3):\n    pass\na = zeros((n, 2))\na[0, 0] = a.shape[0]",
    "for i in range(n):\n    a = zeros((i, 2))\n    i += 1\n    a[0, 0] = a.shape[0]",     # i is another one
    "for i in range(n):\n    u[0, 0] = a.shape[0]\n    a = zeros((i, 2))",
    "for i in range(n):\n    a = zeros((i, 2))\n    for j in range(3):\n        u[0, 0] = a.shape[0]\n"
    "        a = zeros((j, 2))",
    "for i in range(n):\n    a = zeros((i, 2))\n    if i > 2:\n        a = zeros((3, 2))\n    u[0, 0] = a.shape[0]",
    "for i in range(n):\n    if i > 2:\n        a = zeros((3, 2))\n    u[0, 0] = a.shape[0]"])
def test_what_stays(body):
    assert after(body) == body


def test_sizes_of_what_an_iteration_allocates():
    body = "for i in range(n):\n    a = zeros((i, 2))\n    b = zeros_like(a)\n    while b[0, 0] < {0}:\n" \
           "        b[0, 0] += {0}\n    for j in range({0}):\n        b[j, 0] = {1}"
    found = body.replace("zeros_like(a)", "zeros((i, 2))").format("i", 2)
    assert after(body.format("a.shape[0]", "a.shape[1]")) == found


def test_what_raises_is_allocated():
    assert after("a = empty((n, 2))\nu[0, 0] = a.shape[1]") == "a = empty((n, 2))\nu[0, 0] = 2"


def test_arrays_of_another_dtype_are_like_their_own():
    body = "a = empty((n, 2))\nb = zeros_like(a)\nb[0, 0] = 1"
    assert after(body, a=Type("array", "int64", 2)) == body
