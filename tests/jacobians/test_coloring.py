"""Colours: columns of one share no row, whatever the pattern; with a compiler and without one they are the same."""
from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from hypothesis.extra.numpy import arrays

from s2sad.diagnostics import Diagnostic, S2sadError
from s2sad.jacobians.coloring import colored, count_of, loops, star_colored
from s2sad.jacobians.compression_plan import Plan, symmetrized
from s2sad.jacobians.linear_maps import dense
from s2sad.jacobians.sparsity import pattern_of


class Matrix:
    """A matrix as a linear map, of which a nan shows whatever the entry is that it meets."""
    dtype = np.dtype(float)

    def __init__(self, pattern, width=1, engine="numpy"):
        self.pattern, self.given, self.taken = pattern, (len(pattern),), (pattern.shape[1],)
        self.most, self.engine = width, engine

    def width(self, count, transposed=False, measured=None):
        return measured or self.most

    def widths(self, count, transposed=False):
        return ()

    def products(self, directions, width, transposed=False):
        matrix = self.pattern.T if transposed else self.pattern
        for asked in directions:
            assert asked.shape == (matrix.shape[1], width)
            yield np.array([[sum((0.5 * v for v, there in zip(column, row) if there), 0.0) for column in asked.T]
                            for row in matrix]).reshape(len(matrix), width)


PATTERNS = st.tuples(st.integers(0, 7), st.integers(0, 9)).flatmap(lambda shape: arrays(bool, shape))


WIDTHS = st.integers(1, 5)


@given(PATTERNS, WIDTHS)
@settings(max_examples=60, deadline=None)
def test_the_pattern_is_found_and_its_colours_hold(pattern, width):
    for engine in ("numpy", "numba"):
        starts, columns = pattern_of(Matrix(pattern, width, engine))
        wanted = np.nonzero(pattern)
        np.testing.assert_array_equal(np.repeat(np.arange(len(pattern)), np.diff(starts)), wanted[0])
        np.testing.assert_array_equal(columns, wanted[1])
        by_column, rows = loops(engine).turned(starts, columns, pattern.shape[1])
        colors = colored(by_column, rows, starts, engine)
        for row in pattern:
            assert len({*colors[row]}) == row.sum()


@given(PATTERNS, WIDTHS)
@settings(max_examples=30, deadline=None)
def test_columns_and_rows_give_one_matrix(pattern, width):
    for mode in ("forward", "reverse"):
        np.testing.assert_array_equal(dense(Matrix(pattern, width), mode), 0.5 * pattern)


@pytest.mark.parametrize("check", [True, False])
@given(PATTERNS, WIDTHS)
@settings(max_examples=40, deadline=None)
def test_entries_are_told_by_batches_of_any_width(check, pattern, width):
    of = Matrix(pattern, width)
    for mode in ("forward", "reverse", "auto", "both"):
        plan = Plan.of(*pattern_of(of), of, mode)
        entries, theirs = plan.entries(of, check)
        assert not check or plan.agrees(of, entries, theirs)
        np.testing.assert_array_equal(plan.matrix(entries).toarray(), 0.5 * pattern)


@pytest.mark.parametrize("engine", ["numpy", "numba"])
@given(PATTERNS.filter(np.any), WIDTHS, st.sampled_from(["forward", "reverse", "both"]), st.data())
@settings(max_examples=40, deadline=None)
def test_an_entry_that_lacks_is_seen(engine, pattern, width, mode, data):
    rows, columns = np.nonzero(pattern)
    lacking = data.draw(st.integers(0, len(rows) - 1))
    smaller = pattern.copy()
    smaller[rows[lacking], columns[lacking]] = False
    plan = Plan.of(*pattern_of(Matrix(smaller)), Matrix(smaller), mode)
    of = Matrix(pattern, width, engine)
    entries, theirs = plan.entries(of, True)
    assert not plan.agrees(of, entries, theirs) and not plan.agrees(of, entries, theirs, rounded=True)
    assert plan.holds(*pattern_of(Matrix(smaller))) and not plan.holds(*pattern_of(of))


@given(PATTERNS, st.data())
@settings(max_examples=40, deadline=None)
def test_loops_are_what_arrays_are(pattern, data):
    plain, compiled = loops("numpy"), loops("numba")
    starts, columns = pattern_of(Matrix(pattern))
    both = [found.turned(starts, columns, pattern.shape[1]) for found in (plain, compiled)]
    (by_column, rows), order = both[0], data.draw(st.permutations(range(pattern.shape[1])))
    parts = np.array(data.draw(st.lists(st.integers(1, 3), min_size=len(pattern), max_size=len(pattern))), int)
    told = data.draw(arrays(bool, (pattern.shape[1], 6)))
    lanes = np.array(data.draw(st.lists(st.integers(0, 3), min_size=len(pattern), max_size=len(pattern))), int)
    for ask in (lambda f: f.turned(starts, columns, pattern.shape[1]),
                lambda f: (f.first_fit(by_column, rows, starts, np.array(order, int)),),
                lambda f: f.parted(starts, columns, lanes, parts, told)):
        for ours, theirs in zip(ask(plain), ask(compiled)):
            np.testing.assert_array_equal(ours, theirs)


class Counted(Matrix):
    """One that counts its products with rows and with columns; without adjoints those with rows are refused."""

    def __init__(self, pattern, width, engine, adjoints=True):
        super().__init__(pattern, width, engine)
        self.adjoints, self.asked = adjoints, {False: 0, True: 0}

    def width(self, count, transposed=False, measured=None):
        if transposed and not self.adjoints:
            raise S2sadError(Diagnostic("S301", "no adjoint"))
        return super().width(count, transposed, measured)

    def products(self, directions, width, transposed=False):
        for found in super().products(directions, width, transposed):
            self.asked[transposed] += width
            yield found


def dense_rows(rows, columns, dense, seed):
    made = np.eye(rows, columns, dtype=bool)
    made[np.random.default_rng(seed).permutation(rows)[:dense]] = True
    return made


@pytest.mark.parametrize("engine", ["numpy", "numba"])
@pytest.mark.parametrize("pattern", [
    dense_rows(50, 200, 1, 0), dense_rows(50, 200, 3, 1), np.ones((2, 200), bool), dense_rows(1, 200, 1, 2),
    dense_rows(50, 200, 2, 3) | (np.arange(200) == 7)])
def test_rows_of_many_columns_are_asked_for_by_themselves(pattern, engine):
    asked = []
    for adjoints in (True, False):
        of = Counted(pattern, 4, engine, adjoints)
        starts, columns = pattern_of(of)
        np.testing.assert_array_equal(np.repeat(np.arange(len(pattern)), np.diff(starts)), np.nonzero(pattern)[0])
        np.testing.assert_array_equal(columns, np.nonzero(pattern)[1])
        assert (of.asked[True] > 0) == adjoints
        asked.append(sum(of.asked.values()))
    assert 3 * asked[0] < asked[1]


def test_a_band_is_found_by_columns_alone():
    of = Counted(np.tri(60, k=2, dtype=bool) & ~np.tri(60, k=-3, dtype=bool), 4, "numpy")
    pattern_of(of)
    assert of.asked[True] == 0


# -- columns and rows at once -----------------------------------------------------------------------------------------

N = 30
FIRST, DIAGONAL = np.arange(N) == 0, np.eye(N, dtype=bool)
ARROW = DIAGONAL | FIRST | FIRST[:, None]
BLOCKS = np.kron(np.eye(3, dtype=bool), np.ones((2, 10), bool))     # 6 x 30


@pytest.mark.parametrize("engine", ["numpy", "numba"])
@pytest.mark.parametrize(("pattern", "counts", "cheapest"), [
    (ARROW, (2, 1), (2, 1)), (ARROW[::-1, ::-1], (2, 1), (2, 1)),
    (DIAGONAL | FIRST[:, None], (0, 2), (1, 1)), (DIAGONAL | FIRST, (2, 0), (2, 0)),        # a row; a column
    (np.tri(N, k=1, dtype=bool) & ~np.tri(N, k=-2, dtype=bool), (3, 0), (3, 0)),
    (BLOCKS, (0, 2), (0, 2)), (BLOCKS | FIRST, (1, 2), (1, 2)),
    (ARROW[:6], (2, 1), (2, 1)), (ARROW[:, :6], (2, 1), (2, 1)),
    (np.ones((6, N), bool), (0, 6), (0, 6)), (np.ones((N, 6), bool), (6, 0), (6, 0)),
    (np.zeros((6, N), bool), (1, 0), (1, 0)), (np.zeros((0, 3), bool), (0, 0), (0, 0)),
    (np.ones((1, 3), bool), (0, 1), (0, 1)), (np.ones((2, 3), bool), (0, 2), (3, 0))])
def test_what_is_dense_goes_its_own_way(pattern, counts, cheapest, engine):
    of = Matrix(pattern, 4, engine)
    for mode, wanted in (("both", counts), ("auto", cheapest)):
        plan = Plan.of(*pattern_of(of), of, mode)
        assert plan.counts == wanted and plan.colors == sum(wanted)
        entries, theirs = plan.entries(of, True)
        assert plan.agrees(of, entries, theirs)
        np.testing.assert_array_equal(plan.matrix(entries).toarray(), 0.5 * pattern)


@given(PATTERNS)
@settings(max_examples=100, deadline=None)
def test_both_take_no_more_than_either(pattern):
    of = Matrix(pattern)
    forward, reverse, both, auto = (Plan.of(*pattern_of(of), of, mode).counts
                                    for mode in ("forward", "reverse", "both", "auto"))
    assert sum(both) <= min(sum(forward), sum(reverse))
    assert auto[0] + 2 * auto[1] <= min(forward[0], 2 * reverse[1])


# -- symmetric matrices -----------------------------------------------------------------------------------------------

SYMMETRIC = st.integers(0, 9).flatmap(lambda n: arrays(bool, (n, n))).map(lambda a: a | a.T)


def is_star_coloring(pattern, colors):
    """Whether neighbours differ, and no path of four has two colours: by all paths."""
    near = [set(np.flatnonzero(row).tolist()) - {k} for k, row in enumerate(pattern)]
    paths = [(a, b, c, d) for b, around in enumerate(near) for c in around for a in near[b] - {c} for d in near[c] - {b}
             if a != d]
    return all(colors[a] != colors[b] for a, around in enumerate(near) for b in around) and all(
        len({*colors[[*path]]}) > 2 for path in paths)


@given(SYMMETRIC, st.data())
@settings(max_examples=100, deadline=None)
def test_star_colorings(pattern, data):
    starts, indices, twins = symmetrized(*pattern_of(Matrix(pattern)))
    order = np.array(data.draw(st.permutations(range(len(pattern)))), int)
    ours, theirs = (loops(engine).star_fit(starts, indices, twins, order) for engine in ("numpy", "numba"))
    np.testing.assert_array_equal(ours, theirs)
    assert is_star_coloring(pattern, ours)
    best = star_colored(starts, indices, twins, "numpy")
    for row, column in np.argwhere(pattern):        # an entry is alone with its colour, in its row or on the other side
        assert (best[pattern[row]] == best[column]).sum() == 1 or (best[pattern[column]] == best[row]).sum() == 1
    assert count_of(best) <= count_of(colored(starts, indices, starts, "numpy"))


@pytest.mark.parametrize("check", [True, False])
@given(SYMMETRIC, WIDTHS)
@settings(max_examples=60, deadline=None)
def test_entries_of_either_side(check, pattern, width):
    of = Matrix(pattern, width)
    plan = Plan.of(*pattern_of(of), of, "symmetric")
    entries, theirs = plan.entries(of, check)
    assert not check or plan.agrees(of, entries, theirs)
    np.testing.assert_array_equal(plan.matrix(entries).toarray(), 0.5 * pattern)


@pytest.mark.parametrize("engine", ["numpy", "numba"])
@given(SYMMETRIC.filter(np.any), WIDTHS, st.data())
@settings(max_examples=40, deadline=None)
def test_entries_of_either_side_that_lack_are_seen(engine, pattern, width, data):
    rows, columns = np.nonzero(pattern)
    lacking = data.draw(st.integers(0, len(rows) - 1))
    smaller = pattern.copy()
    smaller[rows[lacking], columns[lacking]] = smaller[columns[lacking], rows[lacking]] = False
    plan = Plan.of(*pattern_of(Matrix(smaller)), Matrix(smaller), "symmetric")
    of = Matrix(pattern, width, engine)
    entries, theirs = plan.entries(of, True)
    assert not plan.agrees(of, entries, theirs)


@pytest.mark.parametrize(("pattern", "stars", "columns"), [
    (np.eye(30, dtype=bool) | (np.arange(30) == 0) | (np.arange(30) == 0)[:, None], 2, 30),       # an arrow
    (np.eye(30, dtype=bool) | (np.arange(30) == 29) | (np.arange(30) == 29)[:, None], 2, 30),
    (np.tri(30, k=1, dtype=bool) & ~np.tri(30, k=-2, dtype=bool), 3, 3),                          # three diagonals
    (np.tri(3, k=1, dtype=bool) & ~np.tri(3, k=-2, dtype=bool), 2, 3),
    (np.eye(30, dtype=bool), 1, 1), (np.ones((6, 6), bool), 6, 6), (np.zeros((6, 6), bool), 1, 1)])
def test_a_symmetric_matrix_takes_fewer_products(pattern, stars, columns):
    of = Matrix(pattern)
    plans = [Plan.of(*pattern_of(of), of, mode) for mode in ("symmetric", "forward")]
    assert [plan.colors for plan in plans] == [stars, columns]
