"""capacity: what says how long a list becomes says the same where the list is made.

    us = []                             p[0] = p[1]
    p[0] = p[1]                         stop = user.f(p)
    for k in range(user.f(p)):          us = []
        us.append(x[k])                 for k in range(stop):
                                            us.append(x[k])

Requires resolved names. A list that begins empty is made where it is first used, and what a loop that fills it calls is
called once, before it. `changed` tells whether what is left may be something else by the time that a loop asks for it.
"""
from __future__ import annotations

from collections.abc import Callable

from s2sad.evaluate.argument_binding import user_call
from s2sad.evaluate.effects import Memory
from s2sad.evaluate.scope import KernelScope
from s2sad.tree import (
    AST, Assign, Constant, For, FunctionDef, If, List, Name, While, assign, at, call_name, copy, head_copy, name,
    walk,
)

Appended = Callable[[AST], str | None]          # the name of the list that a statement appends to


def made_late(tree: FunctionDef, scope: KernelScope, appended: Appended) -> FunctionDef:
    """The function with lists that are made where they are first used."""
    grown = {n for s in walk(tree.body) if (n := appended(s)) is not None}
    new = copy(tree)
    new.body = _block(tree.body, grown, scope, appended) if grown else tree.body
    return new


def _block(block: list[AST], grown: set[str], scope: KernelScope, appended: Appended) -> list[AST]:
    made: list[AST] = []
    waiting: list[Assign] = []
    for statement in block:
        if _starts_empty(statement, grown):
            waiting.append(statement)
            continue
        new = head_copy(statement)
        for field in ("body", "orelse"):
            if hasattr(statement, field):
                setattr(new, field, _block(getattr(statement, field), grown, scope, appended))
        if isinstance(new, For) and any(appended(s) is not None for s in walk(new.body)):
            made += _called_before(new, scope)
        used = {n.id for n in walk(new) if isinstance(n, Name)}
        made += [s for s in waiting if s.targets[0].id in used]
        waiting = [s for s in waiting if s.targets[0].id not in used]
        made.append(new)
    return [*made, *waiting]


def _starts_empty(statement: AST, grown: set[str]) -> bool:
    return isinstance(statement, Assign) and len(statement.targets) == 1 and isinstance(
        statement.targets[0], Name) and statement.targets[0].id in grown and isinstance(
        statement.value, List) and not statement.value.elts


def _called_before(loop: For, scope: KernelScope) -> list[AST]:
    """Names for the bounds of a range that calls of kernels give; the loop goes by the names."""
    calls = any(user_call(n) is not None for n in walk(loop.iter))
    if call_name(loop.iter) != "builtins.range" or not calls:
        return []
    before: list[AST] = []
    roles = ("stop",) if len(loop.iter.args) == 1 else ("start", "stop", "step")
    for position, (bound, role) in enumerate(zip(list(loop.iter.args), roles)):
        if not isinstance(bound, Constant):
            before.append(at(assign(new := scope.fresh(role), bound), loop))
            loop.iter.args[position] = at(name(new), bound)
    return before


def only_after(made: Assign, block: list[AST], appended: Appended) -> bool:
    """Whether all that appends to a list follows in the block in which it is made, so that it is made before."""
    home = next(b for b in _blocks(block) if any(s is made for s in b))
    after = {id(s) for s in _statements(home[home.index(made) + 1:])}
    return all(id(s) in after for s in _statements(block) if appended(s) == made.targets[0].id)


def changed(found: AST, made: Assign, loops: list[AST], body: list[AST], memory: Memory) -> bool:
    """Whether the content that an expression reads may be written between the statement that makes a list and the last
    time that the inner one of the loops around an append, the outermost first, goes by the expression."""
    order = {id(n): k for k, n in enumerate(walk(body))}
    first, last = order[id(made)], order[id(loops[-1])]
    again = {id(n) for n in walk(loops[0].body)} if len(loops) > 1 else set()
    parts = [own_part(s) for s in _statements(body) if first < order[id(s)] < last or id(s) in again or last < first]
    return bool(memory.written([found])) or memory.affected(found, memory.written([*parts, *made.value.elts]))


def _blocks(block: list[AST]) -> list[list[AST]]:
    inner = [getattr(s, field) for s in block for field in ("body", "orelse") if hasattr(s, field)]
    return [block, *(b for i in inner for b in _blocks(i))]


def _statements(block: list[AST]) -> list[AST]:
    return [s for b in _blocks(block) for s in b]


def own_parts(block: list[AST]) -> list[AST]:
    """Every statement below, of those with blocks what is not in a block."""
    return [own_part(s) for s in _statements(block)]


def own_part(statement: AST) -> AST:
    """What of a statement is not in a block of its own."""
    if isinstance(statement, For):
        return statement.iter
    return statement.test if isinstance(statement, (If, While)) else statement
