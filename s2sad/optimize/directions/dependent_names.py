"""dependent_names: what of a module differs from one direction to the next, if shadows and seeds of its entry do.

    def f_tangent(y, y_dot, x, x_dot):      y_dot and x_dot are given; t_dot follows, t does not
        t = x[0] * 2.0
        t_dot = 2.0 * x_dot[0]
        y_dot[0] = t_dot * t

A name depends on the direction where it is bound to what does, or is bound in a branch that a direction chooses; an
array where such is stored into it, or into what shares its memory. The size of an array is no content of it.
"""
from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from s2sad.infer.types import Type
from s2sad.liveness import base_name, targets
from s2sad.tree import (
    AST, Assert, Assign, Attribute, AugAssign, Break, Call, Expr, For, FunctionDef, If, Name, Raise, Return, Store,
    Subscript, Tuple, While, call_name, children, user_call, walk,
)

Types = Mapping[str, Mapping[str, Type]]
SIZES = ("shape", "size", "dtype", "ndim", "flags")
OF_SIZES = {"builtins.len", "numpy.shape", "numpy.size", "numpy.ndim", "numpy.zeros_like", "numpy.empty_like",
            "numpy.ones_like"}
_VIEWS = {"numpy.reshape", "numpy.transpose", "numpy.ravel", "numpy.asarray", "numpy.swapaxes", "numpy.moveaxis"}


class OneByOne(Exception):
    """Why a derivative is called for one direction at a time."""


@dataclass
class Dependence:
    """By function: the names that depend on the direction, the results that do, and (by identity) the statements that
    run for one direction as a whole, with their blocks."""
    functions: Mapping[str, FunctionDef]
    types: Types
    names: dict[str, set[str]] = field(default_factory=dict)
    results: dict[str, set[int]] = field(default_factory=dict)
    whole: set[int] = field(default_factory=set)

    def parameters(self, title: str) -> list[str]:
        return [p.id for p in self.functions[title].args.args]

    def is_batched(self, title: str) -> bool:
        """Whether anything of a function depends on the direction."""
        return bool(self.names[title])


def dependent_names(functions: Iterable[FunctionDef], entry: str, given: Iterable[str], types: Types) -> Dependence:
    """What depends on the direction where the parameters `given` of the entry do; raises OneByOne where a primal
    does."""
    found = Dependence({f.name: f for f in functions}, types)
    for title in found.functions:
        found.names[title], found.results[title] = set(), set()
    found.names[entry] |= {*given}
    found.results[entry] |= {k for s in found.functions[entry].body if isinstance(s, Return)
                             for k in range(len(returned(s)))}      # also what is zero for all
    count = -1
    while count != (count := sum(map(len, (*found.names.values(), *found.results.values(), found.whole)))):
        for title in found.functions:
            _Function(found, title).grow()
    changed = sorted({*found.parameters(entry)} & found.names[entry] - {*given})
    if changed:
        raise OneByOne(f"'{changed[0]}' holds what depends on the direction")
    return found


class _Function:
    """One round through one function."""

    def __init__(self, module: Dependence, title: str):
        self.module, self.title = module, title
        self.dependent, self.kinds = module.names[title], module.types.get(title, {})

    def grow(self) -> None:
        for statement in self.module.functions[self.title].body:
            self.statement(statement, False)

    def depends(self, node: AST) -> bool:
        return reads(node, self.dependent)

    def statement(self, statement: AST, inside: bool) -> None:
        """Of a statement, `inside` one that runs for one direction."""
        if isinstance(statement, (If, For, While)):
            test = statement.iter if isinstance(statement, For) else statement.test
            inside = inside or self.depends(test) or id(statement) in self.module.whole
            for inner in (*statement.body, *statement.orelse):
                self.statement(inner, inside)
                if isinstance(statement, (For, While)) and not inside and self.leaves(inner):
                    inside = True
            if inside:
                self.module.whole.add(id(statement))
        elif isinstance(statement, Return):
            parts = returned(statement)
            self.module.results[self.title] |= {k for k, p in enumerate(parts) if self.depends(p) or inside}
        elif user_call(getattr(statement, "value", None)) in self.module.functions:
            self.call(statement, inside)
        elif isinstance(statement, (Assign, AugAssign)):
            self.bind(statement, inside)
        elif isinstance(statement, Expr) and isinstance(statement.value, Call) and statement.value.args:
            if self.depends(statement.value):        # it may write what it is given first
                self.dependent.add(base_name(statement.value.args[0]))

    def leaves(self, statement: AST) -> bool:
        """Whether a statement of a loop's body ends the loop where a direction says so."""
        return isinstance(statement, If) and any(
            isinstance(s, If) and id(s) in self.module.whole and any(isinstance(b, Break) for b in (*s.body, *s.orelse))
            for s in _outside_loops(statement))

    def bind(self, statement: AST, inside: bool) -> None:
        value = statement.value
        depends = inside or self.depends(value)
        for target in targets(statement):
            base = base_name(target)
            if depends or isinstance(target, Subscript) and self.depends(target.slice):
                self.dependent.add(base)
            kind = self.kinds.get(base)
            shared = base_name(_viewed(value))
            if isinstance(target, Name) and kind is not None and kind.is_array and shared and (
                    base in self.dependent and isinstance(statement, Assign)):
                self.dependent.add(shared)

    def call(self, statement: AST, inside: bool) -> None:
        called = statement.value
        title = user_call(called) or ""
        theirs, kinds = self.module.names[title], self.module.types.get(title, {})
        for parameter, argument in zip(self.module.parameters(title), called.args):
            if inside or self.depends(argument):
                theirs.add(parameter)
            kind = kinds.get(parameter)
            if parameter in theirs and kind is not None and kind.is_array and base_name(argument):
                self.dependent.add(base_name(argument))
        for k, target in enumerate(targets(statement)):
            if inside or k in self.module.results[title]:
                self.dependent.add(base_name(target))


def returned(statement: Return) -> list[AST]:
    """The values that a function returns."""
    if statement.value is None:
        return []
    return list(statement.value.elts) if isinstance(statement.value, Tuple) else [statement.value]


def _outside_loops(statement: AST) -> list[AST]:
    """The statements of a branch that are in no loop of it."""
    if not isinstance(statement, If):
        return [statement]
    return [statement, *(s for inner in (*statement.body, *statement.orelse) for s in _outside_loops(inner))]


def _viewed(value: AST) -> AST:
    """What an expression may be a view of."""
    while True:
        if isinstance(value, Call) and call_name(value) in _VIEWS and value.args:
            value = value.args[0]
        elif isinstance(value, Attribute) and value.attr == "T":
            value = value.value
        else:
            return value


def reads(node: AST, dependent: set[str]) -> bool:
    """Whether an expression reads what names of a set hold; the sizes of arrays are not that."""
    waiting = [node]
    while waiting:
        part = waiting.pop()
        if isinstance(part, Name):
            if part.id in dependent and not isinstance(part.ctx, Store):
                return True
            continue
        base = (part.value if isinstance(part, Attribute) and part.attr in SIZES else
                part.args[0] if isinstance(part, Call) and call_name(part) in OF_SIZES and part.args else None)
        if isinstance(base, (Name, Subscript)) and base_name(base):
            while isinstance(base, Subscript):
                waiting.append(base.slice)
                base = base.value
            waiting += [a for a in getattr(part, "args", [])[1:]] if isinstance(part, Call) else []
        else:
            waiting += children(part)
    return False


def touches(statement: AST, dependent: set[str]) -> bool:
    """Whether a simple statement reads or writes what depends on the direction."""
    values = [statement.value] if isinstance(statement, (Assign, AugAssign, Expr)) else (
        [statement.test] if isinstance(statement, Assert) else [statement.exc] if isinstance(statement, Raise) else [])
    return any(base_name(t) in dependent for t in targets(statement)) or any(
        v is not None and reads(v, dependent) for v in values)


def mentioned(node: AST, dependent: set[str]) -> bool:
    """Whether an expression or a statement has such a name at all."""
    return any(isinstance(n, Name) and n.id in dependent for n in walk(node))

