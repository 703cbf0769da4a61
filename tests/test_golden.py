"""Goldens: small kernels, and beside each the texts that the stages make of it, compared as text and run.

`tests/golden/<case>/given.py` holds a kernel with one feature, and what to differentiate: `ARGUMENTS`, `WRT`, `OF`.
Beside it lie

    normal.py         the kernel in normal form
    adjoint.py        the adjoint for NumPy, plain
    adjoint_fast.py   the adjoint for Numba, fast, where its functions are not the plain ones
    tangent.py        the tangent for NumPy, plain

`pytest --update-golden` writes them anew (not where CI is set) and `python -m tests.test_golden` prints how the texts
that are made now differ from them.
"""
from __future__ import annotations

import copy
import difflib
import importlib.util
import inspect
import math
import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

import numpy as np
import pytest

from s2sad import pipeline, read
from s2sad.dispatch.arguments import bind
from s2sad.emit import module_text
from s2sad.interface.pytrees import flattened
from s2sad.infer.types import of_value
from s2sad.program import Generated, Program, Request
from s2sad.run.compiled import compiled
from s2sad.run.module_loader import load
from s2sad.tree import FunctionDef
from s2sad.units import Unit
from s2sad.dispatch.cache import ProgramVersion
from tests.harness.derivatives import VectorFunction, differences
from tests.harness.seeds import generator

FOLDER = Path(__file__).resolve().parent / "golden"
CASES = sorted(path.name for path in FOLDER.iterdir() if path.is_dir() and not path.name.startswith((".", "_")))
FILES = ("normal.py", "adjoint.py", "adjoint_fast.py", "tangent.py")


class Given(NamedTuple):
    """A case as given: its module, its program, its kernel and arguments without structures, and the plain requests for
    its derivatives."""
    module: ModuleType
    program: Program
    kernel: Callable[..., Any]
    arguments: tuple[Any, ...]
    adjoint: Request
    tangent: Request


class Made(NamedTuple):
    """What the stages make of a case: the texts by file, the entry in normal form, the signatures by file."""
    texts: dict[str, str]
    normal: str
    signatures: dict[str, Generated]


@cache
def given(case: str) -> Given:
    path = FOLDER / case / "given.py"
    spec = importlib.util.spec_from_file_location(f"tests.golden.{case}", path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    program, kernel, arguments = read.load(module.kernel), module.kernel, module.ARGUMENTS
    apart = flattened(ProgramVersion.of(program, kernel), arguments)
    if apart is not None:
        arguments = bind(program.kernels[program.entry], arguments)
        program, kernel = apart.state.program, apart.flat_function(kernel, copy.deepcopy(arguments))
        kinds = [inspect.Parameter(name, inspect.Parameter.POSITIONAL_ONLY) for name in apart.paths]
        vars(kernel)["__signature__"] = inspect.Signature(kinds)
        arguments = tuple(apart.values(arguments))
    types = tuple(of_value(a) if apart is None else of_value(a).plain for a in arguments)
    adjoint, tangent = (Request(mode, types, module.WRT, module.OF) for mode in ("adjoint", "tangent"))
    return Given(module, program, kernel, arguments, adjoint, tangent)


@cache
def made(case: str) -> Made:
    program, (adjoint, tangent) = given(case).program, given(case)[-2:]
    units, unit = pipeline.entry(program, adjoint.types, "numpy")
    normal = module_text([titled(u) for u in units.titled.values()], constants=program.constants, standalone=False,
                         header=["Normal form."])
    fast = Request("adjoint", adjoint.types, adjoint.wrt, adjoint.of, "numba", "fast")
    signatures = {"adjoint.py": pipeline.derive(program, adjoint), "adjoint_fast.py": pipeline.derive(program, fast),
                  "tangent.py": pipeline.derive(program, tangent)}
    texts = {"normal.py": normal, **{name: generated.text for name, generated in signatures.items()}}
    if functions(texts["adjoint_fast.py"]) == functions(texts["adjoint.py"]):
        del texts["adjoint_fast.py"]
    return Made(texts, unit.title, signatures)


def titled(unit: Unit) -> FunctionDef:
    """A kernel in normal form, under the name by which others call it."""
    renamed = copy.copy(unit.function)
    renamed.name = unit.title
    return renamed


def functions(text: str) -> str:
    """A module's text without its docstring."""
    return text.split('"""', 2)[2]


def golden(case: str, name: str) -> str:
    """A golden file's text; of a fast text that is the plain one, the plain file's."""
    path = FOLDER / case / name
    if name == "adjoint_fast.py" and not path.exists():
        path = FOLDER / case / "adjoint.py"
    return path.read_text(encoding="utf-8")


def update(case: str) -> None:
    """Writes the files of a case, and removes those that no stage writes any longer."""
    texts = made(case).texts
    for name in FILES:
        path = FOLDER / case / name
        if name not in texts:
            path.unlink(missing_ok=True)
        elif not path.exists() or path.read_text(encoding="utf-8") != texts[name]:
            path.write_text(texts[name], encoding="utf-8")


def difference(case: str) -> str:
    """How the files of a case differ from the texts that are made now; a file that is missing or too many differs
    from nothing."""
    texts, lines = made(case).texts, []
    present = {p.name for p in (FOLDER / case).iterdir() if p.is_file()}
    for name in sorted((present | set(texts)) - {"given.py"}):
        before = golden(case, name).splitlines() if name in present else []
        after = texts[name].splitlines() if name in texts else []
        place = f"tests/golden/{case}/{name}"
        lines += difflib.unified_diff(before, after, place, f"{name} as it is made", lineterm="")
        if name not in texts or name not in present:
            lines.append(f"{place}: {'missing' if name in texts else 'no stage writes this file'}")
    return "\n".join(lines)


@pytest.mark.parametrize("case", CASES)
def test_text(case, request):
    if request.config.getoption("update_golden"):
        update(case)
    found = difference(case)
    assert not found, f"{found}\n\npytest --update-golden writes the files anew"


# -- the files run --------------------------------------------------------------------------------------------------
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


# -- the goldens themselves -----------------------------------------------------------------------------------------
def test_cases_are_small():
    assert len(CASES) >= 30
    for case in CASES:
        lines = (FOLDER / case / "given.py").read_text(encoding="utf-8").splitlines()
        first = next(k for k, line in enumerate(lines) if line.startswith("def kernel"))
        assert lines.index("", first) - first <= 13, f"{case}: one feature, at most a dozen lines and the head"


def test_a_file_too_many_and_a_missing_one(tmp_path, monkeypatch):
    monkeypatch.setattr(sys.modules[__name__], "FOLDER", tmp_path)
    shutil.copytree(Path(__file__).resolve().parent / "golden" / "swap", tmp_path / "swapped")
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


if __name__ == "__main__":
    print("\n".join(filter(None, map(difference, sys.argv[1:] or CASES))))
