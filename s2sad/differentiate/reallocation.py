"""reallocation: the reverse sweep binds the name of an array that a loop allocates anew to each of them again, last
first.

    w = np.empty(0)
    for i in range(n):              w_size_stack[i] = w.shape[0]            for i in range(n - 1, -1, -1):
        w = np.zeros(i + 1)         w = np.zeros(i + 1)                         ...
        ...                         ...                                         w = np.empty(w_size_stack[i])

Their content is restored from the tape, as for any array that is overwritten. Where nothing reads that, and the size is
one of the loop's counters or what it does not change, an iteration of the reverse sweep begins with the allocation.

    for i in range(n):              for i in range(n):                      for i in range(n - 1, -1, -1):
        w = np.zeros(i + 1)             w = np.zeros(i + 1)                     w = np.empty(i + 1)
        ...                             ...                                     ...
"""
from __future__ import annotations

from s2sad.analyze.reallocated_arrays import allocations
from s2sad.analyze.program_structure import ProgramStructure
from s2sad.differentiate.tape import Stack, Tape
from s2sad.infer.types import INT, Type
from s2sad.tree import AST, Assign, assign, attribute, call, call_name, const, copy, index, name, tuple_of


def empty_at_first(structure: ProgramStructure) -> list[AST]:
    """An array without elements for each name that is bound only in loops or branches: what it gives up first."""
    made: list[AST] = []
    for array in structure.bindings:
        found = [structure.place(a) for a in allocations(structure, array)]
        if found and all(place.loops or place.branches for place in found):
            kind = structure.typing.table[array]
            made.append(empty_array(array, [const(0)] * kind.rank, kind))
    return made


def push_sizes(statement: Assign, tape: Tape) -> list[AST]:
    """The size of the array that the allocation replaces, put on the tape."""
    array = statement.targets[0].id
    return [s for axis, stack in enumerate(_stacks(statement, tape))
            for s in tape.push(stack, index(attribute(name(array), "shape"), const(axis)))]


def pop_sizes(statement: Assign, tape: Tape) -> list[AST]:
    """The array of that size again; its content is put back where it was recorded."""
    array, made, sizes = statement.targets[0].id, [], []
    for stack in _stacks(statement, tape):
        size = tape.typing.declare(tape.free.fresh(f"{array}_size"), INT)
        made += tape.pop(stack, name(size))
        sizes.append(name(size))
    return [*made, empty_array(array, sizes, tape.typing.table[array])]


def remade(statement: Assign) -> Assign:
    """The allocation of the same array, with any content."""
    made = copy(statement)
    made.value = call((call_name(made.value) or "").replace("zeros", "empty"), *made.value.args)
    return made


def _stacks(statement: Assign, tape: Tape) -> list[Stack]:
    array = statement.targets[0].id
    inside = tape.structure.place(statement).inside
    return [tape.stack(f"size {id(statement)} {axis}", f"{array}_size", INT, inside, None)
            for axis in range(tape.typing.table[array].rank)]


def empty_array(array: str, sizes: list[AST], kind: Type) -> Assign:
    """The allocation of an array of these sizes under a name."""
    dtype = [] if kind.dtype == "float64" else [name("numpy.bool_" if kind.dtype == "bool" else f"numpy.{kind.dtype}")]
    return assign(array, call("numpy.empty", sizes[0] if len(sizes) == 1 else tuple_of(*sizes), *dtype))
