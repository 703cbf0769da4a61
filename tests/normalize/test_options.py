"""Options of NumPy's functions: taken as NumPy takes them, or refused."""
from __future__ import annotations

import math

import numpy as np
import pytest

import s2sad
from tests.harness.engines import running

REFUSED = {
    "np.zeros_like(x, shape=(2, 3))": "no derivative rule for numpy.zeros_like with shape=",
    "np.array(x, copy=False)": "no derivative rule for numpy.array with copy=",
    "np.array(x, ndmin=2)": "no derivative rule for numpy.array with ndmin=",
    "np.sum(x, keepdims=flag)": "the type of 'y' cannot be inferred",
    "np.sign(x, casting='unsafe')": "no derivative rule for numpy.sign with casting=",
}


@pytest.mark.parametrize("text", REFUSED)
def test_refused(text, tmp_path):
    path = tmp_path / "kernel.py"
    path.write_text(f"import numpy as np\n\n\ndef kernel(x, flag):\n    y = {text}\n    return np.sum(y * y)\n")
    spaces = {}
    exec(compile(path.read_text(), str(path), "exec"), spaces)
    with pytest.raises(s2sad.S2sadError) as caught:
        s2sad.gradient(spaces["kernel"], wrt="x")(np.ones(3), True)
    assert caught.value.diagnostics[0].message == REFUSED[text]


def not_chosen(a, y):
    """What is not chosen has an infinite derivative, or none."""
    b = np.maximum(np.sqrt(a), 0.5) + np.where(a > 0.5, np.sqrt(a), y)
    z = np.log(a, out=y * 2.0, where=a > 0.0)
    total = np.nansum(b * z) + np.nansum(np.log(a) * 0.0 + y)
    for i in range(a.size):
        r = math.sqrt(a[i]) if a[i] > 0.1 else 0.3
        total += (r if a[i] > 0.5 else y[i]) * y[i]
    return total


@pytest.mark.parametrize("engine", ("numpy", "loops"))
def test_a_tangent_of_what_is_not_chosen(engine):
    a, y = np.array([0.0, 0.9, 0.7]), np.array([0.4, 0.8, 0.2])
    with running(engine) as run_under:
        f = s2sad.differentiate(not_chosen, engine=run_under)
        found = s2sad.jvp(f, (a, y), {"a": np.array([1.0, 0.5, -0.5]), "y": np.ones(3)}, of=("return",))["return"]
        gradient = s2sad.vjp(f, (a, y), {"return": 1.0}, wrt=("a", "y"))
    assert np.isfinite(found)
    expected = gradient["a"][1:] @ [0.5, -0.5] + gradient["a"][0] + gradient["y"].sum()
    np.testing.assert_allclose(found, expected, rtol=1e-12)
