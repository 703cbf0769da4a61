"""Indices stay within arrays, as is known, or the primal is run with bounds checks: no derivative reads beyond."""
from __future__ import annotations

import numpy as np
import pytest

import s2sad
from s2sad.dispatch import cache
from s2sad.dispatch.cache import derivatives_of

pytest.importorskip("numba")


def differences(x, y):
    for i in range(x.shape[0] - 1):
        y[i] = x[i + 1] - x[i]


def moved(a, b, n):
    for i in range(n):
        b[i] = 2.0 * a[i + 1]


def through_a_helper(x, y, n):
    moved(x, y, n)


def gathered(x, k):
    total = 0.0
    for i in range(k.shape[0]):
        total += x[k[i]] ** 2
    return total


def never_reached(x, n):
    total = 0.0
    for i in range(n):
        total += x[i + 100] * x[i]
    return total + x[0]


@pytest.fixture
def checked(monkeypatch):
    """The primals that are compiled with bounds checks."""
    found = []
    compiled = cache.compiled
    monkeypatch.setattr(cache, "compiled", lambda *a, **k: found.append(a[1]) or compiled(*a, **k))
    return found


def fresh(function, **keywords):
    """The function with derivatives that nothing has been derived of."""
    derivatives_of(function)._states.clear()
    derivatives_of(function)._current = None
    return s2sad.differentiate(function, engine="numba", **keywords)


def test_what_is_known_is_not_compiled_with_checks(checked):
    f = fresh(differences)
    for n in (5, 4, 0):
        x = np.arange(float(n))
        found = s2sad.vjp(f, (x, np.zeros(max(n - 1, 0))), {"y": np.ones(max(n - 1, 0))})
        np.testing.assert_array_equal(found["x"][1:-1], 0.0)
    assert not checked


@pytest.mark.parametrize("call", [
    lambda f, x, y: s2sad.vjp(f, (x, y), {"y": np.ones_like(y)}),
    lambda f, x, y: s2sad.jvp(f, (x, y), {"x": np.ones_like(x)}),
    lambda f, x, y: f.adjoint(x, np.zeros_like(x), y, np.ones_like(y)),
    lambda f, x, y: f.augmented(x, y),
    lambda f, x, y: f.primal(x, y),
    lambda f, x, y: s2sad.autodiff(s2sad.Reverse, f, s2sad.Duplicated(x, np.zeros_like(x)),
                                   s2sad.Duplicated(y, np.ones_like(y))),
], ids=["vjp", "jvp", "adjoint", "augmented", "primal", "autodiff"])
def test_each_call_is_looked_at(checked, call):
    """Sizes that fit in one call and not in the next; nothing is written then."""
    f, x = fresh(differences), np.arange(5.0)
    call(f, x.copy(), np.zeros(4))
    call(f, x.copy(), np.zeros(9))
    assert not checked
    y = np.full(3, 7.0)
    for _ in range(2):
        with pytest.raises(IndexError):
            call(f, x.copy(), y)
    assert checked == ["differences"] * 2
    np.testing.assert_array_equal(y, 7.0)
    call(f, x.copy(), np.zeros(4))


def test_a_helper_is_called_with_other_sizes(checked):
    f = fresh(through_a_helper, wrt="x", of="y")
    assert s2sad.vjp(f, (np.ones(4), np.zeros(3), 3), {"y": np.ones(3)})["x"].tolist() == [0.0, 2.0, 2.0, 2.0]
    for x, y, n in ((3, 3, 3), (4, 2, 3), (4, 3, 4)):
        with pytest.raises(IndexError):
            s2sad.vjp(f, (np.ones(x), np.zeros(y), n), {"y": np.ones(y)})
    assert s2sad.vjp(f, (np.ones(2), np.zeros(0), 0), {"y": np.ones(0)})["x"].tolist() == [0.0, 0.0]


def test_what_an_array_says_is_checked_at_the_first_call(checked):
    f, x = fresh(gathered), np.arange(4.0)
    for wrong in (4, -5):
        with pytest.raises(IndexError):
            s2sad.gradient(f, wrt="x")(x, np.array([0, wrong]))
    assert s2sad.gradient(f, wrt="x")(x, np.array([1, -1])).tolist() == [0.0, 2.0, 0.0, 6.0]
    assert set(checked) == {"gathered"}


def test_loops_without_a_trip_ask_for_nothing(checked):
    f = fresh(never_reached)
    assert s2sad.gradient(f, wrt="x")(np.ones(3), 0).tolist() == [1.0, 0.0, 0.0]
    assert not checked
    with pytest.raises(IndexError):
        s2sad.gradient(f, wrt="x")(np.ones(3), 1)


def test_what_is_known_is_kept_on_disk(checked, tmp_path, monkeypatch):
    monkeypatch.setenv("S2SAD_CACHE_DIR", str(tmp_path))
    for _ in range(2):
        f = fresh(differences)
        assert f.adjoint(np.ones(3), np.zeros(3), np.zeros(2), np.ones(2)) is None
    assert not checked
    with pytest.raises(IndexError):
        f.adjoint(np.ones(3), np.zeros(3), np.zeros(1), np.ones(1))
