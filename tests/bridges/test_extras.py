"""What needs a package that is not installed says with which extra it comes."""
from __future__ import annotations

import subprocess
import sys

import pytest

import s2sad
from s2sad.bridges import casadi_functions, torch_steps
from s2sad.diagnostics import S2sadError
from s2sad.extras import absent, needed
from tests.harness.documents import environment


@pytest.mark.parametrize("package, title", [("jax", "JAX"), ("torch", "PyTorch"), ("casadi", "CasADi")])
def test_a_bridge_names_its_extra(package, title, monkeypatch):
    monkeypatch.setitem(sys.modules, package, None)
    torch_steps.library.cache_clear()
    casadi_functions._classes.cache_clear()
    with pytest.raises(S2sadError) as caught:
        getattr(s2sad, package)(lambda x: x, *([()] if package == "casadi" else []))
    assert str(caught.value) == (f"error[S405]: s2sad.{package} needs {title}, which is not installed\n"
                                 f'  help: pip install "s2sad[{package}]"')


def test_what_to_do_otherwise_is_said():
    assert str(absent("scipy", "a sparse matrix", "ask for the dense one")) == (
        "error[S405]: a sparse matrix needs SciPy, which is not installed\n"
        '  help: pip install "s2sad[jit]", or ask for the dense one')
    assert needed("json", "a file").dumps(1) == "1"


def test_no_bridge_is_loaded_before_it_is_used():
    script = ("import s2sad, sys; s2sad.jax, s2sad.torch, s2sad.casadi; "
              "print([m for m in ('jax', 'torch', 'casadi') if m in sys.modules])")
    done = subprocess.run([sys.executable, "-c", script], env=environment(), text=True, capture_output=True, check=True)
    assert done.stdout == "[]\n"
