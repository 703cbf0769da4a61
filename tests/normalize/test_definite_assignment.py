"""Names that some ways do not bind: where they are read before they are bound, the kernel and all that is made of it
raise; what is certainly bound is not asked for."""
from __future__ import annotations

import numpy as np
import pytest

import s2sad
from tests.harness.derivatives import check_derivatives
from tests.harness.engines import running
from tests.normalize.structured_form import run_both, shown

FORMS = {
    "a branch": ("""
def f(a):
    if a > 0.5:
        y = a
    return y
""", """\
y_bound = False
if a > 0.5:
    y = a
    y_bound = True
if not y_bound:
    raise UnboundLocalError("f: 'y' is read before it is bound, at `return y`")
return y"""),
    "a loop, which is asked once": ("""
def f(x, n):
    for i in range(n):
        y = x[i]
        x[i] = y + 1.0
    return y
""", """\
y_bound = 0 < n
for i in range(n):
    y = x[i]
    x[i] = y + 1.0
if not y_bound:
    raise UnboundLocalError("f: 'y' is read before it is bound, at `return y`")
return y"""),
    "a loop in a loop": ("""
def f(x, n):
    for i in range(n):
        for j in range(i, 2, -1):
            y = x[j]
    return y
""", """\
y_bound = False
for i in range(n):
    y_bound = y_bound or i > 2
    for j in range(i, 2, -1):
        y = x[j]
if not y_bound:
    raise UnboundLocalError("f: 'y' is read before it is bound, at `return y`")
return y"""),
    "two loops": ("""
def f(x, n, m):
    for i in range(n):
        y = x[i]
    for i in range(m):
        y = x[i] * i
    return y
""", """\
y_bound = 0 < n
for i in range(n):
    y = x[i]
y_bound = y_bound or 0 < m
for i in range(m):
    y = x[i] * i
if not y_bound:
    raise UnboundLocalError("f: 'y' is read before it is bound, at `return y`")
return y"""),
    "a loop that is left early": ("""
def f(x, n):
    for i in range(n):
        if x[i] > 0.5:
            y = x[i]
            break
    return y
""", """\
y_bound = False
for i in range(n):
    if x[i] > 0.5:
        y = x[i]
        y_bound = True
        break
if not y_bound:
    raise UnboundLocalError("f: 'y' is read before it is bound, at `return y`")
return y"""),
    "the first iteration": ("""
def f(x, n):
    s = 0.0
    for i in range(1, n):
        if x[i] > 0.5:
            s += y
        y = x[i]
    return s
""", """\
s = 0.0
for i in range(1, n):
    if x[i] > 0.5:
        if i == 1:
            raise UnboundLocalError("f: 'y' is read before it is bound, at `s += y`")
        s += y
    y = x[i]
return s"""),
    "a test that reads it": ("""
def f(x, n):
    s = 0.0
    for i in range(n):
        if x[i] > 0.5 and y < x[i]:
            s += y
        if x[i] > 0.0:
            y = x[i]
    return s
""", """\
y_bound = False
s = 0.0
for i in range(n):
    if x[i] > 0.5 and (not y_bound):
        raise UnboundLocalError("f: 'y' is read before it is bound, at `if x[i] > 0.5 and y < x[i]:`")
    if x[i] > 0.5 and y < x[i]:
        if not y_bound:
            raise UnboundLocalError("f: 'y' is read before it is bound, at `s += y`")
        s += y
    if x[i] > 0.0:
        y = x[i]
        y_bound = True
return s"""),
}


@pytest.mark.parametrize("name", FORMS)
def test_forms(name):
    text, wanted = FORMS[name]
    assert shown(text) == wanted


CARRIED = "def f(x, n):\n    s = 0.0\n    for i in range({range}):\n        if {test}:\n            s += y\n" \
          "        y = x[i % 4]\n    return s\n"
BEHIND = [("n", "i > 0"), ("n", "i"), ("n", "i >= 1"), ("n", "0 < i"), ("n", "not i == 0"), ("n", "i == 2"),
          ("1, n", "i != 1 and x[i % 4] > 0.2"), ("n - 1, -1, -1", "i < n - 1"),
          ("x.size - 1, 0, -2", "i != x.size - 1"),
          ("n", "not (i == 0 or x[i % 4] > 0.2)"), ("n", "i > 1 or i == 1"), ("-2, n", "i > -2")]
NOT_BEHIND = [("n", "i >= 0"), ("1, n", "i"), ("1, n", "i > 0"), ("n", "i == 0"), ("n", "i != 1"), ("n", "not i"),
              ("n", "i > 0 or x[i % 4] > 0.2"), ("n - 1, -1, -1", "i > 0"), ("n", "i <= 3"), ("n, -1, -1", "i < 3"),
              ("n", "i > -1")]


@pytest.mark.parametrize("loop, test", [*BEHIND, *NOT_BEHIND])
def test_what_the_iteration_before_has_bound(loop, test):
    text = CARRIED.format(range=loop, test=test)
    assert ("raise" in shown(text)) is ((loop, test) in NOT_BEHIND)
    for n in range(6):
        original, ours = run_both(text, np.array([0.3, 0.1, 0.7, 0.5]), n)
        assert ours == original


@pytest.mark.parametrize("body, raises", [
    ("        if i > 0:\n            s += y\n        i = i + 1\n        y = x[0]\n", True),
    ("        for i in range(1, 3):\n            if i > 0:\n                s += y\n        y = x[0]\n", True),
    ("        if i > 0:\n            s += y\n        if s > 5.0:\n            continue\n        y = x[0]\n", True),
    ("        for k in range(n):\n            if i > 0:\n                s += y\n            y = x[0]\n", True),
    ("        for k in range(3):\n            if k > 0:\n                s += y\n            y = x[0]\n", False),
    ("        if i > 0:\n            s += y\n        if s > 5.0:\n            break\n        y = x[0]\n", False)])
def test_what_it_may_not_have_bound(body, raises):
    text = f"def f(x, n, s):\n    for i in range(n):\n{body}    return s\n"
    assert ("raise" in shown(text)) is raises
    for n in range(4):
        for s in (0.0, 7.0):
            original, ours = run_both(text, np.array([0.3]), n, s)
            assert ours == original


def test_a_loop_that_runs_is_not_asked():
    assert "raise" not in shown("def f(x):\n    for i in range(3):\n        y = x[i]\n    return y * i\n")
    assert "raise" in shown("def f(x):\n    for i in range(3, 3):\n        y = x[i]\n    return y * i\n")


# -- derivatives ----------------------------------------------------------------------------------------------------
def of_the_last(x):
    s = 0.0
    for i in range(x.shape[0]):
        if x[i] > 0.5:
            y = x[i] * x[i]
        s += y * x[i]
    return s


def number(a):
    if a > 0.5:
        y = a * a
    return y


def called(x):
    return x[1] * number(x[0])


def of_a_structure(x):
    for i in range(x.shape[0]):
        if x[i] > 0.5:
            pair = [x[i], 2.0 * x[i]]
    return pair[0] * pair[1]


def array(x):
    if x[0] > 0.5:
        w = x * x[0]
    w[0] = x[1]
    return np.sum(w * x)


KERNELS = {
    of_the_last: ("of_the_last: 'y' is read before it is bound, at `s += y * x[i]`", [0.2, 0.9, 0.7]),
    called: ("number: 'y' is read before it is bound, at `return y`", [0.2, 0.9, 0.7]),
    of_a_structure: ("of_a_structure: 'item' is read before it is bound, at `return pair[0] * pair[1]`",
                     [0.2, 0.4, 0.3]),
    array: ("array: 'w' is read before it is bound, at `w[0] = x[1]`", [0.2, 0.4, 0.3]),
}
RIGHT = np.array([0.8, 0.2, 0.7])


@pytest.mark.parametrize("engine", ["numpy", "loops", "numba"])
@pytest.mark.parametrize("kernel", KERNELS)
def test_derivatives_raise_as_the_kernel_does(kernel, engine):
    text, values = KERNELS[kernel]
    x = np.array(values)
    with pytest.raises(UnboundLocalError):
        kernel(x.copy())
    with running(engine) as name:
        f = s2sad.differentiate(kernel, engine=name)
        for call in (lambda: s2sad.gradient(f)(x), lambda: s2sad.jvp(f, (x,), {"x": np.ones(3)})):
            with pytest.raises(UnboundLocalError) as caught:
                call()
            assert str(caught.value) == text
        if engine == "numba":
            with pytest.raises(UnboundLocalError):
                f.primal(x)
    check_derivatives(kernel, (RIGHT,), ("x",), ("return",), engine)
