"""Which names carry what a function returns, when it returns in several places."""
from __future__ import annotations

from s2sad.evaluate.argument_binding import result_count, user_call
from s2sad.evaluate.completion import FALL, bound_after, completion
from s2sad.evaluate.scope import KernelScope
from s2sad.tree import (
    AST, BinOp, BoolOp, Compare, Constant, Div, For, FunctionDef, Name, Not, Return, Tuple, UnaryOp, assign, at,
    call_name, const, copy, dump, name, stored_names, tuple_of, unset, walk, walk_statements,
)

DONE = "jump.done"                      # what a return returns whose value is in the result names already


class ReturnVariables:
    """The result names of one function; `store` gives the assignments that a return becomes."""

    def __init__(self, function: FunctionDef, scope: KernelScope):
        self._scope = scope
        self._returns = [node for node in walk_statements(function.body) if isinstance(node, Return)]
        self._valued = [node for node in self._returns if node.value is not None]
        self._check_paths(function)
        lengths = [self._length(node.value) for node in self._valued]
        for node, length in zip(self._valued, lengths):
            if length != lengths[0]:
                scope.refuse(node, "returns with different numbers of values", help="return as many on every path")
        self._is_tuple = bool(lengths) and lengths[0] is not None
        self.single = len(self._returns) == 1 and function.body[-1:] == self._returns
        self.names = self._named() if self._valued and not self.single else []

    def _check_paths(self, function: FunctionDef) -> None:
        if not self._valued:
            return
        for node in self._returns:
            if node.value is None:
                self._scope.refuse(node, "a result that is sometimes None and sometimes a value",
                                   help="return a value on every path, or on none")
        if FALL in completion(function.body):
            self._scope.refuse(self._valued[0], "a result that is None where the function ends without a return",
                               help="end the function with a return of a value")

    def _length(self, value: AST) -> int | None:
        """The number of results of a tuple, or None for a single value."""
        if isinstance(value, Tuple):
            return len(value.elts)
        kernel = user_call(value)
        count = result_count(kernel, self._scope.program) if kernel is not None else 1
        return count if count > 1 else None

    def _named(self) -> list[str]:
        """One name per result: the user's, where every return returns that same name."""
        if not self._is_tuple:
            columns = [[node.value for node in self._valued]]
        elif all(isinstance(node.value, Tuple) for node in self._valued):
            columns = [list(c) for c in zip(*(node.value.elts for node in self._valued))]
        else:
            columns = [[Constant(None, None)]] * (self._length(self._valued[0].value) or 1)
        found: list[str] = []
        for position, column in enumerate(columns):
            shared = isinstance(column[0], Name) and "." not in column[0].id and len({dump(v) for v in column}) == 1
            if shared and column[0].id not in found:
                found.append(column[0].id)
            else:
                found.append(self._scope.fresh(f"result_{position}" if self._is_tuple else "result"))
        return found

    def store(self, node: Return) -> list[AST]:
        """The assignments of the result names at one return."""
        value = node.value
        if value is None or (isinstance(value, Name) and value.id == DONE):
            return []
        if not self._is_tuple:
            return self._assigned(self.names[0], value, node)
        if isinstance(value, Tuple):
            return [s for n, v in zip(self.names, value.elts) for s in self._assigned(n, v, node)]
        return [at(assign(tuple_of(*map(name, self.names)), value), node)]

    def _assigned(self, identifier: str, value: AST, node: Return) -> list[AST]:
        same = isinstance(value, Name) and value.id == identifier
        return [] if same else [at(assign(identifier, value), node)]

    def end(self, node: AST) -> Return:
        """The function's only return."""
        values: list[AST] = [name(n) for n in self.names]
        value = None if not values else tuple_of(*values) if self._is_tuple else values[0]
        return at(Return(value), node)

    def with_initial_values(self, body: list[AST], parameters: list[str], node: AST) -> list[AST]:
        """The body; a result that the structure alone does not show to be bound starts as zero.

        Every path binds it before it is returned (else the function would return None there), so the zero is
        never the result.
        """
        bound = bound_after(body, frozenset(parameters))
        missing = [n for n in self.names if bound is not None and n not in bound]
        for identifier in reversed(missing):
            place = next((k for k, s in enumerate(body) if identifier in stored_names(s)), 0)
            zero = self._zero(identifier, body)
            body = [*body[:place], at(assign(identifier, unset(zero.value)), node), *body[place:]]
        return body

    def _zero(self, identifier: str, body: list[AST]) -> AST:
        """False, 0 or 0.0, whichever fits everything that the name is bound to."""
        counters = {n for s in walk_statements(body) if isinstance(s, For) and call_name(s.iter) == "builtins.range"
                    for n in stored_names(s.target)}
        bound = [s.value for s in walk(body) if identifier in (getattr(t, "id", "") for t in getattr(s, "targets", []))]
        if bound and all(map(_boolean, bound)):
            return const(False)
        if bound and all(_integer(v, counters) for v in bound):
            return const(0)
        return const(0.0)


def final_return(node: Return, scope: KernelScope) -> list[AST]:
    """A return at the end of the function, kept; the call that it returns gets a name."""
    kernel = user_call(node.value) if node.value is not None else None
    if node.value is None or kernel is None:
        return [node]
    count = result_count(kernel, scope.program)
    targets = [scope.fresh("result")] if count == 1 else [scope.fresh(f"result_{k}") for k in range(count)]
    results = [name(t) for t in targets]
    left = results[0] if count == 1 else tuple_of(*results)
    return [at(assign(left, node.value), node), at(Return(copy(left)), node)]


def _boolean(value: AST) -> bool:
    if isinstance(value, BoolOp):
        return all(map(_boolean, value.values))
    return isinstance(value, Compare) or isinstance(value, Constant) and isinstance(value.value, bool) or (
        isinstance(value, UnaryOp) and isinstance(value.op, Not))


def _integer(value: AST, counters: set[str]) -> bool:
    if isinstance(value, Constant):
        return isinstance(value.value, int)
    if isinstance(value, Name):
        return value.id in counters
    if isinstance(value, BinOp):
        whole = not isinstance(value.op, Div)
        return whole and _integer(value.left, counters) and _integer(value.right, counters)
    if isinstance(value, UnaryOp):
        return _integer(value.operand, counters)
    return call_name(value) in ("builtins.len", "builtins.int")
