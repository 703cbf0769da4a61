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


DECORATED = """
import numpy as np
import s2sad


@s2sad.{name}
def pull(x):
    return np.sum(x ** 3)


def loss(x):
    found = pull(x){item}
    return np.sum(found ** 2)
"""


def adjoint(path, function, types):
    """The module that the command writes."""
    written = path.with_name("written.py")
    assert not main(["adjoint", f"{path}:{function}", "--wrt", "x", "--types", types, "-o", str(written)])
    spec = importlib.util.spec_from_file_location("written", written)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize(("name", "item"), [("gradient", ""), ("grad", ""), ("value_and_gradient", "[1]")])
def test_a_decorator_makes_a_gradient(name, item, tmp_path):
    path = tmp_path / "springs.py"
    path.write_text(DECORATED.format(name=name, item=item))
    x, x_bar = np.array([1.0, 2.0]), np.zeros(2)
    adjoint(path, "loss", "x: float64[:]").loss_adjoint(x, x_bar, 1.0)
    np.testing.assert_allclose(x_bar, 36.0 * x ** 3)


def test_asked_for_by_itself_it_is_what_is_written_there(tmp_path):
    path = tmp_path / "springs.py"
    path.write_text(DECORATED.format(name="value_and_gradient", item="[1]"))
    x, x_bar = np.array([1.0, 2.0]), np.zeros(2)
    adjoint(path, "pull", "x: float64[:]").pull_adjoint(x, x_bar, 1.0)
    np.testing.assert_allclose(x_bar, 3.0 * x ** 2)


@pytest.mark.parametrize("how", ["wrt='x'", "'x'", "wrt=0"])
def test_a_gradient_at_module_level(how, tmp_path):
    path = tmp_path / "springs.py"
    path.write_text(TEXT.format(how=how))
    x, x_bar = np.array([1.0, 2.0]), np.zeros(2)
    adjoint(path, "loss", "x: float64[:], k: float64").loss_adjoint(x, x_bar, 0.5, 1.0)
    np.testing.assert_allclose(x_bar, 36.0 * 0.25 * x ** 3)


def test_it_says_of_what_it_is(tmp_path, capsys):
    path = tmp_path / "springs.py"
    path.write_text(TEXT.format(how="").replace(", )", ")"))
    assert main(["adjoint", f"{path}:loss", "--wrt", "x", "--types", "x: float64[:], k: float64"])
    assert "'energy' takes several arguments" in capsys.readouterr().err
