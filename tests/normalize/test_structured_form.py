"""Structured form: read by a person for the ordinary cases, executed against the original for all."""
from __future__ import annotations

import ast
from pathlib import Path

import numpy as np
import pytest

from benchmarks.kernels import cases
from s2sad.diagnostics import S2sadError
from tests.normalize.structured_cases import CASES, text_of
from tests.normalize.structured_form import form, run_both, shown


@pytest.mark.parametrize("name", CASES)
def test_same_as_python(name):
    for n in (0, 1, 3, 4, 6):
        for v in (-1.5, 0.0, 0.7, 2.0):
            original, ours = run_both(text_of(name), np.array([1.0, -0.5, 2.0, 0.25]), n, v)
            assert ours == original, (n, v, shown(text_of(name)))


@pytest.mark.parametrize("case", cases.LOOPS, ids=lambda case: case.name)
def test_reference_kernels(case):
    path = Path(case.function.__code__.co_filename)
    original, ours = run_both(path.read_text(), *case.arguments("small"), name=case.name)
    assert ours == original


@pytest.mark.parametrize("name", ["seidel", "jacobi", "upwind", "thomas", "cholesky", "spmv", "assemble", "newton",
                                  "nbody", "log_sum_exp"])
def test_ordinary_kernels_stay_as_they_are(name):
    text = Path(cases.loops.__file__).read_text()
    function = next(f for f in ast.parse(text).body if getattr(f, "name", "") == name)
    body = function.body[1:] if isinstance(function.body[0], ast.Expr) else function.body
    lines = "\n".join(map(ast.unparse, body)).splitlines()
    if not isinstance(body[-1], ast.Return):
        lines.append("return")
    assert shown(text, name).splitlines() == lines


def test_every_statement_has_its_place():
    tree = form("def f(x):\n    a, b = x[0], x[1]\n    return a if a > b else b\n")
    assert [s.lineno for s in tree.body] == [2, 2, 3, 3]


GOLDEN = {
    "early return": ("""
def f(a, n):
    if a == n:
        return 0
    if a == -1:
        return n - 1
    return a
""", """\
if a == n:
    result = 0
elif a == -1:
    result = n - 1
else:
    result = a
return result"""),
    "continue": ("""
def f(x):
    s = 0.0
    for i in range(x.size):
        if x[i] == 0.0:
            continue
        s += x[i]
    return s
""", """\
s = 0.0
for i in range(x.size):
    if x[i] != 0.0:
        s += x[i]
return s"""),
    "return in a loop": ("""
def f(x, v):
    for i in range(x.size):
        for j in range(i):
            if x[i] * x[j] > v:
                return x[i]
    return 0.0
""", """\
returned = False
result = 0.0
for i in range(x.size):
    for j in range(i):
        if x[i] * x[j] > v:
            result = x[i]
            returned = True
            break
    if returned:
        break
if not returned:
    result = 0.0
return result"""),
    "only returns": ("""
def f(v):
    while True:
        v *= 0.5
        if v < 1.0:
            return v, 1
        if v > 9.0:
            return v, 2
""", """\
while True:
    v *= 0.5
    if v < 1.0:
        result_1 = 1
        break
    elif v > 9.0:
        result_1 = 2
        break
return (v, result_1)"""),
    "swap": ("""
def f(a, b, n):
    for _ in range(n):
        a, b = b, a + b
    return a
""", """\
for _ in range(n):
    b_after = a + b
    a = b
    b = b_after
return a"""),
    "arrays": ("""
def f(x, y):
    s = 0.0
    for i, row in enumerate(x):
        for a, b in zip(row, y):
            s += i * a * b
    return s
""", """\
s = 0.0
for i in range(len(x)):
    row = x[i]
    for index in range(min(len(row), len(y))):
        a = row[index]
        b = y[index]
        s += i * a * b
return s"""),
    "call in a sum": ("""
def g(u):
    u[0] = 1.0
    return u[1]
def h(a):
    return a * a
def f(u, w):
    return u[0] + w[0] * h(u[1]) + g(u)
""", """\
h_value = h(u[1])
held = u[0] + w[0] * h_value
g_value = g(u)
return held + g_value"""),
}


@pytest.mark.parametrize("name", GOLDEN)
def test_golden(name):
    text, wanted = GOLDEN[name]
    assert shown(text) == wanted


REFUSED = {
    "sometimes none": ("def f(a):\n    if a > 0.0:\n        return\n    return a\n",
                       "kernel.py:3:9: error[S201]: a result that is sometimes None and sometimes a value"),
    "falls off": ("def f(a):\n    if a > 0.0:\n        return a\n",
                  "kernel.py:3:9: error[S201]: a result that is None where the function ends without a return"),
    "different lengths": ("def f(a):\n    if a > 0.0:\n        return a, a\n    return a\n",
                          "kernel.py:4:5: error[S201]: returns with different numbers of values"),
    "missing argument": ("def g(a, b):\n    return a\ndef f(a):\n    return g(a)\n",
                         "kernel.py:4:12: error[S405]: g(a, b) is called without 'b'"),
    "too many arguments": ("def g(a):\n    return a\ndef f(a):\n    return g(a, a)\n",
                           "kernel.py:4:12: error[S405]: g(a) is given 2 arguments"),
    "unknown keyword": ("def g(a):\n    return a\ndef f(a):\n    return g(a, b=a)\n",
                        "kernel.py:4:12: error[S405]: g(a) is given the parameter 'b' which it does not have"),
    "given twice": ("def g(a):\n    return a\ndef f(a):\n    return g(a, a=a)\n",
                    "kernel.py:4:12: error[S405]: g(a) is given the parameter 'a' twice"),
    "wrong count": ("def g(a):\n    return a, a\ndef f(a):\n    x, y, z = g(a)\n    return x\n",
                    "kernel.py:4:15: error[S203]: g returns 2 values, here are 3 names"),
    "targets and values": ("def f(a):\n    x, y = a, a, a\n    return x\n",
                           "kernel.py:2:5: error[S203]: 2 targets for 3 values"),
    "lone call": ("def f(a):\n    np.sin(a)\n",
                  "kernel.py:2:5: error[S201]: a call whose result is not used"),
    "unknown rank": ("def f(a):\n    for i in np.ndindex(a.shape):\n        a[i] = 0.0\n",
                     "kernel.py:2:14: error[S201]: np.ndindex over an unknown number of axes"),
    "reversed zip": ("def f(a):\n    for i, j in reversed(zip(a, a)):\n        a[0] = i\n",
                     "kernel.py:2:26: error[S201]: reversed() of this"),
    "loop for ever": ("def f(a):\n    while a > 0.0:\n        pass\n",
                      "kernel.py:2:5: error[S201]: a loop that changes nothing"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_refusals(name):
    text, wanted = REFUSED[name]
    with pytest.raises(S2sadError) as raised:
        form(text)
    assert str(raised.value.diagnostics[0]).splitlines()[0] == wanted
