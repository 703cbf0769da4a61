"""Views that NumPy may copy, and arrays that may not be contiguous: what is refused."""
from __future__ import annotations

import numpy as np
import pytest

import s2sad
from tests.normalize.views.whole_views import given, ravelled, step


def turned_then_ravelled(x):
    f = np.flip(x)
    g = np.ravel(f)
    g[0] = x[1] ** 2
    f[1] = g[0] * x[0]
    return g[0] + x[2]


def every_other_column(u):
    f = u[:, ::2].reshape(-1)
    f[0] = f[1] ** 2
    return np.sum(u)


def made_of_a_transpose(u):
    w = u.T * 2.0
    f = w.reshape(-1)
    f[1] = f[0] ** 2
    return np.sum(w ** 2)


def of_an_earlier_iteration(u):
    row = u[0]
    for i in range(u.shape[0]):
        r = u[i].reshape(2, 2)
        if i > 0:
            row[0] = r[1, 1] ** 2
        row = r[0]
        r[1] *= row
    return np.sum(u ** 2)


def in_either_branch(u):
    if u[0, 0] > 0.0:
        r = u.T
    else:
        r = u
    r[0] *= r[1]


def given_twice(u, q):
    f = u.ravel()
    step(u, f[:4])


def rebinding_other(u):
    f = u.ravel()
    f[0] *= 2.0
    u = u * 3.0
    f[1] *= u[0, 0]
    g = u.ravel()
    g[0] = f[1]
    return np.sum(u) * np.sum(f)


def bound_to_its_own_memory(u):
    f = u.ravel()
    if u[0, 0] > 0.0:
        f = f * 2.0
    f[0] = 7.0 * u[0, 1]
    return np.sum(u ** 2)


def its_own_after_a_round(u):
    x = u.reshape(-1)
    for _ in range(2):
        x = x + 0.1 * x ** 2
        x[0] = 0.5
    return np.sum(x ** 2)


def a_copy_in_a_branch(u):
    t = u.T
    if u[0, 0] > 0.0:
        t = t.copy()
    t[1] *= 2.0
    return np.sum(u * t)


def under_the_parameters_name(u):
    s = u[0, 0]
    u = u.ravel()
    for _ in range(2):
        u = u + 0.1 * u ** 2
        u[0] = 0.5
    return np.sum(u ** 2) + s


def scaled(u):
    s = 0.0
    for i in range(u.shape[0]):
        s += u[i, 0]
    return u * s


def result_of_a_function(u):
    a = scaled(u.T)
    f = a.ravel()
    f[1] = 0.0
    return np.sum(a ** 2 * scaled(u))


def zeroed(u):
    r = np.zeros_like(u)
    f = r.ravel()
    for i in range(u.size):
        f[i] = u[i // 4, i % 4] ** 2
    return r


def reshaped_in_a_function(u):
    return np.sum(zeroed(u.T) * zeroed(u + 1.0))


def swapped_in_a_branch(u):
    a = u * 1.0
    b = u.T * 2.0
    if u[0, 0] > 0.0:
        a, b = b, a
    f = a.ravel()
    f[1] = 0.0
    return np.sum(a ** 2 * b)


def picked_from_a_list(u):
    m = [u.T * (i + 1.0) for i in range(2)]
    for k in range(2):
        f = m[k % 2].ravel()
        f[1] = 0.0
    return np.sum(m[0] ** 2 * m[1])


def put_into_a_list(u):
    m = []
    for i in range(2):
        m.append(u.T * (i + 1.0))
    f = m[1].ravel()
    f[1] = 0.0
    return np.sum(m[0] ** 2 * m[1])


@pytest.mark.parametrize("kernel", (
    rebinding_other, bound_to_its_own_memory, its_own_after_a_round, a_copy_in_a_branch, under_the_parameters_name,
    result_of_a_function, reshaped_in_a_function, swapped_in_a_branch, picked_from_a_list, put_into_a_list),
    ids=lambda kernel: kernel.__name__)
def test_names_that_may_stand_for_other_memory_are_refused(kernel):
    """Or the memory that they stand for may lie otherwise: NumPy would write a copy."""
    with pytest.raises(s2sad.S2sadError) as caught:
        s2sad.differentiate(kernel, engine="numpy").adjoint_source(given(4, 4))
    assert caught.value.diagnostics[0].code == "S201"


def for_each_element(m):
    f = np.rot90(m)
    for i in range(1, 4):
        f[i, 0] += 2.0 * f[i - 1, 0] * m[0, 0]


@pytest.mark.parametrize("kernel", (turned_then_ravelled, every_other_column, made_of_a_transpose,
                                    of_an_earlier_iteration, in_either_branch, given_twice, for_each_element),
                         ids=lambda kernel: kernel.__name__)
def test_what_may_be_a_copy_or_would_cost_too_much_is_refused(kernel):
    arguments = (given(8),) if kernel.__code__.co_varnames[0] == "x" else (given(4, 4), given(4))
    with pytest.raises(s2sad.S2sadError, match="an array is written that NumPy shares with another one"):
        s2sad.differentiate(kernel, engine="numpy").adjoint_source(*arguments[:kernel.__code__.co_argcount])


def given_a_column(u):
    ravelled(u[:, 1])


def given_what_is_made(u):
    w = u.T * 2.0
    ravelled(w)
    return np.sum(w)


@pytest.mark.parametrize("kernel", (given_a_column, given_what_is_made), ids=lambda kernel: kernel.__name__)
def test_a_helper_that_reshapes_is_given_what_is_contiguous(kernel):
    with pytest.raises(s2sad.S2sadError, match="an array that the function reshapes and writes may not be contiguous"):
        s2sad.differentiate(kernel, engine="numpy").adjoint_source(given(4, 4))


def through_a_helper(u):
    ravelled(u)


@pytest.mark.parametrize("engine", ("numpy", "numba"))
@pytest.mark.parametrize("array", (given(4, 8)[:, ::2], np.asfortranarray(given(4, 4))), ids=("columns", "Fortran"))
def test_arguments_that_are_not_contiguous_are_refused(array, engine):
    function = s2sad.differentiate(through_a_helper, engine=engine)
    said = "'u' is not contiguous, where it or an array made like it is reshaped and written"
    with pytest.raises(s2sad.S2sadError, match=said):
        s2sad.vjp(function, (array,), {"u": np.ones((4, 4))})
    with pytest.raises(s2sad.S2sadError, match=said):
        s2sad.autodiff(s2sad.Reverse, function, s2sad.Duplicated(array, np.ones((4, 4))))
    if engine == "numpy":
        with pytest.raises(s2sad.S2sadError, match="an array that is reshaped and written is not contiguous"):
            function.adjoint(array, np.ones((4, 4)))
    assert np.all(array < 1.2)


def test_a_bound_that_counts_from_the_end_is_refused_where_parts_are_to_lie_side_by_side():
    def beside(y, n):
        a, b = y[:n].reshape(2, -1), y[2 * n:].reshape(2, -1)
        for i in range(2):
            a[i, 0] *= 2.0
            b[i, 0] *= a[i, 0]
    found = s2sad.vjp(beside, (given(6), 2), {"y": np.ones(6)})
    assert found["y"][0] != 1.0
    with pytest.raises(s2sad.S2sadError, match="a bound of a slice counts from the end"):
        s2sad.vjp(beside, (given(6), -2), {"y": np.ones(6)})
