"""adjoint_liveness: the stores that an adjoint does without, for nothing in it reads what they leave.

The reverse sweep reads what the adjoints of statements read, each before its statement. What a kernel stores last is
read by its caller alone, who has called for shadows: neither it nor what it is made of is run, and what it would
overwrite is not recorded. (Adjoint liveness: Hascoet, Araya-Polo, 2005; here before it is asked what is to be recorded,
for loops in which a store and its restore meet.)

    for i in range(n):              the adjoint reads u[i] as it was, and nobody what it becomes:
        u[i] = u[i] * u[i]          neither runs the loop forwards nor records u
"""
from __future__ import annotations

from collections.abc import Callable, Iterable, Set

from s2sad.analyze.dependence import ArrayReference
from s2sad.analyze.program_structure import heads
from s2sad.analyze.recording_plan import RecordingProblem, by_key, reads
from s2sad.liveness import base_name, targets
from s2sad.tree import AST, Assign, AugAssign, Expr, Name, Return, Subscript, While, names


def unread_stores(problem: RecordingProblem, runs: Callable[[AST], bool], with_result: bool) -> frozenset[int]:
    """The ids of the statements that an adjoint leaves out; it `runs` others whatever is read of them, and returns what
    the function does if that is asked for (`with_result`)."""
    return _Reading(problem).unread(runs, with_result)


class _Reading:
    """What is read grows from what the reverse sweep reads; `stores` are those that nothing reads until now."""

    def __init__(self, problem: RecordingProblem):
        self.problem, self.structure, self.typing = problem, problem.structure, problem.structure.typing
        places = self.structure.places.values()
        self.storing = {id(p.statement): p.statement for p in places if problem.writes(p.statement)}
        self.stores = by_key(((s, place) for s in self.storing.values() for place in problem.writes(s)),
                             lambda pair: base_name(pair[1]))
        self.run: dict[int, AST] = {}
        self.waiting: list[AST] = []

    def unread(self, runs: Callable[[AST], bool], with_result: bool) -> frozenset[int]:
        for place in self.structure.places.values():
            statement = place.statement
            if self.problem.active(statement):
                found = self.problem.uses(statement)
                self.read(found.loads, found.names, statement, self.problem.after(statement))
            if runs(statement) or (with_result if isinstance(statement, Return) else not isinstance(
                    statement, (Assign, AugAssign, Expr))):
                self.add(statement)
        while self.waiting:
            statement = self.waiting.pop()
            loads = reads(statement, self.typing)
            if isinstance(statement, AugAssign) and isinstance(statement.target, Subscript):
                loads.append(statement.target)
            self.read(loads, names(heads(statement)), statement, False)
        return self.with_readers(self.storing.keys() - self.run.keys())

    def with_readers(self, unread: Set[int]) -> frozenset[int]:
        """The statements that are not run, with those that read what they return."""
        places = self.structure.places
        readers = by_key(((n, i) for i, p in places.items() if i not in self.run for n in names(heads(p.statement))),
                         lambda pair: pair[0])
        found, waiting = set(unread), [*unread]
        while waiting:
            for target in targets(places[waiting.pop()].statement):
                more = [i for _, i in readers.get(target.id, ()) if i not in found] if isinstance(target, Name) else []
                found.update(more)
                waiting += more
        return frozenset(found)

    def add(self, statement: AST) -> None:
        if id(statement) not in self.run:
            self.run[id(statement)] = statement
            self.waiting.append(statement)

    def read(self, loads: Iterable[AST], used: Iterable[str], statement: AST, after: bool) -> None:
        """What is read at a statement, before it or `after` it: the stores that it may find there run; what a loop asks
        for is read at the end of each trip, too."""
        for identifier in used:
            for binding in self.structure.bindings.get(identifier, ()):
                self.add(binding)
        overlaps = self.problem.dependence.may_overwrite
        for load in loads:
            array = base_name(load)
            reference = ArrayReference.to(load, statement)
            left: list[tuple[AST, AST]] = []
            for store, place in self.stores.get(array, ()):
                if isinstance(statement, While) or overlaps(ArrayReference.to(place, store), reference, same=after):
                    self.add(store)
                else:
                    left.append((store, place))
            self.stores[array] = left
