"""Derivatives that a module binds: in a file that is read without being run they are what Python would bind."""
from __future__ import annotations

import importlib.util

import numpy as np
import pytest

from s2sad.cli.command import main

TEXT = """
import numpy as np
from s2sad import gradient


def energy(x, k):
    return k * np.sum(x ** 3)


pull = gradient(energy, {how})


def loss(x, k):
    return np.sum(pull(x, k) ** 2)
"""


@pytest.mark.parametrize("how", ["wrt='x'", "'x'", "wrt=0"])
def test_a_gradient_at_module_level(how, tmp_path, capsys):
    (tmp_path / "springs.py").write_text(TEXT.format(how=how))
    written = tmp_path / "springs_adjoint.py"
    assert not main(["adjoint", f"{tmp_path / 'springs.py'}:loss", "--wrt", "x", "--types", "x: float64[:], k: float64",
                     "-o", str(written)])
    spec = importlib.util.spec_from_file_location("springs_adjoint", written)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    x, x_bar = np.array([1.0, 2.0]), np.zeros(2)
    module.loss_adjoint(x, x_bar, 0.5, 1.0)
    np.testing.assert_allclose(x_bar, 36.0 * 0.25 * x ** 3)
