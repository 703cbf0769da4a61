"""What has no derivative rule is refused, with its place; nothing without a rule passes as inactive."""
from __future__ import annotations

import importlib.util

import numpy as np
import pytest

import s2sad

LOOP, OTHERS = "write it as a loop over the elements", (
    "write it with functions that have a rule, or give it one: s2sad.rule, s2sad.nondifferentiable")
SUM = "write a loop that adds the elements"
CASES = [
    ("np.linalg.matrix_rank(a)", "error[S301]: no derivative rule for numpy.linalg.matrix_rank", LOOP),
    ("np.union1d(u, u)[0]", "error[S301]: no derivative rule for numpy.union1d", LOOP),
    ("np.exp(u[0], u[1])", "error[S301]: no derivative rule for numpy.exp with 2 arguments there is one for "
     "numpy.exp(x)", OTHERS),
    ("np.sum(u[0] > 0)", "error[S301]: no derivative rule for numpy.sum of bool", SUM),
]


@pytest.mark.parametrize(("expression", "message", "help"), CASES, ids=[c[0] for c in CASES])
def test_refused(expression, message, help, tmp_path):
    path = tmp_path / "kernel.py"
    path.write_text(f"import math\nimport numpy as np\n\n\ndef f(a, u):\n    return {expression}\n")
    spec = importlib.util.spec_from_file_location("kernel", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    with pytest.raises(s2sad.S2sadError) as caught:
        s2sad.gradient(module.f)(np.ones((2, 2)), np.ones(2))
    lines = str(caught.value).splitlines()
    found = " ".join([lines[0].split(": ", 1)[1], lines[2].partition("^")[2].lstrip("^").strip()]).strip()
    assert (found, lines[3]) == (message, f"  help: {help}")
