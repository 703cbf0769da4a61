"""Which functions of a module are never given memory twice."""
from __future__ import annotations

import pytest

from s2sad.infer.types import Type
from s2sad.tree import parse, rename
from s2sad.units.distinct_arguments import distinct_arguments

DOTTED = {"g": "user.g", "h": "user.h", "empty": "numpy.empty", "ravel": "numpy.ravel", "range": "builtins.range",
          "allocate": "runtime.allocate", "solve": "runtime.solve"}
TYPES = {**{n: Type("array", "float64", rank=2) for n in "uvwxyz"}, **{n: Type("number", "int64") for n in "ikn"}}


def distinct(body: str, types=TYPES) -> str:
    """Those of f, of g, which calls h, and of h, where f has a body."""
    text = f"def h(x, y, k):\n    x[k] = y[k]\ndef g(x, y, k):\n    h(x, y, k)\ndef f(u, v, i, n):\n    {body}\n"
    functions = [rename(f, DOTTED) for f in parse(text).body]
    return "".join(sorted(distinct_arguments(functions, dict.fromkeys("fgh", types))))


@pytest.mark.parametrize("body", [
    "g(u, v, i)", "w = empty((n, n)); g(u, w, n)", "h(u, v[0], u[i, i])", "w, n = allocate(v, 0, n); h(w, u, 0)",
    "w, n = allocate(u, 0, n); x, n = allocate(u, n, n); h(w, x, 0)", "w = u + v; h(u, w, i)", "h(u[0], u[1], i)",
    "n = u.shape[0]; h(v, u, n)",
    "for i in range(n):\n        h(u[i], u[i + 1], 0)", "for i in range(n, -1, -1):\n        h(u[i + 1], u[i], 0)"])
def test_other_arrays_and_other_rows_are(body):
    assert distinct(body) == "fgh"


@pytest.mark.parametrize("body", [
    "g(u, u, i)", "g(u, u[0], i)", "w = u; g(u, w, i)", "w = u.T; x = w; g(x, u, i)", "w = ravel(u); g(w, u, i)",
    "w = u if i else v; g(v, w, i)", "for w in u:\n        g(w, u, i)", "w, x = h(u, v, i); g(w, x, i)",
    "if i:\n        w = u\n    g(u, w, i)", "g(u[i], u[i + 1], 0)", "g(u[0], u[-1], 0)", "g(u[0, :], u[:, 0], i)",
    "for i in range(-1, n):\n        g(u[i], u[i + 1], 0)", "for i in range(n):\n        g(u[i], u[n], 0)",
    "g(x=u, y=v, k=i)", "solve(g, u)", "t = z[..., None]; g(t, z, i)", "g(z[None, ...], z, i)", "g(*u, v, i)"])
def test_what_may_share_memory_is_not_nor_what_is_called_with_it(body):
    assert distinct(body) == "f"


def test_what_is_called_with_it_alone():
    assert distinct("g(u, v, i); h(u, u, i)") == "fg"


def test_what_has_no_type_may_be_an_array():
    assert distinct("t = u[0]; g(t, u, i)") == "f"
    assert distinct("t = u[0, 0]; g(v, u, t)") == "fgh"
    assert distinct("g(u, v, i)", {}) == "fgh"
    assert distinct("g(u, i, i)", {}) == "f"


@pytest.mark.parametrize("returned, found", [
    ("w", "fhm"), ("w, k", "fhm"), ("w[1:]", "fhm"), ("x[0, 0]", "fhm"), ("x[0]", "fm"), ("k, (w, y)", "fm"),
    ("k, (w, x)", "fm"), ("x[0, :]", "fm"), ("other(x)", "fm")])
def test_what_a_function_hands_back_may_lie_in_what_it_is_given(returned, found):
    text = (f"def m(x, y, k):\n    w = empty(k)\n    return {returned}\ndef h(x, y, k):\n    x[k] = y[k]\n"
            "def f(u, v, i):\n    w = m(u, v, i)\n    h(u, w, i)")
    functions = [rename(f, {**DOTTED, "m": "user.m", "other": "user.other"}) for f in parse(text).body]
    assert "".join(sorted(distinct_arguments(functions, dict.fromkeys("fhm", TYPES)))) == found
