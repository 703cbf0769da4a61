"""The tool for GradBench: its protocol line by line, and every eval against formulas that know nothing of derivatives
written by s2sad, within the tolerance of GradBench's own checks (1e-4) and closer."""
from __future__ import annotations

import io
import json
import math
import subprocess
import sys
from collections.abc import Callable
from itertools import permutations
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from benchmarks.gradbench import function, inputs, protocol

RUNS = {"min_runs": 1, "min_seconds": 0}
EVALS = ("ba", "det", "gmm", "hello", "ht", "kmeans", "llsq", "lse", "lstm", "ode", "particle", "saddle")


@pytest.fixture(autouse=True, scope="module")
def by_numpy():
    """What is checked here does not depend on the engine; nothing is compiled."""
    function.ENGINE = "numpy"


def asked(module: str, name: str, given: Any) -> Any:
    """The output for an input that went through JSON, as an eval's does."""
    message = {"id": 7, "kind": "evaluate", "module": module, "function": name,
               "input": given | RUNS if isinstance(given, dict) else given}
    answer = json.loads(json.dumps(protocol.Tool().answer(json.dumps(message)), allow_nan=False))
    assert answer["success"], answer["error"]
    assert answer["id"] == 7
    assert [t["name"] for t in answer["timings"]] == ["prepare", "evaluate"]
    assert all(isinstance(t["nanoseconds"], int) and t["nanoseconds"] >= 0 for t in answer["timings"])
    return answer["output"]


def differences(f: Callable[[np.ndarray], Any], x: np.ndarray, step: float = 1e-3) -> np.ndarray:
    """Derivatives of f for each element of x, by central differences extrapolated to order 4."""
    def slope(k: int, h: float) -> np.ndarray:
        moved = h * np.eye(x.size)[k].reshape(x.shape)
        return (np.asarray(f(x + moved)) - np.asarray(f(x - moved))) / (2.0 * h)
    return np.array([(4.0 * slope(k, 0.5 * step) - slope(k, step)) / 3.0 for k in range(x.size)])


# -- the protocol ---------------------------------------------------------------------------------------------------
def served(*lines: str) -> list[Any]:
    answers = io.StringIO()
    protocol.serve(io.StringIO("".join(f"{line}\n" for line in lines)), answers)
    return [json.loads(line) for line in answers.getvalue().splitlines()]


def untimed(answer: Any) -> Any:
    """The answer with the names of its timings alone."""
    return answer | {"timings": [t["name"] for t in answer["timings"]]} if "timings" in answer else answer


def test_session():
    answers = served(
        '{"id": 0, "kind": "start", "eval": "hello"}',
        '{"id": 1, "kind": "define", "module": "hello"}',
        '{"id": 2, "kind": "evaluate", "module": "hello", "function": "square", "input": 3.0, "description": "3"}',
        '{"id": 3, "kind": "analysis", "of": 2, "valid": true}',
        "",
        '{"id": 4, "kind": "evaluate", "module": "hello", "function": "double", "input": 9}',
        '{"id": 5, "kind": "end"}')
    assert [untimed(a) for a in answers] == [
        {"id": 0, "tool": "s2sad", "config": {"version": "0.1.0"}},
        {"id": 1, "success": True, "timings": ["define"]},
        {"id": 2, "success": True, "output": 9.0, "timings": ["prepare", "evaluate"]},
        {"id": 3},
        {"id": 4, "success": True, "output": 18.0, "timings": ["prepare", "evaluate"]},
        {"id": 5}]


@pytest.mark.parametrize(("line", "answer"), [
    ("square", {"id": None, "success": False, "error": "not JSON: Expecting value: line 1 column 1 (char 0)"}),
    ("[1]", {"id": None, "success": False, "error": "a message is an object with an id and a kind"}),
    ('{"id": 1}', {"id": 1}),
    ('{"id": 1, "kind": ["define"]}', {"id": 1}),
    ('{"kind": "start"}', {"id": None, "tool": "s2sad", "config": {"version": "0.1.0"}}),
    ('{"id": 1, "kind": "define", "module": "fft"}',
     {"id": 1, "success": False, "error": f"no module 'fft'; there are {', '.join(EVALS)}"}),
    ('{"id": 1, "kind": "define"}',
     {"id": 1, "success": False, "error": f"no module None; there are {', '.join(EVALS)}"}),
    ('{"id": 1, "kind": "evaluate", "module": "hello", "function": "cube", "input": 1}',
     {"id": 1, "success": False, "error": "no function 'cube' in hello; there are square, double"}),
    ('{"id": 1, "kind": "evaluate", "module": "hello", "function": ["square"], "input": 1}',
     {"id": 1, "success": False, "error": "no function ['square'] in hello; there are square, double"}),
    ('{"id": 1, "kind": "evaluate", "module": "lse", "function": "primal", "input": {"n": 3}}',
     {"id": 1, "success": False, "error": "KeyError: 'x'"}),
    ('{"id": 1, "kind": "evaluate", "module": "hello", "function": "square", "input": 1e200}',
     {"id": 1, "success": False, "error": "the result is not finite, which JSON has no number for"}),
    ('{"id": 1, "kind": "evaluate", "module": "lse", "function": "primal", "input": {"x": [1], "min_runs": "2"}}',
     {"id": 1, "success": False, "error": "min_runs and min_seconds are numbers, not '2' and 0.0"})])
def test_refused(line, answer):
    after = '{"id": 2, "kind": "analysis", "of": 1, "valid": false}'
    assert served(line, after) == [answer, {"id": 2}]


@pytest.mark.parametrize(("options", "least"), [
    ({"min_runs": 3, "min_seconds": 0}, 3), ({"runs": 4}, 4), ({}, 1), ({"min_runs": 1, "min_seconds": 0.02}, 2)])
def test_runs(options, least):
    message = {"id": 1, "kind": "evaluate", "module": "lse", "function": "primal", "input": {"x": [0.0], **options}}
    tool = protocol.Tool()
    first, second = (tool.answer(json.dumps(message)) for _ in range(2))
    assert [t["name"] for t in first["timings"]][:2] == ["prepare", "evaluate"]
    assert {t["name"] for t in second["timings"]} == {"evaluate"}
    taken = [t["nanoseconds"] for t in second["timings"]]
    assert len(taken) == least if "min_seconds" not in options or not options["min_seconds"] else len(taken) >= least
    assert sum(taken) >= options.get("min_seconds", 0) * 1e9


def test_command_keeps_stdout_for_the_protocol():
    """As GradBench runs it: one line in, one line out, ended by the end of the input."""
    lines = ['{"id": 0, "kind": "start"}', "no message",
             '{"id": 1, "kind": "evaluate", "module": "hello", "function": "double", "input": 2.5}']
    done = subprocess.run([sys.executable, "-m", "benchmarks.gradbench", "--engine", "numpy"], input="\n".join(lines),
                          text=True, capture_output=True, check=True, cwd=Path(__file__).parent.parent)
    answers = [json.loads(line) for line in done.stdout.splitlines()]
    assert [a["id"] for a in answers] == [0, None, 1]
    assert answers[2]["output"] == 5.0


# -- the evals ------------------------------------------------------------------------------------------------------
def test_every_eval_is_there():
    assert protocol.MODULES == EVALS


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


def reprojected(values, given):
    """The two residuals of an observation whose camera, point and weight are in a row."""
    r, centre, (f, u, v, k1, k2), point, w = np.split(values, [3, 6, 11, 14])
    angle, x = np.linalg.norm(r), point - centre
    if angle:
        cross = np.array([[0.0, -r[2], r[1]], [r[2], 0.0, -r[0]], [-r[1], r[0], 0.0]]) / angle
        x = x + np.sin(angle) * cross @ x + (1.0 - np.cos(angle)) * cross @ cross @ x
    else:
        x = x + np.cross(r, x)
    seen = x[:2] / x[2]
    square = seen @ seen
    return w * (f * seen * (1.0 + k1 * square + k2 * square ** 2) + [u, v] - given["feat"])


@pytest.mark.parametrize("turned", [True, False])
def test_ba(turned):
    given = inputs.ba(2, 3, 5)
    given["cam"] = [0.3, -0.2, 0.1] if turned else [0.0, 0.0, 0.0]
    given["cam"] += [0.1, 0.2, -2.0, 1.5, 0.1, -0.1, 0.05, 0.01]
    given["x"] = [0.3, -0.4, 1.0]
    values = np.array([*given["cam"], *given["x"], given["w"]])
    found = asked("ba", "objective", given)
    assert found["reproj_error"] == {"elements": pytest.approx(reprojected(values, given)), "repeated": 5}
    assert found["w_err"] == {"element": pytest.approx(1.0 - given["w"] ** 2), "repeated": 5}
    rows = differences(lambda v: reprojected(v, given), values).T
    if not turned:
        rows[:, :3] = 0.0       # a derivative along a jump from one formula to the other: checked below
    found = asked("ba", "jacobian", given)
    assert [*found] == ["rows", "cols", "vals"]
    assert found["vals"][30] == -2.0 * given["w"]
    result = np.array(found["vals"][:30]).reshape(2, 15)
    expected = rows if turned else np.hstack([turning(values, given), rows[:, 3:]])
    assert result == pytest.approx(expected, rel=1e-6, abs=1e-8)
    columns = [*range(11), 22, 23, 24, 31]
    assert found["cols"] == columns + columns + [22 + 9 + 4]
    assert found["rows"] == [*range(0, 151, 15), 151, 152, 153, 154, 155, 155]


def turning(values, given):
    """The derivatives at no rotation along the three axes: r x X moves the point by no more than the first order."""
    def moved(point):
        return reprojected(np.concatenate([np.zeros(3), values[3:11], point, values[14:]]), given)
    slope = differences(moved, values[11:14]).T
    x = values[11:14] - values[3:6]
    return np.stack([slope @ np.cross(axis, x) for axis in np.eye(3)], axis=1)


def skinned(theta, us, data):
    """The residuals by homogeneous matrices; rotations are exponentials, by their series."""
    model = data["model"]

    def rotation(w):
        cross = np.array([[0.0, -w[2], w[1]], [w[2], 0.0, -w[0]], [-w[1], w[0], 0.0]])
        total, term = np.eye(3), np.eye(3)
        for k in range(1, 30):
            term = term @ cross / k
            total = total + term
        return total
    absolute: list[np.ndarray] = []
    posed = np.zeros((len(model["base_positions"]), 3))
    for k, parent in enumerate(model["parents"]):
        turn = np.eye(4)
        if 1 <= k <= 20 and k % 4 != 1:
            finger, joint = divmod(k - 1, 4)
            angles = theta[6 + 4 * finger:10 + 4 * finger]
            x, z = (angles[0], angles[1]) if joint == 1 else (angles[joint], 0.0)
            turn[:3, :3] = rotation(np.array([0.0, 0.0, z])) @ rotation(np.array([x, 0.0, 0.0]))
        relative = np.array(model["base_relatives"][k]) @ turn
        absolute.append(relative if parent == -1 else absolute[parent] @ relative)
        moved = np.array(model["base_positions"]) @ (absolute[k] @ model["inverse_base_absolutes"][k]).T
        posed += np.array(model["weights"])[:, [k]] * moved[:, :3]
    if model["is_mirrored"]:
        posed = posed * [-1.0, 1.0, 1.0]
    posed = posed @ rotation(theta[:3]).T + theta[3:6]
    places = data["correspondences"]
    found = posed[places] if len(us) == 0 else np.array(
        [np.array([u, v, 1.0 - u - v]) @ posed[model["triangles"][c]] for (u, v), c in zip(us, places)])
    return (np.array(data["points"]) - found).ravel()


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize("in_triangles", [False, True])
def test_ht(in_triangles, mirrored):
    given = inputs.ht(5, 4, in_triangles)
    given["data"]["model"]["is_mirrored"] = mirrored
    theta, us, data = np.array(given["theta"]), np.array(given["us"]), given["data"]
    assert asked("ht", "objective", given) == pytest.approx(skinned(theta, us, data), rel=1e-12, abs=1e-12)
    expected = differences(lambda v: skinned(v, us, data), theta).T
    if in_triangles:
        own = differences(lambda v: skinned(theta, v, data), us)
        pairs = [[own[2 * (row // 3) + k, row] for k in range(2)] for row in range(12)]
        expected = np.hstack([pairs, expected])
    found = np.array(asked("ht", "jacobian", given))
    assert found.shape == (12, 28 if in_triangles else 26)
    assert found == pytest.approx(expected, rel=1e-6, abs=1e-7)


@pytest.mark.parametrize("mode", ["rr", "rf", "fr", "ff"])
def test_nested(mode):
    """What GradBench's checks expect: the steps of the descent are prescribed, so that the last digits are, too."""
    assert asked("saddle", mode, {"start": [1.0, 1.0]}) == pytest.approx([8.246324826140356e-06] * 4, rel=1e-9)


@pytest.mark.parametrize(("mode", "start"), [("rr", 0.0), ("rf", 0.19), ("fr", 0.19), ("ff", 0.19)])
def test_particle(mode, start):
    """GradBench's check starts at 0; the others are a part of its way."""
    found = asked("particle", mode, {"w": start})
    assert found == pytest.approx(0.2071918746486116, abs=1e-10 if start == 0.0 else 1e-3)
