"""The loop transformations of the fast level: the same numbers, bit by bit where sums keep their order."""
from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from benchmarks.calls import seed_like
from benchmarks.kernels.cases import CASES, LOOPS, Case
from s2sad import S2sadError, differentiate, gradient, pipeline
from s2sad.dispatch import compiler
from s2sad.emit import layout
from s2sad.infer.types import of_value
from s2sad.program import Generated, Request
from s2sad.runtime import exponentials
from s2sad.optimize.loop_bounds import counted_loop
from s2sad.optimize.loop_peeling import loop_peeling
from s2sad.tree import Compare, rename, statements, walk
from tests.harness.derivatives import check_derivatives
from tests.programs import random_kernel
from tests.harness.seeds import seeded


ELEMENTARY = ("exp", "expm1", "sinh", "cosh", "tanh")


def three_points(x, y):
    for i in range(1, x.size - 1):
        y[i] = x[i - 1] * x[i] - x[i + 1] * x[i + 1]


def wrapped_to_the_last(x, y):
    for i in range(x.size):
        y[i] = x[i - 1] * x[i]


def rows_one_apart(m, r):
    for _ in range(2):
        for i in range(1, m.shape[0]):
            for j in range(1, m.shape[1]):
                r[i, j] = m[i, j] * m[i - 1, j] + m[i, j - 1] * m[i - 1, j - 1]


def cross(m, r):
    for i in range(1, m.shape[0] - 1):
        for j in range(1, m.shape[1] - 1):
            r[i, j] = m[i - 1, j] * m[i, j - 1] - 4.0 * m[i, j] ** 2 + 3.0 * m[i, j + 1] * m[i + 1, j]


def a_row_that_may_be_another(m, r, k):
    for j in range(1, m.shape[1]):
        r[0, j] = m[1, j] * m[k, j - 1]


def overwritten_row_behind(x, a, steps):
    for _ in range(steps):
        for i in range(1, x.size):
            x[i] = a * x[i] * x[i - 1]


def overwritten_row_ahead(x, a, steps):
    for _ in range(steps):
        first = x[0]
        for i in range(x.size):
            after = x[i + 1] if i + 1 < x.size else first
            x[i] = a * x[i] * after


def products_of_neighbours(r, x, y):
    for i in range(1, x.size - 1):
        r[i] = x[i - 1] * x[i + 1] + x[i + 1] * y[i - 1] + x[i] * y[i + 1]


def one_array_twice_inside(r, x):
    products_of_neighbours(r, x, x)


def two_tests(x, y):
    n = x.size
    for i in range(n):
        left = x[i - 1] if i > 0 else x[n - 1]
        right = x[i + 1] if i != n - 1 else x[0]
        y[i] = left * x[i] * right


def of_two_rows(u, v, w):
    for i in range(u.size):
        g = np.exp(w[i] * u[i])
        h = np.tanh(w[i] * v[i])
        u[i] = u[i] * g + v[i]
        v[i] = v[i] * h * u[i]


def pairs_of_rows(m, w):
    for k in range(0, m.shape[0], 2):
        of_two_rows(m[k], m[k + 1], w)


def rows_around(m, w):
    for k in range(m.shape[0]):
        of_two_rows(m[k], m[k - 1], w)


def rows_that_are_chosen(m, w, k, n):
    of_two_rows(m[k], m[n], w)


SPELLING = {f"builtins.{f}": f for f in ("range", "min", "max")}
VECTORS = (three_points, wrapped_to_the_last, two_tests)


def texts(kernel, arguments, wrt, of) -> list[Generated]:
    program, types = compiler.program(kernel), tuple(map(of_value, arguments))
    return [pipeline.derive(program, Request("adjoint", types, wrt, of, "numba", level)) for level in ("plain", "fast")]


def given(generated: Generated, case: Case) -> list[Any]:
    """Fresh arguments of a generated adjoint; the shadows hold something everywhere."""
    primals = iter(case.arguments("small"))
    made: list[Any] = []
    for parameter in generated.parameters:
        made.append(next(primals) if parameter.role == "primal" else seed_like(made[-1])
                    if parameter.role == "shadow" else 1.0 + 0.5 * len(made))
    return made


def same(case: Case) -> None:
    """Both levels' texts as plain Python give the same bits, but for products of blocks, sums that begin with zero,
    reciprocals, and the derivative of tanh."""
    found, rounds = [], False
    for generated in texts(case.function, case.arguments("small"), case.wrt, case.of):
        space: dict = {}
        exec(generated.text, space)
        rounds = rounds or any(w in generated.text for w in (
                "_rows = ", "_gain = ", "_total = 0.0", "reciprocal = ", "sech_squared"))
        space |= {n: getattr(np, n) for n in ELEMENTARY if space.get(n) is getattr(exponentials, n)}
        arguments = given(generated, case)
        result = space[generated.entry](*arguments)
        found.append(([a for a, p in zip(arguments, generated.parameters) if p.role == "shadow"], result or ()))
    tolerance = 1e-12 if rounds else 0.0
    for one, other in zip([*found[0][0], *found[0][1]], [*found[1][0], *found[1][1]]):
        np.testing.assert_allclose(one, other, rtol=tolerance, atol=tolerance)


@pytest.mark.parametrize("case", LOOPS, ids=lambda case: case.name)
def test_levels_agree(case):
    same(case)


@pytest.mark.parametrize("size", range(2, 8))
@pytest.mark.parametrize("kernel", VECTORS, ids=lambda f: f.__name__)
def test_levels_agree_at_every_size(kernel, size):
    same(Case(kernel.__name__, kernel, lambda _: (np.arange(1.0, size + 1.0), np.ones(size)), ("x",), ("y",)))


@pytest.mark.parametrize("kernel", [overwritten_row_behind, overwritten_row_ahead], ids=lambda f: f.__name__)
@pytest.mark.parametrize("size", [1, 2, 3, 6])
def test_rows_of_the_tape(kernel, size):
    same(Case(kernel.__name__, kernel, lambda _: (np.linspace(0.5, 1.5, size), 1.1, 3), ("x", "a"), ("x",)))


@pytest.mark.parametrize("sizes", [(3, 1), (3, 2), (4, 3), (3, 4), (5, 6)], ids=str)
def test_crosses_of_every_size(sizes):
    start = np.linspace(0.5, 1.5, sizes[0] * sizes[1]).reshape(sizes)
    same(Case("cross", cross, lambda _: (start, np.zeros(sizes)), ("m",), ("r",)))


def test_advect_at_every_size():
    for size in range(2, 7):
        same(Case("advect", CASES["advect"].function, lambda _, n=size: (np.sin(np.arange(n)), 0.4, 3), ("u", "c"),
                  ("u",)))


@pytest.mark.parametrize("first", range(0, 60, 30))
def test_levels_agree_on_numbered_programs(first):
    for seed in range(seeded(first), seeded(first) + 30):
        program = random_kernel(seed)
        try:
            same(Case(str(seed), program.load(), lambda _, p=program: tuple(p.arguments()), program.wrt, program.of))
        except S2sadError:
            continue


@pytest.mark.parametrize("kernel, arguments, wrt, of", [
    (three_points, (np.linspace(0.5, 1.5, 9), np.zeros(9)), ("x",), ("y",)),
    (two_tests, (np.linspace(0.5, 1.5, 9), np.zeros(9)), ("x",), ("y",)),
    (rows_one_apart, (np.linspace(0.5, 1.5, 20).reshape(4, 5), np.zeros((4, 5))), ("m",), ("r",)),
    (one_array_twice_inside, (np.zeros(9), np.linspace(0.5, 1.5, 9)), ("x",), ("r",)),
    (cross, (np.linspace(0.5, 1.5, 20).reshape(4, 5), np.zeros((4, 5))), ("m",), ("r",)),
    (a_row_that_may_be_another, (np.linspace(0.5, 1.5, 20).reshape(4, 5), np.zeros((4, 5)), 1), ("m",), ("r",)),
    (a_row_that_may_be_another, (np.linspace(0.5, 1.5, 20).reshape(4, 5), np.zeros((4, 5)), -3), ("m",), ("r",)),
    (pairs_of_rows, (np.linspace(0.5, 1.5, 20).reshape(4, 5), np.linspace(0.3, 0.9, 5)), ("m", "w"), ("m",)),
    (rows_around, (np.linspace(0.5, 1.5, 20).reshape(4, 5), np.linspace(0.3, 0.9, 5)), ("m", "w"), ("m",)),
    (rows_that_are_chosen, (np.linspace(0.5, 1.5, 20).reshape(4, 5), np.linspace(0.3, 0.9, 5), 2, -1), ("m", "w"),
     ("m",)),
    (overwritten_row_behind, (np.linspace(0.5, 1.5, 9), 1.1, 3), ("x", "a"), ("x",)),
    (overwritten_row_ahead, (np.linspace(0.5, 1.5, 9), 1.1, 3), ("x", "a"), ("x",)),
], ids=lambda v: getattr(v, "__name__", ""))
def test_derivatives(kernel, arguments, wrt, of):
    pytest.importorskip("numba")
    measured = check_derivatives(kernel, arguments, wrt, of, "numba")
    assert measured.dot_product <= 1e-12
    assert max(measured.directional, measured.coordinates) <= 1e-7


def sum_of_multiples(c, u):
    return np.sum(c * u)


def test_what_broadcasting_gains_is_added_in_partial_sums():
    """One after the other, a million terms of 0.1 leave an error of 9e4 units in the last place; four sums, the fewest
    that a processor's vectors make, a quarter of it."""
    pytest.importorskip("numba")
    found = gradient(differentiate(sum_of_multiples, engine="numba"), wrt="c")(0.3, np.full(10 ** 6, 0.1))
    assert abs(found - 1e5) < 3e4 * np.spacing(1e5)


def test_rows_are_apart_where_their_numbers_are():
    """Not where one may be counted from the end: with one row, rows 0 and -1 are the same."""
    m, w = np.ones((4, 5)), np.ones(5)
    for kernel, arguments, apart in ((pairs_of_rows, (m, w), True), (rows_around, (m, w), False), (
            rows_that_are_chosen, (m, w, 1, 2), False)):
        plain, fast = texts(kernel, arguments, ("m", "w"), ("m",))
        own = [t.text.partition("def of_two_rows_adjoint(")[2].partition("\ndef ")[0] for t in (plain, fast)]
        assert (own[0] != own[1]) is apart


def test_which_elements_are_held():
    x, m = np.ones(5), np.ones((4, 5))

    def text(kernel, arguments, wrt, of):
        return texts(kernel, arguments, wrt, of)[1].text
    assert "x_bar_held_3" in text(three_points, (x, x), ("x",), ("y",))
    assert "_held" not in text(wrapped_to_the_last, (x, x), ("x",), ("y",))
    assert "_held" not in text(a_row_that_may_be_another, (m, m, 1), ("m",), ("r",))
    assert "m_bar_gains" in text(rows_one_apart, (m, m), ("m",), ("r",))


@pytest.mark.parametrize("loop", ["for i in range(a, b):", "for i in range(b, a, -1):"])
@pytest.mark.parametrize("tests", [("i > {low}",), ("i < {high}",), ("i > {low}", "i != {high}"),
                                   ("i == {low}", "{high} <= i")])
def test_peeled_iterations(loop, tests):
    """The parts of a loop are its iterations, in their order, and tests have their values."""
    low, high = ("a", "b - 1") if "-1" not in loop else ("a + 1", "b")
    tests = [t.format(low=low, high=high) for t in tests]
    text = f"{loop}\n    out.append((i, {', '.join(tests)}))"
    given = rename(statements(text)[0], {"range": "builtins.range"})
    parts = loop_peeling(given, counted_loop(given))
    assert parts is not None
    before, middle, after = parts
    body = "\n".join(layout.text(s, SPELLING) for s in [*before, middle, *after])
    for a, b in [(0, 0), (3, 1), (2, 3), (2, 4), (0, 3), (1, 6)]:
        found: list = []
        wanted: list = []
        exec(body, {"a": a, "b": b, "out": found})
        exec(text, {"a": a, "b": b, "out": wanted})
        assert found == wanted
    assert not any(isinstance(n, Compare) for n in walk(middle.body))
