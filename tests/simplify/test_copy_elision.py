"""What the text for NumPy leaves out: copies of shadows that are emptied, expressions computed twice."""
from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np

from s2sad import differentiate
from s2sad.emit import layout
from s2sad.infer.types import FLOAT
from s2sad.simplify.copy_elision import copy_elision
from s2sad.tree import rename, statements
from tests.harness.derivatives import check_derivatives

SPELLING = {"numpy.copy": "copy", "numpy.reshape": "reshape", "numpy.zeros_like": "zeros_like"}
CONTEXT: Any = SimpleNamespace(types={"t": FLOAT})


def without_copies(body: str) -> str:
    text = "def f(a, w):\n" + "".join(f"    {line}\n" for line in body.strip().splitlines())
    given = rename(statements(text)[0], {v: k for k, v in SPELLING.items()})
    return layout.text(copy_elision(given, CONTEXT), SPELLING)


def test_a_shadow_is_read_where_it_lies():
    assert without_copies("s = copy(w)\nw[...] = 0.0\na[...] += 2.0 * s\na[...] += s") == (
        "def f(a, w):\n    a[...] += 2.0 * w\n    a[...] += w\n    w[...] = 0.0")
    assert "copy" not in without_copies("s = copy(w)\nw[...] = 0.0\nfor i in a:\n    a[...] += s")


def test_a_copy_that_is_needed_stays():
    for rest in ("w[...] += s", "a[...] += s * w", "t = s\na[...] += t", "t = reshape(s, 3)\na[...] += t"):
        assert "s = copy(w)" in without_copies(f"s = copy(w)\nw[...] = 0.0\n{rest}"), rest
    for before in ("s = copy(w)\nw[1] = 0.0\na[...] += s", "s = copy(w)\nw[...] = 1.0\na[...] += s",
                   "a[...] = s\ns = copy(w)\nw[...] = 0.0\na[...] += s"):
        assert "s = copy(w)" in without_copies(before), before


def test_the_copy_of_what_nothing_mentions_any_more():
    made, used = "b = zeros_like(a)\nfor i in a:\n    t = a[i]\n    b[i] += t\n", "s = copy(b)\na[...] += 2.0 * s\n"
    assert without_copies(made + used).endswith("a[...] += 2.0 * b")
    assert without_copies(made + used + "s[0] = 1.0\na[...] += s").endswith("b[0] = 1.0\n    a[...] += b")


def test_the_copy_of_what_another_name_or_the_caller_reads_stays():
    for kernel in ("b = zeros_like(a)\ns = copy(b)\na[...] += s\nb[0] = 1.0\na[...] += s",
                   "b = zeros_like(a)\nv = reshape(b, 3)\ns = copy(b)\ns[0] = 1.0\na[...] += s + v",
                   "b = zeros_like(a)\nfor i in a:\n    v = b[i]\ns = copy(b)\ns[0] = 1.0\na[...] += s + v",
                   "s = copy(w)\ns[0] = 1.0\na[...] += s",
                   "b = zeros_like(a)\nfor i in a:\n    s = copy(b)\n    s[0] += 1.0\n    a[...] += s"):
        assert "s = copy(" in without_copies(kernel), kernel


def flow(u, v, a):
    for _ in range(2):
        rate = u ** 3 * np.exp(a * v)
        v += rate * np.exp(a * v) / (1.0 + u) - u / (1.0 + u)
        u[:] = np.sqrt(1.0 + u * v)


def test_what_is_computed_once():
    u, v = np.linspace(0.5, 1.0, 4), np.linspace(0.1, 0.3, 4)
    text = differentiate(flow, engine="numpy").adjoint_source(u, v, 0.3).partition("# reverse sweep")[2]
    code = [line.strip() for line in text.splitlines() if not line.strip().startswith("#")]
    assert [line for line in code if "np.exp(a * v)" in line] == ["exp_value = np.exp(a * v)"]
    measured = check_derivatives(flow, (u, v, 0.3), ("u", "v", "a"), ("u", "v"), "numpy")
    assert measured.dot_product <= 1e-12
    assert max(measured.directional, measured.coordinates) <= 1e-7


def rows_summed(x, r):
    for _ in range(3):
        total = np.sum(x, axis=0)
        x *= total / (1.0 + total * total)
        mean = np.mean(x * x, axis=0, keepdims=True)
        r += np.sqrt(mean) * x


def test_the_steps_of_a_sum_are_not_recorded():
    x, r = np.linspace(0.5, 1.5, 6).reshape(2, 3), np.zeros((2, 3))
    text = differentiate(rows_summed, engine="numba").adjoint_source(x, r)
    assert "total_stack: total before `total = np.sum(x, axis=0)`" in text
    assert not [line for line in text.splitlines() if "total_stack" in line and "x.shape[0]" in line]
    measured = check_derivatives(rows_summed, (x, r), ("x", "r"), ("x", "r"), "loops")
    assert measured.dot_product <= 1e-12
    assert max(measured.directional, measured.coordinates) <= 1e-7
