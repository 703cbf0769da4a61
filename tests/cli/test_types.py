"""The types of parameters: given, annotated, defaulted, or assumed from how they are used; structures."""
from __future__ import annotations

import pytest

from s2sad.diagnostics import Report
from s2sad.infer.assumed_types import assumed_types
from s2sad.dispatch.arguments import types as types_of
from s2sad import read
from benchmarks.kernels.cases import LOOPS


@pytest.mark.parametrize("case", LOOPS, ids=lambda c: c.name)
def test_types_from_use_are_those_of_the_arguments(case):
    program = read.load(case.function)
    entry = program.kernels[program.entry]
    report = Report(entry.source)
    found = assumed_types(program.entry, {n: k.tree for n, k in program.kernels.items()}, entry.parameters,
                    entry.annotations, entry.defaults, {}, report)
    report.finish()
    assert tuple(found[p].type for p in entry.parameters) == types_of(case.arguments("small"))


def arguments(text):
    return [line.strip() for line in text.splitlines() if line.startswith("    ") and ": " in line][:5]


def test_types_are_given_annotated_defaulted_or_assumed(ran, kernel):
    kernel('def f(a: "float32[:, :]", n: int, c: float, m, scale=2.0):\n'
           "    for i in range(m):\n        a[i, n] *= c * scale\n")
    assert arguments(ran("tangent", "k.py:f", "--types", "m: int32")[1]) == [
        "a: float32[:, :], in-out", "n: int64, in", "c: float64, in", "m: int32, in",
        "scale: float64, in (assumed: its default value)"]


def test_types_through_views_helpers_and_unpacking(ran, kernel):
    kernel("def add(row, k, s):\n    row[k] += s\n\n\n"
           "def f(x, p, j, shift):\n    a, b = p\n    for row in x:\n        add(row, j, a * b)\n"
           "    x[0, 1 << shift] = a\n")
    assert arguments(ran("tangent", "k.py:f")[1])[:4] == [
        "x: float64[:, :], in-out (assumed: used as an array with 2 axes)",
        "p: float64[:], in (assumed: used as an array with 1 axis)",
        "j: int64, in (assumed: used as a bound, an index or a shift)",
        "shift: int64, in (assumed: used as a bound, an index or a shift)"]


def test_types_of_what_tuples_and_lists_spell_out(ran, kernel):
    kernel("def f(x, u, v, m, n, a, b):\n    for w in (u, v):\n        w[0] += x[1]\n    for i in [m, n]:\n"
           "        x[i] = u[0]\n    pair = a, b\n    x[0] *= pair[1]\n")
    lines = [line.strip() for line in ran("tangent", "k.py:f")[1].splitlines() if "(assumed: " in line]
    assert [line.partition(",")[0] for line in lines] == [
        "x: float64[:]", "u: float64[:]", "v: float64[:]", "m: int64", "n: int64", "a: float64", "b: float64"]


def test_axes_are_integers_where_an_array_is_moved(ran, kernel):
    kernel('import numpy as np\n\n\ndef f(x: "float64[:, :]"):\n    return np.sum(np.moveaxis(x, 0, 1)[0])\n')
    assert arguments(ran("tangent", "k.py:f")[1]) == ["x: float64[:, :], in"]


def test_types_that_contradict_each_other(ran, kernel):
    kernel("def f(x):\n    for i in range(x):\n        x[i] = 0.5\n    return 1.0\n")
    assert ran("adjoint", "k.py:f") == (1, "", """\
k.py:2:20: error[S203]: the type of 'x' cannot be inferred: it is used as an array and as a bound, an index or a shift
  2 |     for i in range(x):
    |                    ^ here as an integer
  help: say which: --types "x: float64[:]"
""")
    kernel('def f(x: "float64[:]", y: float):\n    return x[0, 1] * y\n')
    assert ran("adjoint", "k.py:f") == (1, "", """\
k.py:2:12: error[S203]: 'x' is annotated as float64[:] and used as an array with 2 axes
  2 |     return x[0, 1] * y
    |            ^^^^^^^ here
  help: correct the annotation, or say it here: --types "x: float64[:, :]"
""")
    kernel("def f(x, n: float):\n    return x[n]\n")
    assert ran("adjoint", "k.py:f") == (1, "", """\
k.py:2:14: error[S203]: 'n' is annotated as float64 and used as a bound, an index or a shift
  2 |     return x[n]
    |              ^ here
  help: correct the annotation, or say it here: --types "n: int64"
""")


STRUCTURES = """def step(state, p, layers, dt, mask=None):
    for w, b in layers:
        for i in range(state.u.size):
            state.u[i] += dt * p["k"] * w[i] * b
    if mask is not None:
        state.u[0] *= mask[0]
    state.t += dt
"""


def test_structures(ran, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "s.py").write_text(STRUCTURES)
    types = "state: {u: float64[:], t: float}, p: {k: float64}, layers: ((float64[:], float),)"
    status, text, _ = ran("adjoint", "s.py:step", "--types", types, "--wrt", "state.u,p", "--of", "state")
    assert not status
    assert "state_u, state_u_bar, state_t, state_t_bar, p_k, layers_0_0, layers_0_1, dt" in text
    assert "    return (p_k_bar,)" in text
    assert "mask" in ran("adjoint", "s.py:step", "--types", f"{types}, mask: float64[:]")[1]
    assert ran("adjoint", "s.py:step")[2] == """s.py:3:24: error[S203]: 'state' has parts, whose types are not known
  3 |         for i in range(state.u.size):
    |                        ^^^^^^^
  help: say what it is made of, as --types "state: {u: float64, t: float64}"
s.py:4:32: error[S203]: 'p' has parts, whose types are not known
  4 |             state.u[i] += dt * p["k"] * w[i] * b
    |                                ^^^^^^
  help: say what it is made of, as --types "p: {k: float64}"
"""
    assert ran("check", "s.py:step", "--types", types)[2] == (
        "error[S405]: 'step' takes structures, and none can be made up\n  help: give its arguments as Python, in "
        "--arguments, or call s2sad.check\n")
