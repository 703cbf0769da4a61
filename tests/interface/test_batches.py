"""Many directions at once: the derivatives are those for each, and what does not fit is said."""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

import s2sad
from benchmarks.kernels.cases import CASES
from tests import corpus
from tests.harness.batches import compare_batches
from tests.harness.engines import one_line, running

COMPILED = ("advect", "upwind")
CORPUS = {name: case for name, case in corpus.cases() if not case.refused and case.wrt is not None}
ENGINES = pytest.mark.parametrize("engine", ["numpy", "loops"])


@ENGINES
@pytest.mark.parametrize("name", [*CASES])
def test_batches_are_their_single_directions(name, engine):
    case = CASES[name]
    assert compare_batches(case.function, case.arguments("small"), case.wrt, case.of, engine) == (True, True)


@pytest.mark.parametrize("name", COMPILED)
def test_compiled_batches_are_their_single_directions(name):
    case = CASES[name]
    assert compare_batches(case.function, case.arguments("small"), case.wrt, case.of, "numba", 5) == (True, True)


@ENGINES
@pytest.mark.parametrize("name", [*CORPUS][::160])
def test_batches_of_the_corpus_are_their_single_directions(name, engine):
    case = CORPUS[name]
    wrt = (case.wrt,) if isinstance(case.wrt, str) else case.wrt
    compare_batches(case.kernel, case.arguments, wrt, case.of or ("return",), engine)


@pytest.mark.parametrize("count", [1, 3, 4, 18])
def test_what_a_call_found_is_its_own(count):
    """Though compiled functions have directions along the last axis, and memory of calls is used again."""
    args, rng = CASES["upwind"].arguments(3000), np.random.default_rng(1)
    f, along = s2sad.differentiate(CASES["upwind"].function, engine="numba"), rng.standard_normal((count, 3000))
    for call, name, of in ((s2sad.jvp, "u", {"of": "du"}), (s2sad.vjp, "du", {"wrt": "u"})):
        found = call(f, args, {name: along}, batch=True, **of)[[*of.values()][0]]
        assert found.shape == (count, 3000)
        held = found.copy()
        other = call(f, args, {name: along + 1.0}, batch=True, **of)[[*of.values()][0]]
        np.testing.assert_array_equal(found, held)
        assert not np.shares_memory(found, other)
        found[:] = 0.0
        np.testing.assert_array_equal(call(f, args, {name: along}, batch=True, **of)[[*of.values()][0]], held)
        for k in (0, count - 1):
            one = call(f, args, {name: along[k].copy()}, **of)[[*of.values()][0]]
            np.testing.assert_allclose(held[k], one, rtol=1e-15, atol=1e-15)


# -- what a direction decides -----------------------------------------------------------------------------------------

def kinks(u, c):
    """Zero seeds and tangents at infinite slopes: each direction has zeros of its own."""
    s = 0.0
    for i in range(u.size):
        s += np.sqrt(u[i]) * c
    return s


def test_each_direction_has_zeros_of_its_own():
    u, along = np.array([0.0, 4.0]), np.array([[1.0, 0.0], [0.0, 1.0]])
    for engine in ("numpy", "loops"):
        with running(engine) as under:
            f = s2sad.differentiate(kinks, engine=under)
            found = s2sad.jvp(f, (u, 2.0), {"u": along, "c": np.zeros(2)}, batch=True)["return"]
            np.testing.assert_array_equal(found, [np.inf, 0.5])
            found = s2sad.vjp(f, (u, 2.0), {"return": np.array([0.0, 1.0])}, batch=True)["u"]
            np.testing.assert_array_equal(found, [[0.0, 0.0], [np.inf, 0.5]])


def rebinds(x, y):
    """Helpers that bind their parameters anew, and are given one number twice."""
    s = y
    for i in range(x.size):
        s = _twice(s, x[i], s)
        x[i] = _twice(x[i], s, x[i])
    return s


def _twice(a, b, c):
    a = a * b
    b = b + a * c
    a = a - b
    return a * c


def own_rows(x):
    """Arrays that are made in a loop, of other shapes than what is given, and copied."""
    s = 0.0
    for k in range(1, x.shape[0]):
        row = x[:k] * x[k]
        other = row.copy()
        other[0] = x[0] ** 2
        s += np.sum(row * other)
    return s


@ENGINES
@pytest.mark.parametrize(("kernel", "args", "wrt", "of"), [
    (rebinds, (np.array([0.5, 1.5, 0.7]), 0.3), ("x", "y"), ("x", "return")),
    (own_rows, (np.array([0.5, 1.5, 0.7, 2.0]),), ("x",), ("return",))])
def test_what_is_bound_anew_is_each_directions_own(kernel, args, wrt, of, engine):
    assert compare_batches(kernel, args, wrt, of, engine) == (True, True)


@ENGINES
@pytest.mark.parametrize("name", ["as_in_jax", "value_too", "of_both"])
def test_a_call_stays_behind_what_it_is_given(name, engine):
    """Its result is one for all directions, which has to be copied for each behind it."""
    case = CORPUS[f"language.nested_derivatives.{name}"]
    assert compare_batches(case.kernel, case.arguments, case.wrt, ("return",), engine) == (True, True)


# -- shapes -----------------------------------------------------------------------------------------------------------

def scale(u, c, n):
    for i in range(n, u.shape[0]):
        for j in range(u.shape[1]):
            u[i, j] = c * u[i, j]
    return c * u


ARGS = np.arange(6.0).reshape(2, 3), 3.0, 0


@ENGINES
@pytest.mark.parametrize("count", [0, 1, 9])
def test_results_have_the_axis_of_directions(count, engine):
    along = {"u": np.ones((count, 2, 3)), "c": np.zeros(count)}
    seeds = {"u": np.ones((count, 2, 3)), "return": np.zeros((count, 2, 3))}
    with running(engine) as under:
        f = s2sad.differentiate(scale, engine=under)
        found = s2sad.jvp(f, ARGS, along, batch=True)
        assert found["u"].shape == found["return"].shape == (count, 2, 3)
        np.testing.assert_array_equal(found["return"], 9.0 * along["u"])
        found = s2sad.vjp(f, ARGS, seeds, batch=True)
        assert found["u"].shape == (count, 2, 3)
        assert found["c"].shape == (count,)
        np.testing.assert_array_equal(found["u"], 3.0 * seeds["u"])


@ENGINES
def test_directions_may_share_memory(engine):
    along = np.broadcast_to(np.arange(6.0).reshape(2, 3), (4, 2, 3))
    with running(engine) as under:
        found = s2sad.jvp(s2sad.differentiate(scale, engine=under), ARGS, {"u": along}, of="u", batch=True)
    np.testing.assert_array_equal(found["u"], 3.0 * along)


@dataclass
class Grid:
    u: np.ndarray
    t: float
    n: int


def stepped(grid, k):
    for i in range(1, grid.n):
        grid.u[i] += k * grid.u[i - 1] * grid.t
    grid.t += k
    return grid.u[1] * grid.t


@ENGINES
@pytest.mark.parametrize("count", [0, 3])
def test_structures_of_directions(count, engine):
    rng = np.random.default_rng(0)
    along, weights = Grid(rng.random((count, 4)), rng.random(count), 4), rng.random(count)
    each = [(Grid(along.u[k], float(along.t[k]), 4), float(weights[k])) for k in range(count)]
    args = Grid(np.arange(4.0), 0.5, 4), 0.3
    with running(engine) as under:
        f = s2sad.differentiate(stepped, engine=under)
        found = s2sad.jvp(f, args, {"grid": along, "k": weights}, batch=True)
        back = s2sad.vjp(f, args, {"grid": along, "return": weights}, batch=True)
        for k, (grid, number) in enumerate(each):
            one = s2sad.jvp(f, args, {"grid": grid, "k": number})
            np.testing.assert_array_equal(found["grid"].u[k], one["grid"].u)
            assert (found["grid"].t[k], found["return"][k]) == (one["grid"].t, one["return"])
            one = s2sad.vjp(f, args, {"grid": grid, "return": number})
            np.testing.assert_array_equal(back["grid"].u[k], one["grid"].u)
            assert (back["grid"].t[k], back["k"][k]) == (one["grid"].t, one["k"])
    assert found["grid"].u.shape == back["grid"].u.shape == (count, 4)
    assert found["return"].shape == back["k"].shape == (count,)


# -- what does not fit ------------------------------------------------------------------------------------------------

@pytest.mark.parametrize(("along", "said"), [
    ({}, "no directions were given: give a dict by name: {\"x\": an array of shape (k, ...)}"),
    ({"u": np.ones((4, 2, 3)), "c": np.ones(3)}, "'u' has 4 directions, 'c' has 3: give all of them as many"),
    ({"u": np.ones((2, 3))}, "the directions of 'u' are an array of float64 of shape (2, 3): give an array of float64 "
                             "of shape (k, 2, 3), k directions"),
    ({"u": np.ones((4, 2, 3), np.float32)}, "the directions of 'u' are an array of float32 of shape (4, 2, 3): give an "
                                            "array of float64 of shape (k, 2, 3), k directions"),
    ({"c": 1.0}, "the directions of 'c' are of type float: give an array of float64 of shape (k,), k directions"),
    ({"n": np.ones(3)}, "wrt names 'n', which is an integer: give a float (3.0, not 3) if it is a real quantity"),
])
def test_directions_that_do_not_fit(along, said):
    args = ARGS[0].copy(), *ARGS[1:]
    with pytest.raises(s2sad.S2sadError) as caught:
        s2sad.jvp(s2sad.differentiate(scale, engine="numpy"), args, along, batch=True)
    assert one_line(caught.value) == said
    np.testing.assert_array_equal(args[0], ARGS[0])


@pytest.mark.parametrize(("seeds", "said"), [
    ({"u": np.ones((4, 2, 3)), "return": np.ones((3, 2, 3))},
     "'u' has 4 directions, 'return' has 3: give all of them as many"),
    ({"return": np.ones((2, 3))}, "the directions of 'return' are an array of float64 of shape (2, 3): give an array "
                                  "of float64 of shape (k, ..., ...), k directions"),
    ({"return": np.ones((2, 3, 3))}, "the seed 'result_bar' has shape (3, 3), what 'scale' returns there has (2, 3): "
                                     "give an array of its shape"),
])
def test_seeds_that_do_not_fit(seeds, said):
    args = ARGS[0].copy(), *ARGS[1:]
    with pytest.raises(s2sad.S2sadError) as caught:
        s2sad.vjp(s2sad.differentiate(scale, engine="numpy"), args, seeds, batch=True)
    assert one_line(caught.value) == said
    np.testing.assert_array_equal(args[0], ARGS[0])


def cubic(x, a):
    return x ** 3 - a


@s2sad.rule(implicit=cubic)
def cube_root(a):
    return np.cbrt(a)


def weighted(x, a):
    x[0] = a * cube_root(a)


def test_a_derivative_of_the_users_own_is_called_for_each():
    f = s2sad.differentiate(weighted, engine="numpy")
    found = s2sad.jvp(f, (np.ones(1), 8.0), {"a": np.array([1.0, 2.0])}, batch=True)["x"]
    np.testing.assert_allclose(found, [[8.0 / 3.0], [16.0 / 3.0]], rtol=1e-14)
    found = s2sad.vjp(f, (np.ones(1), 8.0), {"x": np.array([[1.0], [2.0]])}, wrt="a", batch=True)["a"]
    np.testing.assert_allclose(found, [8.0 / 3.0, 16.0 / 3.0], rtol=1e-14)


# -- memory -----------------------------------------------------------------------------------------------------------

def lagged(u, y):
    for i in range(1, u.size):
        y[i] = u[i] * u[i - 1]
    return np.sum(y)


@ENGINES
def test_a_call_takes_the_memory_of_the_last_one_and_gives_none_of_it(engine):
    """Directions that are kept between calls: what was found stays, and zeros are zeros again."""
    rng = np.random.default_rng(3)
    u, y = rng.uniform(0.5, 1.5, 1500), np.zeros(1500)
    calls = [(*rng.standard_normal((2, k, 1500)), rng.standard_normal(k)) for k in (5, 3, 9)]
    with running(engine) as under:
        f = s2sad.differentiate(lagged, engine=under)
        ahead = [s2sad.jvp(f, (u, y), {"u": along}, batch=True) for along, _, _ in calls]
        back = [s2sad.vjp(f, (u, y), {"y": w, "return": r}, batch=True) for _, w, r in calls]
        for (along, weights, seeds), found, gradients in zip(calls, ahead, back):
            for k in range(len(along)):
                one = s2sad.jvp(f, (u, y), {"u": along[k].copy()})
                other = s2sad.vjp(f, (u, y), {"y": weights[k].copy(), "return": float(seeds[k])})
                np.testing.assert_allclose(found["y"][k], one["y"], rtol=1e-14)
                np.testing.assert_allclose(found["return"][k], one["return"], rtol=1e-12)
                for name in ("u", "y"):
                    np.testing.assert_allclose(gradients[name][k], other[name], rtol=1e-13, atol=1e-14)
