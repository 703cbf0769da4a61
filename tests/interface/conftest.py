"""The kernels of `kernels`, under each engine, with nothing derived of them."""
from __future__ import annotations

import types

import pytest

from s2sad import Differentiated, pipeline
from s2sad.live_objects.side_table import forget
from tests.interface import kernels


@pytest.fixture
def fresh(monkeypatch, tmp_path_factory):
    monkeypatch.setenv("S2SAD_CACHE_DIR", str(tmp_path_factory.getbasetemp() / "modules"))


@pytest.fixture
def derived(monkeypatch):
    """The requests that reached the pipeline."""
    requests = []
    derive = pipeline.derive
    monkeypatch.setattr(pipeline, "derive",
                        lambda program, request, **given: requests.append(request) or derive(program, request, **given))
    return requests


@pytest.fixture
def apart():
    """Every test begins with nothing derived: the first call with new types runs with bounds checks."""
    for kernel in vars(kernels).values():
        if isinstance(kernel, types.FunctionType):
            forget(kernel)


@pytest.fixture(params=["numpy", "numba"])
def made(request):
    if request.param == "numba":
        pytest.importorskip("numba")
    return lambda name, **options: Differentiated(getattr(kernels, name), engine=request.param, **options)
