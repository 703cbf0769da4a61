"""repeated: what several statements of a block compute from the same arrays is computed once.

    a_bar[...] += np.exp(x + y) * seed      exp_value = np.exp(x + y)
    b_bar[...] += np.exp(x + y) * seed_2    a_bar[...] += exp_value * seed
                                            b_bar[...] += exp_value * seed_2

Requires whole-array statements (the NumPy engine) and their types. Only in the reverse sweep, so that the forward sweep
stays as the kernel has it; only arrays that take two operations or more, or one that is dear.
"""
from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

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


@dataclass
class _Found:
    """An expression: the statement before which it can be computed, and those that hold it."""
    first: int
    node: AST
    users: list[int]


def repeated(function: FunctionDef, mark: str, typing: Typing, free: Names) -> FunctionDef:
    """The function with such expressions named behind the comment `mark`."""
    start = next((k for k, s in enumerate(function.body) if is_comment(s) and s.value.value == mark), None)
    if start is None:
        return function
    return with_body(function, function.body[:start] + _block(function.body[start:], typing, free))


def _block(block: list[AST], typing: Typing, free: Names) -> list[AST]:
    block = [with_blocks(s, lambda inner: _block(inner, typing, free)) for s in block]
    while (found := _most(block, typing)) is not None:
        text, wish = dump(found.node), _wish(found.node)
        held = free.fresh(wish)
        typing.table[held] = typing.of(found.node)

        def change(node: AST, text: str = text, held: str = held) -> AST | None:
            return name(held) if _is_computed(node) and dump(node) == text else None
        block = [rebuild(s, change) if k in found.users else s for k, s in enumerate(block)]
        block.insert(found.first, at(assign(held, copy(found.node)), block[found.first]))
    return block


def _most(block: list[AST], typing: Typing) -> _Found | None:
    """The longest expression that is computed more than once."""
    known: dict[str, _Found] = {}
    done: list[_Found] = []
    for position, statement in enumerate(block):
        if isinstance(statement, (Assign, AugAssign)):
            _visit(statement.value, lambda n, k=position: _note(known, n, k), typing)
            stored = touched(statement)
        elif is_comment(statement):
            continue
        else:
            stored = None
        gone = [t for t, f in known.items() if stored is None or stored & set(names(f.node))]
        done += [known.pop(t) for t in gone]
    several = [f for f in (*done, *known.values()) if len(f.users) > 1]
    return max(several, key=lambda f: (_operations(f.node), -f.first), default=None)


def _note(known: dict[str, _Found], node: AST, position: int) -> None:
    known.setdefault(dump(node), _Found(position, node, [])).users.append(position)


def _visit(node: AST, note: Callable[[AST], None], typing: Typing) -> None:
    for part in walk(node):
        if _is_computed(part) and typing.of(part).is_array and _is_worth(part):
            note(part)


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
