"""A function or a file becomes a tree with places.

    capture             a live function's source, proven to be the function's
    file_module         a file's names, without running it (constant_folding: constant arithmetic)
    outside_values      what a name from outside can mean
    unique_names        every variable has a name of its own
    desugar             plainer spellings of the same
    supported_subset    what the passes behind take; anything else is evaluated
    resolve             every outside name becomes a dotted one
    linker              the kernels of a program, callees first
"""
from __future__ import annotations

import difflib
import os
from collections.abc import Collection, Mapping
from dataclasses import replace
from typing import Any

from s2sad.deep_stack import deep_stack
from s2sad.diagnostics import Diagnostic, S2sadError
from s2sad.live_objects.guards import Guards, Path, reached, recording
from s2sad.program import Program
from s2sad.read.capture import name_of, not_a_function
from s2sad.live_objects.unwrap import python_function
from s2sad.read.linker import Linker
from s2sad.read.outside_values import UserFunctionValue
from s2sad.read.file_module import FileModule
from s2sad.live_objects.registry import GIVEN

__all__ = ["function_in_file", "functions", "load", "load_file", "load_meaning", "of_captured", "python_function"]


@deep_stack
def load(function: Any, varying: Collection[Path] = ()) -> Program:
    """The program of a live function: a plain one, a differentiated one or a Numba dispatcher. Numbers from outside
    at the paths in `varying` are arguments.

    Raises S2sadError: S101 without source, S104 if the source has changed, S201 for what is outside the language, S202
    for unknown names, S204 for recursion.
    """
    plain = python_function(function)
    if plain is None:
        raise S2sadError(not_a_function(function))
    if GIVEN.of(plain) is not None:
        raise S2sadError(Diagnostic("S101", f"'{plain.__name__}' has a derivative of its own, and is not read",
                                    help="differentiate a function that calls it"))
    with recording(Guards(varying)) as guards:
        reached(None, "root", 0, plain)
        linker = Linker()
        program = linker.program(_live(plain))
        return replace(program, guards=guards, warned=tuple(map(str, linker.ignored)))


def of_captured(handle: Any, function: Any) -> Program:
    """The program of a residual function, which `handle.captured()` gives; raises S2sadError."""
    linker = Linker()
    program = linker.program(UserFunctionValue(name_of(function), ("residual", id(handle)), "", handle))
    return replace(program, warned=tuple(map(str, linker.ignored)))


def _live(function: Any) -> UserFunctionValue:
    return UserFunctionValue(name_of(function), ("live", id(function)), "", function)


def load_file(path: str | os.PathLike[str], function: str) -> Program:
    """The program of a function in a file, which is read and not run.

    Raises S2sadError: S101 if the file cannot be read, S102 if it is not Python, S103 if the function is not in it, and
    as `load`.
    """
    meaning, files = function_in_file(path, function)
    return replace(load_meaning(meaning), files=tuple(files))


@deep_stack
def function_in_file(path: str | os.PathLike[str], function: str) -> tuple[UserFunctionValue, Mapping[str, FileModule]]:
    """A function in a file, which is not run, and the files that are read for it, more of them later; raises S2sadError
    as `load_file`."""
    files: dict[str, FileModule] = {}
    module = FileModule(os.fspath(path), files)
    meaning = module.meanings.get(function) and module.lookup(function)
    if not isinstance(meaning, UserFunctionValue):
        raise S2sadError(_no_function(module, function))
    return replace(meaning, handle=meaning.handle.itself()) if meaning.handle.is_derivative else meaning, files


@deep_stack
def load_meaning(function: UserFunctionValue) -> Program:
    """The program of a function; raises S2sadError."""
    return Linker().program(function)


def functions(path: str | os.PathLike[str]) -> list[str]:
    """The functions at the module level of a file, which is read and not run.

    Raises S2sadError: S101 if the file cannot be read, S102 if it is not Python.
    """
    return list(dict.fromkeys(FileModule(os.fspath(path), {}).definitions))


def _no_function(module: FileModule, function: str) -> Diagnostic:
    there = list(dict.fromkeys(module.definitions))
    close = difflib.get_close_matches(function, there, 1)
    listed = f"the file defines: {', '.join(there)}" if there else "the file defines no function at module level"
    help = f"did you mean '{close[0]}'? {listed}" if close else listed
    return Diagnostic("S103", f"{module.path}: no function '{function}' at module level", help=help)
