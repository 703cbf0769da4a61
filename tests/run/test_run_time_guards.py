"""What cannot be known before the kernel runs is refused with its line and both sizes; the kernel's own errors stay."""
from __future__ import annotations

import re

import numpy as np
import pytest

import s2sad
from tests.harness.engines import running

REPEATS = "a length of 1 repeats only where it is written, as in x[:, None] or x[:1], or an argument's"
U, V = np.array([0.3, 0.7, 1.1]), np.array([1.2, -0.4, 0.5, 0.9])


def added(u, v):
    return np.sum((u + v) ** 2)


def added_in_place(u, v):
    u += v
    return np.sum(u ** 2)


def stored(u, v):
    u[:] = v ** 2
    return np.sum(u)


def parts(u, v):
    u[1:] = v[:-1] ** 2
    return np.sum(u)


def chosen(u, v):
    return np.sum(np.where(u > 0, u * v, v))


def stacked(u, v):
    return np.sum(np.stack([u, v]) ** 2)


def out_of_its_array(u, v):
    u[-5:] *= 2.0
    return np.sum(u ** 2)


def halves(u, v):
    a, b = np.split(u, 2)
    return np.sum(a * b)


def turned(u, v):
    for _ in range(2):
        u, v = v, u * 2.0
    return np.sum(u)


def stepped(u, v):
    k = v.size - 5
    w = u[2:0:k]
    return np.sum(w ** 2)


def _sum(a, b):
    c = a + b
    return np.sum(c * c)


def in_a_function(u, v):
    return 2.0 * _sum(u, v)


GUARDED = [
    (added, "shapes differ", "u.shape is (3,), v.shape is (4,)", REPEATS, "return np.sum((u + v) ** 2)"),
    (added_in_place, "shapes differ", "u.shape is (3,), v.shape is (4,)", REPEATS, "u += v"),
    (stored, "shapes differ", "u.shape is (3,), v.shape is (4,)", REPEATS, "u[:] = v ** 2"),
    (parts, "shapes differ", "max(u.shape[0] - 1, 0) is 2, max(v.shape[0] - 1, 0) is 3", REPEATS,
     "u[1:] = v[:-1] ** 2"),
    (chosen, "shapes differ", "u.shape is (3,), v.shape is (4,)", REPEATS,
     "return np.sum(np.where(u > 0, u * v, v))"),
    (stacked, "shapes differ", "u.shape[0] is 3, v.shape[0] is 4", REPEATS, "np.stack([u, v])"),
    (out_of_its_array, "a slice reaches out of its array, where NumPy takes less", "u.shape[0] - 5 is -2",
     "bound it by max(..., 0) or min(..., n)", "u[-5:] *= 2.0"),
    (halves, "np.split into sections that are not of one length", "u.shape[0] % 2 is 1", "np.array_split makes such",
     "np.split(u, 2)"),
    (turned, "'u' may change its size from one iteration to the next", "u_1.shape is (3,), v_1.shape is (4,)", "",
     "u, v = v, u * 2.0"),
    (stepped, "the step of a slice is not positive, where it is not a written number", "v.shape[0] - 6 is -2",
     "write a loop", "w = u[2:0:k]"),
    (in_a_function, "shapes differ", "a.shape is (3,), b.shape is (4,)", REPEATS, "c = a + b"),
]
DOORS = {
    "gradient": lambda f, u, v: s2sad.gradient(f, "u")(u, v),
    "vjp": lambda f, u, v: s2sad.vjp(f, (u, v), {"return": 1.0}),
    "jvp": lambda f, u, v: s2sad.jvp(f, (u, v), {"u": np.ones_like(u)}),
    "adjoint": lambda f, u, v: f.adjoint(u, np.zeros_like(u), v, np.zeros_like(v), 1.0),
    "tangent": lambda f, u, v: f.tangent(u, np.zeros_like(u), v, np.zeros_like(v)),
    "autodiff": lambda f, u, v: s2sad.autodiff(
        s2sad.Reverse, f, s2sad.Duplicated(u, np.zeros_like(u)), s2sad.Duplicated(v, np.zeros_like(v))),
}


def failing(call, *arguments):
    with pytest.raises(s2sad.S2sadError) as caught:
        call(*arguments)
    (found,) = caught.value.diagnostics
    assert isinstance(caught.value, ValueError)     # as NumPy's own error is
    return found


@pytest.mark.parametrize("engine", ["numpy", "loops"])
@pytest.mark.parametrize("kernel, message, note, help, text", GUARDED, ids=[g[0].__name__ for g in GUARDED])
def test_guards_say_where_and_what(kernel, message, note, help, text, engine):
    with running(engine) as name:
        f = s2sad.differentiate(kernel, engine=name)
        for door in sorted(DOORS):
            found = failing(DOORS[door], f, U.copy(), V.copy())
            assert (found.code, found.message, found.note, found.help) == ("S501", message, note, help), door
            line = found.span.source.line(found.span.line)
            assert line[found.span.column:found.span.end_column] == text and found.span.source.path == __file__


def test_guards_of_compiled_code():
    f = s2sad.differentiate(in_a_function, engine="numba")
    U4 = np.ones(4)
    for _ in range(2):
        for door in ("gradient", "adjoint", "tangent"):
            found = failing(DOORS[door], f, U.copy(), V.copy())
            assert (found.message, found.note) == ("shapes differ", "a.shape is (3,), b.shape is (4,)")
            DOORS[door](f, U4.copy(), V.copy())
        found = failing(f.primal, U, V)
        assert (found.message, found.note) == ("shapes differ", "a.shape is (3,), b.shape is (4,)")
        assert f.primal(U4, V) == in_a_function(U4, V)


def test_the_text_of_a_refusal():
    with pytest.raises(s2sad.S2sadError) as caught:
        s2sad.gradient(s2sad.differentiate(added_in_place, engine="numpy"), "u")(U, V)
    first, *rest = str(caught.value).splitlines()
    assert re.fullmatch(r".*test_run_time_guards\.py:\d+:5: error\[S501\]: shapes differ", first)
    assert [line.partition("|")[2] for line in rest[:2]] == [
        "     u += v", "     ^^^^^^ u.shape is (3,), v.shape is (4,)"]
    assert rest[2] == f"  help: {REPEATS}"


def product(u, v):
    return np.dot(u, v)


def reshaped(u, v):
    w = u.reshape(2, -1)
    return np.sum(w * w)


def test_what_numpy_refuses_is_said_with_its_line():
    for kernel, text, said in (
            (product, "np.dot(u, v)", "shapes (3,) and (4,) not aligned: 3 (dim 0) != 4 (dim 0)"),
            (reshaped, "w = u.reshape(2, -1)", "cannot reshape array of size 3 into shape (2,newaxis)")):
        found = failing(s2sad.gradient(s2sad.differentiate(kernel, engine="numpy"), "u"), U, V)
        line = found.span.source.line(found.span.line)
        assert (found.code, found.message) == ("S501", said)
        assert line[found.span.column:found.span.end_column] == text


def asserting(u, v):
    assert u.size == v.size, "as many of both"
    return np.sum(u * v)


def asserting_nothing(u, v):
    assert u.size == v.size
    return np.sum(u * v)


def raising(u, v):
    if u.size != v.size:
        raise ValueError("as many of both")
    return np.sum(u * v)


def singular(u, v):
    a = np.zeros((3, 3))
    return np.sum(np.linalg.solve(a, u))


@pytest.mark.parametrize("engine", ["numpy", "loops", "numba"])
@pytest.mark.parametrize("kernel, kind, arguments", [
    (asserting, AssertionError, ("as many of both",)), (asserting_nothing, AssertionError, ()),
    (raising, ValueError, ("as many of both",))])
def test_what_the_kernel_says_itself_stays(kernel, kind, arguments, engine):
    with running(engine) as name:
        f = s2sad.differentiate(kernel, engine=name)
        for door in ("gradient", "adjoint"):
            with pytest.raises(kind) as caught:
                DOORS[door](f, U.copy(), V.copy())
            assert type(caught.value) is kind and caught.value.args == arguments


def of_two(a, b):
    return a * b


def starred(x, n):
    return of_two(*x[:n])


@pytest.mark.parametrize("engine", ["numpy", "loops", "numba"])
def test_a_starred_argument_of_another_length(engine):
    with running(engine) as name:
        f = s2sad.differentiate(starred, engine=name)
        np.testing.assert_array_equal(s2sad.gradient(f)(V, 2)["x"], [V[1], V[0], 0.0, 0.0])
        for n in (1, 3):
            with pytest.raises(TypeError, match="^the call takes 2 items of its starred argument$"):
                s2sad.gradient(f)(V, n)


def divided(x, n):
    return x[0] * (5 // n)


def remainder(x, n):
    total = 0.0
    for i in range(3):
        total += x[i % n]
    return total


def of_an_index(x, n):
    return x[divmod(7, n)[1]]


def in_a_test(x, n):
    for i in range(3):
        if i % n == 0:
            x[i] *= 2.0
    return np.sum(x)


def a_size(x, n):
    n //= n
    return np.sum(np.ones(n) * x[0])


@pytest.mark.parametrize("engine", ["numpy", "loops", "numba"])
@pytest.mark.parametrize("kernel", [divided, remainder, of_an_index, in_a_test, a_size])
def test_integers_are_not_divided_by_zero(kernel, engine):
    with running(engine) as name:
        f = s2sad.differentiate(kernel, engine=name)
        for n in (2, 0, 3, 0):
            if n:
                assert s2sad.value_and_gradient(f, "x")(V.copy(), n)[0] == pytest.approx(kernel(V.copy(), n))
                continue
            for call in (kernel, s2sad.gradient(f, "x"), lambda x, n: s2sad.jvp(f, (x, n), {"x": V})):
                with pytest.raises(ZeroDivisionError):
                    call(V.copy(), n)


@pytest.mark.parametrize("engine", ["numpy", "numba"])
def test_floats_are(engine):
    """Under NumPy's error model, the numbers of Python's too (docs/limits.md)."""
    f = s2sad.differentiate(of_two_floats, engine=engine)
    assert s2sad.value_and_gradient(f)(1.0, 0.0)[0] == np.inf


def of_two_floats(a, b):
    return a / b


def of_a_part(x, n):
    return x[1:3][n] * x[0]


def of_every_other(x, n):
    return x[::2][n]


def written_part(x, n):
    y = x[:2]
    y[n] += 1.0
    return np.sum(x) * y[0]


def of_a_row(x, n):
    return np.outer(x, x)[1][:2][n]


def in_a_loop(x, n):
    y, total = x[1:3], 0.0
    for k in (0, n):
        total += y[k] * x[k]
    return total


def of_a_list(x, n):
    items = []
    for v in x[:3]:
        if v > 0.0:
            items.append(v * v)
    return items[n] * x[0]


@pytest.mark.parametrize("engine", ["numpy", "loops", "numba"])
@pytest.mark.parametrize("kernel", [of_a_part, of_every_other, written_part, of_a_row, in_a_loop, of_a_list])
def test_an_index_out_of_a_part_is_none_into_its_array(kernel, engine):
    with running(engine) as name:
        f = s2sad.differentiate(kernel, engine=name)
        for n in (0, 1, -1, -2, 2, 3, 1, -3, 40, -40, 0):       # what has been right once is asked for again
            if -3 < n < 2:
                assert s2sad.value_and_gradient(f, "x")(V.copy(), n)[0] == pytest.approx(kernel(V.copy(), n))
                continue
            for call in (kernel, s2sad.gradient(f, "x"), lambda x, n: s2sad.jvp(f, (x, n), {"x": V})):
                with pytest.raises(IndexError):
                    call(V.copy(), n)


def largest(x, n):
    return np.max(x[:n]) * 2.0


def least(x, n):
    w = x[:n] * x[0]
    return np.min(w)


def largest_of_rows(x, n):
    return np.sum(np.max(np.outer(x, x[:n]), axis=1))


@pytest.mark.parametrize("engine", ["numpy", "loops", "numba"])
@pytest.mark.parametrize("kernel", [largest, least, largest_of_rows])
def test_there_is_no_extreme_of_nothing(kernel, engine):
    with running(engine) as name:
        f = s2sad.differentiate(kernel, engine=name)
        for n in (2, 0, 1, 0):
            if n:
                assert s2sad.value_and_gradient(f, "x")(V, n)[0] == pytest.approx(kernel(V, n))
                continue
            with pytest.raises(ValueError):
                kernel(V, n)
            found = failing(s2sad.gradient(f, "x"), V, n)
            assert found.code == "S501"
            if engine != "numpy":
                assert (found.message, found.help) == (
                    "there is no maximum or minimum of no elements", "ask whether there are any before")


def test_singular_matrices_stay_numpys_own_error():
    with pytest.raises(np.linalg.LinAlgError):
        s2sad.gradient(s2sad.differentiate(singular, engine="numpy"), "u")(U, V)


def squares(u, v):
    return u * u


@pytest.mark.parametrize("engine", ["numpy", "loops"])
def test_seeds_of_another_shape(engine):
    with running(engine) as name:
        f = s2sad.differentiate(squares, engine=name)
        for seed in (np.ones(4), np.ones(1)):
            with pytest.raises(s2sad.S2sadError) as caught:
                s2sad.vjp(f, (U, V), {"return": seed}, "u")
            assert str(caught.value) == (
                f"error[S403]: the seed 'result_bar' has shape {seed.shape}, what 'squares' returns there has (3,)\n"
                "  help: give an array of its shape")


def in_two_rows(u):
    v = u.reshape(2, -1)
    return np.sum(v[0] * v[1])


def test_what_does_not_divide_is_not_reshaped():
    """NumPy looks how many elements there are; loops in place of its function have to."""
    with running("loops") as engine:
        f = s2sad.differentiate(in_two_rows, engine=engine)
        np.testing.assert_array_equal(s2sad.gradient(f)(np.arange(4.0)), [2.0, 3.0, 0.0, 1.0])
        with pytest.raises(s2sad.S2sadError) as caught:
            s2sad.gradient(f)(np.arange(5.0))
    (found,) = caught.value.diagnostics
    assert isinstance(caught.value, ValueError)
    assert found.message == "an array is reshaped to another number of elements"
    assert "u.shape[0] is 5" in found.note
