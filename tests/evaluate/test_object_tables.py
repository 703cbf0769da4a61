"""Objects that lie in lists of the run and are changed: random programs against Python."""
from __future__ import annotations

import importlib.util

import pytest

import s2sad
from tests.evaluate.random_objects import program
from tests.harness.engines import running
from tests.normalize.test_list_lengths import compare

REFUSED = {7, 10, 11, 13, 27, 29, 43}       # lists that nothing fills, or that are bound again and again
SEEDS = [seed for seed in range(46) if seed not in REFUSED]


def loaded(path, text):
    path.write_text(text)
    spec = importlib.util.spec_from_file_location(path.stem, path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.f


@pytest.mark.parametrize("seed", SEEDS)
def test_changed_objects(seed, tmp_path):
    f = loaded(tmp_path / "kernel.py", program(seed))
    with running("loops" if seed % 4 == 0 else "numpy") as engine:
        derivative = s2sad.value_and_gradient(s2sad.differentiate(f, engine=engine), "x")
        for n in (4, 0, 1, 2, 6):
            compare(f, derivative, n)
