"""The interface of the compiler to what runs derivatives.

Nothing but `deferred.compiler` imports this module, when something must be read or derived: a process that finds on
disk what it calls goes without.
"""
from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from types import FunctionType, MappingProxyType
from typing import Any

from s2sad import pipeline, read
from s2sad.evaluate.specialize import specialize, unread
from s2sad.evaluate.specialize.evaluator import OutsideError
from s2sad.live_objects.guards import Guards, Path, reached, recording, same
from s2sad.live_objects.unwrap import python_function
from s2sad.infer.independents import independents, usable_as_floats
from s2sad.infer.types import NONE, UNKNOWN, array, of_value
from s2sad.evaluate.structures.call_values import Unread
from s2sad.evaluate.structures.fields import Flat, fields
from s2sad.evaluate.structures.fields import asks as structures_matter
from s2sad.evaluate.structures.groups import StructureValue, nothing
from s2sad.program import DemandedFacts, EntrySummary, Fact, Generated, Kernel, Program, Request
from s2sad.diagnostics import Diagnostic, S2sadError
from s2sad.read.capture import not_a_function
from s2sad.run.user_functions_in_numba import checked_constants, compiled_in, registered_rules, uncompiled
from s2sad.run.user_derivatives import checked_derivatives
from s2sad.pytree import SPARSE, Form, PyTree, leaves
from s2sad.tree import equal

__all__ = ["asks", "checked_constants", "checked_derivatives", "compiled_in", "derived", "entry_kernel", "flat_program",
           "not_a_function", "program", "registered_rules", "result_form", "same_program", "summary", "uncompiled",
           "waiting"]


def program(function: Any, methods: tuple[Any, ...] = (), varying: Collection[Path] = ()) -> Program:
    """The program of a live function; where reading refuses it, its residual program for arguments that are arrays and
    numbers, or one that waits for what it is given."""
    plain = python_function(function)
    try:
        return replace(read.load(function, methods, varying), function=plain)
    except S2sadError as refused:
        if plain is None or refused.diagnostics[0].code.startswith("S1"):
            raise
        try:
            return residual_program(plain, varying)
        except S2sadError as refused:
            return waiting(plain, refused, varying)


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
    entry = replace(made.kernels[made.entry], defaults=kernel.defaults, annotations=kernel.annotations)
    return replace(made, kernels={**made.kernels, made.entry: entry}, guards=guards, replaced=residual.replaced,
                   function=function)


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


def asks(program: Program) -> bool:
    """Whether what a program is depends on what its arguments are made of."""
    return program.refused is not None or structures_matter(program)


def flat_program(program: Program, function: FunctionType, forms: tuple[Form, ...], varying: Collection[Path],
                facts: Mapping[Fact, Any] = MappingProxyType({})) -> tuple[Flat, list[Any], Guards]:
    """The flat program, the functions of classes that it calls, which are read as they are met, and what was taken of
    the arguments' classes; raises DemandedFacts where `facts` does not say enough of the arguments."""
    if program.refused is not None:
        return evaluated(program, forms, varying, facts, program.refused)
    if any(map(_has_matrix, forms)):
        said = S2sadError(Diagnostic("S201", "sparse matrices are evaluated"))
        return evaluated(replace(program, function=function), forms, varying, facts, said)
    parameters = program.kernels[program.entry].parameters
    try:
        found = _fields(program, function, forms, varying)
    except S2sadError as refused:
        return evaluated(replace(program, function=function), forms, varying, facts, refused)
    try:
        return _in_normal_form(found, parameters, forms)
    except S2sadError as refused:
        try:
            return evaluated(replace(program, function=function), forms, varying, facts, refused)
        except S2sadError:
            return found        # which is refused where it is used, by the names that the user has


def _in_normal_form(found: tuple[Flat, list[Any], Guards], parameters: Sequence[str], forms: tuple[Form, ...]
                    ) -> tuple[Flat, list[Any], Guards]:
    """A flat program with its normal form; raises S2sadError."""
    flat, methods, guards = found
    program = flat.program
    types = {path: t for p, form in zip(parameters, forms) for path, t in leaves(form, p)}
    if UNKNOWN in types.values():
        return found
    normal: dict[Any, Any] = {}
    given = [(n, types[flat.paths[n]]) for n in program.kernels[program.entry].parameters]
    pipeline.entry(program, tuple(array(t.dtype, 1) if n in flat.cells else t for n, t in given), "numpy", forms=normal)
    return replace(flat, normal=normal), methods, guards


def _has_matrix(form: Form) -> bool:
    """Whether an argument is a sparse matrix or has one in it."""
    return isinstance(form, PyTree) and (form.kind in SPARSE or any(map(_has_matrix, form.items)))


def _fields(program: Program, function: FunctionType, forms: tuple[Form, ...], varying: Collection[Path]
            ) -> tuple[Flat, list[Any], Guards]:
    """The same without the evaluator; raises S2sadError."""
    methods: list[Any] = []
    while True:
        try:
            with recording(Guards()) as guards:
                return fields(program, forms), methods, guards
        except Unread as missing:
            methods.append(missing.function)
            program = read.load(function, tuple(methods), varying)


def evaluated(program: Program, forms: tuple[Form, ...], varying: Collection[Path], facts: Mapping[Fact, Any],
              refused: S2sadError) -> tuple[Flat, list[Any], Guards]:
    """The residual program of a function for arguments of these forms, with its normal form; where calls stand in
    the way they are written out, and where lists that grow in loops do, these loops. Raises S2sadError."""
    parameters = program.kernels[program.entry].parameters
    found, first = None, None
    for unrolls, inlines in ((False, False), (False, True), (True, True)):
        try:
            made = _evaluated(program, forms, varying, facts, refused, unrolls, inlines)
            found = made if found is None and not unrolls else found
            return _in_normal_form(made, parameters, forms)
        except S2sadError as error:
            first = first or error
    if found is not None:
        return found
    assert first is not None
    raise first from None


def _evaluated(program: Program, forms: tuple[Form, ...], varying: Collection[Path], facts: Mapping[Fact, Any],
               refused: S2sadError, unrolls: bool, inlines: bool) -> tuple[Flat, list[Any], Guards]:
    with recording(Guards(varying)) as guards:
        reached(None, "root", 0, program.function)
        inside = program.refused is not None       # what reading has refused the evaluator may know more of
        try:
            residual = specialize(program.function, dict(zip(program.kernels[program.entry].parameters, forms)), facts,
                                  unrolls, inlines)
            inside = False
            made = read.of_captured(residual, program.function)
        except S2sadError as error:
            lines = set() if inside and not isinstance(error, OutsideError) else set(map(_line, error.diagnostics))
            there = [d for d in refused.diagnostics if _line(d) in lines - {None}]
            raise (S2sadError(*there) if there else error) from None
    made = replace(made, guards=guards, replaced=residual.replaced)
    flat = Flat(made, residual.paths, frozenset(), residual.result, residual.changed, residual.live)
    return flat, [program.function], guards


def _line(found: Diagnostic) -> tuple[str, int] | None:
    """The user's line that a diagnostic is about."""
    if found.span is None:
        return None
    source, line = found.span.source.home(found.span.line)
    return source.path, line


def result_form(group: StructureValue | PyTree) -> PyTree:
    """What a structure that a kernel returns is made of."""
    if isinstance(group, PyTree):
        return group
    items = tuple(result_form(i) if isinstance(i, StructureValue) else NONE if nothing(i) else UNKNOWN
                  for i in group.items)
    return PyTree(group.form.kind, group.form.keys, items, group.form.made, group.form.fixed)


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
            and ours.own is theirs.own and list(ours.defaults) == list(theirs.defaults)
            and all(same(v, theirs.defaults[k]) for k, v in ours.defaults.items()))
