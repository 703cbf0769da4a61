"""simplify: the derivative becomes shorter and computes the same.

In order: zeros merged with the first addition, dead statements out, versions of a variable under one name, neighbouring
branches joined, names folded into their one use, arithmetic with constants; for loops short branches as choices and
gains joined, for whole arrays no copies of emptied shadows and nothing computed twice.
"""
from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from s2sad.analyze.liveness import Liveness, base_name, targets
from s2sad.infer.infer import Typing
from s2sad.differentiate.adjoint import REVERSE
from s2sad.differentiate.calls import POP, PUSH
from s2sad.naming import Names
from s2sad.simplify.algebra import algebra
from s2sad.simplify.branches import branches
from s2sad.simplify.coalesce import coalesce, share, split
from s2sad.simplify.dead import dead
from s2sad.simplify.fold import fold
from s2sad.simplify.gains import gains
from s2sad.simplify.merge import merge
from s2sad.blocks import with_blocks
from s2sad.simplify.repeated import repeated
from s2sad.simplify.select import select
from s2sad.simplify.uncopied import uncopied
from s2sad.simplify.undone import undone
from s2sad.tree import (
    AST, Assert, Assign, AugAssign, Call, FunctionDef, Raise, Subscript, call_name, forgotten, names, walk,
)


Watch = Callable[[str, FunctionDef], object]


def unwatched(stage: str, function: FunctionDef) -> None:
    """What is shown the stages where nobody looks."""


@dataclass(frozen=True)
class Effect:
    """Of a function that was made: the positions of arrays that it reads and writes, and whether it may be dropped."""
    reads: frozenset[int]
    writes: frozenset[int]
    pure: bool
    arrays: frozenset[int] = frozenset()


@dataclass
class Effects:
    """The effects of the functions of a module that is being made."""
    table: dict[str, Effect] = field(default_factory=dict)

    def of(self, called: Call) -> Effect | None:
        room, _, title = (call_name(called) or "").partition(".")
        return self.table.get(title) if room == "user" else None

    def writes(self, called: Call) -> list[str]:
        effect = self.of(called)
        if call_name(called) in (PUSH, POP):
            return [base_name(called.args[0])]
        if effect is None:
            return []
        return [b for k, a in enumerate(called.args) if k in effect.writes and (b := base_name(a))]

    def unread(self, called: Call) -> set[str]:
        effect = self.of(called)
        if effect is None:
            return set()
        bases = [(k, base_name(a)) for k, a in enumerate(called.args) if k in effect.arrays]
        read = {b for k, b in bases if k in effect.reads}
        for position, argument in enumerate(called.args):
            if position not in effect.arrays:
                read |= set(names(argument))
            elif isinstance(argument, Subscript):
                read |= set(names(argument.slice))
        return {b for _, b in bases if b} - read

    def pure(self, called: Call) -> bool:
        effect = self.of(called)
        return (call_name(called) or "") != "builtins.print" and (effect is None or effect.pure)

    def add(self, function: FunctionDef, typing: Typing) -> None:
        """Registers a finished function."""
        parameters = [p.id for p in function.args.args]
        live = Liveness(function, set(), self.writes, self.pure, strong=False, unread=self.unread)
        reads = {k for k, p in enumerate(parameters) if p in live.start}
        written: set[str] = set()
        pure = True
        for node in walk(function.body):
            if isinstance(node, (Assign, AugAssign)):
                written |= {base_name(t) for t in targets(node) if isinstance(t, Subscript)}
                written |= {base_name(node.target)} if isinstance(node, AugAssign) else set()
            if isinstance(node, Call):
                written |= set(self.writes(node))
                pure = pure and self.pure(node)
            pure = pure and not isinstance(node, (Assert, Raise))
        arrays = frozenset(k for k, p in enumerate(parameters) if typing.table[p].is_array)
        self.table[function.name] = Effect(
            frozenset(reads), frozenset(k for k in arrays if parameters[k] in written), pure, arrays)


def simplify(function: FunctionDef, typing: Typing, family: Mapping[str, str], live_out: set[str], effects: Effects,
             names: Names, kept: set[str], shadows: Mapping[str, str], watch: Watch = unwatched,
             choices: bool = False) -> FunctionDef:
    """The function simplified; `live_out` are the arrays whose content the caller reads, `kept` the names that are
    not folded away; `watch` is shown every stage; with `choices` short branches become choices."""
    fixed = {p.id for p in function.args.args}
    function = merge(function)
    watch("merge", function)
    function = dead(function, live_out, effects.writes, effects.pure, effects.unread)
    watch("dead", function)
    function = undone(function, effects.writes, effects.pure)
    function = dead(function, live_out, effects.writes, effects.pure, effects.unread)
    watch("undone", function)
    function, renamed = coalesce(function, dict(family), live_out, effects.writes, fixed, names, shadows)
    watch("coalesce", function)
    function = branches(function)
    watch("branches", function)
    function = split(function, set(_temporaries(typing, names, set(family) | fixed)), names, typing, REVERSE)
    function = fold(function, fixed | {renamed.get(n, n) for n in kept}, effects.writes)
    watch("fold", function)
    function = merge(algebra(function, typing.table))
    watch("algebra", function)
    if choices:
        function = merge(select(function))
        watch("select", function)
        function = gains(function)
        watch("gains", function)
    function = uncopied(function)
    watch("uncopied", function)
    if not choices:
        function = repeated(function, REVERSE, typing, names)
        watch("repeated", function)
    function = dead(function, live_out, effects.writes, effects.pure, effects.unread)
    function.body = _unmarked(function.body)
    return share(function, _temporaries(typing, names, set(renamed.values()) | fixed), live_out, effects.writes)


def _unmarked(block: list[AST]) -> list[AST]:
    return [with_blocks(s, _unmarked) for s in block if not forgotten(s)]


def _temporaries(typing: Typing, names: Names, kept: set[str]) -> dict[str, str]:
    """The numbers that were named for one use, by what was wished for and their type."""
    return {n: f"{w} {typing.table[n].dtype}" for n, w in names.wanted.items()
            if n not in kept and n in typing.table and typing.table[n].is_number}


__all__ = ["Effect", "Effects", "Watch", "simplify", "unwatched"]
