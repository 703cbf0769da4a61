"""trip_counts: the number of iterations of a loop, where it is known before the loop starts.

Requires the structure table.
"""
from __future__ import annotations

from s2sad.analyze.dependence import range_parts
from s2sad.analyze.program_structure import ProgramStructure
from s2sad.analyze.uses import loads_of
from s2sad.tree import (
    AST, BinOp, Call, Constant, For, Name, Sub, Subscript, call, call_name, copy, name, names, sub, walk,
)


def trip_counts(structure: ProgramStructure, loop: AST) -> AST | None:
    """The number of iterations as an expression; None if a break, a while or an odd step leaves it open."""
    if not isinstance(loop, For) or any(type(n).__name__ == "Break" for n in walk(loop.body)):
        return None
    start, stop, step = range_parts(loop)
    if step not in (1, -1) or any(loads_of(loop.iter, structure.typing)):
        return None     # what an array holds may be other than when the loop around starts
    plain = isinstance(start, Constant) and start.value == 0 and step == 1
    return copy(stop) if plain and is_size(structure, stop) else call("builtins.len", copy(loop.iter))


def is_size(structure: ProgramStructure, node: AST) -> bool:
    """Whether a number is a size of an array, and so not negative."""
    if isinstance(node, Name):
        bound = structure.bindings.get(node.id, [])
        return len(bound) == 1 and hasattr(bound[0], "value") and is_size(structure, bound[0].value)
    if isinstance(node, Subscript):
        return getattr(node.value, "attr", "") == "shape"
    return getattr(node, "attr", "") == "size" or isinstance(node, Call) and call_name(node) == "builtins.len"


def counter(loop: For) -> AST:
    """The number of an iteration, from 0."""
    start, _, step = range_parts(loop)
    if step == -1:
        return BinOp(copy(start), Sub(), name(loop.target.id))
    plain = isinstance(start, Constant) and start.value == 0
    return name(loop.target.id) if plain else sub(name(loop.target.id), copy(start))


def bound_before(structure: ProgramStructure, loop: AST) -> set[str]:
    """The names that are bound, for good, before a loop."""
    place = structure.place(loop)
    before = {p.id for p in structure.function.args.args}
    for number, bound in structure.bindings.items():
        first = structure.place(bound[0])
        if len(bound) == 1 and first.order < place.order and not first.loops:
            before.add(number)
    return before


def invariant_trip_counts(structure: ProgramStructure, loops: tuple[AST, ...], home: AST) -> list[AST] | None:
    """The numbers of iterations of nested loops, None unless all are known before the loop `home` starts."""
    sizes = [trip_counts(structure, loop) for loop in loops]
    outside = bound_before(structure, home)
    known = [s for s in sizes if s is not None and set(names(s)) <= outside]
    return known if len(known) == len(sizes) else None
