"""Slices whose step is a name or an expression: diagonals by a step, sieves, transforms by halves."""
from __future__ import annotations

import numpy as np
import pytest

import s2sad
from tests.harness.derivatives import check_derivatives
from tests.harness.engines import each, running
from tests.harness.seeds import generator


def given(*shape: int) -> np.ndarray:
    return generator(7).uniform(0.3, 1.2, shape)


def diagonal(m, n):
    m.ravel()[::n + 1] += 1.0
    return np.sum(m ** 2)


def diagonal_by_shape(m):
    m.ravel()[::m.shape[1] + 1] += 2.0
    return np.sum(m ** 2)


def diagonal_of_rows(m, n):
    m.reshape(-1)[::n + 1] *= m[0]
    return np.sum(m ** 2)


def diagonal_read(m, n):
    return np.sum(m.ravel()[::n + 1] ** 2) + np.sum(m[0])


def bands(n, x):
    m = np.zeros((n, n))
    m.ravel()[::n + 1] = x
    m.reshape(-1)[1::n + 1] = x[:-1] * x[1:]
    m.ravel()[n::n + 1] -= x[1:] ** 2
    return m


def named(x, n):
    d = x[::n + 1]
    x[1] *= d[1]
    d[2] = x[1] ** 2
    return np.sum(d ** 2) * x[-1]


def beside_a_matrix(x, n):
    d = x[::n + 1]
    m = x.reshape(n, n)
    m[0] *= d[1]
    d += 1.0
    return np.sum(m ** 2)


def parts_of_parts(x, n, k):
    d = x[1::n]
    e = d[::k]
    e *= d[0]
    g = d[1:]
    g += 0.1 * g[0] ** 2
    return d[-1] * e[-1] + np.sum(x ** 2)


def rounds(x, n):
    s = 0.0
    for k in range(1, n):
        x[::k] += 0.1 * x[k] * x[::k]
        s += x[-1]
    return s


def rebound(x, k):
    y = np.zeros(4)
    d = x[::k]
    k = 3
    y[:] = d[:4] * x[::k][0]
    k += 1
    e = x[::k]
    e[0] *= y[1]
    return np.sum(y) + np.sum(e)


def two_axes(m, k):
    return np.sum(m[::k, ::k + 1] ** 2) + np.sum(m[:, 1::k] * m[:, :-1:k])


def sieve(x, n):
    for p in range(2, n):
        x[p * p::p] *= 0.5 * x[1]
    return np.sum(x ** 2)


def even_and_odd(x, s):
    a, b = x[::s], x[1::s]
    a[:] = a - b * b
    b *= 2.0 * a
    return np.sum(x * x)


def halves(x, n):
    h = 1
    while h < n:
        a = x[::2 * h].copy()
        b = x[h::2 * h].copy()
        x[::2 * h] = a + b * 0.7
        x[h::2 * h] = a - b * b
        h *= 2
    return np.sum(x * np.arange(float(x.size)))


def asked_of_an_array(x, places):
    return np.sum(x[::places[1]] ** 2)


def scaled(d, k):
    d[::k] *= d[0]
    return d[::k + 1].sum()


def through_a_helper(m, n):
    return scaled(m.ravel(), n + 1) + scaled(m[0], 2) + np.sum(m[:, 0] ** 2)


CASES = [
    (diagonal, (given(3, 3), 3)), (diagonal_by_shape, (given(3, 3),)), (diagonal_of_rows, (given(3, 3), 3)),
    (diagonal_read, (given(3, 3), 3)), (bands, (4, given(4))), (named, (given(9), 3)), (beside_a_matrix, (given(9), 3)),
    (parts_of_parts, (given(9), 2, 2)), (rounds, (given(7), 4)), (rebound, (given(9), 2)), (two_axes, (given(4, 5), 2)),
    (sieve, (given(12), 5)), (even_and_odd, (given(8), 2)), (even_and_odd, (given(8), 4)), (halves, (given(8), 8)),
    (asked_of_an_array, (given(7), np.array([1, 3]))), (through_a_helper, (given(3, 3), 3)),
    (diagonal, (given(1, 1), 1)), (diagonal, (given(0, 0), 0)), (bands, (1, given(1))),
    (diagonal_by_shape, (given(2, 3),)),
    (even_and_odd, (given(2), 7)), (diagonal, (given(3, 3).astype(np.float32), 3)),
    (parts_of_parts, (given(9).astype(np.float32), 3, 1))]


@pytest.mark.parametrize("kernel, arguments, engine", each(CASES))
def test_steps_that_are_no_written_numbers(kernel, arguments, engine):
    wrt = tuple(n for n, a in zip(kernel.__code__.co_varnames, arguments)
                if isinstance(a, np.ndarray) and a.dtype.kind == "f" and a.size)
    if wrt:
        check_derivatives(kernel, arguments, wrt, ("return",), engine=engine)


def read(x, k):
    return np.sum(x[::k] ** 2)


def written(x, k):
    x[::k] *= 2.0


def part(x, k):
    d = x[::k]
    d[0] *= d[-1]


@pytest.mark.parametrize("engine", ("numpy", "loops"))
@pytest.mark.parametrize("kernel", (read, written, part))
@pytest.mark.parametrize("step", (-1, -2, 0))
def test_a_step_that_is_not_positive_is_refused_when_it_is_there(kernel, step, engine):
    with running(engine) as under:
        function = s2sad.differentiate(kernel, engine=under)
        seed = {"return": 1.0} if kernel is read else {"x": np.ones(6)}
        said = r"the step of a slice is not positive, where it is not a written number"
        with pytest.raises(s2sad.S2sadError, match=said):
            s2sad.vjp(function, (given(6), step), seed)


def backwards(x, k):
    d = x[::-1][::k]
    d[0] *= 2.0
    return np.sum(x ** 2)


def test_a_part_of_a_part_that_runs_backwards_is_refused():
    with pytest.raises(s2sad.S2sadError, match="a part of a part of an array whose step is not a written number"):
        s2sad.gradient(backwards)(given(6), 2)
