"""Tables of what an outer loop does not change, and the loops that have none."""
from __future__ import annotations

import numpy as np
import pytest

import s2sad
from tests.corpus.loops.invariant_code_motion import (
    X, carried_name, in_a_branch, left_early, moving_name, of_pairs, of_two_counters, once_a_step, tables, triangle,
    written, written_by_a_function,
)

W = np.array([0.4, -0.3, 0.6, 0.9])


def _fast(kernel) -> str:
    return s2sad.differentiate(kernel, engine="numba").adjoint_source(X.copy(), W.copy(), level="fast")


@pytest.mark.parametrize(("kernel", "names"), [
    (tables, ["cos_table", "exp_table", "sin_table"]), (of_two_counters, ["exp_table"]), (once_a_step, ["exp_table"])])
def test_tables(kernel, names):
    text = _fast(kernel)
    assert sorted(n for n in ("exp_table", "sin_table", "cos_table") if f"{n}, top = " in text) == sorted(names)
    for n in names:
        word = n.partition("_")[0]
        body = text.partition("\ndef ")[2]
        calls = [x.strip() for x in body.splitlines() if f"{word}(" in x and not x.strip().startswith(("#", "def"))]
        assert calls and all(x.startswith((f"{n}[", f"{n}_2[")) for x in calls)     # where tables are filled


@pytest.mark.parametrize("kernel", [written, written_by_a_function, moving_name, carried_name, in_a_branch, left_early,
                                    triangle, of_pairs])
def test_no_table(kernel):
    assert "_table" not in _fast(kernel)


def weighted(x, w, rows, columns):
    total = 0.0
    for i in range(rows):
        for j in range(columns):
            total += np.exp(w[j]) * x[i, j]
    return total


@pytest.mark.parametrize(("rows", "columns"), [(0, 9), (3, 0), (3, 4), (0, 0), (3, -1)])
def test_a_table_is_read_where_the_loops_read(rows, columns):
    """No row: the operand has fewer elements than the inner loop would read."""
    f = s2sad.differentiate(weighted, engine="numba")
    found = s2sad.vjp(f, (X.copy(), W.copy(), rows, columns), {"return": 1.0})
    m = max(columns, 0)
    expected = np.zeros(4)
    if rows:
        expected[:m] = np.exp(W[:m]) * X[:rows, :m].sum(0)
    assert np.allclose(found["w"], expected, rtol=1e-14)
    assert "if rows > 0:" in f.adjoint_source(X.copy(), W.copy(), 3, 4, level="fast")
