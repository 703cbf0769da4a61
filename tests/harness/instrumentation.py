"""Texts for Numba that Python runs, and that note what they do: the constructs of tests/harness/constructs.py."""
from __future__ import annotations

import ast
import operator
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import CodeType, FunctionType
from typing import Any

import numpy as np

from s2sad.interface.value_calls import PreparedCall
from s2sad.run import module_loader

_LETTERS = {"float64": "f", "float32": "s", "complex128": "c", "int64": "i", "bool": "b"}
_NUMBERS = ((bool, "b"), (int, "i"), (float, "f"), (complex, "c"))
_LIBRARIES = ("numpy", "math", "builtins", "scipy", "s2sad.runtime", "_operator")
_SITES = "__sites__"
_recording: list[set[str]] = []


# -- what a text does -----------------------------------------------------------------------------------------------
def _type(value: Any) -> str:
    """The type of an operand, shortly: f a float, f2 a matrix of floats, (ii) a pair of integers."""
    if isinstance(value, np.ndarray):
        return f"{_LETTERS.get(value.dtype.name, value.dtype.name)}{min(value.ndim, 3)}"
    if isinstance(value, np.generic):
        return _LETTERS.get(value.dtype.name, value.dtype.name)
    if isinstance(value, tuple):
        return f"({''.join(map(_type, value[:3]))})"
    if isinstance(value, slice):
        return ":" if value.step is None else "::"
    for kind, letter in _NUMBERS:
        if isinstance(value, kind):
            return letter
    return "..." if value is ... else "None" if value is None else type(value).__name__


def _operand(value: Any) -> str:
    """The type of an operand of elementwise arithmetic, which is compiled alike for all ranks and precisions."""
    found = _type(value)
    found = f"{found[0]}[]" if isinstance(value, np.ndarray) and value.ndim else found
    return found.replace("s", "f") if isinstance(value, (np.ndarray, np.generic)) else found


class Site:
    """A place in a text: does what stands there, and notes with which types, once in each test."""

    def __init__(self, form: str, name: str):
        self.form, self.name, self.noted = form, name, None

    def __call__(self, does: Callable, *operands: Any, **options: Any) -> Any:
        if _recording and self.noted is not _recording[-1]:
            self.noted = _recording[-1]
            self.noted.add(self.construct(does, operands, options))
        return does(*operands, **options)

    def construct(self, does: Callable, operands: tuple, options: dict[str, Any]) -> str:
        if self.form == "call":
            home = getattr(does, "__module__", None) or type(does).__module__
            if not home.startswith(_LIBRARIES):
                return "a function of the module"
            named = [f"{n}=" for n in options]
            return f"{self.name}({', '.join([*map(_type, operands), *named])})"
        if self.form == "operator":
            return f"{self.name} {' '.join(map(_operand, operands))}"
        array, index, *value = operands
        kept = _type(array).replace("s", "f") if isinstance(array, np.ndarray) else _type(array)
        return f"{self.name} {' '.join([kept, _type(index), *map(_operand, value)])}"


class _Forms:
    """The forms of a function's statements, noted where it begins."""

    def __init__(self, forms: set[str]):
        self.forms = forms

    def __call__(self) -> None:
        if _recording:
            _recording[-1].update(self.forms)


def _augmented(does: Callable) -> Callable:
    def change(array: Any, index: Any, value: Any) -> None:
        array[index] = does(array[index], value)
    return change


_METHODS: dict[type, str] = {
    ast.Add: "add", ast.Sub: "sub", ast.Mult: "mul", ast.Div: "truediv", ast.FloorDiv: "floordiv", ast.Mod: "mod",
    ast.Pow: "pow", ast.MatMult: "matmul", ast.BitAnd: "and_", ast.BitOr: "or_", ast.BitXor: "xor",
    ast.LShift: "lshift", ast.RShift: "rshift", ast.USub: "neg", ast.UAdd: "pos", ast.Invert: "invert",
    ast.Not: "not_", ast.Eq: "eq", ast.NotEq: "ne", ast.Lt: "lt", ast.LtE: "le", ast.Gt: "gt", ast.GtE: "ge",
    ast.Is: "is_", ast.IsNot: "is_not"}


def _method(node: ast.AST) -> str | None:
    return _METHODS.get(type(node))


class _Instrument(ast.NodeTransformer):
    """Puts a site where something is done to operands; what it is done by stays the same."""

    def __init__(self) -> None:
        self.sites: list[Any] = []
        self.forms: set[str] = set()

    def _site(self, node: ast.AST, site: Any, *operands: ast.expr, keywords: list[ast.keyword] | None = None,
              does: str | ast.expr | None = None) -> Any:
        self.sites.append(site)
        place = ast.Subscript(ast.Name(_SITES, ast.Load()), ast.Constant(len(self.sites) - 1), ast.Load())
        if isinstance(does, str):
            self.sites.append(getattr(operator, does))
            does = ast.Subscript(ast.Name(_SITES, ast.Load()), ast.Constant(len(self.sites) - 1), ast.Load())
        return ast.copy_location(ast.Call(place, ([does] if does else []) + list(operands), keywords or []), node)

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.AST:
        node.decorator_list, node.returns = [], None
        self.generic_visit(node)
        node.body.insert(0, ast.copy_location(ast.Expr(self._site(node, _Forms(self.forms))), node))
        return ast.fix_missing_locations(node)      # once for all: each would look through all that is below

    def visit_Call(self, node: ast.Call) -> ast.AST:
        name = ast.unparse(node.func)
        if isinstance(node.func, ast.Attribute) and not (isinstance(node.func.value, ast.Name)
                                                         and node.func.value.id in ("np", "math")):
            name = f".{node.func.attr}"
        if any(isinstance(a, ast.Starred) for a in node.args) or any(k.arg is None for k in node.keywords):
            return node
        self.generic_visit(node)
        return self._site(node, Site("call", name), *node.args, keywords=node.keywords, does=node.func)

    def visit_BinOp(self, node: ast.BinOp) -> ast.AST:
        self.generic_visit(node)
        does = _METHODS[type(node.op)]
        return self._site(node, Site("operator", does), node.left, node.right, does=does)

    def visit_UnaryOp(self, node: ast.UnaryOp) -> ast.AST:
        self.generic_visit(node)
        does = _METHODS[type(node.op)]
        constant = isinstance(node.operand, ast.Constant)
        return node if constant else self._site(node, Site("operator", does), node.operand, does=does)

    def visit_Compare(self, node: ast.Compare) -> ast.AST:
        self.generic_visit(node)
        does = _method(node.ops[0])
        if len(node.ops) > 1 or does is None:
            self.forms.add("compared: " + " ".join(type(o).__name__ for o in node.ops))
            return node
        return self._site(node, Site("operator", does), node.left, node.comparators[0], does=does)

    def visit_Subscript(self, node: ast.Subscript) -> ast.AST:
        self.generic_visit(node)
        if not isinstance(node.ctx, ast.Load):
            return node
        return self._site(node, Site("subscript", "load"), node.value, _index(node.slice), does="getitem")

    def visit_Assign(self, node: ast.Assign) -> ast.AST:
        target = node.targets[0]
        self.generic_visit(node)
        if len(node.targets) == 1 and isinstance(target, ast.Subscript):
            stored = self._site(node, Site("subscript", "store"), target.value, _index(target.slice), node.value,
                                does="setitem")
            return ast.copy_location(ast.Expr(stored), node)
        self.forms.add(f"assigned: {' '.join(type(t).__name__ for t in node.targets)}")
        return node

    def visit_AugAssign(self, node: ast.AugAssign) -> ast.AST:
        self.generic_visit(node)
        does = "i" + _METHODS[type(node.op)].rstrip("_")
        if isinstance(node.target, ast.Subscript):
            self.sites.append(_augmented(getattr(operator, does)))
            change = ast.Subscript(ast.Name(_SITES, ast.Load()), ast.Constant(len(self.sites) - 1), ast.Load())
            changed = self._site(node, Site("subscript", does), node.target.value, _index(node.target.slice),
                                 node.value, does=change)
            return ast.copy_location(ast.Expr(changed), node)
        if isinstance(node.target, ast.Name):
            target = ast.copy_location(ast.Name(node.target.id, ast.Load()), node.target)
            value = self._site(node, Site("operator", does), target, node.value, does=does)
            return ast.copy_location(ast.Assign([node.target], value), node)
        return node

    def generic_visit(self, node: ast.AST) -> ast.AST:
        if isinstance(node, (ast.For, ast.While)):
            form = type(node).__name__ + (" else" if node.orelse else "")
            self.forms.add(form)
        elif isinstance(node, ast.Return):
            self.forms.add("Return Tuple" if isinstance(node.value, ast.Tuple) else "Return")
        elif isinstance(node, ast.If):
            self.forms.add("If else" if node.orelse else "If")
        elif isinstance(node, (ast.Break, ast.Continue, ast.Assert, ast.Raise, ast.IfExp, ast.BoolOp, ast.Pass)):
            self.forms.add(type(node).__name__)
        elif isinstance(node, ast.Attribute) and ast.unparse(node.value) not in ("np", "math"):
            self.forms.add(f".{node.attr}")
        return super().generic_visit(node)


def _index(node: ast.expr) -> ast.expr:
    """An index as an expression of its own: slices by their class."""
    if isinstance(node, ast.Slice):
        ends = [part or ast.Constant(None) for part in (node.lower, node.upper, node.step)]
        return ast.Call(ast.Name("slice", ast.Load()), ends, [])
    if isinstance(node, ast.Tuple):
        return ast.Tuple([_index(e) for e in node.elts], ast.Load())
    return node


def instrumented(function: FunctionType) -> FunctionType:
    """A function of a generated module that notes what it does; others as they are."""
    loader = function.__globals__.get("__loader__")
    if not isinstance(loader, module_loader._Loader):
        return function
    tree = ast.parse(loader.get_source(loader.name))
    if loader._guards:
        tree = module_loader._Raising(loader._guards).visit(tree)
    found = next((n for n in tree.body if isinstance(n, ast.FunctionDef) and n.name == function.__name__), None)
    if found is None:
        return function
    work = _Instrument()
    made = compile(ast.Module([work.visit(found)], []), function.__code__.co_filename, "exec", dont_inherit=True,
                   optimize=0)
    code = next(c for c in made.co_consts if isinstance(c, CodeType))
    name = f"{_SITES}{function.__name__}"
    function.__globals__[name] = work.sites
    code = code.replace(co_names=tuple(name if n == _SITES else n for n in code.co_names))
    return FunctionType(code, function.__globals__, function.__name__, function.__defaults__, function.__closure__)


@contextmanager
def recorded() -> Iterator[set[str]]:
    """The constructs of the texts for Numba that Python runs inside, whatever ran before."""
    found: set[str] = set()
    called, ran = PreparedCall.call, set()

    def with_first_run(call: PreparedCall, *args: Any) -> tuple[Any, ...]:
        """Runs the primal, too, also where another case of the same kernel has had its first run."""
        version = call.state, call.types
        if version not in ran:
            ran.add(version)
            call.state.entries.pop(("checked", call.types), None)
            call._ready.clear()
        return called(call, *args)
    _recording.append(found)
    PreparedCall.call = with_first_run
    try:
        yield found
    finally:
        PreparedCall.call = called
        _recording.pop()
