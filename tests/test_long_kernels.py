"""Kernels as long as Python takes them: terms, factors, signs, branches and calls, one in the other."""
from __future__ import annotations

import sys
import threading

import numpy as np
import pytest

import s2sad
from s2sad.deep_stack import deep_stack, on_deep_stack
from s2sad.tree import AST, BinOp, Constant, const, equal, expression, rebuild
from tests.harness.derivatives import check_derivatives


def kernel(text, folder, name="f"):
    """The function of a file with this text."""
    path = folder / "kernel.py"
    path.write_text(f"import numpy as np\n\n\n{text}")
    space = {"__name__": "kernel"}
    exec(compile(path.read_text(), str(path), "exec"), space)
    return space[name]


def adjoints(text, folder, *arguments):
    """Those of both engines for arguments of these types, run by Python."""
    f = kernel(text, folder)
    found = []
    for engine, level in (("numpy", "plain"), ("numba", "fast")):
        source = s2sad.differentiate(f, engine=engine).adjoint_source(*arguments, level=level)
        space = {"__name__": "generated"}
        exec(compile(source.replace("@njit", "@(lambda **_: lambda g: g)") if engine == "numba" else source,
                     "generated", "exec"), space)
        found.append(space["f_adjoint"])
    return found


def gradients(text, folder, *arguments):
    return [adjoint(*arguments, 1.0) for adjoint in adjoints(text, folder, *arguments)]


@pytest.mark.parametrize("terms", [150, 350])
def test_terms(terms, tmp_path):
    text = "def f(x):\n    return " + " + ".join(f"{k}.0 * x" for k in range(terms)) + "\n"
    for (found,) in gradients(text, tmp_path, 1.5):
        assert found == terms * (terms - 1) / 2


def test_signs(tmp_path):
    for (found,) in gradients("def f(x):\n    return " + "-" * 101 + "x * x\n", tmp_path, 1.5):
        assert found == -3.0


@pytest.mark.parametrize("factors", [16, 17, 18, 40])
def test_factors(factors, tmp_path):
    text = "def f(x, y):\n    return " + " * ".join(["x", "y"] * (factors // 2)) + "\n"
    n = factors // 2
    for found in gradients(text, tmp_path, 1.01, 0.98):
        assert found == pytest.approx((n * 1.01 ** (n - 1) * 0.98 ** n, n * 1.01 ** n * 0.98 ** (n - 1)), rel=1e-12)


def test_factors_of_arrays(tmp_path):
    f = kernel("def f(x, y):\n    y[:] = " + " * ".join(["x", "np.cos(y)"] * 9) + "\n", tmp_path)
    for engine in ("numpy", "loops"):
        check_derivatives(f, (np.array([1.1, 0.9]), np.array([0.1, 0.2])), ("x", "y"), ("y",), engine)


def test_functions_one_in_the_other(tmp_path):
    f = kernel("def f(x):\n    return " + "np.sin(x * " * 18 + "x" + ")" * 18 + "\n", tmp_path)
    for engine in ("numpy", "loops"):
        check_derivatives(f, (1.1,), ("x",), ("return",), engine)


CHAIN = """def f(x, k):
    if k == 0:
        y = x
{}    else:
        return -x
    return y * y
"""


@pytest.mark.parametrize("branches", [32, 41])
def test_branches(branches, tmp_path):
    """Those of a chain, and what is left to its end; the test of one is asked only where those before do not hold."""
    text = CHAIN.format("".join(f"    elif k > {n - 1} and k < {n} + 1:\n        y = {n}.0 * x\n"
                                for n in range(1, branches)))
    for adjoint in adjoints(text, tmp_path, 1.5, 0):
        for k in (0, 1, 7, 8, branches - 1):
            assert adjoint(1.5, k, 1.0)[0] == 2.0 * max(k, 1) ** 2 * 1.5
        assert adjoint(1.5, branches, 1.0)[0] == -1.0


def test_tests_in_order(tmp_path):
    """A test behind the one that holds is not asked: it would divide by zero."""
    text = "def f(x, k):\n    y = 0.0\n    if k == 0:\n        y = x\n" + "".join(
        f"    elif 12 // k == {n}:\n        y = {n}.0 * x\n" for n in range(1, 34)) + "    return y\n"
    for adjoint in adjoints(text, tmp_path, 1.5, 0):
        assert [adjoint(1.5, k, 1.0)[0] for k in (0, 1, 4, 13)] == [1.0, 12.0, 3.0, 0.0]


def test_powers_one_in_the_other(tmp_path):
    text = "def f(x, n):\n    return x * " + "(" * 40 + "n" + " ** 1)" * 40 + "\n"
    for adjoint in adjoints(text, tmp_path, 1.5, 3):
        assert adjoint(1.5, 3, 1.0)[0] == 3.0


def test_what_a_change_leaves_is_rebuilt_once():
    """A change that looks at rebuilt operands, and then leaves the node, is asked once for each node."""
    asked: list[AST] = []

    def change(node):
        asked.append(node)
        if isinstance(node, BinOp):
            rebuild(node.left, change)
        return const(2.0) if isinstance(node, Constant) and node.value == 1.0 else None
    given = expression("x" + " + 1.0" * 40)
    made = rebuild(given, change)
    assert len(asked) == len({id(n) for n in asked})
    assert equal(made, expression("x" + " + 2.0" * 40)) and equal(given, expression("x" + " + 1.0" * 40))


def test_calls_one_in_the_other(tmp_path):
    helpers = "".join(f"def h{k}(x, c):\n    return h{k - 1}(x, c) + c * h{k - 1}(x, c)\n\n\n" for k in range(1, 24))
    text = f"def h0(x, c):\n    return x * c\n\n\n{helpers}def f(x):\n    return h4(x, 0.5)\n"
    for (found,) in gradients(text, tmp_path, 1.5):
        assert found == 0.5 * 1.5 ** 4
    deep = kernel(text.replace("h4(x, 0.5)", "h23(x, 0.5)"), tmp_path)
    assert "def h23_adjoint" in s2sad.differentiate(deep).adjoint_source(1.5)


def test_deep_stack():
    """What is too deep runs where there is room; what it raises is raised, and the limit is what it was."""
    limit, here = sys.getrecursionlimit(), threading.current_thread()

    @deep_stack
    def nested(n):
        if n:
            return nested_inside(n - 1)
        assert on_deep_stack() == (threading.current_thread() is not here)
        return threading.current_thread()

    def nested_inside(n):
        return nested_inside(n - 1) if n else nested(0)

    @deep_stack
    def failing(n):
        if n == 0:
            raise KeyError("at the end")
        return failing(n - 1)
    assert nested(10) is here
    assert nested(20_000) is not here
    with pytest.raises(KeyError, match="at the end"):
        failing(20_000)
    assert sys.getrecursionlimit() == limit and not on_deep_stack()
