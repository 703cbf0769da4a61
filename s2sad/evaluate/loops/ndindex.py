"""`for i, j in np.ndindex(x.shape)` becomes nested loops, `x[index]` under one name becomes `x[index_0, index_1]`."""
from __future__ import annotations

from collections.abc import Callable

from s2sad.evaluate.completion import BREAK, completion
from s2sad.evaluate.expressions.hoist import constant_index
from s2sad.evaluate.scope import KernelScope
from s2sad.evaluate.expressions.unpack import unpack
from s2sad.tree import (
    AST, Attribute, Break, For, If, List, Name, Starred, Subscript, Tuple, assign, at, call_name, const, copy,
    counted_for, index, name, names, rebuild, stored_names, tuple_of,
)


def is_index_loop(node: For) -> bool:
    return call_name(node.iter) == "numpy.ndindex"


class IndexLoops:
    """One loop over np.ndindex; `copied` are the names that cannot count."""

    def __init__(self, node: For, scope: KernelScope, hold: Callable[[AST, str], AST], copied: set[str]):
        self._node, self._scope, self._hold, self._copied = node, scope, hold, copied

    def nested(self, body: list[AST], before: list[AST], read_later: bool) -> list[AST]:
        """The nested loops; `before` is filled with what is held, which the caller does not add again."""
        target = self._node.target
        extents = self._extents()
        if not extents:
            return []
        if isinstance(target, Name):
            counters = [self._scope.fresh(f"{target.id}_{k}") for k in range(len(extents))]
            body = self._spread(body, target.id, counters, read_later)
        else:
            direct = [isinstance(t, Name) and t.id not in self._copied for t in target.elts]
            counters = [t.id if d else self._scope.fresh(f"{t.id}_index" if isinstance(t, Name) else "index")
                        for t, d in zip(target.elts, direct)]
            bound = [(t, name(c)) for t, c, d in zip(target.elts, counters, direct) if not d]
            body = [*(at(s, self._node) for t, v in bound for s in unpack([t], v, self._scope)), *body]
        return [*before, *self._loops(counters, extents, body)] if body else before

    def _loops(self, counters: list[str], extents: list[AST], body: list[AST]) -> list[AST]:
        several = len(counters) > 1 and BREAK in completion(body)
        stopped = self._scope.fresh("stopped") if several else ""
        inner: list[AST] = _stopping(body, stopped) if several else body
        for position in range(len(counters) - 1, -1, -1):
            loop = counted_for(counters[position], [extents[position]], inner)
            inner = [loop, If(name(stopped), [Break()], [])] if several and position else [loop]
        return [*([assign(stopped, const(False))] if several else []), *inner]

    def _extents(self) -> list[AST]:
        """The length of every axis; empty, and a diagnostic, where their number is not known."""
        given, target = self._node.iter.args, self._node.target
        rank = len(target.elts) if isinstance(target, (Tuple, List)) else 0
        only = given[0] if len(given) == 1 else None
        shape = only.value if isinstance(only, Starred) else only
        if isinstance(shape, (Tuple, List)):
            given = shape.elts
        elif isinstance(only, Starred) or _is_shape(only) or (only is not None and rank > 1):
            given = [index(copy(shape), const(k)) for k in range(rank)]
        if not given or (rank and rank != len(given)) or any(isinstance(g, Starred) for g in given):
            self._scope.refuse(self._node.iter, "np.ndindex over an unknown number of axes",
                               help="name the indices: for i, j in np.ndindex(x.shape)")
            return []
        return [self._hold(g, "stop") for g in given]

    def _spread(self, body: list[AST], identifier: str, counters: list[str], read_later: bool) -> list[AST]:
        """The body with `x[index]` and `index[0]` in terms of the counters."""
        def change(node: AST) -> AST | None:
            if not isinstance(node, Subscript):
                return None
            if isinstance(node.value, Name) and node.value.id == identifier:
                position = constant_index(node)
                if position is None or not -len(counters) <= position < len(counters):
                    return None
                return at(name(counters[position]), node)
            if isinstance(node.slice, Name) and node.slice.id == identifier:
                where = tuple_of(*map(name, counters)) if len(counters) > 1 else name(counters[0])
                return at(Subscript(rebuild(node.value, change), where, node.ctx), node)
            return None
        new = [rebuild(statement, change) for statement in body]
        if read_later or identifier in names(new) or identifier in stored_names(new):
            self._scope.refuse(self._node.target, f"the index {identifier!r} is used other than as a subscript",
                               help="name the indices: for i, j in np.ndindex(...)")
        return new


def _is_shape(node: AST | None) -> bool:
    return isinstance(node, Attribute) and node.attr == "shape"


def _stopping(statements: list[AST], flag: str) -> list[AST]:
    """Every break sets a flag first, for the loops around."""
    new: list[AST] = []
    for node in statements:
        if isinstance(node, Break):
            new += [at(assign(flag, const(True)), node), node]
        elif isinstance(node, If):
            new.append(at(If(node.test, _stopping(node.body, flag), _stopping(node.orelse, flag)), node))
        else:
            new.append(node)
    return new
