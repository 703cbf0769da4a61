"""Every `for` counts: `for name in range(...)`, the name bound nowhere else and not read after the loop.

    def f(u: float64[:], v: float64[:], n: int64):      def f(u, v, n):
        i = 0                                               i = 0
        for i in range(n):                                  stop = n
            n = n - 1                                       for i_index in range(stop):
            u[i] = v[n]                                         i = i_index
        return u[i]                                             n = n - 1
                                                                u[i] = v[n]
                                                            return u[i]

*Requires* what `single_exit` establishes, and loops over ranges. *Establishes* that every loop has a counter of its
own: bounds that the body changes are held in names before the loop.
"""
from __future__ import annotations

from s2sad.evaluate.effects import parameters
from s2sad.evaluate.live_after_loops import live_after_loops
from s2sad.evaluate.scope import KernelScope
from s2sad.tree import (
    AST, Assign, AugAssign, For, FunctionDef, If, While, assign, at, counted_for, function, name, names, stored_names,
    walk_statements,
)


def counted_loops(tree: FunctionDef, scope: KernelScope) -> FunctionDef:
    scope.begin(tree)
    return at(function(tree.name, parameters(tree), _Loops(tree, scope).block(tree.body)), tree)


class _Loops:
    """The loops of one function; names in `_copied` cannot be counters."""

    def __init__(self, tree: FunctionDef, scope: KernelScope):
        self._scope, self._copied = scope, _copied(tree)

    def block(self, statements: list[AST]) -> list[AST]:
        new: list[AST] = []
        for node in statements:
            if isinstance(node, If):
                new.append(at(If(node.test, self.block(node.body), self.block(node.orelse)), node))
            elif isinstance(node, While):
                new.append(at(While(node.test, self.block(node.body), []), node))
            elif isinstance(node, For):
                new += [at(s, node) for s in self._for(node)]
            else:
                new.append(node)
        return new

    def _for(self, node: For) -> list[AST]:
        body, before, counter = self.block(node.body), list[AST](), node.target.id
        roles = ["stop"] if len(node.iter.args) == 1 else ["start", "stop", "step"]
        bounds = [self._kept(b, wanted, node, before) for b, wanted in zip(node.iter.args, roles)]
        if counter in self._copied:
            counter = self._scope.fresh(f"{counter}_index")
            body = [at(assign(node.target.id, name(counter)), node), *body]
        return [*before, counted_for(counter, bounds, body)] if body else before

    def _kept(self, bound: AST, wanted: str, loop: For, before: list[AST]) -> AST:
        """What keeps a bound's value throughout the loop: itself, or a name before it."""
        stored = {*stored_names(loop.body), *stored_names(loop.target)}
        changes = stored & {*names(bound)} or self._scope.memory.affected(bound, self._scope.memory.written(loop.body))
        return self._scope.held(bound, wanted, before) if changes else bound


def _copied(tree: FunctionDef) -> set[str]:
    """The names that something other than a loop's count binds, or that are read after their loop."""
    found, live = set(parameters(tree)), live_after_loops(tree.body)
    for node in walk_statements(tree.body):
        if isinstance(node, (Assign, AugAssign)):
            found |= set(stored_names(node))
        elif isinstance(node, For) and node.target.id in live[id(node)] | set(stored_names(node.body)):
            found.add(node.target.id)
    return found
