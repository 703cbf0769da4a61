"""Whole modules as text: imports, names, constants, headers, and files that stand alone."""
from __future__ import annotations

import ast
import subprocess
import sys

import numpy as np
import pytest

from s2sad import tree
from s2sad.emit import module_text
from tests.emit.test_layout import lines


# -- modules --------------------------------------------------------------------------------------------------------

def function(source: str, **dotted: str) -> tree.FunctionDef:
    """A function in which each name that `dotted` has is replaced, as resolving does."""
    return tree.rename(tree.statements(source)[0], dotted)


def module(*functions: tree.FunctionDef, header=(), constants=None, standalone=False) -> str:
    return module_text(list(functions), header=list(header), constants=constants or {}, standalone=standalone)


def test_a_whole_module():
    f = function("def f(x):\n    s = grow(x, 1)\n    return exp(x[0]) * sqrt(G) * g(s)", exp="numpy.exp",
                 sqrt="math.sqrt", G="const.G", g="user.g", grow="runtime.grow")
    g = function("def g(x):\n    return x")
    assert module(g, f, header=["Head.", "", "More."], constants={"G": 9.81, "H": 1}) == lines(
        '"""Head.', "", "More.", '"""', "", "import math", "", "import numpy as np", "",
        "from s2sad.runtime import grow  # isort: skip", "", "G = 9.81", "", "", "def g(x):", "    return x", "", "",
        "def f(x):", "    s = grow(x, 1)", "    return np.exp(x[0]) * math.sqrt(G) * g(s)", "")


def test_only_what_is_used():
    assert module(function("def f(x):\n    return x"), constants={"G": 1.0}) == "def f(x):\n    return x\n"


def test_a_last_return_of_nothing_is_left_out():
    f = function("def f(x):\n    x[0] = 1.0\n    return None")
    g = function("def g(x):\n    return None")
    h = function("def h(x):\n    if x:\n        return 1.0\n    return None")
    assert module(f, g, h) == lines("def f(x):", "    x[0] = 1.0", "", "", "def g(x):", "    pass", "", "",
                                    "def h(x):", "    if x:", "        return 1.0", "    return None", "")
    assert isinstance(f.body[-1], tree.Return)


def test_names_do_not_collide():
    f = function("def f(np, math, G):\n    grow = E(np) + E2(math)\n    return R(grow, C)", E="numpy.exp",
                 E2="math.exp", R="runtime.grow", C="const.G")
    assert module(f, constants={"G": -2}) == lines(
        "import math as math_", "", "import numpy as np_", "",
        "from s2sad.runtime import grow as grow_  # isort: skip", "", "G_ = -2", "", "",
        "def f(np, math, G):", "    grow = np_.exp(np) + math_.exp(math)", "    return grow_(grow, G_)", "")


def test_a_local_hides_a_builtin():
    f = function("def f(range):\n    for i in R(range):\n        pass", R="builtins.range")
    g = function("def g(x):\n    return A(x)", A="builtins.abs")
    assert module(f, g).startswith("import builtins\n\n\ndef f(range):\n    for i in builtins.range(range):")
    assert "return abs(x)" in module(f, g)


def test_a_kernel_hides_a_builtin_of_the_runtime():
    f = function("def max(x):\n    return R(x, 1)", R="runtime.grow")
    shown = module(f, standalone=True)
    assert "builtins.max(2 * rows, top + 1)" in shown
    space = _run(shown)
    assert space["max"](np.ones(1)).shape == (2,)


def test_a_local_hides_a_called_kernel():
    f = function("def f(limit):\n    return L(limit)", L="user.limit")
    limit = function("def limit(a):\n    return a + 1.0")
    shown = module(limit, f)
    assert shown == "def limit_(a):\n    return a + 1.0\n\n\ndef f(limit):\n    return limit_(limit)\n"


def test_constants_of_all_kinds():
    constants = {"A": True, "B": float("inf"), "C": -float("inf"), "D": np.float32(0.5), "E": (1, -2.0), "F": None,
                 "H": "s"}
    f = function(f"def f():\n    return {', '.join(constants)}", **{key: f"const.{key}" for key in constants})
    shown = module(f, constants=constants)
    assert shown.split("\n\n\n")[0] == lines(
        "import numpy as np", "", "A = True", "B = np.inf", "C = -np.inf", "D = np.float32(0.5)", "E = 1, -2.0",
        "F = None", 'H = "s"')
    assert _run(shown)["f"]() == tuple(constants.values())


@pytest.mark.parametrize("header", [['a "quote"'], ["ends in \\"], ['"""'], ["a", 'b """ c', "\\N{x} \x1b \x00"],
                                    ["long " * 50, "x" * 300], ["tab\tbed", "two\nlines", "caf\u00e9 \ud800"]])
def test_any_header_is_a_docstring(header):
    shown = module(function("def f():\n    return 1"), header=header)
    assert max(map(len, shown.splitlines())) <= 100
    found = ast.get_docstring(ast.parse(shown.encode("utf-8")), clean=False)
    assert found.replace(" ", "").replace("\n", "") == "".join(header).expandtabs(4).replace(" ", "").replace("\n", "")


def _run(source: str) -> dict:
    space: dict = {}
    exec(compile(source, "<emitted>", "exec"), space)
    return space


def test_standalone_runs_with_numpy_alone():
    f = function("def f(x, np, grow):\n    y = R(x, 7)\n    return P(x), y", R="runtime.grow", P="runtime.pairwise_sum")
    shown = module(f, standalone=True)
    assert "s2sad" not in shown and "def grow_(stack, top):" in shown and "np_.empty" in shown
    total, larger = _run(shown)["f"](np.ones(5), None, None)
    assert total == 5.0 and larger.shape == (10,)
    assert shown == module(f, standalone=True)


def test_emitted_files_pass_ruff(tmp_path):
    pytest.importorskip("ruff")
    long = " + ".join(f"l * exp(u[i, {k}])" for k in range(12))
    f = function(f"def f(l, u, n, ok):\n    for i in range(n):\n        if u == None or ok == True or not i in u:\n"
                 f"            u[i, 0] = {long}\n    return P(u), G, sqrt(l)", exp="numpy.exp", sqrt="math.sqrt",
                 P="runtime.pairwise_sum", G="const.G", range="builtins.range")
    for standalone in (False, True):
        shown = module(f, header=["Head."], constants={"G": 1.0}, standalone=standalone)
        assert max(map(len, shown.splitlines())) <= 100
        path = tmp_path / f"emitted_{standalone}.py"
        path.write_text(shown, encoding="utf-8")
        for options in ([], ["--select", "I"] * (not standalone)):
            ran = subprocess.run([sys.executable, "-m", "ruff", "check", "--isolated", *options, str(path)],
                                 capture_output=True, text=True, check=False)
            assert ran.returncode == 0, ran.stdout + ran.stderr
