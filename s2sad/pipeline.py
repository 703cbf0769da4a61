"""The pipeline: a program and a request in, a generated module out. Read this first.

    read        a function becomes a tree with places and resolved names        (the caller has done it)
    normalize   normal form, with the types of all names (`infer`)                   (KERNELS in `units`)
    analyze     activity, what can be infinite, what is recorded                     (DERIVATIVES in `units`)
    differentiate   adjoint or tangent                                               (DERIVATIVES in `units`)
    simplify    the same with less text
    optimize    for level "fast": faster loops
    emit        origin comments, the engine's dialect, the header, the text

Each room opens with its passes in the order in which they run.
"""
from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Set
from types import MappingProxyType
from typing import Any

import numpy as np

from s2sad.analyze.missing_shadows import missing_shadows
from s2sad.deep_stack import deep_stack
from s2sad.analyze.request import DerivativeRequest
from s2sad.differentiate.augmented_primal import with_tape
from s2sad.optimize.reusable_memory import ReusableMemory, reusable_memory
from s2sad.emit.line_table import line_table
from s2sad.optimize.directions import OneByOne, for_directions
from s2sad.emit.dialect import in_dialect, types_of
from s2sad.emit.header import documented, header, with_docstring
from s2sad.emit.module import ModuleText, module
from s2sad.emit.origins import with_origins
from s2sad.emit.recorded_arrays import recorded_arrays, snapshot_loop
from s2sad.emit.primal import kernels_called, primal_functions
from s2sad.infer.types import Type, of_value
from s2sad.normalize.calls.global_arrays import global_arrays, hidden_name
from s2sad.diagnostics import Diagnostic, S2sadError, Source, WaitingForFacts
from s2sad.evaluate.specialize import specialize
from s2sad.live_objects.guards import recording
from s2sad.read import load as read_function, of_captured
from s2sad.run.module_loader import load
from s2sad.program import (
    DemandedFacts, EntrySummary, Generated, Parameter, Program, RecordedArray, Request, SnapshotLoop,
    Snapshots, UnmadeDerivative,
)
from s2sad.run.user_functions_in_numba import compilable, registered_rules
from s2sad.naming import Names
from s2sad.optimize.inlining import inlined_functions
from s2sad.passes import Watch, unwatched
from s2sad.simplify import Effects
from s2sad.tree import FunctionDef, Name, user_call, walk
from s2sad.units import Place, UnitDerivative, Unit, Units, check_outlined, loops_that_keep, user_names
from s2sad.units.bounds import index_facts
from s2sad.units.nested_derivatives import (
    differentiated_program, nested_call, nested_request, settled, types_of_inner, with_derivative,
)
from s2sad.units.distinct_arguments import distinct_arguments
from s2sad.units.fast_functions import fast, fast_primal, fast_sweeps
from s2sad.units.rounded_tapes import refuse_unrounded

__all__ = ["EntrySummary", "derive", "summary"]


Forms = dict[tuple[Any, ...], tuple[Units, Unit]]
"""The normal forms of one program: its units and that of its entry, by engine and types, and the loops that keep
snapshots if there are such."""


@deep_stack
def summary(program: Program, types: tuple[Type, ...], forms: Forms | None = None) -> EntrySummary:
    """What the program's entry writes and returns for arguments of these types."""
    units, unit = entry(program, types, "numpy", forms=forms)
    parameters = [hidden_name(p.id, units.program) for p in unit.function.args.args]
    both = sorted({parameters[k] for k in unit.summary.written} & program.replaced)
    if both:
        raise S2sadError(Diagnostic("S201", f"'{both[0]}' is written in place, and replaced by another array in the "
                                    "object that has it", help="do either of them"))
    returned = {k: hidden_name(name, units.program) for k, name in unit.summary.returned.items()}
    return EntrySummary(tuple(parameters[k] for k in unit.summary.written), unit.summary.results, returned,
                   any(u.guarded for u in units.made.values()),
                   tuple(parameters[k] for k in unit.contiguous),
                   tuple(sorted(units.program.changed_outside)))


@deep_stack
def derive(program: Program, request: Request, watch: Watch = unwatched, forms: Forms | None = None) -> Generated:
    """The generated module that a request asks for; raises S2sadError with everything that is refused.

    `watch(stage, function)` is shown every function after every pass; `forms` are the program's normal forms that were
    made before, and take those that are made now.
    """
    if request.recording.limit:
        raise S2sadError(Diagnostic("S408", "a limit for the memory chooses loops by the sizes of arguments, which are "
                                    "not known here", help="name the loops that keep snapshots, and how many: k=20"))
    keep = loops_that_keep(program, request.recording.loops) if request.mode == "adjoint" else {}
    units, unit = entry(program, request.types, request.engine, watch, forms, keep)
    units.memory, units.tape_dtype = request.recording.memory, request.recording.tape_dtype
    if request.engine == "numba":
        compilable(units)
    bounds = index_facts(unit, units) if request.engine == "numba" else {}
    if request.mode == "primal":
        parameters = primals(unit, units)
        functions = primal_functions(units, [unit.title])
        if request.level == "fast" and request.engine == "numba":
            functions = [fast_primal(f, units) for f in functions]
        if request.engine == "numba":
            functions = in_dialect(functions, units)
        sources = [units.titled[f.name].kernel.source for f in functions]
        printed = module(functions, header=[f"The primal of {unit.kernel.name}."], constants=units.program.constants,
                         standalone=request.standalone)
        guards, places = line_table(printed, sources)
        return Generated(printed.text, unit.title, parameters, ("result",), {
            "guards": guards, "places": places, **bounds,
            "distinct": distinct_functions(functions, printed, units)})
    wanted = DerivativeRequest(request.wrt, expanded(request.of, unit), request.with_primal, split=request.split)
    derived = units.derive(request.mode, unit, wanted)
    units.keep_derived(derived)
    refuse_unrounded(units)
    made = [f for d in units.derived.values() for f in d.functions]
    found = facts(derived, request, units) | {"unshadowed": missing_shadows(
        unit.structure, derived.activity, {*wanted.wrt, *wanted.of}, units.call_edges), **bounds}

    functions = primal_functions(units, kernels_called(made, units))
    distinct = distinct_arguments(functions + made, types_of(units))

    def final(d: UnitDerivative) -> tuple[FunctionDef, ...]:
        """The function of a derivative, or the two of its sweeps."""
        plain = request.level != "fast" or d.function.name not in distinct
        if d.forward is None:
            return (d.function if plain else fast(d, units, inlined, not request.width),)
        return (d.forward, d.function) if plain else fast_sweeps(d, units, inlined)
    inlined = inlined_functions([*functions, *(d.function for d in units.derived.values() if d.forward is None)],
                                types_of(units))
    if request.level == "fast" and request.engine == "numba":       # steps that run again are most of what runs
        functions = [fast_primal(f, units, True) if units.titled[f.name].outlined else f for f in functions]
    sources = [units.titled[f.name].kernel.source for f in functions]
    for d in units.derived.values():
        more = [*d.beside, *(() if d is derived else of_callee(d, *final(d)))]
        functions += more
        sources += [d.unit.kernel.source] * len(more)
    *first, entered = final(derived)
    functions += first
    kept = with_caller_memory(derived, entered, units) if request.level == "fast" and not request.width else None
    if kept is None:
        functions.append(with_origins(entered, unit.kernel.source))
    else:
        functions += [documented(with_origins(kept.taped, unit.kernel.source), derived, "in given memory"),
                      kept.public]
        found |= {"taped": kept.taped.name, "stacks": kept.stacks, "arena": kept.arena}
    if request.level == "fast":
        functions, sources = called_still(functions, sources, inlined.keys() - {f.name for f in derived.functions})
    functions = in_dialect(functions, units)
    if request.width:
        functions = with_directions(functions, derived, request, units)
    if derived.forward is not None:
        title = Names(derived.types).fresh("tape")
        functions[-2:] = with_tape(functions[-2], functions[-1], len(unit.summary.results), derived.tape, title)
        found |= {"forward": functions[-2].name, "tape": tuple((e.kind, e.written) for e in derived.tape),
                  "taken": primals(unit, units)}
    printed = module(functions, header=header(derived, request, units),
                     constants={**units.program.constants, **units.tables()}, standalone=request.standalone)
    found["functions"] = printed.functions
    found["distinct"] = distinct_functions(functions, printed, units, request.width)
    sources += [unit.kernel.source] * (len(functions) - len(sources))
    found["guards"], found["places"] = line_table(printed, sources)
    if request.mode == "adjoint":
        spelled = dict(zip((f.name for f in functions), (f.name for f in printed.functions)))
        found["recorded"], found["loops"] = recorded(derived, units, spelled, "" if kept is None else kept.taped.name)
    parameters = tuple(Parameter(hidden_name(n, units.program) if role == "primal" else n, role,
                                 hidden_name(p, units.program), derived.types[n])
                       for n, role, p in derived.made.parameters if role != "tape")
    return Generated(printed.text, derived.function.name, parameters, tuple(derived.made.returns), found)


def distinct_functions(functions: list[FunctionDef], printed: ModuleText, units: Units, width: int = 0
                       ) -> tuple[str, ...]:
    """The functions of a printed module that are never given memory twice; for many directions numbers are arrays."""
    found = distinct_arguments(functions, {} if width else types_of(units))
    return tuple(p.name for f, p in zip(functions, printed.functions) if f.name in found)


def called_still(functions: list[FunctionDef], sources: list[Source], inlined: Set[str]
                 ) -> tuple[list[FunctionDef], list[Source]]:
    """The functions without those of which every call has been inlined; sources are those of the first ones."""
    while True:
        used = Counter(n.id.rpartition(".")[2] for f in functions for n in {
            n.id: n for n in walk(f.body) if isinstance(n, Name)}.values())
        gone = {f.name for f in functions if f.name in inlined and not used[f.name]}
        if not gone:
            return functions, sources
        sources = [s for f, s in zip(functions, sources) if f.name not in gone]
        functions = [f for f in functions if f.name not in gone]


def with_directions(functions: list[FunctionDef], derived: UnitDerivative, request: Request, units: Units
                    ) -> list[FunctionDef]:
    """The functions of a module for many directions; raises S2sadError (S411) where it has to be one at a time."""
    owners = [d.unit.kernel for d in units.derived.values() if d.unit.kernel.own is not None or d.unit.kernel.residual]
    given = [n for n, role, _ in derived.made.parameters if role in ("shadow", "seed")]
    results = [t for r in derived.made.returns for t in result_types(r, derived)]
    types = types_of(units)
    for d in units.derived.values():
        types |= {f.name: {**types[f.name], **d.made.coalesced} for f in d.functions}
    try:
        if owners:
            raise OneByOne(f"'{owners[0].name}' has a derivative of its own")
        if request.engine == "numba" and any(t.is_complex for table in types.values() for t in table.values()):
            raise OneByOne("room for numbers of each direction has one dtype, and some are complex")
        return for_directions(functions, derived.function.name, given, types, request.engine, request.width,
                              results)
    except OneByOne as why:
        raise S2sadError(Diagnostic("S411", f"'{derived.unit.kernel.name}' is differentiated for one direction at a "
                                    "time", note=str(why))) from None


def result_types(returned: str, derived: UnitDerivative) -> tuple[Type, ...]:
    """The types of what a derivative returns under a name."""
    results = derived.unit.summary.results
    if returned == "result":
        return results
    place = returned.removeprefix("return ")
    return (results[int(place)] if place != returned else derived.types[returned],)


def of_callee(d: UnitDerivative, *made: FunctionDef) -> list[FunctionDef]:
    """The functions of a derivative that another one calls, as the file has them."""
    *first, last = made
    last = with_origins(last, d.unit.kernel.source)
    if d.kept:
        first[0], last = d.called_halves(first[0], last)
        first[0] = with_docstring(first[0], f"Forward sweep of {d.unit.kernel.name}, which returns its tape.")
    return [*first, documented(last, d)]


def recorded(entered: UnitDerivative, units: Units, spelled: Mapping[str, str], taped: str
             ) -> tuple[tuple[RecordedArray, ...], tuple[SnapshotLoop, ...]]:
    """What the functions of a module record, which are `spelled` so there, and the loops that keep snapshots."""
    arrays: list[RecordedArray] = []
    loops: list[SnapshotLoop] = []
    called = units.program.once(user_names)
    for d in units.derived.values():
        halves = (d.function,) if d.forward is None else (d.function, d.forward)
        own = [*(f.name for f in (*halves, *d.beside)), *([taped] if taped and d is entered else [])]
        own = [spelled[f] for f in own if f in spelled]
        arrays += recorded_arrays(d, own, called)
        if d.unit.loop is not None and d.made.snapshots:
            loops.append(snapshot_loop(d, spelled[d.beside[0].name], called))
    return tuple(arrays), tuple(loops)


def primals(unit: Unit, units: Units) -> tuple[Parameter, ...]:
    """The parameters of a kernel."""
    return tuple(Parameter(hidden_name(p.id, units.program), "primal", p.id, t)
                 for p, t in zip(unit.function.args.args, unit.types))


def with_caller_memory(derived: UnitDerivative, function: FunctionDef, units: Units) -> ReusableMemory | None:
    """The entry's derivative over memory that the caller keeps between calls."""
    if units.engine != "numba" or derived.forward is not None:
        return None
    tape = derived.made.tape
    foreign = registered_rules(units.program) or any(k.residual for k in units.program.kernels.values())
    return reusable_memory(function, [] if tape is None else list(tape.stacks.values()), derived.types,
                           units.titles.fresh(f"{derived.function.name}_taped"),
                           with_arena=not foreign)      # functions of the user's may keep what they are given


def entry(program: Program, types: tuple[Type, ...], engine: str, watch: Watch = unwatched,
          forms: Forms | None = None, keep: Mapping[Place, Snapshots] = MappingProxyType({})) -> tuple[Units, Unit]:
    """The units of a program and the one of its entry; arrays from outside have become parameters. The loops at the
    places `keep` keep snapshots."""
    made = {} if forms is None else forms
    if program.refused is not None:
        raise program.refused       # it waits for what it is given
    key = (engine, types, *sorted(keep.items()))
    if keep:
        entry(program, types, engine, forms=made)
        if key not in made:
            read = residual(program, types, program.evaluated[types]) if types in program.evaluated else program
            made[key] = normal_form(read, types, engine, watch, keep)
            check_outlined(program, keep, made[key][0].outlined_at)
    elif (engine, types) not in made:
        if engine != "numpy" and program.function is not None:
            entry(program, types, "numpy", forms=made)      # which says what the program is, for all engines
        try:
            if types in program.evaluated:
                made[engine, types] = evaluated_form(program, types, engine, watch, program.evaluated[types])
            else:
                made[engine, types] = normal_form(program, types, engine, watch)
        except S2sadError as refused:
            made[engine, types] = evaluated_form(program, types, engine, watch, refused)
    units, unit = made[key]
    return units.without_derivatives(), unit


def normal_form(program: Program, types: tuple[Type, ...], engine: str, watch: Watch,
                keep: Mapping[Place, Snapshots] = MappingProxyType({})) -> tuple[Units, Unit]:
    """The units of a program, and that of its entry for arguments of these types."""
    program = global_arrays(program)
    types += tuple(of_value(a) for a in program.arrays.values())
    while True:
        units = Units(program, engine, watch=watch, checkpoints=keep)
        try:
            return units, units.unit(program.entry, types)
        except UnmadeDerivative as unmade:
            program = derivative_made(program, unmade, engine)


def derivative_made(program: Program, unmade: UnmadeDerivative, engine: str) -> Program:
    """The program in which a kernel that stands for a derivative calls its text."""
    nested = nested_call(program, unmade.kernel)
    inner = differentiated_program(program, nested)
    about = summary(inner, types_of_inner(nested, unmade.types))
    nested = settled(nested, unmade.types, about)
    made = derive(inner, nested_request(nested, unmade.types, engine))
    text = load(made.text, made.entry)
    return with_derivative(program, nested, unmade.types, made, read_function(getattr(text, made.entry)), about)


def evaluated_form(program: Program, types: tuple[Type, ...], engine: str, watch: Watch, refused: S2sadError
                   ) -> tuple[Units, Unit]:
    """The same of the residual program, where what is read is refused; raises what was refused if this is, too."""
    made = residual(program, types, refused)
    try:
        found = normal_form(made, types, engine, watch)
    except DemandedFacts:
        raise WaitingForFacts(*refused.diagnostics) from None
    except S2sadError:
        raise refused from None
    program.evaluated[types] = refused
    return found


def residual(program: Program, types: tuple[Type, ...], refused: S2sadError) -> Program:
    """The residual program for arguments of these types; raises what was refused if there is none."""
    wrong_argument = refused.diagnostics[0].code == "S405"
    if program.function is None or program.refused is not None or wrong_argument:
        raise refused
    try:
        with recording(program.guards):
            found = specialize(program.function, dict(zip(program.kernels[program.entry].parameters, types)), {},
                               inlines=True)
            made = of_captured(found, program.function)
    except DemandedFacts:
        raise WaitingForFacts(*refused.diagnostics) from None
    except S2sadError:
        raise refused from None
    arrays = [*made.arrays.values()], [*program.arrays.values()]
    taken = len(arrays[0]) == len(arrays[1]) and all(map(_is_same_array, *arrays))
    if not taken or found.result is not None or len(found.paths) != len(types):
        raise refused
    return made


def _is_same_array(a: Any, b: Any) -> bool:
    """Whether two arrays from outside are one, or tables of the same numbers, which are made anew."""
    return a is b or a.dtype == b.dtype and np.array_equal(a, b)


def expanded(of: tuple[str, ...], unit: Unit) -> tuple[str, ...]:
    """The outputs, "return" as the numbers of the float results, less the arguments that are outputs themselves."""
    parameters = [p.id for p in unit.function.args.args]
    written = {parameters[k] for k in unit.summary.written}
    results = tuple(f"return {k}" for k, t in enumerate(unit.summary.results)
                    if t.is_inexact and unit.summary.returned.get(k) not in written)
    return tuple(o for name in of for o in (results if name == "return" else (name,)))


def _written(derived: UnitDerivative, effects: Effects) -> set[str]:
    """The names of a derivative that it may write: of two sweeps, or where it calls what is not known, all."""
    body = derived.function.body + (derived.forward.body if derived.forward is not None else [])
    if derived.forward is None and all(effects.of(n) for n in walk(body) if user_call(n)):
        return {p.id for p in derived.function.args.args} & effects.written(derived.function)
    return {n.id for n in walk(body) if isinstance(n, Name)}


def facts(derived: UnitDerivative, request: Request, units: Units) -> dict[str, Any]:
    """What wrappers and reports ask of a derivative: which of `wrt` no output depends on, all that was made, whether
    functions are arguments of functions, which Numba does not keep on disk, the folders of snapshots, and which
    arguments it leaves as they are."""
    active = derived.activity.active
    moving = any(d.unit.kernel.residual and d.beside for d in units.derived.values())
    folders = dict.fromkeys(u.loop.snapshots.on_disk for u in units.titled.values() if u.loop is not None)
    unwritten = tuple(hidden_name(p, units.program) for p, role, _ in derived.made.parameters
                      if role == "primal" and p not in _written(derived, units.effects))
    return {"independent": tuple(w for w in request.wrt if w not in active), "derived": derived, "units": units,
            "unwritten": unwritten,
            "moving": moving, "folders": tuple(f for f in folders if f is not None)}
