"""What docs/functions.md names: all of it runs; `pytest --compiled` has Numba compile each expression and each rule."""
from __future__ import annotations

import importlib.util
import re
from pathlib import Path

import numpy as np
import pytest

import s2sad
from s2sad import rules
from tests.harness.engines import compiling
from tests.docs.functions import FLOATS, PAGE, arguments, expressions, function
from tests.rules import test_rules

HEAD = "import cmath\nimport math\n\nimport numpy as np\nimport scipy.linalg\nimport scipy.sparse.linalg\n" \
    "import scipy.special\n\n\n"
RULES = [name for name in rules.names() if not name.startswith("runtime.")]


def of_a_rule(name):
    """A kernel of an elementwise function, of a number and, where it takes them, of arrays."""
    parameters = rules.find(name).parameters
    elements = [f"{p}[0]" for p in parameters]
    if " " in name or name[0] in "+-":
        spelled = [re.sub(r"\b([ab])\b", r"\1[0]", name), name]
    else:
        called = name.removeprefix("builtins.").replace("numpy.", "np.")
        spelled = [f"{called}({', '.join(elements)})", f"{called}({', '.join(parameters)})"]
    if name.startswith(("math.", "builtins.", "numpy.float32", "numpy.float64")) and name != "builtins.abs":
        spelled.pop()
    return parameters, f"def kernel({', '.join(parameters)}):\n    return {spelled[0]}" + "".join(
        f" + np.sum({s})" for s in spelled[1:]) + "\n"


def loaded(text, folder):
    path = Path(folder) / f"kernel_{abs(hash(text))}.py"
    path.write_text(HEAD + text)
    spec = importlib.util.spec_from_file_location(path.stem, path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.kernel


def gradients(kernel, given, wrt):
    """Of the text for NumPy, and of the text for Numba, compiled."""
    return [s2sad.vjp(s2sad.differentiate(kernel, engine=engine), given, {"return": 1.0}, wrt=wrt)
            for engine in ("numpy", "numba")]


def runs(kernel, given, wrt):
    assert np.isfinite(kernel(*given))
    if compiling:
        expected, found = gradients(kernel, given, wrt)
        for name in wrt:
            np.testing.assert_allclose(found[name], expected[name], rtol=1e-9, atol=1e-11)


@pytest.mark.parametrize("expression", expressions())
def test_expression(expression, tmp_path):
    text = function("kernel", expression)
    used = tuple(n for n in FLOATS if re.search(rf"\b{n}\b", expression))
    runs(loaded(text, tmp_path), arguments(), used)


@pytest.mark.parametrize("name", RULES)
def test_rule(name, tmp_path):
    parameters, text = of_a_rule(name)
    points = test_rules.points(name, 4)
    given = tuple(np.array([point[p] for point in points]) for p in parameters)
    if name == "numpy.where":
        given = (given[0] > 0.0, *given[1:])
    runs(loaded(text, tmp_path), given, parameters[name == "numpy.where":])


def test_what_the_page_names_is_here():
    lines = (Path(__file__).resolve().parents[2] / "docs" / "functions.md").read_text().splitlines()
    rows = {row.split("|")[1].strip(" `"): row for row in lines if row.startswith("| ") and "functions |" not in row}
    assert set(rows) == set(PAGE)
    known = set(re.findall(r"[a-z]\w*", " ".join([*expressions(), *RULES])))
    for row, line in rows.items():
        for name in re.findall(r"`\.?([a-z_0-9.]+)`", line.split("|")[2]):
            last = name.split(".")[-1]
            assert last in known or last[0] == "_" and any(k.endswith(last) for k in known), f"{name}, of {row}"
