"""lambda_lifting: a function that is defined inside a kernel becomes one beside it, which is given what it reads of
the kernel.

    def f(u, a):                    def f(u, a):
        def g(x):                       return g(u[0], a=a) + g(u[1], a=a)
            return a * x
        h = lambda x: g(x) + 1.0    def g(x, *, a):
        return g(u[0]) + h(u[1])        return a * x

Python reads what such a function captures where it is called, and so is the argument. Requires a captured function;
what is defined in a loop or a branch, is defined twice, or is used as a value stays, to be refused.
"""
from __future__ import annotations

import itertools
from collections.abc import Callable, Hashable, Mapping
from dataclasses import dataclass, replace

from s2sad import tree
from s2sad.read.outside_values import AST, Captured, UserFunctionValue, Meaning, NotConstant, Surroundings
from s2sad.read.unique_names import with_plain_names
from s2sad.tree import FunctionDef


@dataclass(frozen=True)
class NestedFunction:
    """A definition inside a function."""
    definition: Captured

    def captured(self) -> Captured:
        return self.definition


class EnclosingNames:
    """The names around a function with nested ones."""

    def __init__(self, scope: Surroundings, inner: Mapping[str, Meaning]):
        self.scope, self.inner = scope, inner

    def lookup(self, name: str) -> Meaning | None:
        return self.inner.get(name) or self.scope.lookup(name)

    def known(self) -> list[str]:
        return [*self.inner, *self.scope.known()]

    def imported(self, module: str, level: int, name: str | None) -> Meaning:
        return self.scope.imported(module, level, name)


def lifted(captured: Captured, key: Hashable) -> Captured:
    """The function without its nested ones, which its scope has instead."""
    function = _with_names_for_lambdas(captured)
    if not any(_definition(s) is not None for s in getattr(function, "body", [])):
        return captured
    found = {d.name: d for s in function.body if (d := _definition(s)) is not None}
    found = {n: d for n, d in found.items() if _is_called_only(n, function)}
    captures = _captures(function, found)
    found = {n: found[n] for n in captures}
    inner: dict[str, UserFunctionValue] = {}
    scope = EnclosingNames(captured.scope, inner)
    found = {n: with_plain_names(d, captured.renamed, captures[n]) for n, d in found.items()}
    kept = {n: {captured.renamed[p]: p for p in _parameters(d) if p in captured.renamed} for n, d in found.items()}

    def by_keyword(node: AST) -> AST | None:
        return _by_keyword(node, kept, by_keyword)
    for name, definition in found.items():
        given = tree.rebuild(definition, by_keyword)
        given.args.kwonlyargs = [*given.args.kwonlyargs, *(tree.function("_", [c], []).args.args[0]
                                                           for c in captures[name])]
        given.args.kw_defaults = [*given.args.kw_defaults, *([None] * len(captures[name]))]
        inner[name] = UserFunctionValue(name, ("nested", key, name), "", NestedFunction(
            Captured(name, given, captured.source, scope, _default, captured.renamed)),
            tuple((c, c) for c in captures[name]))
    new = tree.rebuild(function, by_keyword)
    new.body = [s for s in new.body if (d := _definition(s)) is None or d.name not in found] or [
        tree.at(tree.Pass(), function)]
    return replace(captured, tree=new, scope=scope)


def _with_names_for_lambdas(captured: Captured) -> FunctionDef:
    """The function in which a lambda that is given to a call of a user's function has a name."""
    function = captured.tree
    nodes = _own(function) if isinstance(function, FunctionDef) else []
    if not any(type(n).__name__ == "Lambda" for n in nodes):
        return function
    nested = {d.name for s in function.body if (d := _definition(s)) is not None}
    given = [a for n in nodes if isinstance(n, tree.Call) and isinstance(n.func, tree.Name) and (
        n.func.id in nested or n.func.id not in _bound(function)
        and isinstance(captured.scope.lookup(n.func.id), UserFunctionValue))
        for a in (*n.args, *(k.value for k in n.keywords)) if type(a).__name__ == "Lambda"]
    taken = {n.id for n in tree.walk(function) if isinstance(n, tree.Name)}
    free = (n for n in (f"lambda_{k}" for k in itertools.count(1)) if n not in taken)
    named = {id(a): (next(free), a) for a in given}
    new = tree.copy(function)
    new.body = [tree.rebuild(s, lambda n: tree.at(tree.name(named[id(n)][0]), n) if id(n) in named else None)
                for s in function.body]
    new.body = [*(tree.at(tree.assign(n, a), a) for n, a in named.values()), *new.body]
    return new


def _definition(statement: AST) -> FunctionDef | None:
    """The function that a statement defines, with `def` or as a name for a lambda."""
    if type(statement).__name__ == "FunctionDef":
        return statement
    if isinstance(statement, tree.Assign) and len(statement.targets) == 1 and isinstance(
            statement.targets[0], tree.Name) and type(statement.value).__name__ == "Lambda":
        made = tree.function(statement.targets[0].id, [], [tree.at(tree.Return(statement.value.body), statement)])
        made.args = statement.value.args
        return tree.at(made, statement)
    return None


def _is_called_only(name: str, function: FunctionDef) -> bool:
    """Whether a name is bound once, by its definition, and otherwise called, or given to a call."""
    nodes = list(tree.walk(function))
    bound = [n for n in nodes if isinstance(n, tree.Name) and n.id == name and not isinstance(n.ctx, tree.Load)]
    defined = [n for n in nodes if type(n).__name__ == "FunctionDef" and n.name == name and n is not function]
    called = {id(part) for n in nodes if isinstance(n, tree.Call)
              for part in (n.func, *n.args, *(k.value for k in n.keywords))}
    loads = [n for n in nodes if isinstance(n, tree.Name) and n.id == name and isinstance(n.ctx, tree.Load)]
    return len(bound) + len(defined) == 1 and all(id(n) in called for n in loads)


def _captures(function: FunctionDef, found: dict[str, FunctionDef]) -> dict[str, list[str]]:
    """What each function reads of the kernel's own names, itself or through others that it calls; without those that
    have names of their own in the way."""
    local = _bound(function) - set(found)
    free = {n: _free(d) for n, d in found.items()}
    reads = {n: {f for f in names if f in local} for n, names in free.items()}
    while True:
        grown = {n: names | {c for other in free[n] if other in found for c in reads[other]}
                 for n, names in reads.items()}
        if grown == reads:
            break
        reads = grown
    order = [n.id for n in tree.walk(function) if isinstance(n, tree.Name)]
    clear = {n for n in found if not reads[n] & _bound(found[n])}
    while not all(free[n] & set(found) <= clear for n in clear):
        clear = {n for n in clear if free[n] & set(found) <= clear}
    return {n: sorted(reads[n], key=order.index) for n in found if n in clear}


def _parameters(function: FunctionDef) -> list[str]:
    given = function.args
    return [a.id for a in (*given.posonlyargs, *given.args, *given.kwonlyargs)]


def _by_keyword(node: AST, kept: Mapping[str, Mapping[str, str]], change: Callable[[AST], AST | None]) -> AST | None:
    """A call that gives parameters by keyword whose names are not the user's, as a captured variable has these."""
    known = kept.get(tree.call_name(node) or "")
    if not known or not any(k.arg in known for k in node.keywords):
        return None
    keywords = [tree.keyword(known.get(k.arg, k.arg), tree.rebuild(k.value, change)) for k in node.keywords]
    return tree.at(tree.Call(node.func, [tree.rebuild(a, change) for a in node.args], keywords), node)


def _own(function: FunctionDef) -> list[AST]:
    """The nodes of a function's body, without those inside nested functions."""
    waiting, found = list(reversed(function.body)), []
    while waiting:
        node = waiting.pop()
        found.append(node)
        if type(node).__name__ not in ("FunctionDef", "Lambda"):
            waiting += reversed(tree.children(node))
    return found


def _bound(function: FunctionDef) -> set[str]:
    """The names that a function binds itself."""
    nodes = _own(function)
    stored = {n.id for n in nodes if isinstance(n, tree.Name) and isinstance(n.ctx, tree.Store)}
    return {*_parameters(function)} | stored | {n.name for n in nodes if type(n).__name__ == "FunctionDef"}


def _free(function: FunctionDef) -> set[str]:
    """The names that a function reads from around it."""
    nodes = _own(function)
    found = {n.id for n in nodes if isinstance(n, tree.Name) and isinstance(n.ctx, tree.Load)}
    for node in nodes:
        if type(node).__name__ == "FunctionDef":
            found |= _free(node)
        elif type(node).__name__ == "Lambda":
            found |= {n.id for n in tree.walk(node.body) if isinstance(n, tree.Name)} - {
                a.id for a in node.args.args}
    return found - _bound(function)


def _default(parameter: str, node: AST) -> object:
    value, sign = node, 1
    if isinstance(value, tree.UnaryOp) and isinstance(value.op, tree.USub):
        value, sign = value.operand, -1
    if isinstance(value, tree.Constant) and type(value.value) in (int, float):
        return sign * value.value
    if isinstance(value, tree.Constant) and sign == 1 and (value.value is None or type(value.value) in (bool, str)):
        return value.value
    raise NotConstant
