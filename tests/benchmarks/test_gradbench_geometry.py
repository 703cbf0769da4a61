"""GradBench's evals in space, bundle adjustment and hand tracking, against formulas that share nothing with them."""
from __future__ import annotations

import numpy as np
import pytest

from benchmarks.gradbench import inputs
from tests.benchmarks.gradbench import asked, differences


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
