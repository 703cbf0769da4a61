"""What a derivative records, in words: each stack with what lies on it, which statements need it, and its bytes.

    u_stack: u before `u += dt * du`, 8 * len(range(steps)) * u.size bytes
"""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from s2sad.liveness import base_name
from s2sad.differentiate.tape import Stack
from s2sad.emit.layout import text
from s2sad.emit.origins import text_of
from s2sad.tree import AST, Attribute, Name, Tuple, attribute, const, copy, mult, rename, stored_names, walk
from s2sad.units import UnitDerivative


_LONGEST = 48


@dataclass(frozen=True)
class StackEntry:
    """One stack: the variable whose value lies on it, the statement at which it is pushed, those that need it.

    `factors` are the trees whose product is its bytes, of one push if it grows.
    """
    array: str
    variable: str
    what: str
    dtype: str
    statement: AST
    readers: tuple[AST, ...]
    factors: tuple[AST, ...]
    grows: bool
    family: dict[str, str]

    @property
    def formula(self) -> str:
        """The bytes as an expression in the names of the kernel."""
        product = self.factors[0]
        for factor in self.factors[1:]:
            product = mult(product, factor)
        return text(rename(product, self.family)) + (" per push" if self.grows else "")

    @property
    def bytes_of_number(self) -> int | None:
        """The bytes of a number that lies in no array; None of what does."""
        return None if self.grows or len(self.factors) > 1 else np.dtype(self.dtype).itemsize


def recorded_by(derived: UnitDerivative) -> list[StackEntry]:
    """The stacks of one derivative, in the order in which they were made; none for a tangent."""
    if derived.unit.loop is not None and derived.plan is not None:
        return [_snapshot(derived, s, n) for s, n in derived.made.snapshots.items()]
    if derived.made.tape is None or derived.plan is None:
        return []
    present = {n.id for n in walk(derived.function.body) if isinstance(n, Name)}
    wished = derived.made.tape.free.hints
    found: list[StackEntry] = []
    for key, stack in derived.made.tape.stacks.items():
        if stack.array in present or not stack.sizes and not stack.grows and wished.get(stack.array) in present:
            found.append(_recorded(derived, key, stack))
    return found


def recorded_lines(derived: UnitDerivative, others: list[UnitDerivative]) -> list[str]:
    """The lines of the header: the stacks of the entry and of the derivatives that it calls."""
    lines = []
    for each in [derived, *(d for d in others if d is not derived)]:
        place = "" if each is derived else f" in {each.function.name}"
        lines += [f"    {r.array}{place}: {r.what}, {_unbroken(r)} bytes"
                  f"{' per push' if r.grows else ''}" for r in recorded_by(each)]
        lines += [f"    {stack}{place}: what `{text_of(statement, each.unit.kernel.source, _LONGEST)}` keeps"
                  for stack, statement in each.made.kept]
    return ["It records:", *lines] if lines else ["It records nothing."]


def _unbroken(recorded: StackEntry) -> str:
    """The formula of the bytes, which no line's end divides."""
    return recorded.formula.replace(" per push", "").replace(" ", "\xa0")


def _recorded(derived: UnitDerivative, key: str, stack: Stack) -> StackEntry:
    plan, places = derived.plan, derived.structure.places
    assert plan is not None
    family, source = derived.unit.family, derived.unit.kernel.source
    readers = tuple(plan.readers.get(key, ()))
    if key in plan.stores:
        statement, place = plan.stores[key].statement, plan.stores[key].place
        variable = base_name(place)
        what = f"{variable} before `{text_of(statement, source, _LONGEST)}`"
    elif key in plan.recorded:
        value = plan.recorded[key]
        variable, carried = family.get(value.name, value.name), value.kind == "carried"
        statement = value.home if carried or len(value.bindings) != 1 else value.bindings[0]
        said = text_of(statement, source, _LONGEST)
        if variable not in names_of(derived):
            what = f"which way `{said}` went" if stack.kind.dtype == "bool" else f"a part of `{said}`"
        else:
            what = f"{variable} where an iteration of `{said}` begins" if carried else f"{variable} after `{said}`"
    elif key in (saved := {s.key: s for s in plan.snapshots}):
        statement, variable = saved[key].loop, saved[key].array
        what = f"{variable} where an iteration of `{text_of(statement, source, _LONGEST)}` begins"
        readers = tuple(x.statement for x in derived.structure.inner[id(statement)])
    elif key.startswith("size "):
        statement = places[int(key.split()[1])].statement
        variable = base_name(statement.targets[0])
        what = f"the size of {variable} before `{text_of(statement, source, _LONGEST)}`"
        readers = readers or (statement,)
    else:
        statement = places[int(key.split()[1])].statement
        variable, what = "trips", f"the trips of `{text_of(statement, source, _LONGEST)}`"
        readers = readers or (statement,)
    if key in plan.exact:
        what += f", not rounded for `{text_of(plan.exact[key], source, _LONGEST)}`"
    elif stack.kind.is_inexact and stack.kind != stack.value:
        what += f", as {stack.kind.dtype}"
    return StackEntry(stack.array, variable, what, stack.kind.dtype, statement, readers, _factors(stack),
                      stack.grows, family)


def _snapshot(derived: UnitDerivative, stack: str, kept: AST) -> StackEntry:
    """The states that a loop keeps of an array, of a part of one or of a number."""
    unit, loop = derived.unit, derived.unit.loop
    assert loop is not None and derived.made.rows is not None
    variable, family = base_name(kept), unit.family
    kind = unit.typing.table[variable]
    cells = [attribute(copy(kept), "size")] if kind.is_array else []
    each = np.dtype(kind.dtype).itemsize
    said = text_of(loop.loop, unit.kernel.source, _LONGEST)
    return StackEntry(stack, variable, f"{family.get(variable, variable)} before some steps of `{said}`", kind.dtype,
                      loop.loop, (), (const(each), derived.made.rows, *cells), False, family)


def names_of(derived: UnitDerivative) -> set[str]:
    """The names of the user's function."""
    kernel = derived.unit.kernel
    return {*kernel.parameters, *stored_names(kernel.tree.body)}


def _factors(stack: Stack) -> tuple[AST, ...]:
    shape = stack.shape
    cells: list[AST] = []
    if isinstance(shape, Tuple):
        cells = list(shape.elts)
    elif isinstance(shape, Attribute):
        cells = [attribute(shape.value, "size")]
    elif shape is not None:
        cells = [shape]
    each = np.dtype(stack.kind.dtype or "float64").itemsize
    counts = (*stack.sizes, *cells)
    return (const(each), *counts) if each > 1 or not counts else counts
