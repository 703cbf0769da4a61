"""Goldens: small kernels, and beside each the texts that the stages make of it, compared as text and run."""
from __future__ import annotations

import copy
import math
import os
import shutil
import subprocess
import sys
from typing import Any

import numpy as np
import pytest

from s2sad.run.compiled import compiled
from s2sad.run.module_loader import load
from tests.harness.derivatives import VectorFunction, differences
from tests.harness.seeds import generator
from tests.harness import goldens
from tests.harness.goldens import CASES, FOLDER, difference, given, golden, made, update


@pytest.mark.parametrize("case", CASES)
def test_text(case, request):
    if request.config.getoption("update_golden"):
        update(case)
    found = difference(case)
    assert not found, f"{found}\n\npytest --update-golden writes the files anew"


class Call:
    """One call of a golden derivative on copies of the case's arguments, with the shadows and seeds given."""

    def __init__(self, case: str, name: str, engine: str, shadows: dict[str, Any], seeds: tuple[Any, ...] = ()):
        program, signature = given(case).program, made(case).signatures[name]
        build = compiled if engine == "numba" else load
        function = getattr(build(golden(case, name), signature.entry), signature.entry)
        values = dict(zip(program.kernels[program.entry].parameters, copy.deepcopy(given(case).arguments)))
        values |= {f"array.{key}": value for key, value in program.arrays.items()}
        self.shadows, places = copy.deepcopy(shadows), iter(seeds)
        arguments = [self.shadows[p.primal] if p.role == "shadow" else next(places) if p.role == "seed" else
                     values[p.name] for p in signature.parameters]
        self.returned = dict(zip(signature.returns, function(*arguments) or ()))


def subject_of(case: str) -> VectorFunction:
    module = given(case).module
    return VectorFunction(given(case).kernel, given(case).arguments, module.WRT, module.OF)


def parts(like: dict[str, Any], names: tuple[str, ...], rng: np.random.Generator) -> dict[str, Any]:
    """A random value for each, shaped as it is."""
    def drawn(value: Any) -> Any:
        if isinstance(value, tuple):
            return tuple(map(drawn, value))
        if np.iscomplexobj(value):
            return rng.uniform(0.5, 1.5, np.shape(value)) - 1j * rng.uniform(0.5, 1.5, np.shape(value))
        return rng.uniform(0.5, 1.5, value.shape).astype(value.dtype) if isinstance(value, np.ndarray) else (
            float(rng.uniform(0.5, 1.5)))
    return {name: drawn(like[name]) for name in names}


def flat(values: dict[str, Any], names: tuple[str, ...]) -> np.ndarray:
    return np.concatenate([np.zeros(0), *(reals(np.ravel(v)) for name in names for v in (
        values[name] if isinstance(values[name], tuple) else (values[name],)))]).astype(float)


def reals(vector: np.ndarray) -> np.ndarray:
    """The real and imaginary parts of complex numbers, in turns."""
    return vector.view(float) if np.iscomplexobj(vector) else vector


def tolerance(subject: VectorFunction) -> float:
    return 2e-3 if any(getattr(v, "dtype", None) == np.float32 for v in subject.given.values()) else 1e-7


def adjoint_gradient(case: str, name: str, engine: str, seeds: dict[str, Any], rng: np.random.Generator) -> np.ndarray:
    """The gradient by a golden adjoint; where a shadow only receives it finds something there already."""
    subject, signature = subject_of(case), made(case).signatures[name]
    shadowed = [p.primal for p in signature.parameters if p.role == "shadow"]
    start = parts(subject.given, tuple(n for n in shadowed if n not in subject.of), rng)
    results = seeds.get("return", ())
    call = Call(case, name, engine, {**{n: seeds[n] for n in shadowed if n in seeds}, **start},
                results if isinstance(results, tuple) else (results,))
    found = {n: call.shadows[n] - start.get(n, 0.0) if n in call.shadows else call.returned[n] for n in subject.wrt}
    return flat(found, subject.wrt)


@pytest.mark.parametrize("engine, name", [("numpy", "adjoint.py"), ("numpy", "adjoint_fast.py"),
                                          ("numba", "adjoint_fast.py")])
@pytest.mark.parametrize("case", CASES)
def test_adjoint_runs(case, engine, name):
    if engine == "numba":
        pytest.importorskip("numba")
    rng, subject = generator(0), subject_of(case)
    seeds = parts(subject.outputs, subject.of, rng)
    gradient, bars, scales = adjoint_gradient(case, name, engine, seeds, rng), flat(seeds, subject.of), subject.scales()
    for k in range(subject.x.size):
        direction = np.zeros(subject.x.size)
        direction[k] = scales[k]
        expected, error = differences(subject, direction)
        assert error.max() < 1e-7 * (1.0 + np.abs(expected).max()), "a kink: choose other arguments"
        wanted, magnitude = math.fsum(bars * expected), np.abs(bars * expected).sum() + np.abs(gradient[k] * scales[k])
        assert abs(gradient[k] * scales[k] - wanted) <= tolerance(subject) * magnitude + 10 * error.sum(), (
            f"input {k}: the golden has {gradient[k]}, differences have {wanted / scales[k]}")


@pytest.mark.parametrize("case", CASES)
def test_tangent_runs(case):
    rng, subject = generator(0), subject_of(case)
    direction = parts(subject.given, subject.wrt, rng)
    shadowed = [p.primal for p in made(case).signatures["tangent.py"].parameters if p.role == "shadow"]
    start = {n: np.zeros_like(subject.given[n]) for n in shadowed if n not in subject.wrt}
    call = Call(case, "tangent.py", "numpy", {**direction, **start})
    results = tuple(v for r, v in call.returned.items() if r not in subject.of)
    found = flat({**call.shadows, "return": results}, subject.of)
    expected, error = differences(subject, flat(direction, subject.wrt))
    apart = np.abs(found - expected)
    assert np.all(apart <= tolerance(subject) * np.abs(expected).max() + 10 * error), (found, expected)


def _parts(result: Any) -> tuple[Any, ...]:
    return result if isinstance(result, tuple) else (result,)


@pytest.mark.parametrize("case", CASES)
def test_normal_form_runs(case):
    """The kernel in normal form leaves and returns the very same."""
    kernel, arguments, program = given(case).kernel, given(case).arguments, given(case).program
    function = getattr(load(golden(case, "normal.py"), "normal"), made(case).normal)
    theirs, ours = copy.deepcopy(arguments), copy.deepcopy(arguments)
    wanted, found = kernel(*theirs), function(*ours, *program.arrays.values())
    for ours_k, theirs_k in zip(_parts(found), _parts(wanted)):
        np.testing.assert_allclose(flat({"": ours_k}, ("",)), flat({"": theirs_k}, ("",)), rtol=1e-14)
    for left, right in zip(ours, theirs):
        np.testing.assert_allclose(left, right, rtol=1e-6 if getattr(right, "dtype", None) == np.float32 else 1e-14)


def test_cases_are_small():
    assert len(CASES) >= 30
    for case in CASES:
        lines = (FOLDER / case / "given.py").read_text(encoding="utf-8").splitlines()
        first = next(k for k, line in enumerate(lines) if line.startswith("def kernel"))
        assert lines.index("", first) - first <= 13, f"{case}: one feature, at most a dozen lines and the head"


def test_a_file_too_many_and_a_missing_one(tmp_path, monkeypatch):
    monkeypatch.setattr(goldens, "FOLDER", tmp_path)
    shutil.copytree(FOLDER / "swap", tmp_path / "swapped")
    assert "missing" not in difference("swapped")
    (tmp_path / "swapped" / "primal.py").write_text("kept by hand\n", encoding="utf-8")
    (tmp_path / "swapped" / "adjoint.py").unlink()
    update("swapped")
    assert "swapped/primal.py: no stage writes this file" in difference("swapped")
    (tmp_path / "swapped" / "primal.py").unlink()
    (tmp_path / "swapped" / "tangent.py").unlink()
    assert "swapped/tangent.py: missing" in difference("swapped")
    update("swapped")
    assert not difference("swapped")


def test_update_is_refused_under_ci():
    command = [sys.executable, "-m", "pytest", "-n", "0", "-q", "--collect-only", "--update-golden", __file__]
    done = subprocess.run(command, cwd=FOLDER.parent.parent, env={**os.environ, "CI": "true"}, text=True, check=False,
                          capture_output=True)
    assert done.returncode == pytest.ExitCode.USAGE_ERROR
    assert "--update-golden is refused where CI is set" in done.stderr
