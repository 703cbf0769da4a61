"""fast_functions: derivatives and kernels at the level "fast": after the passes of `optimize`."""
from __future__ import annotations

from collections.abc import Mapping, Set

from s2sad import optimize
from s2sad.naming import Names
from s2sad.passes import run
from s2sad.simplify import DerivativeContext, InlinedFunction, remove_marks
from s2sad.tree import Call, FunctionDef, call_name, copy, names, walk, with_body
from s2sad.units.unit_derivatives import UnitDerivative, Units


def fast(derived: UnitDerivative, units: Units, inlined: Mapping[str, InlinedFunction], in_rows: bool = True
         ) -> FunctionDef:
    """A derivative after the passes of `optimize`; its loops need no rows that run in vectors where directions do."""
    context = _context(derived, derived.function, units, frozenset(), inlined)
    context.adjoint = context.adjoint and in_rows
    return run(optimize.PASSES, derived.function, context)


def fast_sweeps(derived: UnitDerivative, units: Units, inlined: Mapping[str, InlinedFunction]
                ) -> tuple[FunctionDef, FunctionDef]:
    """The two functions of a derivative after these passes. A function of numbers is the system's in both or in none:
    what the second computes again has the digits that it had."""
    assert derived.forward is not None
    known = with_body(derived.function, [*map(copy, derived.equal_sizes), *derived.function.body])
    system: Set[str] = frozenset()
    while True:
        made, contexts = [], []
        for function in (derived.forward, known):
            contexts.append(_context(derived, function, units, system, inlined))
            made.append(remove_marks(run(optimize.PASSES, function, contexts[-1]), contexts[-1]))
        first, second = (c.called_math for c in contexts)
        apart = {f for f in first.keys() & second.keys() if first[f] != second[f]}
        if not apart:
            return made[0], made[1]
        system |= apart


def _context(derived: UnitDerivative, function: FunctionDef, units: Units, system: Set[str],
             inlined: Mapping[str, InlinedFunction]) -> DerivativeContext:
    """What the passes share for a function of a derivative; the functions `system` stay the system's."""
    tape, made = derived.made.tape, derived.made
    family = derived.unit.family
    sums = {f"{family.get(p, p)}_bar" for p in made.shadows} - {*family, *family.values()}
    # numbers of the derivative's own: what it sums into them has no order that a value of the kernel depends on
    own = {n for n in names(function.body) if shadow_of(n) in sums and n not in family}
    own |= {n for n, kind in derived.types.items() if n not in derived.unit.typing.table and kind.is_number
            and kind.is_inexact}
    shadows = {n for n, role, _ in made.parameters if role == "shadow"}
    primals = {p.id for p in function.args.args if derived.types[p.id].is_array}
    return DerivativeContext(
        program=units.program, kernel=derived.unit.kernel, names=Names(), engine=units.engine, watch=units.watch,
        types=derived.types, effects=units.effects, adjoint=tape is not None,
        live_out=primals if function is derived.forward else shadows,
        stacks=set() if tape is None else {s.array for s in tape.stacks.values()},
        tops=set() if tape is None else {s.top for s in tape.stacks.values() if s.top},
        gaining={s for s in made.shadows.values() if derived.types[s].is_array} | made.sums,
        numbers=own, seeds={n for n, role, _ in made.parameters if role == "seed"},
        shadows={s: p for p, s in made.shadows.items()}, writing=_writing(function, units), system_math=system,
        inlined=inlined)


def fast_primal(function: FunctionDef, units: Units, adjoint: bool = False) -> FunctionDef:
    """A kernel's function after the passes of `optimize`, those for adjoints if it is a part of one."""
    unit = units.titled[function.name]
    context = DerivativeContext(
        program=units.program, kernel=unit.kernel, names=Names(), engine=units.engine, watch=units.watch,
        types=unit.lowered_types, effects=units.effects, adjoint=adjoint,
        live_out={p.id for p in function.args.args if unit.typing.table[p.id].is_array} if adjoint else set(),
        writing=_writing(function, units))
    return run(optimize.PASSES, function, context)


def _writing(function: FunctionDef, units: Units) -> set[str]:
    """The functions that a function calls and that write arrays."""
    return {call_name(n) or "" for n in walk(function.body) if isinstance(n, Call) and units.effects.writes(n)}


def shadow_of(identifier: str) -> str:
    """The name of a shadow without the number of its version."""
    stem, _, number = identifier.rpartition("_")
    return stem if number.isdigit() else identifier
