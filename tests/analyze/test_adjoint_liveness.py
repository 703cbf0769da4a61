"""What nothing of an adjoint reads is neither run nor recorded; what something reads is, wherever it stands."""
from __future__ import annotations

import inspect
import re

import numpy as np
import pytest

import s2sad
from tests.harness.derivatives import check_derivatives, check_value

# -- left out -------------------------------------------------------------------------------------------------------


def squared_in_place(u, c):
    for i in range(u.size):
        u[i] = u[i] + c * u[i] * u[i]


def flux_then_update(u, f, c):
    for i in range(u.size - 1):
        f[i] = c * u[i] * u[i + 1]
    for i in range(1, u.size - 1):
        u[i] -= f[i] - f[i - 1]


def filled(f, u):
    for i in range(u.size):
        f[i] = u[i] * u[i]


def helper_then_update(u, f, c):
    filled(f, u)
    u += 0.5 * f


# -- read, and so run -----------------------------------------------------------------------------------------------

def along_a_row(u, f, c):
    for i in range(1, u.size):
        u[i] = u[i] * u[i - 1] * c


def along_a_row_backwards(u, f, c):
    for i in range(u.size - 2, -1, -1):
        u[i] = u[i] * u[i + 1] * c


def linear_along_a_row(u, f, c):
    for i in range(u.size - 2, -1, -1):
        u[i] = f[i] * u[i + 1] + u[i]


def twice_over_it(u, f, c):
    for _ in range(2):
        for i in range(u.size):
            u[i] = u[i] * u[i] * c


def increment_of_what_was_stored(u, f, c):
    f[0] = c * u[0] * u[1]
    f[0] += u[2]
    for i in range(u.size):
        u[i] = u[i] * f[0]


def place_that_was_stored(u, f, c):
    place = np.zeros(u.size, dtype=np.int64)
    for i in range(u.size):
        place[i] = (3 * i + 1) % u.size
    for i in range(u.size):
        f[place[i]] = u[i] * u[place[i]]


def way_that_was_stored(u, f, c):
    for i in range(u.size):
        f[i] = c * u[i]
    for i in range(u.size):
        if f[i] > 0.5:
            u[i] = u[i] * u[i]


def until_it_is_small(u, f, c):
    while f[0] > 0.15:
        f[0] = 0.5 * f[0]
        for i in range(u.size):
            u[i] = u[i] * u[i] * c


def left_where_it_is_large(u, f, c):
    for i in range(u.size):
        f[i] = 2.0 * u[i]
        if f[i] > 1.0:
            break
        u[i] = u[i] * u[i] * c


def norm_and_square(u, f):
    total = 0.0
    for i in range(u.size):
        f[i] = u[i] * u[i]
        total += f[i]
    return total


def number_of_a_helper(u, f, c):
    total = norm_and_square(u, f)
    for i in range(u.size):
        u[i] = u[i] * total * c


def rows_on_their_own(u, f, c):
    for i in range(u.size):
        inner = np.zeros(3)
        for k in range(3):
            inner[k] = u[i] * c + k
        for k in range(3):
            inner[k] = inner[k] * inner[k]
            f[i] += inner[k]


def rows_that_flow(u, f, c):
    for i in range(u.size):
        for k in range(2):
            f[k] = f[k] * u[i] + c
        for k in range(2):
            u[i] = u[i] + f[k] * f[k]


def whole_arrays(u, f, c):
    f[1:] = u[:-1] * u[1:]
    u[1:] = f[1:] * u[:-1]
    u[:-1] = u[:-1] * u[1:]


def linear_result(u, f, c):
    f[0] = 3.0 * u[0] + c
    return f[0]


def turned(u):
    u[:] = u[::-1]
    return u[1]


def halved(u):
    for i in range(u.size):
        u[i] = 0.5 * u[i]
    return u[0], 2.0 * u[1]


def number_that_nothing_reads(u, f, c):
    r = turned(u)
    q = 0.5 * r + c
    f[0] += q
    return q - 2.0 * r


def numbers_of_rounds(u, f, c):
    total = 0.0
    for i in range(f.size):
        total += turned(u)
        a, b = halved(u)
        if f[i] > 0.0:
            total += a - b * c
            f[i] -= turned(u)
    return total


RETURNING = (number_that_nothing_reads, numbers_of_rounds, linear_result)
ALL = (*RETURNING, flux_then_update, helper_then_update, along_a_row, along_a_row_backwards, linear_along_a_row,
       twice_over_it, increment_of_what_was_stored, place_that_was_stored, way_that_was_stored, until_it_is_small,
       left_where_it_is_large, number_of_a_helper, rows_on_their_own, rows_that_flow, whole_arrays)


def given() -> tuple[np.ndarray, np.ndarray, float]:
    return np.array([0.3, 0.45, -0.2, 0.6, 0.35]), np.array([0.8, 0.1, 0.3, -0.4, 0.2]), 1.3


@pytest.mark.parametrize("engine", ["numpy", "loops"])
@pytest.mark.parametrize("kernel", ALL, ids=lambda kernel: kernel.__name__)
def test_derivatives(kernel, engine):
    stored = dict(re.findall(r"^ +(u|f)\b[^=]*( [-+]?=) ", inspect.getsource(kernel), re.M))
    stored |= {"f": ""} if kernel in (number_of_a_helper, helper_then_update) else {}
    stored |= {"u": ""} if kernel in (number_that_nothing_reads, numbers_of_rounds) else {}
    of = (*stored, "return") if kernel in RETURNING else tuple(stored)
    check_derivatives(kernel, given(), ("u", "f", "c"), of, engine)


@pytest.mark.parametrize("engine", ["numpy", "loops"])
def test_the_value_beside_a_gradient_is_stored(engine):
    check_value(linear_result, given(), ("u", "c"), engine)


@pytest.mark.parametrize("engine", ["numpy", "numba"])
@pytest.mark.parametrize(("kernel", "arguments"), [
    (squared_in_place, (given()[0], 1.3)), (flux_then_update, given()), (helper_then_update, given())],
    ids=lambda x: getattr(x, "__name__", ""))
def test_what_is_stored_last_is_neither_stored_nor_recorded(kernel, arguments, engine):
    text = s2sad.differentiate(kernel, engine=engine).adjoint_source(*arguments)
    assert "It records nothing." in text
    own = text.partition(f"def {kernel.__name__}_adjoint(")[2]
    assert not [line for line in own.splitlines() if line.lstrip().startswith(("u[", "f[", "filled("))]


def guarded(u, f, c):
    f[0] = c * u[0]
    assert f[0] > 0.0
    u[0] = u[0] * u[0]


def test_what_a_guard_reads_is_stored():
    f = s2sad.differentiate(guarded, engine="numpy", of=("u",))
    with pytest.raises(AssertionError):
        s2sad.vjp(f, (-given()[0], given()[1], 1.3), {"u": np.ones(5)})


def test_the_sweeps_apart_store_what_the_kernel_does():
    text = s2sad.differentiate(flux_then_update, engine="numpy").adjoint_source(*given(), split=True)
    assert "u[i] -= f[i] - f[i - 1]" in text.partition("_reverse(")[0]
