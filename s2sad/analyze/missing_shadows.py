"""missing_shadows: array parameters without a shadow through which derivatives would have to flow.

Requires normal form and its activity; shows, for each array parameter that is neither among the inputs nor the outputs
asked for, the first statement that stores an active value there which may be read again on a path to an output.

    tmp[i] = u[i] * u[i]        # tmp: this store, if `out` depends on it and tmp has no shadow
    out[i] = tmp[i]
"""
from __future__ import annotations

from collections.abc import Iterator

from s2sad.analyze.activity import Activity, CallEdges, activity_of
from s2sad.analyze.dependence import Dependence, ArrayReference
from s2sad.liveness import base_name, targets
from s2sad.analyze.program_structure import ProgramStructure
from s2sad.tree import AST, Attribute, Call, For, If, Name, Subscript, While, function, walk

Edges = tuple[tuple[str, str], ...]


def missing_shadows(structure: ProgramStructure, found: Activity, shadowed: set[str],
                    call_edges: CallEdges) -> dict[str, AST]:
    """The first such store by parameter."""
    typing = structure.typing
    lost = [p.id for p in structure.function.args.args if typing.table[p.id].is_array and p.id in found.active
            and p.id not in shadowed]
    if not lost:
        return {}
    simple: list[tuple[AST, Edges]] = [
        (place.statement, activity_of(function("_", [], [place.statement]), typing, set(), set(), call_edges).edges)
        for place in structure.places.values() if not isinstance(place.statement, (For, While, If))]
    stores: dict[str, AST] = {}
    dependence = Dependence(structure)
    for array in lost:
        reads = [r for statement, edges in simple if any(a == array and b != array and b in found.useful
                                                         for a, b in edges) for r in _reads(array, statement)]
        for statement, edges in simple:
            if any(b == array and a != array and a in found.varied for a, b in edges) and any(
                    _reaches(w, r, dependence) for w in _writes(array, statement) for r in reads):
                stores.setdefault(array, statement)
    return stores


def _reaches(write: ArrayReference, read: ArrayReference, dependence: Dependence) -> bool:
    return dependence.may_overwrite(write, read, same=isinstance(_value(write.statement), Call))


def _value(statement: AST) -> AST | None:
    return getattr(statement, "value", None)


def _writes(array: str, statement: AST) -> Iterator[ArrayReference]:
    stored = [t for t in targets(statement) if isinstance(t, Subscript) and base_name(t) == array]
    yield from (ArrayReference.to(t, statement) for t in stored)
    if not stored:
        yield from _reads(array, statement)     # a call that writes its argument


def _reads(array: str, statement: AST) -> Iterator[ArrayReference]:
    """The places of an array whose content a statement uses; its shape alone is no use."""
    skipped: set[int] = set()
    for node in walk(_value(statement) or statement):
        if isinstance(node, Attribute):
            skipped.add(id(node.value))
        elif isinstance(node, Subscript) and isinstance(node.value, Name):
            skipped.add(id(node.value))
            if node.value.id == array:
                yield ArrayReference.to(node, statement)
        elif isinstance(node, Name) and node.id == array and id(node) not in skipped:
            yield ArrayReference.to(node, statement)
