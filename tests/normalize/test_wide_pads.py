"""Pads wider than what they surround, and correlations with a signal that is longer."""
from __future__ import annotations

import numpy as np
import pytest

import s2sad
from tests.harness.derivatives import check_derivatives
from tests.harness.engines import running

U, V = np.array([0.3, 0.7, 1.1]), np.array([1.2, -0.4, 0.5, 0.9])


def padded_reflect(u, v):
    return np.pad(u, (7, 5), mode="reflect") * 1.5


def padded_symmetric(u, v):
    return np.pad(u, (8, 4), mode="symmetric") * 1.5


def padded_wrap(u, v):
    return np.pad(u, (8, 7), mode="wrap") * 1.5


def padded_plane(u, v):
    return np.pad(np.outer(u, v), ((4, 1), (0, 9)), mode="reflect") ** 2


def shorter_first(u, v):
    return np.correlate(u, v)


def shorter_first_same(u, v):
    return np.correlate(u, v, mode="same")


def longer_first_same(u, v):
    return np.correlate(v, u, mode="same")


def even_first_same(u, v):
    return np.correlate(v, np.concatenate((u, v)), mode="same")


@pytest.mark.parametrize("engine", ["numpy", "loops"])
@pytest.mark.parametrize("kernel", [
    padded_reflect, padded_symmetric, padded_wrap, padded_plane, shorter_first, shorter_first_same, longer_first_same,
    even_first_same])
def test_wide_pads_and_short_signals(kernel, engine):
    check_derivatives(kernel, (U, V), ("u", "v") if kernel not in (
        padded_reflect, padded_symmetric, padded_wrap) else ("u",), ("return",), engine)
    for n in (1, 2):    # NumPy fills what reflects one element with it
        with running(engine) as name:
            assert np.allclose(s2sad.differentiate(kernel, engine=name).primal(U[:n], V), kernel(U[:n], V))
            x, dot = U[:n].copy(), np.ones(n)
            assert np.allclose(s2sad.jvp(s2sad.differentiate(kernel, engine=name), (x, V), {"u": dot})["return"],
                               (kernel(x + 1e-6 * dot, V) - kernel(x - 1e-6 * dot, V)) / 2e-6, atol=1e-6)
