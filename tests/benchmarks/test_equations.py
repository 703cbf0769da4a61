"""The equations of the benchmark are those of the literature, and its chapter is drawn from what is stored."""
from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from benchmarks import equations
from benchmarks.kernels.equations import POLLUTION, pollution
from benchmarks.peers.sections import Picture

integrate = pytest.importorskip("scipy.integrate")


def test_pollution():
    """The test set's reference solution at t = 60."""
    def rate(t, u):
        du = np.zeros(20)
        pollution(du, u, POLLUTION[1])
        return du
    found = integrate.solve_ivp(rate, (0.0, 60.0), POLLUTION[0], method="BDF", rtol=1e-7, atol=1e-10).y[:, -1]
    np.testing.assert_allclose(found[[0, 1, 3]], [0.05646255480022769, 0.1342484130422339, 0.005523140207484359],
                               rtol=1e-5)


def test_a_failure_is_said():
    stored = Path(__file__).resolve().parents[2] / "docs" / "performance" / "equations.json"
    found = json.loads(stored.read_text())
    found["equations"]["pk-pd"]["forward"] = [{"by": 1e-3, "failed": "too stiff."}]
    _, table, *pictures = equations.render(found).body
    assert "pk-pd, sensitivities, 0.001: too stiff." in table.notes[0]
    assert table.rows[-1][3] == "none"
    assert [p.name for p in pictures if isinstance(p, Picture)] == [f"equations-{n}" for n in found["equations"]]
