"""repeated: what several statements of a block compute from the same arrays is computed once.

    a_bar[...] += np.exp(x + y) * seed      exp_value = np.exp(x + y)
    b_bar[...] += np.exp(x + y) * seed_2    a_bar[...] += exp_value * seed
                                            b_bar[...] += exp_value * seed_2

Requires whole-array statements (the NumPy engine) and their types. Only in the reverse sweep, so that the forward sweep
stays as the kernel has it; only arrays that take two operations or more, or one that is dear.
"""
from __future__ import annotations

from dataclasses import dataclass, field

from s2sad.analyze.liveness import touched
from s2sad.blocks import with_blocks
from s2sad.infer.infer import Typing
from s2sad.naming import Names
from s2sad.tree import (
    AST, Add, Assign, Attribute, AugAssign, BinOp, Call, Constant, Div, FunctionDef, Mult, Pow, Sub, UnaryOp,
    assign, at, call_name, copy, dump, is_comment, name, names, rebuild, walk, with_body,
)

CHANGES_ROUNDING = False

_DEAR = {f"numpy.{f}" for f in ("exp", "expm1", "log", "log1p", "log2", "log10", "sin", "cos", "tan", "sinh", "cosh",
                                "tanh", "arcsin", "arccos", "arctan", "arctan2", "hypot", "sqrt", "cbrt", "power",
                                "where")}
_WISHES = {Add: "total", Sub: "difference", Mult: "product", Div: "quotient", Pow: "power"}


@dataclass(frozen=True)
class _Computed:
    """An expression of a statement that is worth a name: its text, the names in it, and how much it computes."""
    node: AST
    text: str
    names: tuple[str, ...]
    operations: int


@dataclass
class _Found:
    """An expression: the statement before which it can be computed, and those that hold it."""
    first: int
    what: _Computed
    users: list[int]


def repeated(function: FunctionDef, mark: str, typing: Typing, free: Names) -> FunctionDef:
    """The function with such expressions named behind the comment `mark`."""
    start = next((k for k, s in enumerate(function.body) if is_comment(s) and s.value.value == mark), None)
    if start is None:
        return function
    return with_body(function, function.body[:start] + _block(function.body[start:], typing, free))


def _block(block: list[AST], typing: Typing, free: Names) -> list[AST]:
    """The block; what is computed on one side of a loop or a branch is not known on the other."""
    block = [with_blocks(s, lambda inner: _block(inner, typing, free)) for s in block]
    runs: list[_Run] = [_Run([], typing, free)]
    for statement in block:
        runs[-1].statements.append(statement)
        if not isinstance(statement, (Assign, AugAssign)) and not is_comment(statement):
            runs.append(_Run([], typing, free))
    found = {k: most for k, run in enumerate(runs) if (most := run.most()) is not None}
    while found:
        longest = max(found, key=lambda k: (found[k].what.operations, -k))
        runs[longest].bind(found.pop(longest))
        if (most := runs[longest].most()) is not None:
            found[longest] = most
    return [s for run in runs for s in run.statements]


@dataclass
class _Run:
    """Statements up to a loop or a branch; `facts` remembers, by `id`, what each computes and what it may write."""
    statements: list[AST]
    typing: Typing
    free: Names
    facts: dict[int, tuple[AST, list[_Computed], set[str]]] = field(default_factory=dict)

    def most(self) -> _Found | None:
        """The longest expression that is computed more than once."""
        known: dict[str, _Found] = {}
        reading: dict[str, dict[str, None]] = {}
        done: list[_Found] = []
        for position, statement in enumerate(self.statements):
            if not isinstance(statement, (Assign, AugAssign)):
                continue
            computed, stored = self.fact(statement)
            for what in computed:
                known.setdefault(what.text, _Found(position, what, [])).users.append(position)
                for n in what.names:
                    reading.setdefault(n, {})[what.text] = None
            gone = {t for n in stored for t in reading.pop(n, ()) if t in known}
            done += [known.pop(t) for t in list(known) if t in gone] if gone else []
        several = [f for f in (*done, *known.values()) if len(f.users) > 1]
        return max(several, key=lambda f: (f.what.operations, -f.first), default=None)

    def fact(self, statement: AST) -> tuple[list[_Computed], set[str]]:
        found = self.facts.get(id(statement))
        if found is None or found[0] is not statement:
            computed = [_Computed(n, dump(n), tuple(names(n)), _operations(n)) for n in walk(statement.value)
                        if _is_computed(n) and self.typing.of(n).is_array and _is_worth(n)]
            found = self.facts[id(statement)] = statement, computed, touched(statement)
        return found[1], found[2]

    def bind(self, found: _Found) -> None:
        """Names an expression before the first statement that computes it."""
        text, made = found.what.text, self.statements
        held = self.free.fresh(_wish(found.what.node))
        self.typing.table[held] = self.typing.of(found.what.node)

        def change(node: AST) -> AST | None:
            return name(held) if _is_computed(node) and dump(node) == text else None
        for k in dict.fromkeys(found.users):
            made[k] = rebuild(made[k], change)
        made.insert(found.first, at(assign(held, copy(found.what.node)), made[found.first]))


def _is_computed(node: AST) -> bool:
    return isinstance(node, BinOp) and type(node.op) in _WISHES or call_name(node) in _DEAR


def _is_worth(node: AST) -> bool:
    dear = call_name(node) in _DEAR or isinstance(node, BinOp) and isinstance(node.op, Pow) and not (
        isinstance(node.right, Constant) and node.right.value in (1, 2))
    return dear or _operations(node) > 1


def _operations(node: AST) -> int:
    return sum(isinstance(n, (BinOp, UnaryOp, Call)) and not isinstance(n, Attribute) for n in walk(node))


def _wish(node: AST) -> str:
    called = call_name(node)
    if called == "numpy.where":
        return "chosen"
    return f"{called.rpartition('.')[2]}_value" if called else _WISHES[type(node.op)]


__all__ = ["repeated"]
