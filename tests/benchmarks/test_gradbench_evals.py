"""GradBench's evals, asked of its tool, against formulas that know nothing of derivatives written by s2sad: within the
tolerance of GradBench's own checks (1e-4) and closer."""
from __future__ import annotations

import math
from itertools import permutations

import numpy as np
import pytest

from benchmarks.gradbench import inputs
from tests.benchmarks.gradbench import asked, differences


@pytest.mark.parametrize("ell", [1, 2, 3, 4, 5])
def test_det(ell):
    given = inputs.det(ell)
    a = np.array(given["A"]).reshape(ell, ell)
    expanded = sum(np.linalg.det(np.eye(ell)[list(p)]) * math.prod(a[i, p[i]] for i in range(ell))
                   for p in permutations(range(ell)))
    assert asked("det", "primal", given) == pytest.approx(expanded, rel=1e-12)
    found = asked("det", "gradient", given)
    assert np.reshape(found, (ell, ell)) == pytest.approx(np.linalg.det(a) * np.linalg.inv(a).T, rel=1e-10)


def test_llsq():
    given = inputs.llsq(9, 5)
    t = np.linspace(-1.0, 1.0, 9)
    matrix = np.vander(t, 5, increasing=True)
    residual = np.sign(t) - matrix @ given["x"]
    assert asked("llsq", "primal", given) == pytest.approx(0.5 * residual @ residual, rel=1e-13)
    assert asked("llsq", "gradient", given) == pytest.approx(-matrix.T @ residual, rel=1e-12)


def test_lse():
    x = np.array([-100.0, 3.0, 700.0, 699.5])
    powers = np.exp(x - 700.0)
    assert asked("lse", "primal", {"x": x.tolist()}) == pytest.approx(700.0 + np.log(powers.sum()), rel=1e-15)
    assert asked("lse", "gradient", {"x": x.tolist()}) == pytest.approx(powers / powers.sum(), rel=1e-12)


def test_ode():
    """For four equations the method is exact: y_i(2) = x_0 ... x_i 2^(i+1) / (i+1)!."""
    given = inputs.ode(4, 3)
    x = np.array(given["x"])
    exact = np.cumprod(x) * 2.0 ** np.arange(1, 5) / [1.0, 2.0, 6.0, 24.0]
    assert asked("ode", "primal", given) == pytest.approx(exact, rel=1e-13)
    assert asked("ode", "gradient", given) == pytest.approx(exact[-1] / x, rel=1e-13)


def test_kmeans():
    given = inputs.kmeans(3, 20, 2)
    points, centroids = np.array(given["points"]), np.array(given["centroids"])
    distances = np.sum((points[:, None] - centroids) ** 2, axis=2)
    nearest = distances.argmin(axis=1)
    assert asked("kmeans", "cost", given) == pytest.approx(distances.min(axis=1).sum(), rel=1e-13)
    towards = [centroids[j] - points[nearest == j].mean(axis=0) for j in range(3)]
    assert np.array(asked("kmeans", "dir", given)) == pytest.approx(np.array(towards), rel=1e-12)


def log_posterior(given, alpha, mu, q, below, sign=1.0):
    """By densities, determinants and traces, as far from the kernel's formula as possible."""
    d, freedom, total = given["d"], given["d"] + given["m"] + 1, 0.0
    factors = []
    for k in range(given["k"]):
        factor = np.diag(np.exp(q[k]))
        factor.T[np.triu_indices(d, 1)] = below[k]
        factors.append(factor)
    precisions = [f.T @ f for f in factors]
    for x in np.array(given["x"]):
        density = sum(np.exp(a - 0.5 * (x - m) @ p @ (x - m)) * np.sqrt(np.linalg.det(p) / (2.0 * np.pi) ** d)
                      for a, m, p in zip(alpha, mu, precisions))
        total += np.log(density / np.exp(alpha).sum())
    log_gamma = d * (d - 1) / 4 * np.log(np.pi) + sum(math.lgamma((freedom - j) / 2) for j in range(d))
    for p in precisions:
        prior = 0.5 * given["m"] * np.log(np.linalg.det(p)) - 0.5 * given["gamma"] ** 2 * np.trace(p)
        total += sign * (prior + freedom * d * np.log(given["gamma"] / np.sqrt(2.0)) - log_gamma)
    return total


@pytest.mark.parametrize("jagged", [False, True])
def test_gmm(jagged):
    given = inputs.gmm(3, 2, n=4, m=2, gamma=0.7)
    parts = {name: np.array(given[name]) for name in ("alpha", "mu", "q", "l")}
    expected = {name: differences(lambda v, name=name: log_posterior(given, *(parts | {name: v}).values()), value)
                for name, value in parts.items()}
    if jagged:
        given = given | {"l": [[[], [a], [b, c]] for a, b, c in given["l"]]}
    assert asked("gmm", "objective", given) == pytest.approx(log_posterior(given, *parts.values()), rel=1e-12)
    found = asked("gmm", "jacobian", given)
    assert [*found] == ["alpha", "mu", "q", "l"]
    if jagged:
        assert [[len(row) for row in rows] for rows in found["l"]] == [[0, 1, 2]] * 2
        found["l"] = [[a, b, c] for _, (a,), (b, c) in found["l"]]
    for name, value in found.items():
        assert np.shape(value) == parts[name].shape
        assert np.ravel(value) == pytest.approx(expected[name], rel=1e-7, abs=1e-8)


def test_gmm_of_earlier_versions():
    new = inputs.gmm(2, 3, n=5)
    icf = np.hstack([new["q"], new["l"]])
    given = {name: new[name] for name in ("d", "k", "n", "x", "m", "gamma", "alpha")} | {
        "means": new["mu"], "icf": icf.tolist()}
    parts = [np.array(given[name]) for name in ("alpha", "means", "icf")]

    def value(flat):
        alpha, means, icf = np.split(flat, [3, 9])
        icf = icf.reshape(3, 3)
        return log_posterior(given, alpha, means.reshape(3, 2), icf[:, :2], icf[:, 2:], sign=-1.0)
    flat = np.concatenate([part.ravel() for part in parts])
    assert asked("gmm", "objective", given) == pytest.approx(value(flat), rel=1e-12)
    assert asked("gmm", "jacobian", given) == pytest.approx(differences(value, flat), rel=1e-7, abs=1e-8)


def lstm_loss(main, extra, state, sequence):
    """Row by row, with whole arrays."""
    layers, total = [s.copy() for s in state], 0.0
    for row, following in zip(sequence, sequence[1:]):
        x = row * extra[0]
        for k in range(0, len(layers), 2):
            hidden, cell = layers[k], layers[k + 1]
            (wf, wi, wo, wc), (bf, bi, bo, bc) = np.split(main[k], 4), np.split(main[k + 1], 4)
            forget, ingate, outgate = (1.0 / (1.0 + np.exp(-z)) for z in (x * wf + bf, hidden * wi + bi, x * wo + bo))
            layers[k + 1] = cell * forget + ingate * np.tanh(hidden * wc + bc)
            x = layers[k] = outgate * np.tanh(layers[k + 1])
        y = x * extra[1] + extra[2]
        total += following @ (y - np.log(2.0 + np.exp(y).sum()))
    return -total / sequence[1:].size


def test_lstm():
    given = inputs.lstm(2, 4, b=2)
    main, extra, state, sequence = (np.array(v) for v in given.values())
    assert asked("lstm", "objective", given) == pytest.approx(lstm_loss(main, extra, state, sequence), rel=1e-13)
    expected = np.concatenate([differences(lambda v: lstm_loss(v, extra, state, sequence), main),
                               differences(lambda v: lstm_loss(main, v, state, sequence), extra)])
    assert asked("lstm", "jacobian", given) == pytest.approx(expected, rel=1e-7, abs=1e-9)


@pytest.mark.parametrize("mode", ["rr", "rf", "fr", "ff"])
def test_nested(mode):
    """What GradBench's checks expect: the steps of the descent are prescribed, so that the last digits are, too."""
    assert asked("saddle", mode, {"start": [1.0, 1.0]}) == pytest.approx([8.246324826140356e-06] * 4, rel=1e-9)


@pytest.mark.parametrize(("mode", "start"), [("rr", 0.0), ("rf", 0.19), ("fr", 0.19), ("ff", 0.19)])
def test_particle(mode, start):
    """GradBench's check starts at 0; the others are a part of its way."""
    found = asked("particle", mode, {"w": start})
    assert found == pytest.approx(0.2071918746486116, abs=1e-10 if start == 0.0 else 1e-3)
