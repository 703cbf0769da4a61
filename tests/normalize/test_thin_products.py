"""Products of a column and a row, and of a row and a matrix, are loops in text for Numba."""
from __future__ import annotations

import numpy as np
import pytest

from s2sad import differentiate
from tests.harness.derivatives import check_derivatives
from tests.harness.seeds import generator

RNG = generator(7)
U, W, B, V = RNG.random(4), RNG.random((3, 1)), RNG.random(3), RNG.random((1, 3))


def network(u, w, b, v, steps):
    for _ in range(steps):
        hidden = np.tanh(w @ u.reshape(1, u.size) + b[:, None])
        u += 0.1 * np.exp(v @ hidden)[0]
    return np.sum(u ** 2)


def into_parts(w, v, a, y):
    y[1:, :3] = w @ v
    y[:1] = v @ a
    y[:1, ::2] *= np.dot(v, a)[:, ::2]
    row = v.copy()
    for _ in range(2):
        row = row @ a
        row[...] = row @ a.T
    y[0, :3] += row[0] * (v @ (a @ v.T))[0, 0]


def of_sizes(w, v, y):
    """Lengths of 1 that only a run tells."""
    y[...] = w @ v


@pytest.mark.parametrize("engine", ["numpy", "loops", "numba"])
@pytest.mark.parametrize("kernel, arguments, wrt, of", [
    (network, (U, W, B, V, 3), ("u", "w", "b", "v"), ("return",)),
    (network, (np.zeros(0), W, B, V, 2), ("u", "w", "b", "v"), ("return",)),
    (into_parts, (W, V, RNG.random((3, 3)), np.zeros((4, 3))), ("w", "v", "a"), ("y",)),
    (of_sizes, (W, V, np.zeros((3, 3))), ("w", "v"), ("y",))])
def test_derivatives(kernel, arguments, wrt, of, engine):
    check_derivatives(kernel, arguments, wrt, of, engine)


def test_no_call_is_left():
    """What such a product gives is neither recorded nor copied."""
    text = differentiate(network, engine="numba").adjoint_source(U, W, B, V, 3)
    code = [line for line in text.split('"""')[2].splitlines() if not line.lstrip().startswith("#")]
    assert not any("@" in line or "matmul_value_stack" in line for line in code)
