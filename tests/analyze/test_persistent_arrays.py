"""Loops that run again and hand on what they store in cells that nothing overwrites; and cells that something does."""
from __future__ import annotations

import numpy as np
import pytest

import s2sad
from tests.harness.derivatives import check_derivatives
from tests.harness.seeds import generator


def trajectory(x, p):
    """Each iteration writes a row from the one before, through work arrays."""
    n, m = x.shape
    for k in range(n - 1):
        a = np.sin(x[k] * p)
        b = np.exp(-a * a) * a
        x[k + 1] = x[k] + 0.1 * (np.sqrt(1.0 + b[::-1] * b[::-1]) * a)


def two_rows(x, p):
    """Rows are filled in parts and from two rows before, in both branches."""
    n, m = x.shape
    for k in range(1, n - 1):
        a = np.sin(x[k] * p)
        b = np.exp(-a * a) * x[k - 1]
        if b[0] > 0.6:
            x[k + 1, 1:] = a[1:] * b[:-1]
            x[k + 1, 0] = x[k, 0] * a[0]
        else:
            for i in range(m):
                x[k + 1, i] = np.sqrt(1.0 + b[i] * b[m - 1 - i]) * a[i]


def substituted(c, d, p):
    """A substitution back over rows that a loop forward left."""
    n, m = c.shape
    for k in range(n - 1):
        a = np.sin(c[k] * p)
        b = np.exp(-a * a) * d[k]
        c[k + 1] = 0.1 * (np.sqrt(1.0 + b[::-1] * b[::-1]) * a)
        d[k + 1] = d[k] + b * b * a
    for k in range(n - 2, -1, -1):
        d[k] *= c[k] * d[k + 1]


def overwritten_after(x, p):
    """The rows are overwritten after the loop, which must find them as they were."""
    n, m = x.shape
    for k in range(n - 1):
        a = np.sin(x[k] * p)
        b = np.exp(-a * a) * a
        x[k + 1] = x[k] + 0.1 * (np.sqrt(1.0 + b[::-1] * b[::-1]) * a)
    total = 0.0
    for k in range(n):
        total += np.sum(x[k])
        x[k] = (k + 0.3) * p
        p *= np.cos(x[k])
    p *= total


def read_before(x, p):
    """What the loop overwrites was read before it."""
    n, m = x.shape
    for k in range(n):
        p *= 1.0 + 0.1 * x[k] * x[k]
    for k in range(n - 1):
        a = np.sin(x[k] * p)
        b = np.exp(-a * a) * a
        x[k + 1] = x[k] + 0.1 * (np.sqrt(1.0 + b[::-1] * b[::-1]) * a)


def read_ahead(x, p):
    """An iteration reads the row that it overwrites."""
    n, m = x.shape
    for k in range(n - 1):
        a = np.sin(x[k] * p) * x[k + 1]
        b = np.exp(-a * a) * a
        x[k + 1] = x[k] + 0.1 * (np.sqrt(1.0 + b[::-1] * b[::-1]) * a)


def overwritten_by_the_next(x, p):
    """An iteration reads what it stored, and the next one overwrites it."""
    n, m = x.shape
    for k in range(n - 2):
        a = np.sin(x[k] * p)
        b = np.exp(-a * a) * a
        x[k + 2] = a * b
        d = np.cos(x[k + 2] * x[k + 2]) * b
        x[k + 1] = x[k] + 0.1 * (np.sqrt(1.0 + d[::-1] * b[::-1]) * a)


def last_row(x, p):
    """The first iteration reads the last row, which the last one overwrites."""
    n, m = x.shape
    for k in range(n - 1):
        a = np.sin(x[k - 1] * p)
        b = np.exp(-a * a) * x[k]
        x[k + 1] = x[k] + 0.1 * (np.sqrt(1.0 + b[::-1] * b[::-1]) * a)


def added(x, p):
    """An iteration adds to what is there: run again, it would add twice."""
    n, m = x.shape
    for k in range(n - 1):
        a = np.sin(x[k] * p)
        b = np.exp(-a * a) * a
        x[k + 1] += 0.1 * (np.sqrt(1.0 + b[::-1] * b[::-1]) * a)
        p *= 1.0 + 0.1 * (x[k + 1] * x[k + 1])


def in_place(x, p):
    """An iteration overwrites what the same statement reads."""
    n, m = x.shape
    for k in range(n - 1):
        a = np.sin(x[k] * p)
        b = np.exp(-a * a) * a
        x[k + 1] = np.sin(x[k + 1] * b) * np.sqrt(1.0 + b[::-1] * b[::-1]) * a


def result_before(x, p):
    """The adjoint of what is before the loop reads all of its result, of which the loop overwrites a part."""
    n, m = x.shape
    x[1] = np.linalg.solve(np.diag(p * p) + 0.1, p)
    p *= x[1, 0]
    for k in range(n - 1):
        a = np.sin(x[k] * p)
        b = np.exp(-a * a) * a
        for i in range(1, m):
            x[k + 1, i] = 0.1 * (np.sqrt(1.0 + b[i] * b[i - 1]) * a[i])


def read_back(x, p):
    """A number before the loop, made from what a cell held, lies in that cell, and the loop overwrites it."""
    n, m = x.shape
    total = 0.0
    for k in range(n - 1):
        for i in range(m):
            t = np.exp(x[k + 1, i] * (k + 1))
            x[k + 1, i] = t
            total += t * t * t
    for k in range(n - 1):
        a = np.sin(x[k] * p)
        b = np.exp(-a * a) * a
        x[k + 1] = x[k] + 0.1 * (np.sqrt(1.0 + b[::-1] * b[::-1]) * a)
    p *= total


def run_through_twice(x, p):
    """A loop around it goes through the rows again."""
    n, m = x.shape
    for _ in range(2):
        for k in range(n - 1):
            a = np.sin(x[k] * p)
            b = np.exp(-a * a) * a
            x[k + 1] = x[k] + 0.1 * (np.sqrt(1.0 + b[::-1] * b[::-1]) * a)
        x[0] = np.tanh(x[n - 1] * x[0])


def results_overwritten(x, p):
    """Adjoints read results that iterations leave in one row, each over the last one's."""
    n, m = x.shape
    for k in range(n - 2):
        a = np.sin(x[0] * p)
        b = np.exp(-a * a) * p[::-1]
        x[1] = np.exp(a * b * (0.3 + k))
        x[k + 2] = a[::-1] * b


def looked_up(x, p):
    """The subscript is looked up: any row may be overwritten."""
    n, m = x.shape
    row = np.array([1, 2, 1, 3, 2])
    for k in range(n - 1):
        a = np.sin(x[row[k] - 1] * p)
        b = np.exp(-a * a) * a
        x[row[k]] = x[0] + 0.1 * (np.sqrt(1.0 + b[::-1] * b[::-1]) * a)


HAND_ON = {trajectory: ("x", "p"), two_rows: ("x", "p"), substituted: ("c", "d", "p"), overwritten_after: ("x", "p")}
OVERWRITE = (read_before, read_ahead, overwritten_by_the_next, last_row, added, in_place, result_before, read_back,
             run_through_twice, results_overwritten, looked_up)
CHANGE_P = (overwritten_after, read_before, added, result_before, read_back)


def _given(wrt):
    random = generator(5)
    return tuple(0.4 + random.random(5 if n == "p" else (6, 5)) for n in wrt)


@pytest.mark.parametrize("engine", ["numpy", "numba"])
@pytest.mark.parametrize("kernel", [*HAND_ON, *OVERWRITE], ids=lambda kernel: kernel.__name__)
def test_derivatives(kernel, engine):
    wrt = HAND_ON.get(kernel, ("x", "p"))
    of = tuple(n for n in wrt if n != "p" or kernel in CHANGE_P)
    check_derivatives(kernel, _given(wrt), wrt, of, engine)


@pytest.mark.parametrize("kernel", HAND_ON, ids=lambda kernel: kernel.__name__)
def test_work_arrays_are_not_recorded(kernel):
    """Of those that hand on what they store, nothing is recorded but rows that are overwritten after the loop."""
    text = s2sad.differentiate(kernel, engine="numba", memory="least").adjoint_source(*_given(HAND_ON[kernel]))
    recorded = text.partition('"""\n\n')[0].partition("It records")[2]
    assert ("nothing" in recorded) is (kernel in (trajectory, two_rows)), recorded
    assert "    a:" not in recorded and "    b:" not in recorded


def test_what_is_there_is_not_stored_again():
    """Once in the forward sweep and once in a comment."""
    given = _given(("x", "p"))
    assert s2sad.differentiate(trajectory, engine="numpy").adjoint_source(*given).count(" x[k + 1] = x[k]") == 2
    assert s2sad.differentiate(two_rows, engine="numpy").adjoint_source(*given).count(" x[k + 1, 0] = x[k, 0]") == 2
