"""coalesce_names: an array that is made under one name and goes on under another one has the other one from the start.

    w = np.zeros(3)                     made = np.zeros(3)
    w[0] = x[k]                         made[0] = x[k]
    made = w                            us[k] = made
    us[k] = made

Requires structured form, where functions that return arrays are written out. Only where there are lists: that what lies
in one is new, and nobody else's, is then to be seen.
"""
from __future__ import annotations

from collections import Counter

from s2sad.blocks import with_blocks
from s2sad.infer.call_types import LISTED
from s2sad.evaluate.effects import fresh_value
from s2sad.normalize.context import NormalContext
from s2sad.tree import (
    AST, Assign, Break, For, FunctionDef, Name, Return, call_name, copy, names, rename, times_bound, walk,
)


def coalesce_names(function: FunctionDef, context: NormalContext) -> FunctionDef:
    """The function with one name for such an array."""
    if not any(call_name(n) == LISTED for n in walk(function.body)):
        return function
    mentions = Counter(n.id for n in walk(function.body) if isinstance(n, Name))

    def block(given: list[AST]) -> list[AST]:
        made = [with_blocks(s, block) for s in given]
        place = 0
        while place < len(made):
            start = _start(made, place, mentions)
            if start is None:
                place += 1
                continue
            old, new = made[place].value.id, made[place].targets[0].id
            made[start:place + 1] = [rename(s, {old: new}) for s in made[start:place]]
            mentions[new] += mentions.pop(old) - 2
            place = start
        return made
    named = copy(function)
    named.body = block(function.body)
    return named


def _start(block: list[AST], place: int, mentions: Counter[str]) -> int | None:
    """Where the array that a statement gives another name is made, if that name may be the only one."""
    handed = block[place]
    if not isinstance(handed, Assign) or not isinstance(handed.targets[0], Name) or not isinstance(handed.value, Name):
        return None
    old, new = handed.value.id, handed.targets[0].id
    start = next((k for k in range(place - 1, -1, -1) if times_bound([block[k]], Assign, For)[old]), None)
    if start is None or not isinstance(first := block[start], Assign) or not isinstance(first.targets[0], Name) or not (
            fresh_value(first.value)):
        return None
    found = Counter(n.id for n in walk(block[start:place]) if isinstance(n, Name))
    left = any(isinstance(n, (Break, Return)) for n in walk(block[start:place]))
    alone = found[old] + 1 == mentions[old] and not found[new] and old not in names(first.value)
    return start if alone and not left else None
