"""The kernels of a program: found through calls from the entry, callees first, each with a name of its own."""
from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import dataclass, replace
from typing import Any

from s2sad import tree
from s2sad.diagnostics import Report, S2sadError, Span
from s2sad.program import Kernel, Program
from s2sad.read import fence
from s2sad.read.capture import capture
from s2sad.read.meaning import AST, Array, Captured, Function, NotConstant, Number, Record
from s2sad.read.modules import FileFunction
from s2sad.read.resolve import Resolved, resolve


@dataclass
class _Found:
    captured: Captured
    resolved: Resolved
    defaults: dict[str, Any]


class Linker:
    """Collects what the entry reaches; `program` gives it, or raises with everything that is wrong."""

    def __init__(self) -> None:
        self.outside: dict[Hashable, tuple[str, Function | Number | Array | Record]] = {}
        self.found: dict[str, _Found] = {}  # callees first
        self.reports: list[Report] = []

    def program(self, entry: Function, methods: tuple[Function, ...] = ()
                ) -> tuple[Program, dict[str, Callable[[], Any]]]:
        """The program, with kernels for the given methods, and how to look up again each number and array that it read
        from outside."""
        for method in methods:
            if self.identify(method) not in self.found:
                self.visit(method, [])
        self.visit(entry, [])
        wrong = [d for report in self.reports for d in sorted(report.found, key=_position)]
        if wrong:
            raise S2sadError(*wrong)
        names = self._names()
        kernels = {}
        for key, found in self.found.items():
            kernels[names[key].partition(".")[2]] = _kernel(names[key].partition(".")[2], found, names)
        values = {names[key].partition(".")[2]: m for key, m in self.outside.values() if not isinstance(m, Function)}
        constants = {n: m.value for n, m in values.items() if isinstance(m, Number)}
        arrays = {n: m.value for n, m in values.items() if isinstance(m, Array)}
        records = {n: m.value for n, m in values.items() if isinstance(m, Record)}
        watched = {names[key]: m.current for key, m in self.outside.values()
                   if not isinstance(m, (Function, Record)) and m.current is not None}
        return Program(names[self.identify(entry)].partition(".")[2], kernels, constants, arrays,
                       records, {m.handle: names[self.identify(m)].partition(".")[2] for m in methods}), watched

    def identify(self, meaning: Function | Number | Array | Record) -> str:
        """A provisional dotted name, one for each function, each number by name and value, each array."""
        if isinstance(meaning, Function):
            kind, key = "user", meaning.key
        elif isinstance(meaning, Number):
            kind, key = "const", (meaning.name, type(meaning.value).__name__, repr(meaning.value))
        elif isinstance(meaning, Record):
            kind, key = "record", (meaning.name, id(meaning.value))
        else:
            kind, key = "array", (meaning.name, id(meaning.value))
        return self.outside.setdefault((kind, key), (f"{kind}.{len(self.outside)}", meaning))[0]

    def visit(self, function: Function, callers: list[Function]) -> None:
        captured = function.handle.captured() if isinstance(function.handle, FileFunction) else capture(function.handle)
        report = Report(captured.source)
        self.reports.append(report)
        fence.check(captured.tree, report)
        if fence.opaque(captured.tree) and not isinstance(captured.tree, tree.FunctionDef):
            return
        resolved = resolve(captured, report, self.identify)
        defaults = _defaults(captured, report)
        callers = [*callers, function]
        for callee, node in resolved.calls:
            self._call(callee, node, callers, report)
        self.found[self.identify(function)] = _Found(captured, resolved, defaults)

    def _call(self, callee: Function, node: AST, callers: list[Function], report: Report) -> None:
        keys = [caller.key for caller in callers]
        if callee.key in keys:
            cycle = [c.name for c in callers[keys.index(callee.key):]] + [callee.name]
            report.error("S204", f"recursion is not supported: {' -> '.join(cycle)}", node,
                         help="write it as a loop, with a work array for what each level holds")
        elif self.identify(callee) not in self.found:
            try:
                self.visit(callee, callers)
            except S2sadError as error:
                for d in error.diagnostics:  # the callee could not be had: the place to see it is the call
                    place = d.span or Span.of(report.source, node)
                    report.found.append(replace(d, span=place))

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


def _position(diagnostic: Any) -> tuple[int, int]:
    return (diagnostic.span.line, diagnostic.span.column) if diagnostic.span else (0, 0)


def _kernel(name: str, found: _Found, names: dict[str, str]) -> Kernel:
    definition = tree.rename(found.resolved.tree, names)
    definition.name = name
    source, given = found.captured.source, found.captured.tree.args
    annotations = {a.id: _annotation(a.annotation, source) for a in (*given.posonlyargs, *given.args, *given.kwonlyargs)
                   if a.annotation is not None}
    return Kernel(name, definition, source, found.resolved.parameters, found.defaults, annotations)


def _annotation(node: AST, source: Any) -> str:
    """An annotation's text; a string's is what it says."""
    if isinstance(node, tree.Constant) and isinstance(node.value, str):
        return node.value
    place = Span.of(source, node)
    lines = [source.line(n) for n in range(place.line, place.end_line + 1)]
    lines[-1] = lines[-1][:place.end_column]
    lines[0] = lines[0][place.column:]
    return " ".join(line.strip() for line in lines)


def _defaults(captured: Captured, report: Report) -> dict[str, Any]:
    given = captured.tree.args
    positional = [*given.posonlyargs, *given.args]
    pairs = [*zip(positional[len(positional) - len(given.defaults):], given.defaults),
             *((a, d) for a, d in zip(given.kwonlyargs, given.kw_defaults) if d is not None)]
    values = {}
    for parameter, node in pairs:
        try:
            values[parameter.id] = captured.default(parameter.id, node)
        except NotConstant:
            report.error("S201", f"the default of '{parameter.id}' is not a number, a string or None", node,
                         help="write a number, or leave the default out and pass the value")
    return values
