"""rounded_values: which floats are recorded in single precision where that is asked for.

    for k in range(n):                              u is recorded as float32: partials alone read it
        for i in range(u.size):                     v as it is: the reverse sweep asks it which way to go
            u[i] = np.sin(u[i]) * a[i]
            if v[i] > 0.0:
                v[i] = v[i] * v[i]

Requires the plan of what is recorded. What the reverse sweep has again goes into partials, and into what it decides:
branches, indices, integers, sides of choices, and whatever loops do that run again. All that the latter hangs on stays
as it was, so that both sweeps go the same way; so do states in which loops begin again.
"""
from __future__ import annotations

from collections.abc import Iterable

from s2sad.analyze.context import AnalysisContext
from s2sad.analyze.tape_entries.decision_reads import DecisionReads
from s2sad.liveness import base_name, targets
from s2sad.tree import AST, Assign, AugAssign, While, user_call

ROUNDED = {"float64": "float32", "complex128": "complex64"}


def rounded_values(context: AnalysisContext) -> tuple[dict[str, str], dict[str, AST]]:
    """The dtypes of what is rounded, by its key; and what is not, with the statement that decides by it."""
    assert context.plan is not None
    deciding = _Deciding(context)
    dtypes: dict[str, str] = {}
    exact: dict[str, AST] = {}
    for key, array, statement in deciding.recorded():
        kind = context.typing.table[array]
        if kind.dtype not in ROUNDED or deciding.runs_again(statement):
            continue
        if array in deciding.found:
            exact[key] = deciding.found[array]
        else:
            dtypes[key] = ROUNDED[kind.dtype]
    return dtypes, exact


class _Deciding:
    """The names of floats on which the way of the reverse sweep hangs, each with the first statement that asks."""

    def __init__(self, context: AnalysisContext):
        assert context.plan is not None
        self.plan, self.structure, self.typing = context.plan, context.structure, context.typing
        self.active = context.problem.active
        self.asked = DecisionReads(context.typing, context.calls, context.choices)
        self.found: dict[str, AST] = {}
        waiting = [(n, s) for s in self.evaluated() for n in sorted(self.asked.of(s))]
        while waiting:
            name, statement = waiting.pop()
            if name not in self.found:
                self.found[name] = statement
                waiting += [(n, statement) for n in self.hangs_on(name)]

    def recorded(self) -> Iterable[tuple[str, str, AST]]:
        """What is recorded: its key, its name, and the statement with which it is."""
        yield from ((k, v.name, v.home) for k, v in self.plan.recorded.items())
        yield from ((k, base_name(s.place), s.statement) for k, s in self.plan.stores.items())

    def runs_again(self, statement: AST) -> bool:
        """Whether a statement is a loop that runs again in the reverse sweep, or in one."""
        place = self.structure.place(statement)
        return any(id(s) in self.plan.rerun for s in (statement, *place.inside))

    def evaluated(self) -> list[AST]:
        """The statements of which the reverse sweep evaluates something, beside what is pulled back: those with an
        adjoint, those that are computed again, and what loops hold that run again."""
        kept = set(self.plan.recorded)
        computed = {id(b) for key, value in self.plan.values.items() if key not in kept for b in value.bindings}
        return [p.statement for i, p in self.structure.places.items() if i in computed or self.active(p.statement)
                or self.runs_again(p.statement) or not self.runs_forwards_alone(p.statement)]

    def runs_forwards_alone(self, statement: AST) -> bool:
        """Whether a statement only binds a number or stores, or is a loop of which the reverse sweep counts the trips.
        """
        return isinstance(statement, While) or isinstance(statement, (Assign, AugAssign)) and not user_call(
            statement.value)

    def hangs_on(self, name: str) -> list[str]:
        """What a name is computed from where the reverse sweep has it again otherwise than by its own record."""
        if self.typing.table[name].is_array:
            return [n for s in self.structure.places.values() for n in self.written_from(s.statement, name)]
        found = [n for b in self.structure.bindings.get(name, []) if self.runs_again(b) for n in self.asked.floats(b)]
        for key, value in self.plan.values.items():
            if value.name != name or key in self.plan.recorded:
                continue
            for binding in value.bindings:
                found += self.asked.floats(binding)
            if key in self.plan.reloaded:
                found.append(base_name(targets(self.plan.reloaded[key])[0]))
            if key in self.plan.shifted:
                shift = self.plan.shifted[key]
                found += [base_name(shift.store.place), shift.start]
        return found

    def written_from(self, statement: AST, array: str) -> list[str]:
        """What a statement writes an array from, if it runs again in the reverse sweep, or its call does."""
        again = self.runs_again(statement) or user_call(getattr(statement, "value", None))
        return sorted(self.asked.floats(statement)) if again and array in self.asked.written(statement) else []
