"""Views that functions make, written and read beside what they are views of; every kernel against differences."""
from __future__ import annotations

import numpy as np
import pytest

import s2sad
from s2sad.emit import text
from s2sad import pipeline, read
from s2sad.infer.types import of_value
from tests.harness.derivatives import check_derivatives
from tests.harness.engines import running
from tests.normalize.views import part_views, whole_views
from tests.normalize.views.part_views import in_loops, integrate, rhs
from tests.normalize.views.whole_views import element_mix, given, of_any_size

CASES = {**whole_views.CASES, **part_views.CASES}


def selected(kernel, arguments):
    """Every float array, and what the kernel writes or returns."""
    names = kernel.__code__.co_varnames[:kernel.__code__.co_argcount]
    after = [np.copy(a) if isinstance(a, np.ndarray) else a for a in arguments]
    returned = kernel(*after)
    floats = [n for n, a in zip(names, arguments) if isinstance(a, np.ndarray) and a.dtype.kind == "f"]
    written = [n for n, a, b in zip(names, arguments, after) if n in floats and not np.array_equal(a, b)]
    return tuple(floats), (*written, *(() if returned is None else ("return",)))


@pytest.mark.parametrize("engine", ("numpy", "loops"))
@pytest.mark.parametrize("kernel", CASES, ids=lambda kernel: kernel.__name__)
def test_views_and_operands_are_kept_in_step(kernel, engine):
    check_derivatives(kernel, CASES[kernel], *selected(kernel, CASES[kernel]), engine=engine)


@pytest.mark.parametrize("kernel", (integrate, in_loops, element_mix), ids=lambda kernel: kernel.__name__)
def test_they_are_when_compiled(kernel):
    check_derivatives(kernel, CASES[kernel], *selected(kernel, CASES[kernel]), engine="numba")


@pytest.mark.parametrize("shape", ((1, 1), (1, 3), (3, 1)))
def test_sizes_of_1(shape):
    check_derivatives(of_any_size, (given(*shape),), ("u",), ("u", "return"), engine="numpy")


def whole(u):
    f = u.ravel()
    f *= 2.0
    u *= f.size
    f += 1.0


@pytest.mark.parametrize("engine", ("numpy", "loops"))
def test_no_elements(engine):
    with running(engine) as name:
        found = s2sad.vjp(s2sad.differentiate(whole, engine=name), (np.zeros((0, 3)),), {"u": np.zeros((0, 3))})
    assert found["u"].shape == (0, 3)


def test_copies_are_made_where_they_must_be():
    """What the pass writes is Python that computes the same; the usual right-hand side has one copy back."""
    seen = []
    program = read.load(rhs)
    types = tuple(map(of_value, (given(18), given(18), 3)))
    pipeline.entry(program, types, "numpy", lambda stage, tree: seen.append(tree) if stage == "coherence" else None)
    lines = [line.strip() for line in text(seen[0]).splitlines()]
    assert lines[1:] == [
        "u = np.reshape(y[:n * n], (n, n))", "v = np.reshape(y[n * n:], (n, n))",
        "du = np.copy(np.reshape(dy[:n * n], (n, n)))", "dv = np.copy(np.reshape(dy[n * n:], (n, n)))",
        "du[1:-1, 1:-1] = u[2:, 1:-1] * v[1:-1, 1:-1]", "dv[:] = u * u - v", "dy[:n * n] = np.ravel(du)",
        "dy[n * n:] = np.ravel(dv)", "return"]


def part_added_to_by_its_own_elements(u):
    u[0, :2] += 0.5 * u[1, 1] + 0.1 * u[0, 1] ** 2


@pytest.mark.parametrize("engine", ("numpy", "loops"))
def test_the_seed_of_a_part_is_what_it_was_before_its_elements_gain(engine):
    check_derivatives(part_added_to_by_its_own_elements, (given(4, 4),), ("u",), ("u",), engine=engine)


def columns_and_rows(x):
    c, r = x.reshape(-1, 1), np.reshape(x, (1, -1))
    for k in range(3):
        c[k, 0] *= x[3]
    r[0, 1] += 2.0 * c[2, 0]
    f = x[::-1].reshape(-1)
    f[0] = f[1] ** 2
    d = x[::2].reshape(-1, 1)
    d *= 0.5
    return np.sum(c * r) + np.sum(d)


@pytest.mark.parametrize("engine", ("numpy", "loops"))
def test_an_array_of_one_axis_is_a_column_and_a_row_wherever_it_lies(engine):
    check_derivatives(columns_and_rows, (given(4),), ("x",), ("x", "return"), engine=engine)
