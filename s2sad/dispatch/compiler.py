"""The interface of the compiler to what runs derivatives.

Nothing but `deferred.compiler` imports this module, when something must be read or derived: a process that finds on
disk what it calls goes without.
"""
from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from types import FunctionType
from typing import Any

from s2sad import pipeline, read
from s2sad.live_objects.guards import Guards, Path, recording, same
from s2sad.infer.independents import independents, usable_as_floats
from s2sad.infer.types import NONE, UNKNOWN, of_value
from s2sad.evaluate.structures.call_values import Unread
from s2sad.evaluate.structures.fields import Flat, asks, fields
from s2sad.evaluate.structures.groups import StructureValue, nothing
from s2sad.program import EntrySummary, Generated, Kernel, Program, Request
from s2sad.read.capture import not_a_function
from s2sad.run.user_functions_in_numba import checked_constants, compiled_in, registered_rules, uncompiled
from s2sad.run.user_derivatives import checked_derivatives
from s2sad.pytree import Form, PyTree
from s2sad.tree import equal

__all__ = ["asks", "checked_constants", "checked_derivatives", "compiled_in", "derived", "entry_kernel", "flat_program",
           "not_a_function", "program", "registered_rules", "result_form", "same_program", "summary", "uncompiled"]


def program(function: Any, methods: tuple[Any, ...] = (), varying: Collection[Path] = ()) -> Program:
    """The program of a live function; raises S2sadError."""
    return read.load(function, methods, varying)


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


def flat_program(program: Program, function: FunctionType, forms: tuple[Form, ...], varying: Collection[Path]
                ) -> tuple[Flat, list[Any], Guards]:
    """The flat program, the functions of classes that it calls, which are read as they are met, and what was taken of
    the arguments' classes."""
    methods: list[Any] = []
    while True:
        try:
            with recording(Guards()) as guards:
                return fields(program, forms), methods, guards
        except Unread as unread:
            methods.append(unread.function)
            program = read.load(function, tuple(methods), varying)


def result_form(group: StructureValue) -> PyTree:
    """What a structure that a kernel returns is made of."""
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
