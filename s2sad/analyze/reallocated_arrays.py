"""reallocated_arrays: arrays that a loop allocates anew in every iteration, in a size that may change there.

Requires the structure table; `hoist_allocations` has moved out every allocation whose shape does not change. Such a
name has one array after another. It is read only after the allocation of the same iteration, or after the loop; or it
is allocated before the loop as well, and each iteration begins with the array of the one before (`is_carried`). The
reverse sweep binds it to each again, last first: before an allocation the
forward sweep records the size of the array that the name gives up, and its content if that is read. A loop that runs
forward and back per iteration allocates it again instead; so does the reverse of an iteration where nothing reads its
content, and counters and what no loop changes say its size (`is_remade`).
"""
from __future__ import annotations

from collections.abc import Callable

from s2sad.analyze.program_structure import ProgramStructure, heads
from s2sad.normalize.loops.hoist_allocations import is_allocation
from s2sad.tree import AST, Assign, Attribute, For, Load, Name, call_name, names, user_call, walk


def allocations(structure: ProgramStructure, array: str) -> list[AST]:
    """The allocations of an array."""
    return [b for b in structure.bindings.get(array, []) if is_allocation(b)]


def is_reallocation(structure: ProgramStructure, statement: AST) -> bool:
    """Whether a statement allocates in a loop."""
    return is_allocation(statement) and bool(structure.place(statement).loops)


def allocation_loops(structure: ProgramStructure, array: str) -> tuple[AST, ...]:
    """The loops around all allocations of an array: each iteration of the innermost has an array of its own."""
    found = [structure.place(a).loops for a in allocations(structure, array)]
    if not found:
        return ()
    shortest = min(found, key=len)
    return tuple(x for k, x in enumerate(shortest) if all(loops[k] is x for loops in found))


def is_reallocated(structure: ProgramStructure, array: str, loop: AST | None = None) -> bool:
    """Whether a loop, or this one, allocates an array."""
    return any(structure.place(a).loops if loop is None else any(x is loop for x in structure.place(a).loops)
               for a in allocations(structure, array))


def is_carried(structure: ProgramStructure, array: str, loop: AST) -> bool:
    """Whether an iteration of a loop that allocates an array begins with the one that was there."""
    return is_reallocated(structure, array, loop) and not any(x is loop for x in allocation_loops(structure, array))


def reads_carried(structure: ProgramStructure, statement: Assign) -> bool:
    """Whether a value is made of an array, or of its size, that is another one where the iteration ends."""
    loops = structure.place(statement).loops
    return any(is_carried(structure, n, loop) for n in names(statement.value) if n in structure.bindings
               for loop in loops)


def outlives_loop(structure: ProgramStructure, array: str) -> bool:
    """Whether an array that a loop allocates is used outside of that loop, where the last one is live."""
    own = allocation_loops(structure, array)
    return bool(own) and any(
        not is_nested_in(place.loops, own) for place in structure.places.values()
        if any(isinstance(n, Name) and n.id == array for head in heads(place.statement) for n in walk(head)))


def is_remade(structure: ProgramStructure, statement: Assign, lasting: Callable[[str, AST], bool]) -> bool:
    """Whether the reverse of an iteration can allocate the array of a loop's allocation itself, with any content:
    each iteration has its own, and counters and `lasting` numbers say the size."""
    array, place = statement.targets[0].id, structure.place(statement)
    if len(structure.bindings[array]) != 1 or place.inside[-1] is not place.loops[-1] or outlives_loop(
            structure, array):
        return False
    read = [n for n in walk(statement.value) if isinstance(n, Name) and isinstance(n.ctx, Load)]
    sizes = {id(n.value) for n in walk(statement.value) if isinstance(n, Attribute) and n.attr == "shape"}
    sizes |= {id(a) for a in statement.value.args[:1] if "_like" in (call_name(statement.value) or "")}
    if any(user_call(n) for n in walk(statement.value)) or any(
            structure.typing.of(n).is_array and id(n) not in sizes or is_reallocated(structure, n.id)
            for n in read if n.id in structure.typing.table):
        return False
    counters = {loop.target.id for loop in place.loops if isinstance(loop, For)}
    return all(n.id in counters or n.id not in structure.loop_of and lasting(n.id, statement) for n in read)


def is_nested_in(loops: tuple[AST, ...], outer: tuple[AST, ...]) -> bool:
    """Whether the loops around a statement begin with the loops `outer`."""
    return len(loops) >= len(outer) and all(x is y for x, y in zip(loops, outer))


def reallocations_to_reverse(structure: ProgramStructure, active: Callable[[AST], bool]) -> list[AST]:
    """The allocations in nests of loops in which there is something to reverse."""
    nests = {id(p.loops[0]) for p in structure.places.values() if p.loops and active(p.statement)}
    return [p.statement for p in structure.places.values()
            if is_reallocation(structure, p.statement) and id(p.loops[0]) in nests]
