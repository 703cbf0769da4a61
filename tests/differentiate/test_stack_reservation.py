"""Stacks that grow get room for the entries of their innermost loops at once, and hold the same values."""
from __future__ import annotations

import re

import numpy as np
import pytest

import s2sad
from tests.harness.derivatives import check_derivatives


def triangle(x, steps):
    for i in range(steps):
        for j in range(i + 1, x.shape[0]):
            x[j] = np.sin(x[j]) * x[i]


def rows(x, steps):
    k = 0
    while k < steps:
        for i in range(k, x.shape[0]):
            for j in range(x.shape[1] - 1, -1, -1):
                x[i, j] = np.cos(x[i, j] * x[i, j - 1]) + np.sin(x[k, j])
        k += 1


def sizes_that_change(x, steps):
    m = 0
    for k in range(steps):
        m += k % 3
        for i in range(k):
            for j in range(min(m, x.shape[0])):
                x[j] = x[j] * np.cos(x[i])
                m = m - 1 if j == 2 else m
    return np.sum(x)


def taken_at_times(x, steps):
    k = 0
    while k < steps:
        for i in range(k, x.shape[0]):
            if x[i] > 0.5:
                x[i] = x[i] * x[i - 1]
        for i in range(x.shape[0]):
            if i > k + 2:
                break
            x[i] = np.exp(-x[i])
        k += 1


def sizes_in_an_array(x, steps):
    ends = np.array([0, 2, 1, 4])
    for k in range(steps):
        for i in range(ends[k % 4]):
            x[i] = np.sin(x[i]) * x[i + 1]
        ends[k % 4] = (ends[k % 4] + k) % 5


KERNELS = (triangle, rows, sizes_that_change, taken_at_times, sizes_in_an_array)


@pytest.mark.parametrize("engine", ("numpy", "loops"))
@pytest.mark.parametrize("steps", (0, 1, 5))
@pytest.mark.parametrize("kernel", KERNELS, ids=lambda k: k.__name__)
def test_derivatives(kernel, steps, engine):
    shape = (5, 3) if kernel is rows else (6,)
    of = ("return",) if kernel is sizes_that_change else ("x",)
    given = 0.2 + 0.7 * np.random.default_rng(steps).random(shape)
    check_derivatives(kernel, (given, steps), ("x",), of, engine)


@pytest.mark.parametrize("kernel", (triangle, rows), ids=lambda k: k.__name__)
def test_nothing_is_asked_for_each_entry(kernel):
    """Innermost loops only write: what grows does so in front of them."""
    text = s2sad.differentiate(kernel, wrt="x", of="x", engine="numba").adjoint_source(
        np.ones((5, 3) if kernel is rows else 6), 3)
    words = " ".join(text.split())
    assert words.count("x_stack = grow(") == len(re.findall(r"x_stack = grow\([^=:]*\) for ", words)) == 1, text
