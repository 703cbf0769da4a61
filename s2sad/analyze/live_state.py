"""live_state: what must be kept of a step of a loop so that the rest of the loop can run again from there.

Requires the step in normal form. A number or an array that the loop changes is state where a later step, or the
adjoint of one, reads what an earlier one left there. An array that each step fills before it reads it is none
(`refills`): what it holds is the step's own, and the elements that no step fills stay what they are.
"""
from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Set
from dataclasses import dataclass

from s2sad.liveness import Accesses, Liveness, base_name, read_names, targets
from s2sad.tree import (
    AST, Assign, Attribute, Call, Constant, Expr, For, FunctionDef, If, Name, Return, Subscript, While, dump, names,
    stored_names, user_call, walk, walk_statements, with_body,
)

Callee = Callable[[Call], FunctionDef | None]


def live_state(step: FunctionDef, counter: str, changed: Mapping[str, str], needed: Collection[str],
               accesses: Accesses, callee: Callee) -> set[str]:
    """Those of a step's parameters that are state; `changed` has the name that each parameter which a step changes goes
    by where the step ends, `needed` are those that its adjoint reads, `counter` is the one that the loop counts."""
    ends = step.body[-1:] if isinstance(step.body[-1], Return) else []
    body = with_body(step, step.body[:len(step.body) - len(ends)])
    parameters = [p.id for p in step.args.args]
    fixed = {p for p in parameters if p not in changed} - {counter}
    free = {a for a in changed if changed[a] == a and refills(step, a, fixed, callee)}
    state = ({*needed} & {*changed}) - free
    while True:
        start = Liveness(body, {changed[n] for n in state}, accesses).start
        grown = state | ((start & {*changed}) - free)
        if grown == state:
            return state
        state = grown


def refills(function: FunctionDef, array: str, fixed: Set[str], callee: Callee) -> bool:
    """Whether a function stores into the same elements of an array each time that its parameters `fixed` are the same,
    and reads none of them before it has."""
    return _Refill(function, array, fixed, callee).block(function.body, frozenset())


@dataclass
class _Refill:
    """One array of a function."""
    function: FunctionDef
    array: str
    fixed: Set[str]
    callee: Callee

    def __post_init__(self) -> None:
        stored: dict[str, list[AST]] = {}
        for statement in walk_statements(self.function.body):
            for target in targets(statement):
                if isinstance(target, Name):
                    stored.setdefault(target.id, []).append(statement)
        known = {*self.fixed}
        for name, bound in stored.items():      # in the order of the text
            if len(bound) == 1 and (self.is_known(bound[0].iter, known) if isinstance(bound[0], For) else isinstance(
                    bound[0], Assign) and self.is_known(bound[0].value, known)):
                known.add(name)
        self.known = known

    def is_known(self, node: AST, known: Set[str]) -> bool:
        """Whether an expression has the same values each time: of such names, and of sizes."""
        return not any(isinstance(n, Call) and user_call(n) or isinstance(n, Subscript) and isinstance(n.value, Name)
                       for n in walk(node)) and {n for n in read_names(node) if not n.startswith("=")} <= known

    def stores(self, statement: AST) -> bool:
        return any(base_name(t) == self.array for s in walk_statements(statement) for t in targets(s)) or any(
            user_call(n) and self.array in map(base_name, n.args) for n in walk(statement))

    def reads(self, node: AST) -> bool:
        """Whether something reads elements of the array; its size is none."""
        return self.array in read_names(node)

    def block(self, block: list[AST], varying: Set[str]) -> bool:
        """Whether a block that stores into the array does so before it reads it; `varying` are the names that the loops
        around it bind: what is stored there may be one row of several."""
        storing = [k for k, s in enumerate(block) if self.stores(s)]
        if not storing:
            return False
        all_of_it = not any((set(names(block[k])) - set(stored_names(block[k]))) & varying for k in storing)
        filled: set[str] = set()
        for position, statement in enumerate(block):
            if position in storing:
                if not self.statement(statement, varying):
                    return False
                filled |= {dump(t) for t in targets(statement)} if isinstance(statement, Assign) else set()
            elif self.reads(statement) and not (all_of_it and position > storing[-1]) and not self.reads_only(
                    statement, filled):
                return False
        return True

    def reads_only(self, statement: AST, filled: set[str]) -> bool:
        """Whether a statement reads elements of the array that have just been stored, and no others."""
        found = [n for n in walk(statement) if isinstance(n, Subscript) and base_name(n) == self.array]
        sizes = sum(isinstance(n, Attribute) and base_name(n.value) == self.array for n in walk(statement))
        count = sum(isinstance(n, Name) and n.id == self.array for n in walk(statement)) - sizes
        return len(found) == count and all(dump(n) in filled for n in found)

    def statement(self, statement: AST, varying: Set[str]) -> bool:
        """Whether a statement stores, and reads nothing of the array that it has not stored."""
        if isinstance(statement, For):
            inner = {*varying, statement.target.id, *stored_names(statement.body)}
            return self.is_known(statement.iter, self.known) and self.block(statement.body, inner)
        if isinstance(statement, (If, While)):
            return False
        if isinstance(statement, (Assign, Expr)) and user_call(statement.value):
            return self.call(statement.value)
        if not isinstance(statement, Assign) or self.reads(statement.value):
            return False
        place = statement.targets[0]
        return isinstance(place, Subscript) and not self.reads(place.slice) and self.is_known(place.slice, self.known)

    def call(self, called: Call) -> bool:
        """Whether the function that is called stores so."""
        function = self.callee(called)
        given = [k for k, a in enumerate(called.args) if self.reads(a)]
        if function is None or len(given) != 1 or not isinstance(called.args[given[0]], Name):
            return False
        parameters = [p.id for p in function.args.args]
        fixed = {p for p, a in zip(parameters, called.args) if isinstance(a, Constant) or self.is_known(a, self.known)}
        return refills(function, parameters[given[0]], fixed, self.callee)
