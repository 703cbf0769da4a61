"""Programs with structures: what is left when they are evaluated computes what Python computes, and its derivatives."""
from __future__ import annotations

import builtins
import importlib.util
import sys
import warnings

import numpy as np
import pytest

import s2sad
from s2sad import tree
from s2sad.evaluate.specialize import specialize
from s2sad.infer.types import array
from s2sad.program import DemandedFacts
from tests.harness import object_programs
from tests.harness.seeds import generator, seeded
from tests.programs.given_objects import source as source_of_given
from tests.programs.structures import source

X = np.array([0.3, 0.7, 1.1, 1.9])
PROGRAMS = int(generator(0).integers(10 ** 6)) % 10 ** 6, 100      # the first seed, and how many


def loaded(seed, folder):
    """The function of a program, None where Python does not run it to a number."""
    path = folder / f"program_{seed}.py"
    path.write_text(source(seed))
    spec = importlib.util.spec_from_file_location(path.stem, path)
    sys.modules[path.stem] = module = importlib.util.module_from_spec(spec)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            spec.loader.exec_module(module)
            return module.f if np.isfinite(module.f(X.copy())) else None
    except (ArithmeticError, TypeError, IndexError, NameError, ValueError):
        return None


def residual(function):
    """The residual function, as Python runs it; None where it is refused."""
    facts = {}
    for _ in range(3):
        try:
            found = specialize(function, {"x": array("float64", 1)}, facts)
            break
        except DemandedFacts as demanded:
            facts |= dict.fromkeys(demanded.facts, X.shape)
        except s2sad.S2sadError:
            return None
    else:
        return None
    return as_python_runs_it(found.captured())


def as_python_runs_it(made):
    """A residual function, with the values and the functions around it."""
    around = {"numpy": np, "builtins": builtins}
    names = {n: n.replace(".", "_") for n in made.scope.names if n.startswith(("outside.", "separate."))}
    around |= {new: made.scope.names[n].value for n, new in names.items() if n.startswith("outside.")}
    for n, new in names.items():
        if n.startswith("separate."):
            definition = tree.rename(made.scope.names[n].handle.tree, names)
            definition.name = new
            exec(tree.written(definition), around)  # noqa: S102
    exec(tree.written(tree.rename(made.tree, names)), around)  # noqa: S102
    return around[made.name]


@pytest.mark.parametrize("part", range(10))
def test_values(part, tmp_path):
    """Values, and what is left in the argument."""
    first, count = PROGRAMS
    compared = 0
    for seed in range(first + part * count // 10, first + (part + 1) * count // 10):
        function = loaded(seed, tmp_path)
        made = None if function is None else residual(function)
        if made is None:
            continue
        ours, theirs = X.copy(), X.copy()
        np.testing.assert_allclose(made(ours), function(theirs), rtol=1e-12, err_msg=source(seed))
        np.testing.assert_array_equal(ours, theirs, err_msg=source(seed))
        compared += 1
    assert compared


@pytest.mark.parametrize("seed", range(12))
def test_derivatives(seed, tmp_path):
    """Tangent and adjoint agree, and the differences with them where there is no kink near."""
    function = loaded(seed, tmp_path)
    if function is None:
        return
    try:
        found = s2sad.value_and_gradient(s2sad.differentiate(function, engine="numpy"))(X.copy())
    except s2sad.S2sadError:
        return
    value, slope = found
    np.testing.assert_allclose(value, function(X.copy()), rtol=1e-12)
    direction = generator(seed).standard_normal(4)
    along = s2sad.jvp(s2sad.differentiate(function, engine="numpy"), (X.copy(),), {"x": direction})["return"]
    np.testing.assert_allclose(slope @ direction, along, rtol=1e-9, atol=1e-12 * np.abs(slope).sum())


@pytest.mark.parametrize("first", range(0, 40, 10))
def test_objects_that_are_given(first, tmp_path):
    """A failure names its number for `python -m tests.harness.object_programs`."""
    kinds = []
    for seed in range(seeded(first), seeded(first) + 10):
        kind, place, text = object_programs.outcome(source_of_given(seed), seed, "numpy", tmp_path)
        assert kind in ("ok", "refused", "invalid"), f"seed {seed}: {kind}, {place}\n{source_of_given(seed)}\n{text}"
        kinds.append(kind)
    assert "ok" in kinds
