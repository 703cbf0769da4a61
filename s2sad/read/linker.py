"""The kernels of a program: found through calls from the entry, callees first, each with a name of its own."""
from __future__ import annotations

import os
from collections.abc import Callable, Hashable
from dataclasses import dataclass, replace
from typing import Any

from s2sad import tree
from s2sad.diagnostics import Diagnostic, Report, S2sadError, Source, Span, warn_once
from s2sad.program import Kernel, NestedDerivative, Program
from s2sad.read import supported_subset
from s2sad.read.capture import captured_of
from s2sad.read.ignored import ignored
from s2sad.read.local_imports import local_imports
from s2sad.read.live_module import live_meaning
from s2sad.read.outside_values import AST, Array, Captured, UserFunctionValue, NotConstant, Number, Record
from s2sad.read.desugar import desugar
from s2sad.read.resolve import Resolved, resolve
from s2sad.read.shape_assignment import shape_assignment
from s2sad.read.unique_names import unique_names
from s2sad.live_objects.registry import GIVEN, RegisteredDerivative


_PYTHON = os.path.dirname(os.__file__)
_INSTALLED = ("site-packages", "dist-packages")


@dataclass
class _LinkedKernel:
    captured: Captured
    resolved: Resolved
    defaults: dict[str, Any]
    own: RegisteredDerivative | None = None
    residual: UserFunctionValue | None = None
    nested: NestedDerivative | None = None


class Linker:
    """Collects what the entry reaches; `program` gives it, or raises with everything that is wrong."""

    def __init__(self) -> None:
        self.outside: dict[Hashable, tuple[str, UserFunctionValue | Number | Array | Record]] = {}
        self.found: dict[str, _LinkedKernel] = {}  # callees first
        self.reports: list[Report] = []
        self.ignored: list[Diagnostic] = []

    def program(self, entry: UserFunctionValue) -> Program:
        """The program."""
        self.visit(entry, [])
        wrong = [d for report in self.reports for d in sorted(report.found, key=_position)]
        if wrong:
            raise S2sadError(*wrong)
        for diagnostic in self.ignored:
            warn_once(str(diagnostic))
        names = self._names()
        kernels = {}
        for key, found in self.found.items():
            kernels[names[key].partition(".")[2]] = _kernel(names[key].partition(".")[2], found, names, self.identify)
        title = names[self.identify(entry)].partition(".")[2]
        values = {names[key].partition(".")[2]: m for key, m in self.outside.values() if not isinstance(m,
                                                                                                        UserFunctionValue)}
        constants = {n: m.value for n, m in values.items() if isinstance(m, Number)}
        arrays = {n: m.value for n, m in values.items() if isinstance(m, Array)}
        records = {n: m.value for n, m in values.items() if isinstance(m, Record)}
        return called_once(Program(title, kernels, constants, arrays, records))

    def identify(self, meaning: UserFunctionValue | Number | Array | Record) -> str:
        """A provisional dotted name, one for each function, each number by name and value, each array."""
        if isinstance(meaning, UserFunctionValue):
            kind, key = "user", meaning.key
        elif isinstance(meaning, Number):
            kind, key = "const", (meaning.name, type(meaning.value).__name__, repr(meaning.value))
        elif isinstance(meaning, Record):
            kind, key = "record", (meaning.name, id(meaning.value))
        else:
            kind, key = "array", (meaning.name, id(meaning.value))
        return self.outside.setdefault((kind, key), (f"{kind}.{len(self.outside)}", meaning))[0]

    def visit(self, function: UserFunctionValue, callers: list[UserFunctionValue], caller: Source | None = None,
              call: AST | None = None
              ) -> None:
        captured = _called_from(unique_names(captured_of(function.handle)), caller, call)
        captured = shape_assignment(local_imports(captured))
        captured = replace(captured, tree=desugar(captured.tree))
        report = Report(captured.source)
        self.reports.append(report)
        if getattr(function.handle, "is_derivative", False):
            report.error("S201", f"'{captured.name}' is a derivative of what is written there",
                         header_of(captured.tree))
        is_residual = hasattr(function.handle, "captured")
        own = GIVEN.own(getattr(function.handle, "given", None) if is_residual else function.handle)
        if own is not None:
            _reached(own, captured, report)
        if own is not None and "primal" in own.functions:
            resolved = unread(captured, own)
        else:
            supported_subset.check(captured.tree, report)
            if supported_subset.opaque(captured.tree) and not isinstance(captured.tree, tree.FunctionDef):
                return
            resolved = resolve(captured, report, self.identify)
        self.ignored += ignored(captured.tree, captured.source)
        defaults = defaults_said(captured, report)
        callers = [*callers, function]
        for callee, node in resolved.calls:
            self._call(callee, node, callers, report)
        residual = getattr(function.handle, "residual", None) if is_residual else None
        if residual is None and own is not None and own.residual is not None:
            residual = live_meaning("residual", own.residual)
        if isinstance(residual, UserFunctionValue):
            self._call(residual, header_of(captured.tree), callers, report)
        self.found[self.identify(function)] = _LinkedKernel(captured, resolved, defaults, own,
                                                            residual if isinstance(residual, UserFunctionValue)
                                                            else None, getattr(function.handle, "nested", None))

    def _call(self, callee: UserFunctionValue, node: AST, callers: list[UserFunctionValue], report: Report) -> None:
        keys = [caller.key for caller in callers]
        if callee.key in keys:
            cycle = [c.name for c in callers[keys.index(callee.key):]] + [callee.name]
            report.error("S204", f"recursion is not supported: {' -> '.join(cycle)}", node,
                         help="write it as a loop, with a work array for what each level holds")
        elif self.identify(callee) not in self.found:
            before = len(self.reports)
            try:
                self.visit(callee, callers, report.source, node)
                self._of_library(callee, node, before, report)
            except S2sadError as error:
                for d in error.diagnostics:  # the callee could not be had: the place to see it is the call
                    place = d.span or Span.of(report.source, node)
                    report.found.append(replace(d, span=place))

    def _of_library(self, callee: UserFunctionValue, node: AST, before: int, report: Report) -> None:
        """What cannot be read of a library's function is said where it is called."""
        if not _is_of_library(callee) or not any(r.found for r in self.reports[before:]):
            return
        del self.reports[before:]
        path = ".".join(p for p in callee.path.split(".") if not p.startswith("_"))
        report.error("S201", f"'{path}' is not a function that s2sad can read", node,
                     help=f"write out what it does, or give its derivative: s2sad.rule(\"{path}(x)\", x=...)")

    def _names(self) -> dict[str, str]:
        """The final dotted name behind each provisional one: the user's, with `_` appended where that is taken.

        A name must not mean anything else in a kernel that uses it, so its locals and built-ins are avoided.
        """
        builtin = {n.id.partition(".")[2] for found in self.found.values() for n in tree.walk(found.resolved.tree)
                   if isinstance(n, tree.Name) and n.id.startswith("builtins.")}
        taken: set[str] = set(builtin)
        final = {}
        entry = next(reversed(self.found), "")
        for key, meaning in sorted(self.outside.values(), key=lambda pair: pair[0] != entry):
            local = {n for f in self.found.values() if key in f.resolved.references for n in f.resolved.locals}
            name = meaning.name
            while name in taken or name in local:
                name += "_"
            taken.add(name)
            final[key] = f"{key.partition('.')[0]}.{name}"
        return final


def _is_of_library(function: UserFunctionValue) -> bool:
    """Whether a function is one of Python's own or of SciPy's."""
    file = getattr(getattr(function.handle, "__code__", None), "co_filename", "")
    own = file.startswith(_PYTHON) and not any(word in file for word in _INSTALLED)
    return own or function.path.partition(".")[0] == "scipy"


def _called_from(captured: Captured, caller: Source | None, call: AST | None) -> Captured:
    """A function of another file than the kernel's, with the place in that file that leads to it."""
    if caller is None or caller.path == captured.source.path and not caller.call:
        return captured
    place = Span.of(caller, call)
    return replace(captured, source=replace(captured.source, call=caller.call or f"{caller.path}:{place.line}"))


def _position(diagnostic: Any) -> tuple[int, int]:
    return (diagnostic.span.line, diagnostic.span.column) if diagnostic.span else (0, 0)


def _reached(own: RegisteredDerivative, captured: Captured, report: Report) -> None:
    """Reports what a generated file could not import of a user's own derivative."""
    for what, given in own.functions.items():
        if not given.reachable():
            module, _, last = given.path.rpartition(".")
            report.error("S201", f"'{own.title}' has a derivative of its own, but 'from {module} import {last}' does "
                         f"not give its {what}", header_of(captured.tree), help="define it at module level, and "
                         "register it again when it was defined anew")


def unread(captured: Captured, own: RegisteredDerivative) -> Resolved:
    """What stands for a function that is called as it is: a call of it, and no more."""
    parameters = [p for _, p in own.roles["primal"]]
    called = tree.call(own.name("primal"), *map(tree.name, parameters))
    results = [f"result_{k}" for k in range(own.returns)]
    names = [tree.name(r) for r in results]
    body: list[AST] = [tree.Expr(called)] if not results else [
        tree.assign(names[0] if len(names) == 1 else tree.tuple_of(*names), called),
        tree.Return(names[0] if len(names) == 1 else tree.tuple_of(*names))]
    definition = tree.function(captured.tree.name, parameters, [tree.at(s, header_of(captured.tree)) for s in body])
    return Resolved(tree.at(definition, captured.tree), tuple(parameters), frozenset({*parameters, *results}))


def called_once(program: Program) -> Program:
    """The program; an entry with a derivative of its own is called by another, which is differentiated as usual.

        def f(x): ...                   def f_own(x): ...
                                        def f(x): return f_own(x)
    """
    kernel = program.kernels[program.entry]
    if kernel.own is None:
        return program
    inner = f"{kernel.name}_own"
    while inner in {*program.kernels, *program.constants, *program.arrays, *kernel.parameters}:
        inner += "_"
    definition = tree.copy(kernel.tree)
    definition.name = inner
    values = any(isinstance(n, tree.Return) and n.value is not None for n in tree.walk(kernel.tree.body))
    called = tree.call(f"user.{inner}", *map(tree.name, kernel.parameters))
    statement = tree.at(tree.Return(called) if values else tree.Expr(called), header_of(kernel.tree))
    outer = tree.at(tree.function(kernel.name, list(kernel.parameters), [statement]), kernel.tree)
    kernels = {n: k for n, k in program.kernels.items() if k is not kernel}
    kernels[inner] = replace(kernel, name=inner, tree=definition)
    kernels[kernel.name] = replace(kernel, tree=outer, own=None, residual="")
    return replace(program, kernels=kernels)


def header_of(definition: AST) -> AST:
    """The first line of a definition, as a place."""
    head = tree.name(definition.name)
    head.lineno = head.end_lineno = definition.lineno
    head.col_offset = definition.col_offset
    head.end_col_offset = definition.col_offset + len(f"def {definition.name}".encode())
    return head


def _kernel(name: str, found: _LinkedKernel, names: dict[str, str], identify: Callable[[UserFunctionValue],
                                                                                       str]) -> Kernel:
    definition = tree.rename(found.resolved.tree, names)
    definition.name = name
    source, annotations = found.captured.source, annotations_said(found.captured)
    residual = names[identify(found.residual)].partition(".")[2] if found.residual is not None else ""
    return Kernel(name, definition, source, found.resolved.parameters, found.defaults, annotations, found.own, residual,
                  nested=found.nested, unsure=found.captured.unsure)


def annotations_said(captured: Captured) -> dict[str, str]:
    """The texts of the annotations of a function's parameters."""
    given = captured.tree.args
    return {a.id: annotation_text(a.annotation, captured.source) for a in (
        *given.posonlyargs, *given.args, *given.kwonlyargs) if a.annotation is not None}


def annotation_text(node: AST, source: Any) -> str:
    """An annotation's text; a string's is what it says."""
    if isinstance(node, tree.Constant) and isinstance(node.value, str):
        return node.value
    place = Span.of(source, node)
    lines = [source.line(n) for n in range(place.line, place.end_line + 1)]
    lines[-1] = lines[-1][:place.end_column]
    lines[0] = lines[0][place.column:]
    return " ".join(line.strip() for line in lines)


def defaults_said(captured: Captured, report: Report | None = None) -> dict[str, Any]:
    """The defaults of a function's parameters that are plain values; others go into the report."""
    given = captured.tree.args
    positional = [*given.posonlyargs, *given.args]
    pairs = [*zip(positional[len(positional) - len(given.defaults):], given.defaults),
             *((a, d) for a, d in zip(given.kwonlyargs, given.kw_defaults) if d is not None)]
    values = {}
    for parameter, node in pairs:
        try:
            values[parameter.id] = captured.default(parameter.id, node)
        except NotConstant:
            if report is not None:
                report.error("S201", f"the default of '{parameter.id}' is not a number, a string or None", node,
                             help="write a number, or leave the default out and pass the value")
    return values
