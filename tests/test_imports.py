"""Functions that import what they use, and arrays that are given another shape."""
from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest

import s2sad
from tests.derivatives import check_derivatives
from tests.engines import each

X = np.array([0.3, 0.9, 0.7, 0.62])


def of_modules(x):
    import math
    import numpy.linalg as la
    from numpy import cos as c
    from numpy import sin
    from scipy.linalg import solve_triangular
    a = np.eye(4) + np.tril(np.outer(x, x))
    return math.exp(x[0]) * c(x[1]) + sin(x[2]) + la.det(a) + np.sum(solve_triangular(a, x, lower=True))


def of_an_outer_function(x):
    import numpy
    from math import e as base
    from numpy import tanh as squashed

    def g(v):
        from math import pi
        return squashed(v) * pi
    return g(x[0]) + g(x[1]) * numpy.sum(x) * base


def shaped_twice(x):
    a = np.zeros(4)
    for i in range(4):
        a[i] = x[i] ** 2
    a.shape = 2, 2
    b = a.T @ a
    a.shape = (4,)
    a += x
    return np.sum(a ** 2) + b[0, 1]


def shaped_in_a_loop(x):
    s = 0.0
    for k in range(2):
        a = x * (k + 1.0)
        v = a[1:]
        a.shape = (2, 2)
        a[0] *= a[1]
        v[0] *= 3.0
        s += np.sum(a ** 2)
    return s


KERNELS = [of_modules, of_an_outer_function, shaped_twice, shaped_in_a_loop]


@pytest.mark.parametrize(("kernel", "engine"), each(KERNELS))
def test_derivatives(kernel, engine):
    check_derivatives(kernel, (X.copy(),), ("x",), ("return",), engine=engine)


def test_from_a_file_that_is_not_run(tmp_path):
    (tmp_path / "scales.py").write_text("UNIT = 2.5\n\n\ndef half(v):\n    return 0.5 * v\n")
    path = tmp_path / "model.py"
    path.write_text("def model(x):\n    import numpy as np\n    from scales import UNIT, half\n"
                    "    return half(np.sum(x ** 2)) * UNIT\n")
    made = subprocess.run([sys.executable, "-m", "s2sad", "adjoint", f"{path}:model", "--types", "x: float64[:]"],
                          capture_output=True, text=True, check=False)
    assert "def model_adjoint(x, x_bar, result_bar):" in made.stdout, made.stderr


def held_by_two(x):
    a = x * 2.0
    b = a
    a.shape = (2, 2)
    return np.sum(b)


def given_back(x):
    a = x * 2.0
    b = same(a)
    a.shape = (2, 2)
    return np.sum(b)


def same(a):
    return a


def argument(x):
    x.shape = (2, 2)
    return np.sum(x @ x)


def made_or_not(x):
    a = x * 2.0
    if x[0] > 0.5:
        a = x
    a.shape = (2, 2)
    return np.sum(a)


def converted(x):
    a = 2.0 * x
    c = np.asarray(a)
    a.shape = (2, 2)
    return np.sum(c[0]) * x[0]


def chosen(x):
    a = 2.0 * x
    c = a if x[0] > 0.0 else x
    a.shape = (2, 2)
    return np.sum(c[0]) * x[0]


def in_a_dict(x):
    a = 2.0 * x
    d = {"a": a}
    a.shape = (2, 2)
    return np.sum(d["a"][0])


def closed_over(x):
    a = 2.0 * x

    def g():
        return a
    c = g()
    a.shape = (2, 2)
    return np.sum(c[0])


def written_into(x):
    a = np.zeros(4)
    b = np.add(x, x, out=a)
    a.shape = (2, 2)
    return np.sum(b[0])


def made_into(x):
    b = np.zeros(4)
    a = np.exp(x, b)
    a.shape = (2, 2)
    return np.sum(b[0])


@pytest.mark.parametrize("kernel", [held_by_two, given_back, argument, made_or_not, converted, chosen, in_a_dict,
                                    closed_over, written_into, made_into])
def test_other_names_would_have_the_shape_too(kernel):
    name = "x" if kernel is argument else "a"
    with pytest.raises(s2sad.S2sadError, match=f"an assignment to the attribute {name}.shape is not supported"):
        s2sad.gradient(kernel)(X.copy())


def missing(x):
    import no_such_module
    return no_such_module.f(x)


def test_what_cannot_be_imported():
    with pytest.raises(s2sad.S2sadError, match="which fails: No module named 'no_such_module'"):
        s2sad.gradient(missing)(X)
