"""The evaluator: kernels with objects, lists, dicts and functions as values have right values and derivatives."""
from __future__ import annotations

import functools

import numpy as np
import pytest

from s2sad import S2sadError, gradient
from tests.evaluate.test_objects import State
from tests.harness.derivatives import check_derivatives
from tests.evaluate.objects import (
    control, exchanges, gathered, generators, identity, known_counts, laziness, loop_exits, patterns,
    plain_python, solvers,
)

CASES = [(f"{module.__name__.rpartition('.')[2]}.{case.kernel.__name__}", case)
         for module in (identity, control, exchanges, gathered, generators, known_counts, laziness, loop_exits,
                        patterns, plain_python, solvers)
         for case in module.cases()]


def twice(x):
    doubled = (v * 2.0 for v in State(x).u[:2])
    return sum(doubled) * x[0] + sum(doubled)


def once_in_each_round(x):
    pairs = zip(State(x).u, x)
    s = 0.0
    for _ in range(int(x.size)):
        for a, b in pairs:
            s += a * b
    return s


def counting_behind_a_cache(x):
    calls = [0]

    @functools.cache
    def f(k):
        calls[0] += 1
        return x[k]
    return f(0) + f(0) + calls[0] * x[1]


def bound_anew_behind_a_cache(x):
    c = x[0]

    @functools.cache
    def f(k):
        return c * k
    first = f(2)
    c = x[1] * 3.0
    return first + f(2)


def element_behind_a_cache(x):
    held = [x[0]]

    @functools.cache
    def f(k):
        return held[0] * k
    first = f(2)
    held[0] = 7.0
    return first + f(2)


@functools.cache
def listed(v):
    return [v]


def list_behind_a_cache(x):
    return listed(x[0])[0] * x[1]


def calls_behind_a_cache(x):
    @functools.cache
    def price(i, j):
        return x[0] ** j * x[1] if i == 6 else 0.5 * (price(i + 1, j + 1) + x[1] * price(i + 1, j))
    return price(0, 0)


def structure_behind_a_cache(x):
    @functools.lru_cache
    def f(k, scale=1.0):
        return [x[0] * k * scale]
    f(2)[0] *= x[1]
    return f(2)[0] + f(3)[0] + f(3, scale=2.0)[0]


@pytest.mark.parametrize("engine", ["numpy", "loops"])
@pytest.mark.parametrize("kernel", [counting_behind_a_cache, bound_anew_behind_a_cache, element_behind_a_cache,
                                    calls_behind_a_cache, structure_behind_a_cache])
def test_a_function_behind_a_cache_gives_the_same_for_the_same_arguments(kernel, engine):
    check_derivatives(kernel, (np.array([0.3, 0.7]),), ("x",), ("return",), engine)


def forgetful(x):
    @functools.lru_cache(maxsize=2)
    def f(k):
        return x[0] ** k
    return f(1) + f(2) + f(3)


def on_one_way(x):
    @functools.cache
    def f(k):
        return x[0] ** k
    s = f(2) if x[1] > 0.0 else 1.0
    return s + f(2)


@pytest.mark.parametrize("kernel, said", [
    (list_behind_a_cache, "a function behind a cache, which is more than one of numbers"),
    (forgetful, "a cache that forgets: it is asked for more results than it holds"),
    (on_one_way, "a cache that holds this result on some ways only")])
def test_a_cache_that_is_not_followed_is_refused(kernel, said):
    with pytest.raises(S2sadError, match=said):
        gradient(kernel)(np.array([0.3, 0.7]))


@pytest.mark.parametrize("kernel", [twice, once_in_each_round])
def test_an_iterator_has_no_items_the_second_time(kernel):
    with pytest.raises(S2sadError, match="an iterator is gone through twice"):
        gradient(kernel)(np.array([0.3, 0.7]))


def begun_by_next(x):
    squares = (v * v for v in x)
    return next(squares) * 2 + sum(squares)


def test_a_generator_that_next_has_begun():
    with pytest.raises(S2sadError) as caught:
        gradient(begun_by_next)(np.array([0.3, 0.7]))
    (found,) = caught.value.diagnostics
    assert (found.message, found.help) == (
        "a generator goes on behind the item that next() has taken",
        "go through it in one loop, or make it a list first, items = list(...), and pick by an index")


@pytest.mark.parametrize("engine", ["numpy", "loops"])
@pytest.mark.parametrize("case", [pytest.param(case, id=name) for name, case in CASES])
def test_derivatives(case, engine):
    check_derivatives(case.kernel, case.arguments, (case.wrt,), case.of, engine, **case.options)
