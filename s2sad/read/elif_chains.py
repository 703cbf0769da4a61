"""elif_chains: a long chain of `elif` first finds the branch that is taken, then goes to it in few steps.

    if k == 0:                      branch = 300
        y = x                       if k == 0:
    elif k == 1:                        branch = 0
        y = 2.0 * x                 elif k == 1:                        (as many as _GROUP)
    ...                                 branch = 1
    else:                           if branch == 300:
        y = 0.0                         if k == 8: ...
                                    if branch < 150:
                                        if branch < 75: ...

A chain is a tree as deep as it has branches; so made, no text is indented further than Python reads, and no pass goes
deeper. Chains that compare numbers only: what is decided while compiling (texts, None, types) stays as it is written.
"""
from __future__ import annotations

from itertools import count

from s2sad.tree import (
    AST, BinOp, BoolOp, Compare, Constant, Eq, FunctionDef, If, Lt, Name, Pass, UnaryOp, assign, at, compare, const,
    name, walk,
)

_MOST = 32      # branches of a chain that stays
_GROUP = 8      # of those that are asked for in one chain


def elif_chains(function: FunctionDef) -> FunctionDef:
    """The function, which is changed in place."""
    taken = {n.id for n in walk(function) if isinstance(n, Name)}
    stack: list[AST] = [function]
    while stack:
        node = stack.pop()
        for field in ("body", "orelse", "finalbody"):
            block = getattr(node, field, None)
            if isinstance(block, list):
                made = [new for s in block for new in _apart(s, taken)]
                setattr(node, field, made)
                stack += made
    return function


def _apart(statement: AST, taken: set[str]) -> list[AST]:
    """The statements in place of a chain; any other statement stays."""
    chain: list[If] = []
    rest: list[AST] = [statement]
    while len(rest) == 1 and isinstance(rest[0], If):
        chain.append(rest[0])
        rest = rest[0].orelse
    if len(chain) <= _MOST or not all(_is_of_numbers(link.test) for link in chain):
        return [statement]
    word = next(n for k in count(1) for n in ["branch" if k == 1 else f"branch_{k}"] if n not in taken)
    taken.add(word)
    none = len(chain)
    made = [at(assign(word, const(none)), statement)]
    for start in range(0, none, _GROUP):
        group: list[AST] = []
        for number in reversed(range(start, min(none, start + _GROUP))):
            group = [at(If(chain[number].test, [assign(word, const(number))], group), chain[number])]
        made += group if start == 0 else [at(If(compare(name(word), Eq(), const(none)), group, []), chain[start])]
    return [*made, *_chosen(word, 0, none, [*(link.body for link in chain), rest], statement)]


def _chosen(word: str, first: int, last: int, blocks: list[list[AST]], place: AST) -> list[AST]:
    """The block whose number a name holds, of those from the first to the last."""
    if first == last:
        return blocks[first]
    middle = (first + last + 1) // 2
    low, high = _chosen(word, first, middle - 1, blocks, place), _chosen(word, middle, last, blocks, place)
    origin = low[0] if low else place
    return [at(If(compare(name(word), Lt(), const(middle)), low or [Pass()], high), origin)]


def _is_of_numbers(test: AST) -> bool:
    """Whether a test compares what may be numbers, and numbers only."""
    parts = list(walk(test))
    return any(isinstance(n, Compare) for n in parts) and not any(
        isinstance(n, Constant) and not isinstance(n.value, (int, float))
        or not isinstance(n, (Compare, Name, Constant, BoolOp, BinOp, UnaryOp)) and type(n)._fields for n in parts)
