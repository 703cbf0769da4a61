"""unique_names: every variable of a function and of the scopes inside it has a name of its own (alpha-renaming).

    for w, b in layers:                         for w, b in layers:
        x = np.tanh(w * x + b)                      x = np.tanh(w * x + b)
    return sum(np.sum(w) for w, b in layers)    return sum(np.sum(w_2) for w_2, b_2 in layers)

    t = [w * x for w in w]                      t = [w_2 * x for w_2 in w]

Comprehensions, lambdas and nested functions have scopes, resolved as Python does: what a comprehension goes through
first is evaluated around it, `:=` binds in the function. So no later pass has to know scopes, and none can take one
variable for another. The function's own variables, and what it reads from outside, keep their names; a variable of an
inner scope keeps its name where nothing else in the function has it. Comes before every other pass.
"""
from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace

from s2sad import tree
from s2sad.read.outside_values import AST, Captured
from s2sad.tree import FunctionDef, Name

_COMPREHENSIONS = ("ListComp", "GeneratorExp", "SetComp", "DictComp")
_UNREAD = ("Global", "Nonlocal", "ClassDef", "Match")       # the fence refuses them


def unique_names(captured: Captured) -> Captured:
    """The function with a name for each variable; `renamed` tells what the user calls those with a new one."""
    function = captured.tree
    if not isinstance(function, FunctionDef):
        return captured
    kinds = {type(n).__name__ for s in function.body for n in tree.walk(s)}
    if not kinds & {*_COMPREHENSIONS, "Lambda", "FunctionDef"} or kinds & set(_UNREAD):
        return captured
    new = tree.copy(function)
    scopes = _Scopes()
    outer = scopes.of_function(new, None)
    renamed = scopes.rename(outer)
    if not renamed:
        return captured
    return replace(captured, tree=new, renamed={**captured.renamed, **renamed},
                   source=replace(captured.source, renamed=(*captured.source.renamed, *renamed.items())))


@dataclass(eq=False)
class _Scope:
    """The variables that a function, a lambda or a comprehension binds, and where it mentions names."""
    parent: _Scope | None
    home: _Scope | None = None          # the function around a comprehension, in which `:=` binds
    bound: dict[str, list[AST]] = field(default_factory=dict)
    mentions: list[AST] = field(default_factory=list)

    def owner(self, identifier: str) -> _Scope | None:
        """The scope whose variable a name is here; None for what is outside of all."""
        scope: _Scope | None = self
        while scope is not None and identifier not in scope.bound:
            scope = scope.parent
        return scope


class _Scopes:
    """The scopes of one function in the order of the text, the function's own first."""

    def __init__(self) -> None:
        self.all: list[_Scope] = []

    def of_function(self, node: AST, parent: _Scope | None) -> _Scope:
        scope = self._made(parent, None)
        given = node.args
        for parameter in (*given.posonlyargs, *given.args, given.vararg, *given.kwonlyargs, given.kwarg):
            if parameter is not None:
                self._collect(parameter, scope)
        self._all(node.body if isinstance(node.body, list) else [node.body], scope)
        return scope

    def _made(self, parent: _Scope | None, home: _Scope | None) -> _Scope:
        self.all.append(made := _Scope(parent, home))
        return made

    def _all(self, nodes: Iterable[AST | None], scope: _Scope) -> None:
        for node in nodes:
            if node is not None:
                self._collect(node, scope)

    def _collect(self, node: AST, scope: _Scope) -> None:
        """Takes down what a part of the text binds and mentions."""
        waiting = [(node, scope)]
        while waiting:
            node, scope = waiting.pop()
            kind = type(node).__name__
            if isinstance(node, Name):
                self._mention(node, scope)
            elif kind in _COMPREHENSIONS:
                self._comprehension(node, scope)
            elif kind in ("FunctionDef", "AsyncFunctionDef", "Lambda"):
                if kind != "Lambda":
                    scope.bound.setdefault(node.name, []).append(node)
                    self._all([*node.decorator_list, node.returns], scope)
                self._all([*node.args.defaults, *node.args.kw_defaults], scope)
                self.of_function(node, scope)
            elif kind == "NamedExpr":
                self._mention(node.target, scope.home or scope)
                waiting.append((node.value, scope))
            elif kind in ("Import", "ImportFrom"):
                for alias in node.names:
                    scope.bound.setdefault(alias.asname or alias.name.partition(".")[0], [])
            else:
                waiting += [(child, scope) for child in reversed(tree.children(node))]

    def _mention(self, node: AST, scope: _Scope) -> None:
        if not isinstance(node.ctx, tree.Load):
            scope.bound.setdefault(node.id, [])
        scope.mentions.append(node)

    def _comprehension(self, node: AST, scope: _Scope) -> None:
        first = node.generators[0]
        self._collect(first.iter, scope)
        inner = self._made(scope, scope.home or scope)
        for generator in node.generators:
            self._collect(generator.target, inner)
            if generator is not first:
                self._collect(generator.iter, inner)
            self._all(generator.ifs, inner)
        items = [node.key, node.value] if hasattr(node, "key") else [node.elt]
        self._all(items, inner)

    def rename(self, outer: _Scope) -> dict[str, str]:
        """Gives the variables of inner scopes names of their own, in place; those that are new, with the old ones."""
        owned = [(node, scope.owner(node.id)) for scope in self.all for node in scope.mentions]
        known = {node.id for node, _ in owned} | {n for scope in self.all for n in scope.bound}
        taken = {*outer.bound, *(node.id for node, owner in owned if owner is None)}
        made: dict[tuple[int, str], str] = {}
        renamed: dict[str, str] = {}
        for scope in self.all:
            for identifier in scope.bound if scope is not outer else ():
                new = identifier
                if identifier in taken:
                    new = _fresh(identifier, known)
                    made[id(scope), identifier], renamed[new] = new, identifier
                taken.add(new)
        for scope in self.all:
            for identifier, definitions in scope.bound.items():
                for node in definitions:
                    node.name = made.get((id(scope), identifier), node.name)
        for node, owner in owned:
            node.id = made.get((id(owner), node.id), node.id)
        return renamed


def _fresh(wanted: str, known: set[str]) -> str:
    number, base = 2, wanted
    while f"{base}_{number}" in known:
        number += 1
    known.add(f"{base}_{number}")
    return f"{base}_{number}"
