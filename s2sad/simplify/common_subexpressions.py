"""common_subexpressions: an array expression that several statements of a block compute is computed once.

    def f(a: float64[:], x: float64[:], y: float64[:]):
        y[:] = a * np.exp(x + a)

in its adjoint:

    def f_adjoint(...):
        ...
        seed_2 = a * y_bar
        seed_3 = np.where(seed_2 != 0.0, np.exp(x + a) * seed_2, 0.0)
        a_bar[...] += np.exp(x + a) * y_bar + seed_3
        ...

becomes

    def f_adjoint(...):
        ...
        seed_2 = a * y_bar
        exp_value = np.exp(x + a)
        seed_3 = np.where(seed_2 != 0.0, exp_value * seed_2, 0.0)
        a_bar[...] += exp_value * y_bar + seed_3
        ...

*Requires* whole-array statements (the NumPy engine) and their types. *Establishes* the same values. Only in the reverse
sweep, so that the forward sweep keeps the kernel's own statements; only array expressions of two operations or more, or
of one expensive operation.
"""
from __future__ import annotations

from dataclasses import dataclass, field

from s2sad.differentiate.adjoint import REVERSE
from s2sad.liveness import touched
from s2sad.blocks import with_blocks
from s2sad.infer.inference import Typing
from s2sad.naming import Names
from s2sad.passes import Context
from s2sad.tree import (
    AST, Add, Assign, Attribute, AugAssign, BinOp, Call, Constant, Div, FunctionDef, Mult, Pow, Sub, UnaryOp,
    assign, at, call_name, copy, dump, is_comment, name, names, rebuild, walk, with_body,
)

CHANGES_ROUNDING = False

_EXPENSIVE = {f"numpy.{f}" for f in (
    "exp", "expm1", "log", "log1p", "log2", "log10", "sin", "cos", "tan", "sinh", "cosh", "tanh", "arcsin", "arccos",
    "arctan", "arctan2", "hypot", "sqrt", "cbrt", "power", "where")}
_OPERATION_NAMES = {Add: "total", Sub: "difference", Mult: "product", Div: "quotient", Pow: "power"}


@dataclass(frozen=True)
class _Candidate:
    """An expression that is worth a temporary: its text, the names in it, and the number of its operations."""
    node: AST
    text: str
    names: tuple[str, ...]
    operations: int


@dataclass
class _SharedExpression:
    """A candidate, the statement before which it is available, and the statements that use it."""
    first: int
    candidate: _Candidate
    users: list[int]


def common_subexpressions(function: FunctionDef, context: Context) -> FunctionDef:
    """The function with such expressions named behind the comment `mark`."""
    mark, typing, free = REVERSE, context.typing, context.names
    start = next((k for k, s in enumerate(function.body) if is_comment(s) and s.value.value == mark), None)
    if start is None:
        return function
    return with_body(function, function.body[:start] + _block(function.body[start:], typing, free))


def _block(block: list[AST], typing: Typing, free: Names) -> list[AST]:
    """The block; nothing is available across a loop or a branch."""
    block = [with_blocks(s, lambda inner: _block(inner, typing, free)) for s in block]
    runs: list[_StraightLine] = [_StraightLine([], typing, free)]
    for statement in block:
        runs[-1].statements.append(statement)
        if not isinstance(statement, (Assign, AugAssign)) and not is_comment(statement):
            runs.append(_StraightLine([], typing, free))
    found = {k: most for k, run in enumerate(runs) if (most := run.longest_shared()) is not None}
    while found:
        longest = max(found, key=lambda k: (found[k].candidate.operations, -k))
        runs[longest].bind_before(found.pop(longest))
        if (most := runs[longest].longest_shared()) is not None:
            found[longest] = most
    return [s for run in runs for s in run.statements]


@dataclass
class _StraightLine:
    """Straight-line code; `facts` remembers, by `id`, what each statement computes and which names it may write."""
    statements: list[AST]
    typing: Typing
    free: Names
    facts: dict[int, tuple[AST, list[_Candidate], set[str]]] = field(default_factory=dict)

    def longest_shared(self) -> _SharedExpression | None:
        """The largest expression that several statements compute."""
        known: dict[str, _SharedExpression] = {}
        reading: dict[str, dict[str, None]] = {}
        done: list[_SharedExpression] = []
        for position, statement in enumerate(self.statements):
            if not isinstance(statement, (Assign, AugAssign)):
                continue
            computed, stored = self.facts_of(statement)
            for what in computed:
                known.setdefault(what.text, _SharedExpression(position, what, [])).users.append(position)
                for n in what.names:
                    reading.setdefault(n, {})[what.text] = None
            gone = {t for n in stored for t in reading.pop(n, ()) if t in known}
            done += [known.pop(t) for t in list(known) if t in gone] if gone else []
        several = [f for f in (*done, *known.values()) if len(f.users) > 1]
        return max(several, key=lambda f: (f.candidate.operations, -f.first), default=None)

    def facts_of(self, statement: AST) -> tuple[list[_Candidate], set[str]]:
        found = self.facts.get(id(statement))
        if found is None or found[0] is not statement:
            computed = [_Candidate(n, dump(n), tuple(names(n)), _operations(n)) for n in walk(statement.value)
                        if _is_operation(n) and self.typing.of(n).is_array and _is_worthwhile(n)]
            found = self.facts[id(statement)] = statement, computed, touched(statement)
        return found[1], found[2]

    def bind_before(self, found: _SharedExpression) -> None:
        """Binds an expression to a temporary before the first statement that uses it."""
        text, made, node = found.candidate.text, self.statements, found.candidate.node
        held = self.typing.declare(self.free.fresh(_wanted_name(node)), self.typing.of(node))

        def change(node: AST) -> AST | None:
            return name(held) if _is_operation(node) and dump(node) == text else None
        for k in dict.fromkeys(found.users):
            made[k] = rebuild(made[k], change)
        made.insert(found.first, at(assign(held, copy(found.candidate.node)), made[found.first]))


def _is_operation(node: AST) -> bool:
    return isinstance(node, BinOp) and type(node.op) in _OPERATION_NAMES or call_name(node) in _EXPENSIVE


def _is_worthwhile(node: AST) -> bool:
    expensive = call_name(node) in _EXPENSIVE or isinstance(node, BinOp) and isinstance(node.op, Pow) and not (
        isinstance(node.right, Constant) and node.right.value in (1, 2))
    return expensive or _operations(node) > 1


def _operations(node: AST) -> int:
    return sum(isinstance(n, (BinOp, UnaryOp, Call)) and not isinstance(n, Attribute) for n in walk(node))


def _wanted_name(node: AST) -> str:
    called = call_name(node)
    if called == "numpy.where":
        return "chosen"
    return f"{called.rpartition('.')[2]}_value" if called else _OPERATION_NAMES[type(node.op)]


__all__ = ["common_subexpressions"]
