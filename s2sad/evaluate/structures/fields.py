"""fields: structures become their arrays and numbers, in parameters, bodies, calls and returns.

    def step(state, p, dt):                      def step(state_u, state_t, p_k, dt):
        for i in range(state.u.size):       ->       for i in range(state_u.size):
            state.u[i] += dt * p["k"]                    state_u[i] += dt * p_k
        state.t += dt                                state_t[0] += dt

Requires a program as it was read, and what its entry's arguments are made of. Establishes a program of arrays and
numbers: every later pass knows no structure. Each kernel is made for what its arguments are made of; a number that is
assigned is an array of one element (a cell). `is None` is decided here: None is no argument.
"""
from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from s2sad.deep_stack import deep_stack
from s2sad.diagnostics import Report, S2sadError
from s2sad.infer.types import FLOAT, UNKNOWN, Type
from s2sad.naming import Names
from s2sad.evaluate.completion import FALL, completion
from s2sad.evaluate.structures.blocks_of_fields import StructureBlocks
from s2sad.evaluate.structures.literal_arguments import gives_tuples
from s2sad.evaluate.structures.groups import (
    CELL, ORDINARY, SPELLED, StructureValue, Leaf, Plain, Value, flat, grouped, nothing, spelled, usable,
)
from s2sad.program import Kernel, Program
from s2sad.pytree import Form, PyTree, is_held, leaves, step
from s2sad.tree import (
    AST, Attribute, Compare, Dict, In, Is, IsNot, Name, NotIn, Return, Store, at, const, copy, function, tuple_of, walk,
    walk_statements,
)


@dataclass(frozen=True)
class Flat:
    """A program of arrays and numbers; `paths` has, for each of the entry's flat parameters, what a user calls it,
    `cells` the flat parameters that are arrays of one element, `result` what structure is returned."""
    program: Program
    paths: dict[str, str]
    cells: frozenset[str]
    result: StructureValue | PyTree | None
    changed: frozenset[str] = frozenset()       # the paths of structures that are changed otherwise
    live: frozenset[int] = frozenset()          # what is taken from outside, by id
    normal: Mapping[Any, Any] = field(default_factory=dict)     # its normal form, where it was made


@dataclass
class SpecializedKernel:
    """A kernel made for arguments of one pattern: its flat names by parameter, and those that it takes."""
    title: str
    flat: dict[str, list[str]]
    taken: tuple[str, ...] = ()
    needed: set[int] = field(default_factory=set)
    result: StructureValue | None = None


def asks(program: Program) -> bool:
    """Whether kernels assign attributes, make structures or test what arguments are: that is settled here."""
    if any(gives_tuples(k.tree, program) for k in program.kernels.values()):
        return True
    return bool(program.records) or any(
               isinstance(n, Dict) or
               isinstance(n, Attribute) and isinstance(n.ctx, Store) or
               isinstance(n, Compare) and any(isinstance(o, (Is, IsNot, In, NotIn)) for o in n.ops)
               for k in program.kernels.values() for n in walk(k.tree.body))


@deep_stack
def fields(program: Program, forms: tuple[Form, ...]) -> Flat:
    """The flat program for arguments of these forms; raises S2sadError with what cannot be taken apart."""
    cells: frozenset[str] = frozenset()
    while True:
        making = _Making(program)
        entry = program.kernels[program.entry]
        made = making.made(entry, tuple(_with_cells(f, p, cells) for p, f in zip(entry.parameters, forms)), True)
        names = [n for p in entry.parameters for n in made.flat[p]]
        paths = [path for p, f in zip(entry.parameters, forms) for path, t in leaves(f, p) if is_held(t)]
        new = cells | {paths[k] for k in made.needed}
        if new == cells:
            making.finish()
            by_name = dict(zip(names, paths))
            own = program.function if entry.parameters == tuple(names) == tuple(paths) else None
            return Flat(replace(program, kernels=making.kernels, function=own), by_name,
                        frozenset(n for n, p in by_name.items() if p in cells), made.result)
        cells = new


def _with_cells(form: Form, path: str, cells: Iterable[str]) -> Form:
    """The form in which the numbers at some paths are cells."""
    if isinstance(form, Type):
        return replace(form, kind=CELL) if path in cells else form
    items = tuple(_with_cells(i, step(form, path, k), cells) for k, i in zip(form.keys, form.items))
    return replace(form, items=items)


class _Making:
    """The kernels of one flat program, callees first."""

    def __init__(self, program: Program):
        self.program = program
        self.kernels: dict[str, Kernel] = {}
        self.reports: list[Report] = []
        self._made: dict[tuple[str, tuple[Form, ...]], SpecializedKernel] = {}
        used = {n.id for k in program.kernels.values() for n in walk(k.tree) if isinstance(n, Name)}
        self._titles = Names({*program.kernels, *used, *(n.rpartition(".")[2] for n in used)} - {program.entry})
        self._names = Names(used | {n.partition(".")[2] for n in used if "." in n})
        self._by_path: dict[str, str] = {}

    def callee(self, kernel: str, patterns: tuple[Form, ...]) -> SpecializedKernel:
        return self.made(self.program.kernels[kernel], patterns, False)

    def made(self, kernel: Kernel, patterns: tuple[Form, ...], is_entry: bool) -> SpecializedKernel:
        """The kernel for arguments of these patterns."""
        key = (kernel.name, patterns)
        if key not in self._made:
            first = all(name != kernel.name for name, _ in self._made)
            title = kernel.name if first else self._titles.fresh(f"{kernel.name}_{self._count(kernel.name) + 1}")
            made = self._made[key] = SpecializedKernel(title, {})
            report = Report(kernel.source)
            make = self._flat if kernel.own is None else self._as_given
            self.kernels[title] = make(kernel, patterns, made, report, is_entry)
            self.reports.append(report)
        return self._made[key]

    def _count(self, kernel: str) -> int:
        return sum(name == kernel for name, _ in self._made)

    def finish(self) -> None:
        """Raises everything that was refused; puts callees before callers."""
        found = [d for report in self.reports for d in report.found]
        if found:
            raise S2sadError(*dict.fromkeys(found))

    def flat_name(self, path: str) -> str:
        """The flat name of a leaf: one for each path, in all kernels."""
        if path not in self._by_path:
            self._by_path[path] = self._names.fresh(_joined(path))
        return self._by_path[path]

    def fresh(self, path: str) -> str:
        return self._names.fresh(_joined(path))

    def _as_given(self, kernel: Kernel, patterns: tuple[Form, ...], made: SpecializedKernel, report: Report,
                  is_entry: bool
                  ) -> Kernel:
        """A function with a derivative of the user's own, which takes arrays and numbers only."""
        for parameter, form in zip(kernel.parameters, patterns):
            if isinstance(form, PyTree) or not is_held(form):
                report.error("S201", f"a structure for '{parameter}' of '{kernel.name}', which has a derivative of its "
                             "own", kernel.tree, help="give it the arrays and numbers that it needs")
        residual = kernel.residual
        if residual:
            plain = (UNKNOWN,) * len(self.program.kernels[residual].parameters)
            residual = self.callee(residual, plain).title
        assert kernel.own is not None
        if "primal" not in kernel.own.functions:
            read = self._flat(kernel, (UNKNOWN,) * len(patterns), made, report, is_entry)
            return replace(read, own=kernel.own, residual=residual)
        made.flat, made.taken = {p: [p] for p in kernel.parameters}, kernel.parameters
        tree = copy(kernel.tree)
        tree.name = made.title
        return replace(kernel, name=made.title, tree=tree, residual=residual)

    def _flat(self, kernel: Kernel, patterns: tuple[Form, ...], made: SpecializedKernel, report: Report,
              is_entry: bool) -> Kernel:
        blocks = StructureBlocks(kernel, self, report, self.fresh)
        annotations = {p: t for p, t in kernel.annotations.items()}
        place = 0
        for parameter, form in zip(kernel.parameters, patterns):
            start = place
            kinds = list(leaves(form, parameter))

            def leaf(path: str, kind: Type, start: int = start, kinds: list = kinds) -> Leaf:
                held = [p for p, t in kinds if is_held(t)]
                return Leaf(self.flat_name(path), path, kind, start + held.index(path)) if is_held(kind) else Leaf(
                    "", path, kind)
            if isinstance(form, PyTree):
                group = grouped(form, parameter, leaf)
                blocks.env[parameter] = group
                made.flat[parameter] = [v.name for v in flat(group) if isinstance(v, Leaf)]
                annotations.pop(parameter, None)
                annotations |= {self.flat_name(p): "float" for p, t in kinds if t == FLOAT}
            elif is_held(form):
                blocks.env[parameter] = ORDINARY
                made.flat[parameter] = [parameter]
            else:
                blocks.env[parameter] = Leaf("", parameter, form)
                made.flat[parameter] = []
            place += len(made.flat[parameter])
        body = blocks.block(kernel.tree.body)
        made.needed = blocks.needed
        made.result = self._returned(blocks, body, report, is_entry)
        used = {n.id for n in walk(body) if isinstance(n, Name)}
        parameters = made.taken = tuple(n for p in kernel.parameters for n in made.flat[p]
                                        if is_entry or n in used or n == p)
        tree = at(function(made.title, list(parameters), body or [at(Return(None), kernel.tree)]), kernel.tree)
        defaults = {p: v for p, v in kernel.defaults.items() if p in parameters}
        return Kernel(made.title, tree, kernel.source, parameters, defaults, annotations)

    def _returned(self, blocks: StructureBlocks, body: list[AST], report: Report,
                  is_entry: bool) -> StructureValue | None:
        """What structure a kernel returns; its returns give the values that the caller does not have."""
        given = {id(r) for r, _ in blocks.returned}
        others = [n for n in walk_statements(body) if isinstance(n, Return) and id(n) not in given]
        tuples = all(isinstance(i, (Plain, Leaf)) for _, g in blocks.returned for i in g.items)
        plain = tuples and all(g.path == SPELLED and g.form.kind in ("tuple", "list") for _, g in blocks.returned)
        if not blocks.returned or (others or is_entry) and plain:
            for node, group in blocks.returned:
                node.value = spelled(group, node)
            return None
        groups = [group for _, group in blocks.returned]
        places = [[v.place if isinstance(v, Leaf) and not is_entry else -1 for v in flat(g)] for g in groups]
        for node, group in blocks.returned:
            if _keys(group) != _keys(groups[0]) or others:
                report.error("S201", "returns that are structures of different makes, or no structure on some way",
                             node, help="return the same structure on every path")
                return None
        if FALL in completion(body):
            report.error("S201", "a result that is None where the function ends without a return",
                         blocks.returned[0][0], help="end the function with a return of a value")
        kept = [ps[0] if len(set(ps)) == 1 else -1 for ps in zip(*places)]
        for node, group in blocks.returned:
            values = [spelled(v, node) or const(0.0) for v, k in zip(flat(group), kept) if k < 0]
            node.value = None if not values else at(values[0] if len(values) == 1 else tuple_of(*values), node)
        remaining = iter(kept)
        return _placed(groups[0], remaining)


def _placed(value: Value, places) -> StructureValue:
    items: list[Value] = []
    for item in value.items if isinstance(value, StructureValue) else ():
        if isinstance(item, StructureValue):
            items.append(_placed(item, places))
        elif nothing(item) or isinstance(item, Leaf) and not usable(item):
            items.append(item)
        else:
            items.append(Leaf(item.name if isinstance(item, Leaf) else "result", "", UNKNOWN, next(places)))
    assert isinstance(value, StructureValue)
    return replace(value, items=tuple(items))


def _keys(value: Value) -> object:
    if isinstance(value, StructureValue):
        return (value.form.kind, value.form.keys, tuple(map(_keys, value.items)))
    return nothing(value)


def _joined(path: str) -> str:
    """`layers[0].w` as one word."""
    return re.sub(r"\W+", "_", path).strip("_")
