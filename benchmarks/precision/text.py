"""The text of a function, changed so that every number in it has 113 bits.

    0.5 * x / n           quad_(0.5) * divide_(x, n)
    import numpy as np    np is what `modules.MODULES` has for numpy

A literal stays the double that it is; 1.0 / 9.0 is the ninth. The constants of derivative rules (log(2),
2 / sqrt(pi), ...) are rounded to 113 bits; those that the kernel itself spells are the kernel's, and stay doubles.
"""
from __future__ import annotations

import ast
import importlib
import inspect
import math
import textwrap
from collections.abc import Callable
from types import FunctionType, ModuleType
from typing import Any

from benchmarks.precision.linalg import matmul
from benchmarks.precision.modules import CONSTANTS, MODULES, replaced_in_runtime
from benchmarks.precision.quad import Namespace, NoReference, as_quad, divide, power

OPERATORS = {ast.Div: "divide_", ast.Pow: "power_", ast.MatMult: "matmul_"}
GLOBALS = {"quad_": as_quad, "divide_": divide, "power_": power, "matmul_": matmul, "float": as_quad}


class _Numbers(ast.NodeTransformer):
    """Wraps float literals, quotients, powers and products of matrices."""

    def __init__(self, constants: dict[float, Any]) -> None:
        self.constants, self.values = constants, {}

    def visit_Constant(self, node: ast.Constant) -> ast.AST:
        if isinstance(node.value, complex):
            raise NoReference("complex numbers")
        return self._held(node.value) if isinstance(node.value, float) else node

    def visit_Attribute(self, node: ast.Attribute) -> ast.AST:
        return self._held(math.pi) if node.attr == "pi" and math.pi in self.constants else self.generic_visit(node)

    def visit_BinOp(self, node: ast.BinOp) -> ast.AST:
        name = OPERATORS.get(type(node.op))
        if name is None:
            return self.generic_visit(node)
        return ast.Call(ast.Name(name, ast.Load()), [self.visit(node.left), self.visit(node.right)], [])

    def visit_AugAssign(self, node: ast.AugAssign) -> ast.AST:
        node = self.generic_visit(node)
        if isinstance(node.op, (ast.Div, ast.Pow)):
            node.value = ast.Call(ast.Name("quad_", ast.Load()), [node.value], [])
        return node

    def visit_JoinedStr(self, node: ast.JoinedStr) -> ast.AST:
        return node

    def _held(self, value: float) -> ast.Name:
        name = f"number_{len(self.values)}_"
        self.values[name] = self.constants[value] if value in self.constants else as_quad(value)
        return ast.Name(name, ast.Load())


def executed(text: str, constants: dict[float, Any], given: dict[str, Any] | None = None) -> dict[str, Any]:
    """The names that the text binds, run with numbers of 113 bits.

    Args:
        text: Python source; of modules it may import those that `quad` stands for, and `s2sad.runtime`.
        constants: what floats of the text stand for that are rounded in it.
        given: names that the text reads.
    """
    parsed = ast.parse(text)
    space = {**GLOBALS, **(given or {}), "__name__": "quad_text"}
    parsed.body = [node for node in parsed.body if not _imported(node, space)]
    numbers = _Numbers(constants)
    parsed = ast.fix_missing_locations(numbers.visit(parsed))
    space.update(numbers.values)
    exec(compile(parsed, "<text of 113 bits>", "exec"), space)
    return space


def _imported(node: ast.stmt, space: dict[str, Any]) -> bool:
    """Binds what an import names to what stands for it; whether the statement is an import."""
    if isinstance(node, ast.Import):
        for name in node.names:
            found = _module(name.name)
            first = name.name.partition(".")[0]
            space[name.asname or first] = found if name.asname else _module(first)
        return True
    if not isinstance(node, ast.ImportFrom):
        return False
    if node.module != "__future__":
        module = _module(str(node.module))
        for name in node.names:
            space[name.asname or name.name] = getattr(module, name.name)
    return True


_RUNTIME: dict[str, Namespace] = {}


def _module(name: str) -> Any:
    if name.startswith("s2sad.runtime"):
        return _runtime(name)
    if name not in MODULES:
        raise NoReference(f"the module {name}")
    return MODULES[name]


def _runtime(name: str) -> Namespace:
    """A module of the runtime, its text run with 113 bits."""
    if name not in _RUNTIME:
        module = importlib.import_module(name)
        _RUNTIME[name] = made = Namespace(name)
        if name == "s2sad.runtime":
            for public in module.__all__:
                owner = getattr(module, public).__module__
                made.lazily(public, lambda owner=owner, public=public: getattr(_runtime(owner), public))
        else:
            space = executed(inspect.getsource(module), CONSTANTS)
            space.update(replaced_in_runtime(space))    # in the module itself, whose functions call them, too
            made.update(space)
    return _RUNTIME[name]


def function_of(function: Callable[..., Any]) -> Callable[..., Any]:
    """A user's function, and the functions that it calls, with 113 bits, as they are written."""
    if not isinstance(function, FunctionType):
        raise NoReference(f"{function!r}, which is no plain function")
    return _function(function, {})


def _function(function: FunctionType, made: dict[FunctionType, Any]) -> Any:
    if function not in made:
        node = ast.parse(textwrap.dedent(inspect.getsource(function))).body[0]
        if not isinstance(node, ast.FunctionDef):
            raise NoReference(f"{function.__name__}, which is no def statement")
        node.decorator_list, node.returns = [], None
        for argument in (*node.args.args, *node.args.kwonlyargs):
            argument.annotation = None
        box: list[Any] = []

        def called(*given: Any, **named: Any) -> Any:       # the function may call itself
            return box[0](*given, **named)
        made[function] = called
        read = inspect.getclosurevars(function)
        given = {n: _global(n, v, made) for n, v in {**read.globals, **read.nonlocals}.items()}
        box.append(executed(ast.unparse(node), {}, given)[function.__name__])
    return made[function]


def _global(name: str, value: Any, made: dict[FunctionType, Any]) -> Any:
    if isinstance(value, ModuleType):
        return _module(value.__name__)
    if isinstance(value, FunctionType) and not value.__module__.startswith(("numpy", "scipy")):
        return _function(value, made)
    if callable(value):
        home = MODULES.get(getattr(value, "__module__", None) or "numpy")
        if home is None:
            raise NoReference(f"the function {name}")
        return getattr(home, value.__name__)
    return as_quad(value) if not isinstance(value, (str, bytes, tuple, list, dict, type(None))) else value
