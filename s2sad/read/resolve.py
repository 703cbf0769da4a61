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

import builtins
import difflib
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

from s2sad import rules, tree
from s2sad.diagnostics import Report
from s2sad.read import fence
from s2sad.read.handed import handed
from s2sad.read.meaning import (
    AST, BUILTIN_CALLS, Array, Captured, Function, Library, Meaning, Number, Record, Space, Text, Unusable, dotted,
    library_value,
)
from s2sad.read.modules import dropped_decorator
from s2sad.rules.given import GIVEN, ROOM
from s2sad.rules.spellings import is_scipy
from s2sad.tree import FunctionDef


@dataclass
class Resolved:
    """A kernel's tree with resolved names; the functions it calls with the first place of each; its own names."""
    tree: FunctionDef
    parameters: tuple[str, ...]
    locals: frozenset[str]
    calls: list[tuple[Function, AST]] = field(default_factory=list)
    references: set[str] = field(default_factory=set)


Identify = Callable[["Function | Number | Array | Record"], str]


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


def _decorator(decorator: AST, captured: Captured, report: Report) -> None:
    node = decorator.func if isinstance(decorator, tree.Call) else decorator
    parts = _path(node)
    meaning = captured.scope.lookup(parts[0]) if parts else None
    for part in parts[1:]:
        meaning = meaning.scope.lookup(part) if isinstance(meaning, Space) else None
    unknown = meaning is None and parts and parts[-1] in ("jit", "njit", "differentiate")
    if not unknown and not dropped_decorator(dotted(meaning) or ""):
        text = ".".join(parts) or "..."
        report.error("S201", f"the decorator @{text} is not supported on a kernel", decorator,
                     help="take it off, and wrap the kernel elsewhere under another name; Numba's jit and njit are "
                     "fine")


def _path(node: AST) -> list[str]:
    """`a.b.c` as a list; empty for anything else."""
    if isinstance(node, tree.Name):
        return [node.id]
    base = _path(node.value) if isinstance(node, tree.Attribute) else []
    return [*base, node.attr] if base else []


class _Resolver:
    """One kernel's walk; `change` is what `tree.rebuild` asks at every node."""

    def __init__(self, captured: Captured, report: Report, identify: Identify, local: set[str]):
        self.scope, self.report, self.identify, self.local = captured.scope, report, identify, local
        self.calls: list[tuple[Function, AST]] = []
        self.references: set[str] = set()
        self.called: set[int] = set()
        self.raised: set[int] = set()
        self.said: set[str] = set()

    def change(self, node: AST) -> AST | None:
        if fence.opaque(node):
            return node
        if isinstance(node, tree.AnnAssign):
            plain = tree.Pass() if node.value is None else tree.Assign([node.target], node.value, None)
            return tree.rebuild(tree.at(plain, node), self.change)
        if isinstance(node, tree.Call):
            return self._call(node)
        if isinstance(node, tree.Raise) and node.exc is not None:
            self.raised.add(id(node.exc.func if isinstance(node.exc, tree.Call) else node.exc))
        if isinstance(node, (tree.Name, tree.Attribute)) and not isinstance(node.ctx, tree.Store):
            return self._path(node)
        return None

    def _call(self, node: tree.Call) -> AST | None:
        self.called.add(id(node.func))
        if isinstance(node.func, tree.Name) and node.func.id in self.local:
            self._refuse(f"a call through the variable '{node.func.id}' is not supported in a kernel", node,
                         help="call a function of the module by its name")
        elif not isinstance(node.func, (tree.Name, tree.Attribute)):
            self._refuse("a call of what an expression gives is not supported in a kernel", node,
                         help="call a function of the module by its name")
        else:
            return self._functions_given(node)
        return None

    def _functions_given(self, node: tree.Call) -> AST | None:
        """A call of a user's function that is given functions, or captures names of the kernel, made plain."""
        callee = self._function_meant(node.func)
        if not isinstance(callee, Function) or rules.result_kind(callee.path) is not None:
            return None
        arguments = [*enumerate(node.args), *((k.arg, k.value) for k in node.keywords)]
        given = {k: f for k, a in arguments if (f := self._function_meant(a)) is not None}
        made = handed(node, callee, given) if given else None
        if made is None and not callee.given:
            return None
        callee, plain = made or (callee, node)
        path = self._function(node.func, callee, callee.name, True)
        captured = [tree.keyword(k, tree.at(tree.name(n), node)) for k, n in callee.given]
        new = tree.Call(tree.at(tree.name(path), node.func), plain.args, [*plain.keywords, *captured])
        new.args = [tree.rebuild(a, self.change) for a in new.args]
        new.keywords = [tree.keyword(k.arg, tree.rebuild(k.value, self.change)) for k in new.keywords]
        return tree.at(new, node)

    def _function_meant(self, node: AST) -> Function | Library | None:
        """The function of the user's or of NumPy's or Python's mathematics that a name or path means."""
        parts = _path(node)
        if not parts or parts[0] in self.local:
            return None
        meaning: Meaning | None = self.scope.lookup(parts[0])
        for part in parts[1:]:
            meaning = _member(meaning, part) if isinstance(meaning, Space) else None
        if isinstance(meaning, Library) and meaning.path.startswith(("numpy.", "math.")):
            value = library_value(meaning.path)
            return meaning if callable(value) and not isinstance(value, type) else None
        return meaning if isinstance(meaning, Function) else None

    def _refuse(self, message: str, node: AST, help: str) -> None:
        self.report.error("S201", message, node, help=help)

    # -- paths --------------------------------------------------------------------------------------------------------

    def _path(self, node: AST) -> AST | None:
        parts = _path(node)
        if not parts or parts[0] in self.local:
            return None
        meaning: Meaning | None = self.scope.lookup(parts[0])
        if meaning is None:
            return self._unknown(node, parts, 0, [*sorted(self.local), *self.scope.known(), *BUILTIN_CALLS])
        taken = 1
        while taken < len(parts) and isinstance(meaning, (Space, Library)):
            inner = _member(meaning, parts[taken])
            if inner is None:
                known = meaning.scope.known() if isinstance(meaning, Space) else []
                return self._unknown(node, parts, taken, known)
            meaning, taken = inner, taken + 1
        if taken == len(parts):
            return self._reference(node, meaning, ".".join(parts))
        if isinstance(meaning, (Number, Array)):
            return None  # `table.shape`: the name below is resolved on its own
        if isinstance(meaning, Text):
            self._refuse("a method of a string is not supported in a kernel", node, "write the string out")
        elif isinstance(meaning, Unusable):
            return self._reference(node, meaning, ".".join(parts[:taken]))
        else:
            self._refuse(f"an attribute of the function '{'.'.join(parts[:taken])}' is not supported in a kernel", node,
                         "call the function itself")
        return tree.copy(node)

    def _unknown(self, node: AST, parts: list[str], at: int, known: list[str]) -> AST:
        text, owner = ".".join(parts[:at + 1]), ".".join(parts[:at])
        if text not in self.said:
            self.said.add(text)
            close = difflib.get_close_matches(parts[at], known, 1, 0.7)
            help = f"did you mean '{owner + '.' if owner else ''}{close[0]}'?" if close else (
                "give it a value in the kernel, define it at module level, or pass it as an argument" if not owner else
                f"define it in '{owner}', or correct the name")
            message = f"'{owner}' has no '{parts[at]}'" if owner else f"the name '{text}' is not known"
            place = node
            while isinstance(place, tree.Attribute) and not owner:
                place = place.value
            self.report.error("S202", message, place, help=help)
        return tree.copy(node)

    # -- references ---------------------------------------------------------------------------------------------------

    def _reference(self, node: AST, meaning: Meaning, text: str) -> AST:
        if isinstance(meaning, Text):
            return tree.at(tree.Constant(meaning.value, None), node)
        called = id(node) in self.called
        path = self._given(node, dotted(meaning), text)
        if isinstance(meaning, Function):
            path = self._function(node, meaning, text, called)
        elif isinstance(meaning, Record):
            path = self.identify(meaning)
            self.references.add(path)
            if not called:
                self._refuse(f"the class '{text}' as a value is not supported in a kernel", node,
                             f"make one: {text}(...)")
        elif isinstance(meaning, (Number, Array)):
            path = self.identify(meaning)
            self.references.add(path)
            if called:
                word = "a number" if isinstance(meaning, Number) else "an array"
                self._refuse(f"'{text}' is {word}, not a function", node, "correct the name, or subscript with []")
        elif isinstance(meaning, Unusable):
            if text not in self.said:
                self._refuse(f"'{text}' cannot be used in a kernel: it is {meaning.what}", node, meaning.help)
            self.said.add(text)
        elif path is not None and rules.result_kind(path) is None:
            self._library(node, meaning, path, text, called)
        elif path is not None and not called and not isinstance(library_value(path), type):
            self._as_value(node, text)
        return tree.copy(node) if path is None else tree.at(tree.name(path), node)

    def _given(self, node: AST, path: str | None, text: str) -> str | None:
        """The path of what a library has, `given.` before it if the user gave it a derivative."""
        given = None if path is None else GIVEN.named(path) or GIVEN.of(library_value(path))
        if given is not None:
            path = ROOM + given.path
        if path is None or not path.startswith(ROOM):
            return path
        lost = [g for g in GIVEN.closure([path[len(ROOM):]]) if not g.reachable()]
        for given in lost:
            module, _, last = given.path.rpartition(".")
            self._refuse(f"'{text}' has a derivative of its own, but 'from {module} import {last}' does not give "
                         f"{'it' if given.path == path[len(ROOM):] else repr(last) + ', which its derivative calls'}",
                         node, "define it at module level, and register it again when it was defined anew")
        return path

    def _as_value(self, node: AST, text: str) -> None:
        self._refuse(f"the function '{text}' as a value is not supported in a kernel", node,
                     "call it where it is needed")

    def _function(self, node: AST, meaning: Function, text: str, called: bool) -> str:
        if rules.result_kind(meaning.path) is not None:
            return meaning.path
        path = self.identify(meaning)
        self.references.add(path)
        if not called:
            self._as_value(node, text)
        elif all(meaning.key != known.key for known, _ in self.calls):
            self.calls.append((meaning, node))
        return path

    def _library(self, node: AST, meaning: Meaning, path: str, text: str, called: bool) -> None:
        root, _, rest = path.partition(".")
        if root == "builtins":
            self._builtin(node, rest, called)
        elif root == "scipy" and is_scipy(path):
            if not called:
                self._as_value(node, text)
        elif root not in ("numpy", "math", "runtime") and (called or rest):
            self._refuse(f"'{text}' is not a function that s2sad can read", node, "write it with numpy and math, or "
                         f"give its derivative: s2sad.rule(\"{path}(x)\", x=...)")
        elif isinstance(meaning, Space):
            self._refuse(f"the module '{text}' as a value is not supported in a kernel", node, "name what is in it")
        elif root in ("numpy", "math"):
            value = library_value(path)
            if called and not callable(value):
                self._refuse(f"'{text}' is a number, not a function", node, "correct the name")
            elif not called and callable(value) and not isinstance(value, type):
                self._as_value(node, text)

    def _builtin(self, node: AST, word: str, called: bool) -> None:
        value = getattr(builtins, word, None)
        if id(node) in self.raised and isinstance(value, type) and issubclass(value, Exception):
            return
        if word in BUILTIN_CALLS:
            if not called and word not in ("int", "float", "bool"):
                self._as_value(node, word)
            return
        self._refuse(f"the built-in '{word}' is not supported in a kernel", node, _BUILTIN_HELP.get(
            word, f"these are: {', '.join(BUILTIN_CALLS)}"))


_BUILTIN_HELP = {
    "divmod": "write a // b and a % b",
    "complex": "keep the real and the imaginary part in two names",
    "any": "write a for loop with an if, or np.any of an array",
    "all": "write a for loop with an if, or np.all of an array",
    "sorted": "sort before the kernel is called, and pass the sorted array or the order",
    "list": "allocate an array with np.empty or np.zeros",
    "tuple": "write the elements out: (a, b)",
    "isinstance": "write one kernel for each type",
    "map": "write a for loop",
    "filter": "write a for loop with an if",
}


def _member(meaning: Space | Library, name: str) -> Meaning | None:
    if isinstance(meaning, Space):
        return meaning.scope.lookup(name)
    path = f"{meaning.path}.{name}"
    value = library_value(meaning.path)
    return Library(path) if value is None or hasattr(value, name) else None
