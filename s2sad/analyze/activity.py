"""activity: which names carry derivatives from the independents to the dependents.

Requires normal form; establishes `varied` (depends differentiably on an independent), `useful` (a dependent depends
differentiably on it) and `active`, both. (Hascoet, Naumann, Pascual, FGCS 21, 2005.)
Numbers are bound once, so one set a function is exact for them; an array is one variable for its whole life.
"""
from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from s2sad.liveness import base_name, targets
from s2sad.analyze.context import AnalysisContext
from s2sad.analyze.uses import sources
from s2sad.diagnostics import Report
from s2sad.infer.inference import Typing
from s2sad.tree import (
    AST, Assign, AugAssign, Call, Expr, FunctionDef, List, Return, Tuple, user_call, walk, walk_statements,
)

CallEdges = Callable[[Call], list[tuple[int, "int | str"]]]


@dataclass(frozen=True)
class Activity:
    """The verdicts; `edges` lists (from, to) with the result of the function as "return 0", "return 1", ..."""
    varied: frozenset[str]
    useful: frozenset[str]
    edges: tuple[tuple[str, str], ...]

    @property
    def active(self) -> frozenset[str]:
        return self.varied & self.useful

    def verdict(self, name: str) -> str:
        if name in self.varied:
            return "active" if name in self.useful else "inactive: it reaches no output"
        return "inactive: it does not depend on an input"


def activity(function: FunctionDef, context: AnalysisContext) -> None:
    """Leaves the table for the inputs and outputs of the request in `context.activity`."""
    request = context.request
    context.activity = activity_of(function, context.typing, set(request.wrt), set(request.of),
                                   context.calls.call_edges)


def activity_of(function: FunctionDef, typing: Typing, independents: set[str], dependents: set[str],
                call_edges: CallEdges) -> Activity:
    """The table for one function and one choice of inputs and outputs ("return k" are the results)."""
    edges = tuple(dict.fromkeys(_edges(function, typing, call_edges)))
    forwards: dict[str, list[str]] = {}
    backwards: dict[str, list[str]] = {}
    for a, b in edges:
        forwards.setdefault(a, []).append(b)
        backwards.setdefault(b, []).append(a)
    varied = reach(forwards, independents)
    _refuse_tuples(function, typing, varied)
    return Activity(frozenset(varied), frozenset(reach(backwards, dependents)), edges)


def _refuse_tuples(function: FunctionDef, typing: Typing, varied: set[str]) -> None:
    """Raises where a tuple of values that vary is bound, passed to a kernel or returned: its derivative would be
    lost."""
    for statement in walk(function.body):
        values = []
        if isinstance(statement, (Assign, AugAssign, Expr)):
            values = statement.value.args if user_call(statement.value) else [statement.value]
        elif isinstance(statement, Return) and statement.value is not None:
            values = statement.value.elts if isinstance(statement.value, Tuple) else [statement.value]
        for value in values:
            if isinstance(value, (Tuple, List)) and not varied.isdisjoint(_in_tuple(value, typing)):
                report = Report(typing.report.source)
                report.error("S201", "values with derivatives stay together in a tuple or a list here", statement,
                             help="give its items names, or put them into an array: np.array([...])")
                report.finish()


def _in_tuple(node: AST, typing: Typing) -> Iterator[str]:
    """The names on which the items of a tuple depend differentiably."""
    for item in node.elts if isinstance(node, (Tuple, List)) else ():
        yield from _in_tuple(item, typing) if isinstance(item, (Tuple, List)) else sources(item, typing)


def reach(arrows: dict[str, list[str]], start: set[str]) -> set[str]:
    """Everything that can be reached, the start included."""
    seen, waiting = set(start), sorted(start)
    while waiting:
        for name in arrows.get(waiting.pop(), []):
            if name not in seen:
                seen.add(name)
                waiting.append(name)
    return seen


def _edges(function: FunctionDef, typing: Typing, call_edges: CallEdges) -> Iterator[tuple[str, str]]:
    for statement in walk_statements(function.body):
        if isinstance(statement, (Assign, AugAssign, Expr)) and user_call(statement.value):
            yield from _call(statement, typing, call_edges)
        elif isinstance(statement, (Assign, AugAssign)):
            for target in targets(statement):
                if typing.of(target).is_inexact:
                    for source in sources(statement.value, typing):
                        yield source, base_name(target)
        elif isinstance(statement, Return) and statement.value is not None:
            parts = statement.value.elts if isinstance(statement.value, Tuple) else [statement.value]
            for number, part in enumerate(parts):
                for source in sources(part, typing):
                    yield source, f"return {number}"


def _call(statement: AST, typing: Typing, call_edges: CallEdges) -> Iterator[tuple[str, str]]:
    call = statement.value
    results = [base_name(t) for t in targets(statement)]
    for start, end in call_edges(call):
        goal = results[int(end.split()[1])] if isinstance(end, str) and results else base_name(call.args[end]) \
            if isinstance(end, int) else ""
        if goal:
            for source in sources(call.args[start], typing):
                yield source, goal
