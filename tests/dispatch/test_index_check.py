"""Indices stay within arrays, as is known, or the primal is run with bounds checks: no derivative reads beyond."""
from __future__ import annotations

import numpy as np
import pytest

import s2sad
from s2sad.dispatch.cache import ProgramVersion, derivatives_of

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


def multiplied(y, data, indices, starts, x):
    for row in range(y.shape[0]):
        y[row] = 0.0
        for k in range(starts[row], starts[row + 1]):
            y[row] += data[k] * x[indices[k]]


def stored(y, x, places):
    """Stores, where the place counts from the end, too."""
    for k in range(places.shape[0]):
        y[places[k]] += x[k] * x[k]


def first_ones(x, k, n):
    total = 0.0
    for i in range(n):
        total += x[k[i]] ** 2
    return total


def counted(x, n):
    """The place is a number that a loop counts up as a float has it."""
    place, total = 0, 0.0
    for i in range(n):
        total += x[place] * x[place]
        if x[i] > 0.0:
            place += 1
    return total


def to_the_next_power(x, n):
    """The size of an array is what a loop multiplies up to."""
    size = 1
    while size < n:
        size = size * 2
    total, place = 0.0, 0
    while place < size:
        total += x[place] * x[place]
        place = place + 1
    return total


def never_reached(x, n):
    total = 0.0
    for i in range(n):
        total += x[i + 100] * x[i]
    return total + x[0]


@pytest.fixture
def checked(monkeypatch):
    """The primals that are run with bounds checks, each time that they are."""
    found = []
    run = ProgramVersion._run_checked

    def counted_run(self, *args):
        found.append(self.kernel.name)
        return run(self, *args)
    monkeypatch.setattr(ProgramVersion, "_run_checked", counted_run)
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


SPARSE = np.ones(3), np.array([0, 2, 1]), np.array([0, 1, 3]), np.arange(3.0)


@pytest.mark.parametrize(("place", "wrong"), [
    (1, [0, 3, 1]), (1, [0, -4, 1]), (2, [0, 1, 4]), (2, [-4, 1, 3]), (2, [0, 3]), (0, np.ones(2))])
@pytest.mark.parametrize("call", [
    lambda f, y, y_bar, given, bars: f.adjoint(y, y_bar, given[0], bars[0], *given[1:], bars[1]),
    lambda f, y, y_bar, given, bars: f.tangent(y, y_bar, given[0], bars[0], *given[1:], bars[1]),
    lambda f, y, y_bar, given, bars: f.primal(y, *given)], ids=["adjoint", "tangent", "primal"])
def test_later_calls_are_refused_and_write_nothing(call, place, wrong):
    f = fresh(multiplied, wrt=("data", "x"), of="y")
    call(f, np.zeros(2), np.ones(2), SPARSE, (np.zeros(3), np.zeros(3)))
    given = [a.copy() for a in SPARSE]
    given[place] = np.array(wrong)
    y, y_bar, bars = np.full(2, 7.0), np.ones(2), (np.full(given[0].shape, 2.0), np.full(3, 3.0))
    for _ in range(2):
        with pytest.raises(IndexError):
            call(f, y, y_bar, given, bars)
        assert y.tolist() == [7.0, 7.0] and y_bar.tolist() == [1.0, 1.0]
        assert set(bars[0]) == {2.0} and set(bars[1]) == {3.0}
    call(f, np.zeros(2), np.ones(2), SPARSE, (np.zeros(3), np.zeros(3)))


def test_the_line_of_the_kernel_is_named():
    f = fresh(multiplied, wrt=("data", "x"), of="y")
    data, indices, starts, x = SPARSE
    with pytest.raises(IndexError, match=r"S501.*out of bounds") as caught:
        s2sad.vjp(f, (np.zeros(2), data, indices + 1, starts, x), {"y": np.ones(2)})
    assert "y[row] += data[k] * x[indices[k]]" in str(caught.value)


def test_places_from_the_end_are_places(checked):
    f, x = fresh(stored, wrt="x", of="y"), np.array([1.0, 2.0, 3.0])
    for places in ([0, 1, 1], [-1, 0, -2], [1, -2, 0]):
        found = s2sad.vjp(f, (np.zeros(2), x, np.array(places)), {"y": np.array([1.0, 10.0])})["x"]
        np.testing.assert_array_equal(found, 2.0 * x * np.array([1.0, 10.0])[places])
    assert not checked
    with pytest.raises(IndexError):
        s2sad.vjp(f, (np.zeros(2), x, np.array([0, 1, -3])), {"y": np.ones(2)})


def test_what_no_loop_reads_may_be_anything(checked):
    f, x, k = fresh(first_ones), np.arange(1.0, 4.0), np.array([1, 0, 99])
    for n, found in ((1, [0.0, 4.0, 0.0]), (2, [2.0, 4.0, 0.0])):
        assert s2sad.gradient(f, wrt="x")(x, k, n).tolist() == found
    assert checked == ["first_ones"] * 2
    with pytest.raises(IndexError):
        s2sad.gradient(f, wrt="x")(x, k, 3)


def test_what_floats_decide_is_looked_at_in_each_call(checked):
    f = fresh(counted)
    assert s2sad.gradient(f, wrt="x")(np.array([-1.0, 1.0]), 2).tolist() == [-4.0, 0.0]
    with pytest.raises(IndexError):
        s2sad.gradient(f, wrt="x")(np.array([1.0]), 3)
    assert checked == ["counted"] * 2


def test_calls_with_the_same_integers_are_looked_at_once(checked):
    f = fresh(to_the_next_power)
    for x in ([1.0, 2.0, 3.0, 4.0], [4.0, 3.0, 2.0, 1.0], [1.0, 2.0, 3.0, 4.0]):
        assert s2sad.gradient(f, wrt="x")(np.array(x), 3).tolist() == [2.0 * value for value in x]
    assert checked == ["to_the_next_power"]
    for x, n in ((np.ones(3), 3), (np.ones(4), 5)):
        for _ in range(2):
            with pytest.raises(IndexError):
                s2sad.gradient(f, wrt="x")(x, n)
    assert checked == ["to_the_next_power"] * 5


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
