"""Options of NumPy's functions: taken as NumPy takes them, or refused."""
from __future__ import annotations

import math

import numpy as np
import pytest

import s2sad
from tests.derivatives import check_derivatives
from tests.engines import each, running
from tests.seeds import generator

linalg = pytest.importorskip("scipy.linalg")


def filled_where(x, y, a):
    """The array for a result is made in the call, a part, or one of two names."""
    z = np.divide(x, y, out=np.zeros_like(x), where=y > 0.5)
    e = np.exp(x, out=np.empty(5))
    w: np.ndarray = np.sin(y, out=np.empty(5))
    p = q = np.multiply(x, y, out=x.copy())
    p[0] = 3.0 * z[0]
    s = np.sum(a, axis=0, out=np.zeros(5))
    y[1:] = np.maximum(np.add(x[1:], y[1:], out=s[1:]), 0.1)
    return np.sum(z * w + e * q) + np.sum(np.divide(x, y, out=np.ones_like(x), where=x > 0.6) ** 2) + np.sum(s ** 2)


def returned(x, y, a):
    return np.divide(x, y, out=np.zeros_like(x), where=y > 0.5)


def positions(x, y, a):
    """Where `out` stands by position; options that are true and not written True."""
    b = np.zeros(2)
    np.max(a, 1, b)
    z = np.round(x * 10.0, 0, y)
    c = a / np.sum(a ** 2, axis=1, keepdims=1)
    return np.sum(b ** 2) + np.sum(z * x) + np.sum(c * np.linspace(x[0], x[1], 5, endpoint=1)) + np.sum(
        np.vander(x, 3, increasing=1))


def dtypes(x, y, a):
    """Results of integers that are floats."""
    k = np.array([3, 1, 4])
    w = np.full(5, round(x[0], 1)) + math.pow(2, -1)
    v, u = np.full(3, math.fmod(5, 3)), np.rint(k)
    v[0], u[1] = x[0] ** 2, x[1] ** 2
    h = np.hstack((k, x[2]))
    mask = (x > 0.7) * 2
    mask[0] += 3
    return np.sum(w * x) + np.sum(v * u) + np.sum(h ** 2) * np.sum(np.append(k, y[0])) + np.sum(mask * y) + np.sum(
        np.extract(np.array([2, 0, 1, 0, 3]), x))


def copied(x, y, a):
    """Powers and products of bools are numbers; a copy is one."""
    b = np.array(x, copy=True)
    b[0] = y[0] * x[1]
    m = (x > 0.7) ** 1 + (y > 0.5) ** 1
    return np.sum(b * x * m) + x[0] * (True * 1 + 1 * True)


def shifted(u, v, start, axis):
    u[...] = v + np.roll(v, 1, axis)


def one_array_twice(x, y, a):
    """The helper is made without its second parameter; its axis is still the last argument."""
    shifted(a, a, 0, 1)
    shifted(a, a, 0, 1)
    return a[0, 1] * a[1, 0]


CASES = [(copied, ("return",)), (one_array_twice, ("a", "return")),
         (filled_where, ("y", "return")), (returned, ("return",)), (positions, ("return",)), (dtypes, ("return",))]


@pytest.mark.parametrize(("kernel", "of", "engine"), each(CASES))
def test_kernel(kernel, of, engine):
    random = generator(3)
    given = 0.2 + random.random(5), 0.2 + random.random(5), 0.2 + random.random((2, 5))
    check_derivatives(kernel, given, ("x", "y", "a"), of, engine)


REFUSED = {
    "np.zeros_like(x, shape=(2, 3))": "no derivative rule for numpy.zeros_like with shape=",
    "np.array(x, copy=False)": "no derivative rule for numpy.array with copy=",
    "np.array(x, ndmin=2)": "no derivative rule for numpy.array with ndmin=",
    "np.sum(x, keepdims=flag)": "the type of 'y' cannot be inferred",
    "np.sign(x, casting='unsafe')": "no derivative rule for numpy.sign with casting=",
}


@pytest.mark.parametrize("text", REFUSED)
def test_refused(text, tmp_path):
    path = tmp_path / "kernel.py"
    path.write_text(f"import numpy as np\n\n\ndef kernel(x, flag):\n    y = {text}\n    return np.sum(y * y)\n")
    spaces = {}
    exec(compile(path.read_text(), str(path), "exec"), spaces)
    with pytest.raises(s2sad.S2sadError) as caught:
        s2sad.gradient(spaces["kernel"], wrt="x")(np.ones(3), True)
    assert caught.value.diagnostics[0].message == REFUSED[text]


def transposed(x, y, a):
    m = np.diag(x) + np.triu(np.outer(x, y), 1) + np.eye(5) * 2.0
    return np.sum(linalg.solve_triangular(m, y, 2) * x) + np.sum(linalg.solve_triangular(m, y, "T") ** 2)


def along_both(x, y, a):
    g, h = np.gradient(np.outer(x, y), axis=(0, 1))
    return np.sum(g * h)


def three_spacings(x, y, a):
    f, g, h = np.gradient(x[:, None, None] * y[:, None] * y, 1, 1, 1)
    return np.sum(f * g * h)


@pytest.mark.parametrize("engine", ("numpy", "loops"))
def test_a_transposition_by_position(engine):
    given = 0.2 + np.arange(5.0) / 5.0, 1.0 - np.arange(5.0) / 7.0, np.ones(1)
    check_derivatives(transposed, given, ("x", "y"), ("return",), engine)


@pytest.mark.parametrize("kernel", (along_both, three_spacings))
def test_parts_of_a_gradient_along_axes_that_are_not_told_apart(kernel):
    with pytest.raises(s2sad.S2sadError, match="the type of 'gradient_0' cannot be inferred"):
        s2sad.gradient(kernel, wrt="x")(np.ones(5), np.ones(5), np.ones(1))


def own(x):
    x[0] *= 2.0
    return x[1]


def beside_a_call(x):
    return np.sum(np.multiply(own(x), x, out=x.copy(), where=x > 0.5))


def test_an_array_that_is_made_beside_a_call():
    with pytest.raises(s2sad.S2sadError) as caught:
        s2sad.gradient(beside_a_call)(np.ones(3))
    assert caught.value.diagnostics[0].message == (
        "the array for a result is made, or a part, beside a call of a kernel")
    assert caught.value.diagnostics[0].help == "give the array a name of its own before"


def not_chosen(a, y):
    """What is not chosen has an infinite derivative, or none."""
    b = np.maximum(np.sqrt(a), 0.5) + np.where(a > 0.5, np.sqrt(a), y)
    z = np.log(a, out=y * 2.0, where=a > 0.0)
    total = np.nansum(b * z) + np.nansum(np.log(a) * 0.0 + y)
    for i in range(a.size):
        r = math.sqrt(a[i]) if a[i] > 0.1 else 0.3
        total += (r if a[i] > 0.5 else y[i]) * y[i]
    return total


@pytest.mark.parametrize("engine", ("numpy", "loops"))
def test_a_tangent_of_what_is_not_chosen(engine):
    a, y = np.array([0.0, 0.9, 0.7]), np.array([0.4, 0.8, 0.2])
    with running(engine) as run_under:
        f = s2sad.differentiate(not_chosen, engine=run_under)
        found = s2sad.jvp(f, (a, y), {"a": np.array([1.0, 0.5, -0.5]), "y": np.ones(3)}, of=("return",))["return"]
        gradient = s2sad.vjp(f, (a, y), {"return": 1.0}, wrt=("a", "y"))
    assert np.isfinite(found)
    expected = gradient["a"][1:] @ [0.5, -0.5] + gradient["a"][0] + gradient["y"].sum()
    np.testing.assert_allclose(found, expected, rtol=1e-12)
