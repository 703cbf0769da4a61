"""Where Python takes nothing but an integer, a float is refused with its place, under both engines."""
from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pytest

import s2sad

INTEGER = "make it an integer: int(...), or // in place of /"
INDEX = "make it an integer: x[int(k)]; what lies in one list with floats is a float"


def trips(u, n):
    for _ in range(n):
        u[0] *= 1.5
    return u[0]


def last(u, n):
    s = 0.0
    for i in range(0, n, 1):
        s += u[i]
    return s


def index(u, n):
    return u[n] ** 2


def stored_at(u, n):
    u[n] = u[0] ** 2
    return u[0] + u[1]


def part(u, n):
    return np.sum(u[:n] ** 2)


def stepped(u, n):
    return np.sum(u[::n] ** 2)


def filled_part(u, n):
    u[n:] = u[0] * 2
    return np.sum(u ** 2)


def size(u, n):
    v = np.zeros((2, n))
    v[0, 0] = u[0]
    return np.sum(v * v)


def size_of_shape(u, n):
    return np.sum(u.reshape(n, 1) ** 2)


def number_of_points(u, n):
    return np.sum(np.linspace(0.0, 1.0, n) * u[0])


def diagonal(u, n):
    return np.sum(np.diag(u, n) ** 2)


def shifted(u, n):
    return u[0] * (1 << n)


def bits(u, n):
    return u[0] * (n & 3)


def inverted(u, n):
    return u[0] * ~n


def under_another_name(u, n):
    m = n
    for _ in range(m):
        u[0] *= 1.5
    return u[0]


def comprehension(u, n):
    return sum(u[i] ** 2 for i in range(n))


def _sum(u, k):
    s = 0.0
    for i in range(k):
        s += u[i] ** 2
    return s


def in_a_function(u, n):
    return _sum(u, n)


@pytest.mark.parametrize("engine", ["numpy", "numba"])
@pytest.mark.parametrize("kernel, said", [
    (trips, "the argument 'n' is a float, and a bound of range is an integer"),
    (last, "the argument 'n' is a float, and a bound of range is an integer"),
    (index, "the argument 'n' is a float, and an index is an integer"),
    (stored_at, "the argument 'n' is a float, and an index is an integer"),
    (part, "the argument 'n' is a float, and a bound of a slice is an integer"),
    (stepped, "the argument 'n' is a float, and a bound of a slice is an integer"),
    (filled_part, "the argument 'n' is a float, and a bound of a slice is an integer"),
    (size, "the argument 'n' is a float, and a size is an integer"),
    (size_of_shape, "the argument 'n' is a float, and a size is an integer"),
    (number_of_points, "the argument 'n' is a float, and a size is an integer"),
    (diagonal, "the argument 'n' is a float, and k= is an integer"),
    (shifted, "the argument 'n' is a float, and << takes integers"),
    (bits, "the argument 'n' is a float, and & takes integers"),
    (inverted, "the argument 'n' is a float, and ~ takes integers"),
    (under_another_name, "the argument 'n' is a float, and a bound of range is an integer"),
    (comprehension, "the argument 'n' is a float, and a bound of range is an integer"),
    (in_a_function, "the argument 'k' is a float, and a bound of range is an integer"),
])
def test_float_arguments(kernel, said, engine):
    g = s2sad.gradient(s2sad.differentiate(kernel, engine=engine), "u")
    for n in (1.0, 3.7, math.nan, math.inf, np.float32(1.0)):
        with pytest.raises(s2sad.S2sadError) as caught:
            g(np.ones(3), n)
        (found,) = caught.value.diagnostics
        name = said.split("'")[1]
        assert (found.code, found.message, found.help) == ("S405", said, f"give an int, or write int({name})")
        assert found.span is not None and name in found.span.source.line(found.span.line)


def half(u, n):
    for _ in range(u.size / 2):
        u[0] *= 1.5
    return u[0]


def element(u, n):
    v = np.zeros(3)
    v[0] = n
    for _ in range(v[0]):
        u[0] *= 1.5
    return u[0]


def floor(u, n):
    return u[np.floor(n)] ** 2


def quotient(u, n):
    return np.sum(np.zeros(n / 1)) + u[0]


def counted(u, n):
    k, s = 0.0, 0.0
    while k < n:
        s += u[k] ** 2
        k += 1
    return s


@pytest.mark.parametrize("engine", ["numpy", "numba"])
@pytest.mark.parametrize("kernel, text, said, help", [
    (half, "u.size / 2", "a float, where a bound of range is an integer", INTEGER),
    (element, "v[0]", "a float, where a bound of range is an integer", INTEGER),
    (floor, "np.floor(n)", "a float, where an index is an integer", INDEX),
    (quotient, "n / 1", "a float, where a size is an integer", INTEGER),
    (counted, "k", "a float, where an index is an integer", INDEX),
])
def test_floats_that_a_kernel_computes(kernel, text, said, help, engine):
    with pytest.raises(s2sad.S2sadError) as caught:
        s2sad.gradient(s2sad.differentiate(kernel, engine=engine), "u")(np.ones(3), 2.0)
    (found,) = caught.value.diagnostics
    assert (found.code, found.message, found.help) == ("S203", said, help)
    assert found.span.source.line(found.span.line)[found.span.column:found.span.end_column] == text


@dataclass
class Grid:
    n: object
    h: float = 0.5


def over_grid(u, grid):
    s = 0.0
    for i in range(grid.n):
        s += grid.h * u[i] ** 2
    return s


@pytest.mark.parametrize("engine", ["numpy", "numba"])
def test_a_field_of_a_structure(engine):
    g = s2sad.gradient(s2sad.differentiate(over_grid, engine=engine), "u")
    with pytest.raises(s2sad.S2sadError) as caught:
        g(np.ones(3), Grid(2.0))
    (found,) = caught.value.diagnostics
    assert found.message == "the argument 'grid.n' is a float, and a bound of range is an integer"
    assert found.help == "give an int, or write int(grid.n)"


@pytest.mark.parametrize("value, said", [
    (None, "None"), ("3", "a str"), (np.arange(3), "an array of int64")])
@pytest.mark.parametrize("engine", ["numpy", "numba"])
def test_what_is_no_number_of_trips(value, said, engine):
    with pytest.raises(s2sad.S2sadError) as caught:
        s2sad.gradient(s2sad.differentiate(trips, engine=engine), "u")(np.ones(3), value)
    (found,) = caught.value.diagnostics
    assert (found.code, found.message) == (
        "S405", f"the argument 'n' is {said}, and a bound of range is an integer")


@pytest.mark.parametrize("call", [
    lambda f, u, n: f.primal(u, n), lambda f, u, n: s2sad.vjp(f, (u, n), {"return": 1.0}),
    lambda f, u, n: s2sad.jvp(f, (u, n), {"u": u}), lambda f, u, n: f.adjoint(u, np.zeros(3), n, 1.0),
    lambda f, u, n: f.tangent(u, np.zeros(3), n, 1.0), lambda f, u, n: f.adjoint_source(u, n),
    lambda f, u, n: s2sad.autodiff(s2sad.Reverse, f, s2sad.Duplicated(u, np.zeros(3)), s2sad.Const(n)),
])
def test_every_way_to_call(call):
    f = s2sad.differentiate(trips, engine="numba")
    for _ in range(2):
        with pytest.raises(s2sad.S2sadError, match=r"test_operand_types\.py:\d+:\d+: error\[S405\]: the argument "
                                                   "'n' is a float, and a bound of range is an integer"):
            call(f, np.ones(3), 2.5)


def element(u, k):
    return u[k] ** 2


def halved(u, k):
    a = np.arange(3)
    a *= 0.5
    return a @ u


def divided(u, k):
    a = np.arange(3)
    a /= 2
    return a @ u


def moved(u, k):
    a = np.arange(3)
    a[1:] -= u[1:]
    return a @ u


def masked(u, k):
    a = np.arange(3)
    a[a > 1] *= 1.5
    return a @ u


def counted_in(u, k):
    a = np.zeros(3, bool)
    a += u > 0.5
    a[0] = True
    n = np.arange(3)
    n *= 2
    n[1] += k
    n[2] += 0.7
    w = np.ones(3, np.float32)
    w *= 0.5
    return a @ u + n @ u ** 2 + np.sum(w * u)


@pytest.mark.parametrize("engine", ["numpy", "numba"])
@pytest.mark.parametrize("kernel, held, made", [
    (halved, "int64", "float64"), (divided, "int64", "float64"), (moved, "int64", "float64"),
    (masked, "int64", "float64")])
def test_arrays_that_do_not_hold_what_they_get_in_place(kernel, held, made, engine):
    """NumPy raises UFuncTypeError; a store would round."""
    with pytest.raises(s2sad.S2sadError) as caught:
        s2sad.gradient(s2sad.differentiate(kernel, engine=engine), "u")(np.ones(3), 2)
    (found,) = caught.value.diagnostics
    assert (found.code, found.message, found.help) == (
        "S203", f"an array of {held} is changed in place, and what it gets is {made}",
        f"make it one of {made}: dtype={made.rstrip('0123456789')}, or a.astype(...)")
    with pytest.raises(TypeError):
        kernel(np.ones(3), 2)


@pytest.mark.parametrize("engine", ["numpy", "numba"])
def test_arrays_that_hold_what_they_get_in_place(engine):
    u = np.array([0.3, 0.7, 0.9])
    value, gradient = s2sad.value_and_gradient(s2sad.differentiate(counted_in, engine=engine), "u")(u, 3)
    assert value == pytest.approx(counted_in(u, 3), rel=1e-15)
    np.testing.assert_allclose(gradient, [1.5, 2 * 5 * 0.7 + 1.5, 2 * 4 * 0.9 + 1.5], rtol=1e-15)


SHAPE, LISTED = (3, 2), [3, 2]


def of_a_shape_outside(u, k):
    return np.sum(np.zeros(SHAPE) + u[0]) + np.sum(np.full(shape=LISTED, fill_value=1.0) * u[1])


def of_an_array(u, k):
    return np.sum(np.zeros(k) + u[0])


@pytest.mark.parametrize("engine", ["numpy", "numba"])
def test_shapes_that_are_no_tuples_here(engine):
    """What a module has is an array of numbers to a kernel without structures: np.zeros of one has several axes."""
    f = s2sad.gradient(s2sad.differentiate(of_a_shape_outside, engine=engine), "u")
    np.testing.assert_array_equal(f(np.ones(2), 0), [6.0, 6.0])
    with pytest.raises(s2sad.S2sadError) as caught:
        s2sad.gradient(s2sad.differentiate(of_an_array, engine=engine), "u")(np.ones(2), np.array([3, 2]))
    (found,) = caught.value.diagnostics
    assert (found.code, found.message) == ("S405", "the argument 'k' is an array of int64, and a size is an integer")


def negated(u, k):
    return np.sum(-(u > 0.5) * u)


def exchanged(u, k):
    return np.sum(((u > 0.5) - (u < 0.8)) * u)


@pytest.mark.parametrize("engine", ["numpy", "numba"])
@pytest.mark.parametrize("kernel", [negated, exchanged])
def test_bools_have_no_minus(kernel, engine):
    with pytest.raises(s2sad.S2sadError) as caught:
        s2sad.gradient(s2sad.differentiate(kernel, engine=engine), "u")(np.ones(3), 2)
    (found,) = caught.value.diagnostics
    assert (found.code, found.message, found.help) == (
        "S203", "an array of bools has no minus", "write ~a, a ^ b, or a.astype(int)")
    with pytest.raises(TypeError):
        kernel(np.ones(3), 2)
