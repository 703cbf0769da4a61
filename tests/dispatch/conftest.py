"""Processes that keep what is derived, and a function to differentiate under each engine."""
from __future__ import annotations

import sys

import pytest

import s2sad
from s2sad.dispatch import artifacts
from tests.dispatch.kernels import scaled
from tests.dispatch.processes import Processes
from tests.harness.engines import running


@pytest.fixture
def processes(tmp_path, monkeypatch):
    monkeypatch.setenv("S2SAD_CACHE_DIR", str(tmp_path / "cache"))
    monkeypatch.setattr(artifacts, "ENABLED", True)
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    yield Processes(tmp_path, monkeypatch)
    for name in ("kernel_of_artifacts", "helpers_of_artifacts"):
        sys.modules.pop(name, None)


@pytest.fixture(params=["numpy", "loops"])
def f(request):
    with running(request.param) as engine:
        yield s2sad.differentiate(scaled, engine=engine)
