"""Sums of products by subscripts, where an axis of length 1 repeats."""
from __future__ import annotations

import numpy as np
import pytest

import s2sad
from tests.harness.derivatives import check_derivatives
from tests.harness.engines import running


def rows(a, x):
    return np.einsum("ij,j->i", a, x)


def columns(a, x):
    return np.einsum("ij,i->j", a, x)


def plain(a, x):
    return np.einsum("i,ij", x, a)


def matrices(a, b):
    return np.einsum("ij,jk->ik", a, b)


def turned_matrices(a, b):
    return np.einsum("ji,kj->ik", a, b)


def scalars(a, x):
    return np.einsum("i,i", a[0], x)


@pytest.mark.parametrize("engine", ["numpy", "loops"])
@pytest.mark.parametrize("kernel, shapes", [
    (rows, ((3, 4), (1,))), (rows, ((3, 1), (4,))), (rows, ((3, 1), (1,))), (rows, ((3, 4), (4,))),
    (columns, ((3, 4), (1,))), (columns, ((1, 4), (3,))), (plain, ((1, 4), (3,))), (plain, ((3, 4), (1,))),
    (matrices, ((2, 1), (3, 4))), (matrices, ((2, 3), (1, 4))), (matrices, ((1, 3), (1, 1))),
    (turned_matrices, ((1, 2), (4, 3))), (turned_matrices, ((3, 2), (4, 1))), (scalars, ((2, 4), (1,)))])
def test_einsum_repeats_an_axis_of_length_1(kernel, shapes, engine):
    generator = np.random.default_rng(5)
    a, b = (generator.uniform(-1.0, 1.0, s) for s in shapes)
    check_derivatives(kernel, (a, b), kernel.__code__.co_varnames[:2], ("return",), engine)


def stacks(x, n):
    return np.sum(np.ones((n, 3, 4)) @ np.swapaxes(x, 1, 2))


def two_sums(x, n):
    return np.sum(np.tensordot(np.ones((n, 3, 4)), x, axes=([0, 1], [0, 2])))


@pytest.mark.parametrize("engine", ["numpy", "loops"])
@pytest.mark.parametrize(("kernel", "n"), [(stacks, 1), (stacks, 3), (two_sums, 4)])
def test_products_of_stacks_of_other_sizes_are_refused(kernel, n, engine):
    """NumPy repeats a stack of one matrix; axes whose sizes have the same product are not the same."""
    x = np.ones((2, 3, 4)) if kernel is stacks else np.ones((3, 5, 4))
    with running(engine) as run_under, pytest.raises(s2sad.S2sadError, match="shapes differ"):
        s2sad.gradient(s2sad.differentiate(kernel, engine=run_under), wrt="x")(x, n)
