"""The interface of the compiler to what runs derivatives.

Nothing but `deferred.compiler` imports this module, when something must be read or derived: a process that finds on
disk what it calls goes without.
"""
from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from types import FunctionType, MappingProxyType
from typing import Any

from s2sad import pipeline, read
from s2sad.evaluate.needs_evaluation import needs_evaluation
from s2sad.evaluate.specialize import Residual, specialize, unread
from s2sad.evaluate.specialize.evaluator import UNROLL_LIMIT
from s2sad.evaluate.specialize.signals import OutsideError
from s2sad.live_objects.registry import GIVEN
from s2sad.live_objects.guards import Guards, Path, reached, recording, same
from s2sad.live_objects.unwrap import python_function
from s2sad.infer.independents import independents, usable_as_floats
from s2sad.infer.types import UNKNOWN, Type, array, of_value
from s2sad.liveness import base_name
from s2sad.program import (
    DemandedFacts, EntrySummary, Evaluation, Fact, FlatProgram, Generated, Kernel, Program, Request,
)
from s2sad.diagnostics import Diagnostic, S2sadError
from s2sad.read.capture import not_a_function
from s2sad.run.user_functions_in_numba import checked_constants, compiled_in, registered_rules, uncompiled
from s2sad.run.user_derivatives import checked_derivatives
from s2sad.pytree import Form, leaves
from s2sad.tree import Assign, Subscript, equal, walk_statements

__all__ = ["checked_constants", "checked_derivatives", "compiled_in", "derived", "entry_kernel", "flat_program",
           "not_a_function", "program", "registered_rules", "same_program", "summary", "uncompiled",
           "waiting"]


def program(function: Any, varying: Collection[Path] = ()) -> Program:
    """The program of a live function; where reading refuses it, its residual program for arguments that are arrays and
    numbers, or one that waits for what it is given."""
    plain, refused = python_function(function), None
    try:
        found = replace(read.load(function, varying), function=plain)
        if plain is None or not needs_evaluation(found) or GIVEN.own(plain) is not None:
            return found
    except S2sadError as error:
        if plain is None or error.diagnostics[0].code.startswith("S1"):
            raise
        refused = error
    try:
        return residual_program(plain, varying)
    except S2sadError as error:
        return waiting(plain, refused or error, varying)


def residual_program(function: FunctionType, varying: Collection[Path]) -> Program:
    """The residual program of a function for arguments that are arrays and numbers, of types that are not known;
    raises S2sadError."""
    with recording(Guards(varying)) as guards:
        reached(None, "root", 0, function)
        outline = unread(function)
        kernel = outline.kernels[outline.entry]
        try:
            residual = specialize(function, dict.fromkeys(kernel.parameters, UNKNOWN), {})
        except DemandedFacts as demanded:
            raise demanded.error from None
        if residual.result is not None or residual.paths != {p: p for p in kernel.parameters}:
            raise S2sadError(Diagnostic("S201", "what is returned is made of more than arrays and numbers"))
        made = read.of_captured(residual, function)
    entry = replace(made.kernels[made.entry], defaults=kernel.defaults, annotations=kernel.annotations,
                    rest=kernel.rest)
    return replace(made, kernels={**made.kernels, made.entry: entry}, guards=guards, replaced=residual.replaced,
                   function=function, evaluation=_evaluation(residual, {}), changed_outside=residual.changed_outside)


def waiting(function: FunctionType, refused: S2sadError, varying: Collection[Path]) -> Program:
    """The program of a function that waits for what it is given."""
    with recording(Guards(varying)) as guards:
        reached(None, "root", 0, function)
        return replace(unread(function, refused), guards=guards)


def entry_kernel(program: Program) -> Kernel:
    """The entry, and which of its parameters are floats."""
    kernel = program.kernels[program.entry]
    usable = usable_as_floats(program.entry, {n: k.tree for n, k in program.kernels.items()})
    found = independents(usable, kernel.parameters, kernel.annotations, kernel.defaults)
    return replace(kernel, floats=tuple(p for p in kernel.parameters if p in usable), independents=found)


def summary(program: Program, types: tuple[Any, ...], forms: dict[Any, Any]) -> EntrySummary:
    """What the entry of a program writes and returns; raises S2sadError."""
    return pipeline.summary(program, types, forms)


def derived(program: Program, request: Request, forms: dict[Any, Any]) -> Generated:
    """The generated module for a request; raises S2sadError."""
    return pipeline.derive(program, request, forms=forms)


def flat_program(program: Program, function: FunctionType, forms: tuple[Form, ...], varying: Collection[Path],
                facts: Mapping[Fact, Any] = MappingProxyType({})) -> FlatProgram:
    """The residual program for arguments of these forms; raises S2sadError, and DemandedFacts where `facts` does not
    say enough of the arguments."""
    return evaluated(replace(program, function=function), forms, varying, facts, program.refused or S2sadError())


def _in_normal_form(flat: FlatProgram, parameters: Sequence[str], forms: tuple[Form, ...]
                    ) -> tuple[FlatProgram, frozenset[str]]:
    """A flat program with its normal form, and the paths of cells that become something that they do not hold: a float
    in an integer's; raises S2sadError."""
    program = flat.program
    types = {path: t for p, form in zip(parameters, forms) for path, t in leaves(form, p)}
    if UNKNOWN in types.values():
        return flat, frozenset()
    normal: dict[Any, Any] = {}
    given = [(n, types[flat.paths[n]]) for n in program.kernels[program.entry].parameters]
    _, unit = pipeline.entry(program, tuple(array(t.dtype, 1) if n in flat.cells else t for n, t in given), "numpy",
                             forms=normal)
    stores = [(base_name(s.targets[0]), unit.typing.of(s.value)) for s in walk_statements(unit.function.body)
              if isinstance(s, Assign) and isinstance(s.targets[0], Subscript)]
    misfits = frozenset(flat.paths[n] for n, t in stores if n in flat.cells and not _fits(t, types[flat.paths[n]]))
    return replace(flat, normal=normal), misfits


def _fits(value: Type, cell: Type) -> bool:
    """Whether a cell holds a number of a type as it is."""
    return value.dtype == cell.dtype or cell.is_inexact and not (value.is_complex and cell.is_float)


def evaluated(program: Program, forms: tuple[Form, ...], varying: Collection[Path], facts: Mapping[Fact, Any],
              refused: S2sadError) -> FlatProgram:
    """The residual program of a function for arguments of these forms, with its normal form; where a list that grows
    in a loop of many rounds stands in the way the loop is written out, as are calls where they do, and then every loop
    in which lists grow. Raises S2sadError."""
    parameters = program.kernels[program.entry].parameters
    found = first = None
    stayed = False
    for unrolls, inlines, limit in ((False, False, UNROLL_LIMIT), (False, False, math.inf), (False, True, math.inf),
                                    (True, True, math.inf)):
        if limit > UNROLL_LIMIT and not (inlines or stayed):
            continue
        no_cells: frozenset[str] = frozenset()
        try:
            while True:
                made, stayed = _evaluated(program, forms, varying, facts, refused, unrolls, inlines, no_cells, limit)
                found = made if found is None and not (unrolls or stayed) else found
                made, misfits = _in_normal_form(made, parameters, forms)
                if not misfits:
                    return made
                no_cells |= misfits
        except S2sadError as error:
            first = first or (None if stayed else error)
    if found is None:
        raise first or refused
    return found


def _evaluated(program: Program, forms: tuple[Form, ...], varying: Collection[Path], facts: Mapping[Fact, Any],
               refused: S2sadError, unrolls: bool, inlines: bool, no_cells: frozenset[str], unroll_limit: float
               ) -> tuple[FlatProgram, bool]:
    """The residual program, and whether loops of many rounds stayed in it that could be written out."""
    with recording(Guards(varying)) as guards:
        reached(None, "root", 0, program.function)
        inside = program.refused is not None       # what reading has refused the evaluator may know more of
        try:
            residual = specialize(program.function, dict(zip(program.kernels[program.entry].parameters, forms)), facts,
                                  unrolls, inlines, no_cells, unroll_limit=unroll_limit)
            inside = False
            made = read.of_captured(residual, program.function)
        except S2sadError as error:
            lines = set() if inside and not isinstance(error, OutsideError) else set(map(_line, error.diagnostics))
            there = [d for d in refused.diagnostics if _line(d) in lines - {None}]
            raise (S2sadError(*there) if there else error) from None
    made = replace(made, guards=guards, replaced=residual.replaced, evaluation=_evaluation(residual, facts),
                   changed_outside=residual.changed_outside)
    return FlatProgram(made, residual.paths, residual.cells, residual.result, residual.changed,
                       residual.mutated, residual.live), residual.stayed


def _evaluation(residual: Residual, facts: Mapping[Fact, Any]) -> Evaluation:
    """What was computed away, for reports."""
    return Evaluation({n: p for n, p in residual.paths.items() if n != p}, residual.unrolled, tuple(facts.items()))


def _line(found: Diagnostic) -> tuple[str, int] | None:
    """The user's line that a diagnostic is about."""
    if found.span is None:
        return None
    source, line = found.span.source.home(found.span.line)
    return source.path, line


def same_program(ours: Program, theirs: Program) -> bool:
    """Whether two readings of one function are the same, but for the derivatives that the user gave what they call."""
    return (list(ours.constants) == list(theirs.constants) and list(ours.arrays) == list(theirs.arrays)
            and all(same(v, theirs.constants[k]) for k, v in ours.constants.items())
            and all(of_value(v) == of_value(theirs.arrays[k]) for k, v in ours.arrays.items())
            and ours.records == theirs.records
            and list(ours.kernels) == list(theirs.kernels)
            and all(_same_kernel(k, theirs.kernels[name]) for name, k in ours.kernels.items()))


def _same_kernel(ours: Kernel, theirs: Kernel) -> bool:
    return (ours.source == theirs.source and equal(ours.tree, theirs.tree)    # a name may mean another function now
            and ours.own is theirs.own and ours.nested == theirs.nested and list(ours.defaults) == list(theirs.defaults)
            and all(same(v, theirs.defaults[k]) for k, v in ours.defaults.items()))
