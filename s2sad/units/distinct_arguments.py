"""distinct_arguments: the functions of a module that are never given memory twice.

    def f(u, v, i):             f, for Python's calls are checked
        w = np.empty(u.size)
        g(u, w)                 g
        h(v[i], v[i + 1])       h, where 0 <= i: other rows
        x = u.T
        k(u, x)                 not k, nor what k calls

*Requires* the functions of a module, and the types of their names by function; a name without a type may be an array's.
*Establishes* the names of those functions of which no two arrays share memory: their loops may be transformed, and
compiled, as if what is stored under one name were read under no other.
"""
from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence, Set
from itertools import combinations

from s2sad.blocks import heads
from s2sad.infer.types import Type
from s2sad.liveness import targets
from s2sad.optimize.loop_bounds import are_apart, least_counter
from s2sad.tree import (
    AST, Attribute, BinOp, BoolOp, Call, Compare, Constant, For, FunctionDef, Name, Return, Slice, Starred, Subscript,
    UnaryOp, call_name, children, indices, stored_names, user_call, walk, walk_statements,
)

_NEW = frozenset({"numpy.empty", "numpy.zeros", "numpy.ones", "numpy.full", "numpy.arange", "numpy.empty_like",
        "numpy.zeros_like", "numpy.ones_like", "numpy.full_like", "numpy.copy", "numpy.dot", "numpy.matmul",
        "runtime.allocate", "runtime.allocate_zeros"})    # parts of an arena lie behind each other
_VALUES = (BinOp, UnaryOp, BoolOp, Compare, Constant)
Table = Mapping[str, Type]


def distinct_arguments(functions: Sequence[FunctionDef], types: Mapping[str, Table]) -> set[str]:
    """The names of the functions, callees first, that no other one gives memory twice."""
    called = {f.name: {c for n in walk(f.body) if (c := user_call(n))} for f in functions}
    parameters = {f.name: [types.get(f.name, {}).get(p.id) for p in f.args.args] for f in functions}
    new, waiting = _NEW, list[str]()
    for function in functions:
        memory = _Memory(function, types.get(function.name, {}), new)
        waiting += memory.aliased(parameters)
        new = new if memory.is_handed_back() else new | {f"user.{function.name}"}
    aliased: set[str] = set()
    while waiting:
        found = waiting.pop()
        if found not in aliased:
            aliased.add(found)
            waiting += called.get(found, ())
    return set(called) - aliased


class _Memory:
    """Whose memory the names of a function mean; the results of calls of what is `new` are in nobody else's."""

    def __init__(self, function: FunctionDef, table: Table, new: Set[str]):
        self.function, self.table, self.new = function, table, new
        self.owners = {p.id: {p.id} for p in function.args.args}
        found = None
        while found != (found := sum(map(len, self.owners.values()))):
            for statement in walk_statements(function.body):
                value = statement.iter if isinstance(statement, For) else getattr(statement, "value", None)
                bound = [n for t in targets(statement) for n in stored_names(t) if self.may_be_array(n)]
                if value is not None and bound:
                    of = self.of(value) | ({bound[0]} if len(bound) > 1 and call_name(value) not in _NEW else set())
                    for identifier in bound:
                        self.owners.setdefault(identifier, set()).update(of or {identifier})

    def of(self, node: AST) -> set[str]:
        """The parameters and new arrays in whose memory the value of an expression may lie."""
        if isinstance(node, Name):
            is_own = "." not in node.id
            return self.owners.get(node.id, {node.id} if is_own else set()) if self.may_be_array(node.id) else set()
        if isinstance(node, _VALUES) or call_name(node) in self.new or isinstance(
                node, Attribute) and node.attr == "shape":
            return set()
        if isinstance(node, Subscript):
            return set() if self.is_element(node) else self.of(node.value)
        return set().union(*map(self.of, children(node)))

    def may_be_array(self, identifier: str) -> bool:
        kind = self.table.get(identifier)
        return kind is None or not kind.is_number

    def is_element(self, node: Subscript) -> bool:
        kind = self.table.get(node.value.id) if isinstance(node.value, Name) else None
        return kind is not None and kind.is_array and len(indices(node)) == kind.rank and not any(
            isinstance(i, Slice) or isinstance(i, Constant) and i.value in (None, ...) for i in indices(node))

    def is_handed_back(self) -> bool:
        """Whether what the function returns may lie in what it is given."""
        return any(self.of(s.value) & {p.id for p in self.function.args.args}
                   for s in walk_statements(self.function.body) if isinstance(s, Return) and s.value is not None)

    def aliased(self, parameters: Mapping[str, Sequence[Type | None]]) -> Iterator[str]:
        """What the function gives memory twice, or hands to others, who may."""
        for call, least in _calls(self.function.body, {}):
            for given in (*call.args, *(k.value for k in call.keywords)):
                if isinstance(given, Name) and given.id.startswith("user."):
                    yield given.id.removeprefix("user.")
            callee = user_call(call)
            if callee is None:
                continue
            kinds = [*parameters.get(callee, ()), *[None] * len(call.args)]
            arrays = [(a, self.of(a)) for a, kind in zip(call.args, kinds) if kind is None or not kind.is_number]
            is_open = call.keywords or any(isinstance(a, Starred) for a in call.args)
            if is_open or any(m & n and not _are_rows_apart(a, b, least)
                                    for (a, m), (b, n) in combinations(arrays, 2)):
                yield callee


def _are_rows_apart(a: AST, b: AST, least: Mapping[str, int]) -> bool:
    return isinstance(a, Subscript) and isinstance(b, Subscript) and isinstance(a.value, Name) and isinstance(
        b.value, Name) and a.value.id == b.value.id and are_apart(a, b, least)


def _calls(block: list[AST], least: Mapping[str, int]) -> Iterator[tuple[Call, Mapping[str, int]]]:
    """The calls of a block, with the least numbers of the counters around them."""
    for statement in block:
        for head in heads(statement):
            yield from ((n, least) for n in walk(head) if isinstance(n, Call))
        counts = isinstance(statement, For) and call_name(statement.iter) == "builtins.range"
        first = least_counter(statement) if counts else None
        inner = {**least, statement.target.id: first} if first is not None else least
        for body in (getattr(statement, "body", []), getattr(statement, "orelse", [])):
            yield from _calls(body, inner)
