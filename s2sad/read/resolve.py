"""Names get their meaning: what is outside a kernel becomes a dotted name, what is local stays as it is.

    import numpy as np                     def f(x):
    G = 9.81                       ->          np = x[0]
    def f(x):                                  return np * const.G + numpy.exp(x[1])
        np = x[0]                          (were `np` not local: np.exp -> numpy.exp)
        return np * G + exp(x[1])

Requires a captured function; shows what is unknown or cannot be used in the report. User's functions, numbers and
arrays get the ids that `identify` gives; `link` names them at the end.
"""
from __future__ import annotations

import difflib
from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy

from s2sad import rules, tree
from s2sad.diagnostics import Report
from s2sad.read import supported_subset
from s2sad.read.outside_values import (
    AST, BUILTIN_CALLS, Array, Captured, UserFunctionValue, Namespace, Library, Matrix, Meaning, Number, ModuleValue,
    StringValue, Unusable, dotted, library_value,
)
from s2sad.read.file_definitions import dropped_decorator
from s2sad.read.outside_names import ITERATORS, Identify, OutsideNames
from s2sad.tree import FunctionDef


@dataclass
class Resolved:
    """A kernel's tree with resolved names; the functions it calls with the first place of each; its own names."""
    tree: FunctionDef
    parameters: tuple[str, ...]
    locals: frozenset[str]
    calls: list[tuple[UserFunctionValue, AST]] = field(default_factory=list)
    references: set[str] = field(default_factory=set)


def resolve(captured: Captured, report: Report, identify: Identify) -> Resolved:
    """The kernel with plain positional parameters, its names resolved; decorators are judged and dropped."""
    function = captured.tree
    for decorator in function.decorator_list:
        _decorator(decorator, captured, report)
    given = function.args
    parameters = [a.id for a in (*given.posonlyargs, *given.args, *given.kwonlyargs)]
    local = {*parameters, *(s.id for s in (given.vararg, given.kwarg) if s is not None), *_bound(function.body)}
    pass_ = _Resolver(captured, report, identify, local)
    body = [tree.rebuild(statement, pass_.change) for statement in function.body]
    new = tree.at(tree.function(function.name, parameters, body), function)
    return Resolved(new, tuple(parameters), frozenset(local), pass_.calls, pass_.references)


def _bound(body: list[AST]) -> Iterable[str]:
    """The names that a body binds; constructs that are refused bind theirs too, so that only one error is shown."""
    yield from tree.stored_names(body)
    for node in tree.walk(body):
        if type(node).__name__ in ("Import", "ImportFrom"):
            yield from (alias.asname or alias.name.partition(".")[0] for alias in node.names)
        elif type(node).__name__ in ("FunctionDef", "AsyncFunctionDef", "ClassDef", "ExceptHandler", "MatchAs"):
            yield from [node.name] if node.name else []


_TAKEN_OFF = ("jit", "njit", "differentiate", "gradient", "value_and_gradient")    # where their names mean nothing


def _decorator(decorator: AST, captured: Captured, report: Report) -> None:
    node = decorator.func if isinstance(decorator, tree.Call) else decorator
    parts = _path(node)
    meaning = captured.scope.lookup(parts[0]) if parts else None
    for part in parts[1:]:
        meaning = meaning.scope.lookup(part) if isinstance(meaning, ModuleValue) else None
    unknown = meaning is None and parts and parts[-1] in _TAKEN_OFF
    if not unknown and not dropped_decorator(dotted(meaning) or ""):
        text = ".".join(parts) or "..."
        report.error("S201", f"the decorator @{text} is not supported on a kernel", decorator,
                     help="take it off, and wrap the kernel elsewhere under another name; Numba's jit and njit are "
                     "fine")


def _path(node: AST) -> list[str]:
    """`a.b["c"]` as a list, items in brackets; empty for anything else."""
    if isinstance(node, tree.Name):
        return [node.id]
    if isinstance(node, tree.Subscript) and isinstance(node.slice, tree.Constant) and isinstance(node.slice.value, str):
        base, last = _path(node.value), f"[{node.slice.value}]"
    else:
        base, last = (_path(node.value), node.attr) if isinstance(node, tree.Attribute) else ([], "")
    return [*base, last] if base else []


def _spelled(parts: list[str]) -> str:
    """A path as one writes it: a.b['c']."""
    return "".join(f"[{p[1:-1]!r}]" if p.startswith("[") else f".{p}" if k else p for k, p in enumerate(parts))


class _Resolver(OutsideNames):
    """One kernel's walk; `change` is what `tree.rebuild` asks at every node."""

    def __init__(self, captured: Captured, report: Report, identify: Identify, local: set[str]):
        self.scope, self.report, self.identify, self.local = captured.scope, report, identify, local
        self.calls: list[tuple[UserFunctionValue, AST]] = []
        self.references: set[str] = set()
        self.called: set[int] = set()
        self.raised: set[int] = set()
        self.said: set[str] = set()
        self.picked: dict[int, int] = {}
        self.looped: set[int] = set()
        self.stored: set[int] = set()
        self.exponents: set[int] = set()
        self.rows: set[int] = set()

    def library(self, node: AST) -> str | None:
        """The path of the library's function that a name or path means."""
        parts = _path(node)
        meaning: Meaning | None = self.scope.lookup(parts[0]) if parts and parts[0] not in self.local else None
        for part in parts[1:]:
            meaning = _member(meaning, part) if isinstance(meaning, (ModuleValue, Library)) else None
        return dotted(meaning)

    def change(self, node: AST) -> AST | None:
        if supported_subset.opaque(node):
            return node
        if isinstance(node, tree.AnnAssign):
            plain = tree.Pass() if node.value is None else tree.Assign([node.target], node.value, None)
            return tree.rebuild(tree.at(plain, node), self.change)
        power = isinstance(node, tree.BinOp) and isinstance(node.op, tree.Pow)
        if power or isinstance(node, (tree.Assign, tree.For, tree.GeneratorExp, tree.ListComp, tree.Subscript)):
            self._pick(node)
        if isinstance(node, tree.Call):
            return self._call(node)
        if isinstance(node, tree.Attribute) and (limit := self._limit(node)) is not None:
            return limit
        if isinstance(node, tree.Raise) and node.exc is not None:
            self.raised.add(id(node.exc.func if isinstance(node.exc, tree.Call) else node.exc))
        if isinstance(node, (tree.Name, tree.Attribute, tree.Subscript)) and not isinstance(node.ctx, tree.Store):
            return self._path(node)
        return None

    def _limit(self, node: tree.Attribute) -> AST | None:
        """What NumPy says of a type of numbers: `np.finfo(float).eps`, with the type of numbers that NumPy gives it."""
        called = node.value
        path = self.library(called.func) if isinstance(called, tree.Call) else None
        if path not in ("numpy.finfo", "numpy.iinfo") or len(called.args) != 1 or called.keywords:
            return None
        kind = library_value(self.library(called.args[0]) or "")
        if kind not in (float, int, numpy.float64, numpy.int64, numpy.float32, numpy.int32):
            return None
        value = getattr(library_value(path)(kind), node.attr, None)
        if type(value) is int:
            return tree.at(tree.const(value), node)
        if not isinstance(value, numpy.floating) or value.dtype.itemsize not in (4, 8):
            return None
        return tree.at(tree.call(f"numpy.{type(value).__name__}", tree.const(float(value))), node)

    def _call(self, node: tree.Call) -> AST | None:
        if self.library(node.func) in ("math.modf", "numpy.modf") and len(node.args) == 1 and _is_repeatable(
                node.args[0]):
            return self._split(node)
        if len(node.args) == 1 and node.keywords and self._replaces(node.func):
            method = tree.at(tree.attribute(node.args[0], "__replace__"), node.func)
            return tree.at(tree.rebuild(tree.Call(method, [], node.keywords), self.change), node)
        self.called.add(id(node.func))
        if isinstance(self._function_meant(node.func), Library) or isinstance(
                node.func, tree.Name) and node.func.id in ("len", *ITERATORS):
            self._pick(node)
        if self.library(node.func) == "builtins.dict" and node.keywords and not node.args:
            keys = [tree.at(tree.const(k.arg), k.value) for k in node.keywords]
            values = [tree.rebuild(k.value, self.change) for k in node.keywords]
            return tree.at(tree.Dict(keys, values), node)
        if self.library(node.func) == "builtins.isinstance" and self._is_class_of_none(node.args[1:]):
            return tree.at(tree.compare(tree.rebuild(node.args[0], self.change), tree.Is(), tree.const(None)), node)
        if isinstance(node.func, tree.Name) and node.func.id in self.local:
            self._refuse(f"a call through the variable '{node.func.id}' is not supported in a kernel", node,
                         help="call a function of the module by its name")
        elif not isinstance(node.func, (tree.Name, tree.Attribute)) and self._function_meant(node.func) is None:
            self._refuse("a call of what an expression gives is not supported in a kernel", node,
                         help="call a function of the module by its name")
        else:
            return self._functions_given(node)
        return None

    def _is_class_of_none(self, given: list[AST]) -> bool:
        """Whether what is given is `type(None)`."""
        asked = given[0] if len(given) == 1 else None
        return isinstance(asked, tree.Call) and self.library(asked.func) == "builtins.type" and not asked.keywords and (
            len(asked.args) == 1 and isinstance(asked.args[0], tree.Constant) and asked.args[0].value is None)

    def _replaces(self, node: AST) -> bool:
        """Whether a function is the one that makes a structure with other fields of another."""
        meant = self._function_meant(node)
        return isinstance(meant, UserFunctionValue) and meant.path in ("dataclasses.replace", "copy.replace")

    def _split(self, node: tree.Call) -> AST:
        """A number's part behind the point and the part before it."""
        whole = [tree.call("numpy.trunc", tree.rebuild(node.args[0], self.change)) for _ in range(2)]
        rest = tree.BinOp(tree.rebuild(node.args[0], self.change), tree.Sub(), whole[0])
        return tree.at(tree.tuple_of(rest, whole[1]), node)

    def _functions_given(self, node: tree.Call) -> AST | None:
        """A call of a user's function that is given functions, or captures names of the kernel, made plain."""
        callee = self._function_meant(node.func)
        if not isinstance(callee, UserFunctionValue) or rules.result_kind(callee.path) is not None:
            return None
        arguments = [*node.args, *(k.value for k in node.keywords)]
        for a in arguments:
            if self._function_meant(a) is not None:
                self.report.error("S201", "a function is given to a function", a)
        return None

    def _function_meant(self, node: AST) -> UserFunctionValue | Library | None:
        """The function of the user's or of NumPy's or Python's mathematics that a name or path means."""
        parts = _path(node)
        if not parts or parts[0] in self.local:
            return None
        meaning: Meaning | None = self.scope.lookup(parts[0])
        for part in parts[1:]:
            meaning = _member(meaning, part) if isinstance(meaning, ModuleValue) else None
        if isinstance(meaning, Library) and meaning.path.startswith(("numpy.", "math.")):
            value = library_value(meaning.path)
            return meaning if callable(value) and not isinstance(value, type) else None
        if isinstance(meaning, Namespace):
            meaning = meaning.scope.lookup("__call__")
        return meaning if isinstance(meaning, UserFunctionValue) else None

    # -- paths --------------------------------------------------------------------------------------------------------

    def _path(self, node: AST) -> AST | None:
        parts = _path(node)
        if not parts or parts[0] in self.local:
            return None
        meaning: Meaning | None = self.scope.lookup(parts[0])
        if meaning is None:
            return self._unknown(node, parts, 0, [*sorted(self.local), *self.scope.known(), *BUILTIN_CALLS])
        taken = 1
        while taken < len(parts) and isinstance(meaning, (ModuleValue, Library)):
            inner = _member(meaning, parts[taken])
            if inner is None:
                known = meaning.scope.known() if isinstance(meaning, ModuleValue) else []
                return self._unknown(node, parts, taken, known)
            meaning, taken = inner, taken + 1
        if taken == len(parts):
            return self._reference(node, meaning, _spelled(parts))
        if isinstance(meaning, (Number, Array, Matrix)):
            return None  # `table.shape`: the name below is resolved on its own
        if isinstance(meaning, StringValue):
            self._refuse("a method of a string is not supported in a kernel", node, "write the string out")
        elif isinstance(meaning, Unusable):
            return self._reference(node, meaning, _spelled(parts[:taken]))
        else:
            self._refuse(f"an attribute of the function '{_spelled(parts[:taken])}' is not supported in a kernel", node,
                         "call the function itself")
        return tree.copy(node)

    def _unknown(self, node: AST, parts: list[str], at: int, known: list[str]) -> AST:
        text, owner = _spelled(parts[:at + 1]), _spelled(parts[:at])
        if text not in self.said:
            self.said.add(text)
            close = difflib.get_close_matches(parts[at], known, 1, 0.7)
            help = f"did you mean '{_spelled([*parts[:at], close[0]])}'?" if close else (
                "give it a value in the kernel, define it at module level, or pass it as an argument" if not owner else
                f"define it in '{owner}', or correct the name")
            message = f"'{owner}' has no '{parts[at].strip('[]')}'" if owner else f"the name '{text}' is not known"
            place = node
            while isinstance(place, tree.Attribute) and not owner:
                place = place.value
            self.report.error("S202", message, place, help=help)
        return tree.copy(node)


def _member(meaning: ModuleValue | Library, name: str) -> Meaning | None:
    if isinstance(meaning, ModuleValue):
        return meaning.scope.lookup(name)
    path = f"{meaning.path}.{name}"
    value = library_value(meaning.path)
    return Library(path) if value is None or hasattr(value, name) else None


def _is_repeatable(node: AST) -> bool:
    """Whether an expression may be computed several times."""
    kinds = (tree.Constant, tree.Name, tree.Subscript, tree.Attribute, tree.Tuple, tree.BinOp, tree.UnaryOp, tree.Slice)
    return all(isinstance(n, kinds) or not isinstance(n, tree.expr) for n in tree.walk(node))
