"""recorded_arrays: the arrays of a generated module with a tape or snapshots, and the loops that keep snapshots."""
from __future__ import annotations

from collections.abc import Mapping

from s2sad.emit.stack_report import recorded_by
from s2sad.program import RecordedArray, SnapshotLoop, SourcePlace
from s2sad.tree import AST
from s2sad.units import Place, UnitDerivative


def recorded_arrays(derived: UnitDerivative, functions: list[str], called: Mapping[Place, str]
                    ) -> list[RecordedArray]:
    """What one derivative records, in the functions that it became; `called` has users' names of loops."""
    kind = "tape" if derived.unit.loop is None else "snapshots"
    loops = {} if derived.made.tape is None else {s.array: s.loops for s in derived.made.tape.stacks.values()}
    found = []
    for entry in recorded_by(derived):
        around = [entry.statement] if kind == "snapshots" else list(loops.get(entry.array, ()))[:1]
        place = _place(derived, around[0]) if around else None
        title = derived.function.name
        found += [RecordedArray(f, entry.array, kind, title, place, _called(place, called)) for f in functions]
    return found


def snapshot_loop(derived: UnitDerivative, function: str, called: Mapping[Place, str]) -> SnapshotLoop:
    """The loop of a derivative that keeps snapshots, which the function runs."""
    loop = derived.unit.loop
    assert loop is not None
    place = _place(derived, loop.loop)
    return SnapshotLoop(function, _called(place, called), place, loop.snapshots, derived.made.trips, loop.is_counted,
                        derived.made.again)


def _place(derived: UnitDerivative, node: AST) -> SourcePlace | None:
    return SourcePlace.of(derived.unit.kernel.source, node) if getattr(node, "lineno", None) else None


def _called(place: SourcePlace | None, called: Mapping[Place, str]) -> str:
    return "" if place is None else called.get((place.path, place.line, place.column), "")
