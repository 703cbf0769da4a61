"""What the evaluator knows of shapes is what NumPy gives: where a rank decides a branch the other one is gone."""
from __future__ import annotations

import numpy as np
import pytest

import s2sad
from s2sad.evaluate.specialize.sequences.known_shapes import of_call
from s2sad.evaluate.specialize.values import Data, TupleValue, constant
from s2sad.read.outside_values import library_value
from s2sad.tree import name
from tests.harness.derivatives import check_derivatives

V, W, M, N = np.array([0.3, 0.9, 0.5]), np.array([1.2, 0.4, 0.7]), np.eye(3) + 0.1, np.full((3, 3), 0.2)
S, T = np.ones((2, 3)), np.ones((2, 3, 3))
AXES = ({}, {"axis": 0}, {"axis": -1}, {"axis": None})
CALLS = [
    *(("numpy.outer", (a, b), {}) for a, b in ((V, W), (M, V), (S, T))),
    *((f"numpy.{room}", (a, b), {}) for room in ("matmul", "dot") for a, b in ((V, W), (M, V), (V, M), (S, M), (T, M))),
    *((f"numpy.{room}", ([a, b],), k) for room in ("stack", "concatenate") for a, b in ((V, W), (M, N)) for k in AXES
      if room == "concatenate" or k != {"axis": None}),
    *((f"numpy.{room}", ([a, b],), {}) for room in ("vstack", "hstack", "column_stack")
      for a, b in ((V, W), (M, N), (1.0, 2.0), (T, T)) if room != "column_stack" or a is not T),
    *(("numpy.diag", (a,), k) for a in (V, M) for k in ({}, {"k": 1})), ("numpy.diag", (V, -1), {}),
    ("numpy.eye", (3,), {}), ("numpy.identity", (3,), {}), ("numpy.vander", (V, 4), {}),
    *(("numpy.kron", (a, b), {}) for a, b in ((V, W), (M, V), (T, S))), *(("numpy.linalg.inv", (a,), {}) for a in (M,)),
    *(("numpy.transpose", (a,), {}) for a in (V, S, T)), ("numpy.transpose", (T, (1, 0, 2)), {}),
    *((f"numpy.{room}", (a,), k) for room in ("cumsum", "cumprod", "sort") for a in (V, S, T) for k in AXES),
    *(("numpy.sort", (S, k), {}) for k in (None, 0)),
    *(("numpy.flip", (a,), k) for a in (V, S, T) for k in AXES),
    *(("numpy.roll", (a, 1), k) for a in (V, S) for k in AXES),
    *(("numpy.diff", (a,), k) for a in (V, S) for k in AXES[:3]), *(("numpy.pad", (a, 1), {}) for a in (V, S)),
    *(("numpy.repeat", (a, 2), k) for a in (V, S) for k in AXES),
    *(("numpy.tile", (a, k), {}) for a in (V, S, 1.0) for k in (2, (2, 1, 1), (3,))),
    *((f"numpy.{room}.outer", (a, b), {}) for room in ("add", "subtract", "multiply", "divide")
      for a, b in ((V, W), (M, V), (1.0, V)))]


def value(given):
    """What the evaluator would be given."""
    if isinstance(given, np.ndarray):
        return Data(name("x"), shape=(given.shape[0], *(None for _ in given.shape[1:])))
    return TupleValue(tuple(map(value, given))) if isinstance(given, (list, tuple)) else constant(given)


@pytest.mark.parametrize("call", CALLS, ids=lambda call: f"{call[0]}-{[np.shape(a) for a in call[1]]}-{call[2]}")
def test_what_is_known_is_so(call):
    path, arguments, options = call
    found = of_call(path, list(map(value, arguments)), {k: constant(v) for k, v in options.items()})
    shape = np.shape(library_value(path)(*arguments, **options))
    assert found is None or len(found) == len(shape) and all(a in (None, b) for a, b in zip(found, shape))


def test_something_is_known_of_each_function():
    known = {path for path, arguments, options in CALLS if of_call(
        path, list(map(value, arguments)), {k: constant(v) for k, v in options.items()}) is not None}
    assert known == {path for path, _, _ in CALLS} - {"numpy.vander"}


def test_lengths_of_one_are_not_seen():
    assert of_call("numpy.squeeze", [value(np.ones((3, 1)))], {}) is None
    assert of_call("numpy.squeeze", [value(np.ones((3, 1)))], {"axis": constant(1)}) == (None,)


def norm(v):
    if v.ndim == 1:
        return v @ v
    return (v * v).sum(axis=1) @ v[:, 0]


def norms(x, y):
    rows = norm(np.outer(x, y)) + norm(np.stack([x, y])) + norm(np.column_stack([x, y, x * y])) + norm(np.diag(x).T)
    rows += norm(np.concatenate([x, y])) + norm(np.outer(x, y) @ y) + norm(np.cumsum(np.outer(x, y), axis=0))
    rows += norm(np.outer(x, y)[[0, 2, 0]]) + norm(np.tile(x, 2)[np.array([1, 4])]) + norm(np.outer(x, y)[x > 0.4])
    return rows + norm(np.repeat(x, 2)) + norm(np.add.outer(x, y)) + norm(np.eye(3) * x)


def test_a_rank_decides_a_branch():
    check_derivatives(norms, (V, W), ("x", "y"), ("return",))
    assert s2sad.gradient(s2sad.differentiate(norms, engine="numpy"), wrt="x")(V, W).shape == V.shape
