"""live_range_splitting: a name that is bound to values of several types is several names, where no path takes one
for the other.

    def f(x, y):                def f(x, y):
        r = x[:] - y[:]             r = x[:] - y[:]
        r = np.sum(r * r)           r_2 = np.sum(r * r)
        return r                    return r_2

Requires structured form; establishes one type for each name. A binding and all uses that it reaches are one live range;
the first one keeps the name. What is bound to several types in one live range is left for `infer` to refuse, but for
numbers that become arrays in a loop (`control/peel_first_iteration.py`), for arrays of float32 and of float64, which
are of float64, and for what a branch binds to one type on each side (`control/types_by_branch.py`).
"""
from __future__ import annotations

from collections.abc import Mapping

from s2sad.diagnostics import Report
from s2sad.infer.inference import inference
from s2sad.infer.types import Type
from s2sad.infer.call_types import CallTypes
from s2sad.naming import Names
from s2sad.normalize.context import NormalContext
from s2sad.normalize.control.peel_first_iteration import peel_first_iteration
from s2sad.normalize.control.types_by_branch import MOST, types_by_branch
from s2sad.tree import (
    AST, Assign, AugAssign, Break, Continue, For, FunctionDef, If, Name, Raise, Return, Store, While, rebuild, walk,
)

State = dict[str, frozenset[int]]   # the bindings that each name may have


def live_range_splitting(function: FunctionDef, context: NormalContext) -> FunctionDef:
    """The function with those names; the context has the types of all."""
    context.pending = Report(context.report.source)
    function, table = split_live_ranges(function, context.given, context.callees.call_types, context.pending,
                                        context.constants, context.names)
    context.typing = context.typed(table, Report(context.report.source))
    return function


def split_live_ranges(function: FunctionDef, types: Mapping[str, Type], call_types: CallTypes, report: Report,
                      constants: Mapping[str, object], free: Names) -> tuple[FunctionDef, Mapping[str, Type]]:
    """The function with those names, and the types of them all."""
    wider, begun, duplicated = False, False, 0
    refused = None      # as it was before statements were duplicated
    while True:
        said, conflicting = Report(report.source), set[str]()
        table = inference(function, types, call_types, said, constants, conflicting, wider)
        new = LiveRanges(function, conflicting).split(free) if conflicting else None
        if new is None and conflicting and not begun:
            new, begun = peel_first_iteration(function, conflicting, free), True
        if new is None and conflicting and wider and duplicated <= MOST and (
                apart := types_by_branch(function, conflicting, free)) is not None:
            refused = refused or (function, table, said)
            new, duplicated = apart[0], duplicated + apart[1]
        if new is None and (wider or not conflicting):
            function, table, said = refused if refused and conflicting else (function, table, said)
            report.found += said.found
            return function, table
        wider = wider or new is None
        function = new or function


class LiveRanges:
    """The live ranges of some names: each binding is known by its node, `joined` leads to one of the same range."""

    def __init__(self, function: FunctionDef, conflicting: set[str]):
        self.function = function
        self.joined: dict[int, int] = {}
        self.exits: list[list[State]] = []      # of the loops around, by `break`
        self.next_trips: list[list[State]] = []     # by `continue`
        given = {p.id: frozenset({id(p)}) for p in function.args.args if p.id in conflicting}
        self.conflicting = conflicting
        self.block(function.body, given)

    def split(self, free: Names) -> FunctionDef | None:
        """The function with a name for each live range; None if each name has one alone."""
        first: dict[str, int] = {
            p.id: self.live_range(id(p)) for p in self.function.args.args if p.id in self.conflicting}
        called: dict[int, str] = {}
        for node in walk(self.function.body):
            if isinstance(node, Name) and node.id in self.conflicting:
                live_range = self.live_range(id(node))
                if first.setdefault(node.id, live_range) != live_range and live_range not in called:
                    called[live_range] = free.numbered(node.id)
        if not called:
            return None

        def change(node: AST) -> AST | None:
            is_split = isinstance(node, Name) and node.id in self.conflicting
            new = called.get(self.live_range(id(node))) if is_split else None
            if new is None:
                return None
            made = rebuild(node, lambda n: None)
            made.id = new
            return made
        return rebuild(self.function, change)

    def live_range(self, binding: int) -> int:
        while self.joined.get(binding, binding) != binding:
            binding = self.joined[binding]
        return binding

    def join(self, node: Name, bindings: frozenset[int]) -> None:
        """A use of a name and the bindings that reach it are of one live range."""
        for binding in bindings:
            self.joined[self.live_range(binding)] = self.live_range(id(node))

    def read(self, node: AST | None, state: State) -> None:
        for n in walk(node) if node is not None else ():
            if isinstance(n, Name) and n.id in state and not isinstance(n.ctx, Store):
                self.join(n, state[n.id])

    def bind(self, target: AST, state: State) -> State:
        made = {n.id: frozenset({id(n)}) for n in walk(target)
                if isinstance(n, Name) and isinstance(n.ctx, Store) and n.id in self.conflicting}
        return {**state, **made}

    def block(self, block: list[AST], state: State | None) -> State | None:
        """The state after statements; None where none is reached."""
        for statement in block:
            if state is None:
                return None
            state = self.statement(statement, state)
        return state

    def statement(self, statement: AST, state: State) -> State | None:
        if isinstance(statement, Assign):
            self.read(statement.value, state)
            self.read(statement.targets[0], state)
            return self.bind(statement.targets[0], state)
        if isinstance(statement, If):
            self.read(statement.test, state)
            return _either(self.block(statement.body, state), self.block(statement.orelse, state))
        if isinstance(statement, (For, While)):
            return self.loop(statement, state)
        if isinstance(statement, Break):
            self.exits[-1].append(state)
            return None
        if isinstance(statement, Continue):
            self.next_trips[-1].append(state)
            return None
        self.read(statement, state)
        if isinstance(statement, AugAssign) and isinstance(statement.target, Name):
            self.join(statement.target, state.get(statement.target.id, frozenset()))
        return None if isinstance(statement, (Return, Raise)) else state

    def loop(self, loop: For | While, state: State) -> State | None:
        if isinstance(loop, For):
            self.read(loop.iter, state)
        left: list[State] = []
        while True:
            if isinstance(loop, While):
                self.read(loop.test, state)
            self.exits.append(left)
            self.next_trips.append([])
            after = self.block(loop.body, self.bind(loop.target, state) if isinstance(loop, For) else state)
            self.exits.pop()
            for early in self.next_trips.pop():
                after = _either(after, early)
            grown = _either(state, after)
            if grown == state:
                break
            state = grown or state
        for early in left:
            state = _either(state, early) or state
        return state


def _either(a: State | None, b: State | None) -> State | None:
    if a is None or b is None:
        return b if a is None else a
    return {n: a.get(n, frozenset()) | b.get(n, frozenset()) for n in {**a, **b}}
