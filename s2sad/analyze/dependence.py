"""dependence: whether one reference to an array may be to a cell that another one, executed later, overwrites.

Requires the structure table; answers by subscripts that are affine in loop counters and in numbers bound once, with
the loops' bounds, the order of execution, and negative subscripts counted from the end as NumPy does.
(Banerjee, Dependence Analysis, 1997; the systems are solved by `affine.feasible`.)
"""
from __future__ import annotations

from dataclasses import dataclass
from itertools import chain, product

from s2sad.analyze.reallocated_arrays import outlives_loop, allocation_loops, is_nested_in
from s2sad.analyze.program_structure import ProgramStructure
from s2sad.infer.types import INT
from s2sad.infer.affine import Affine, at_most, combined, equals, feasible
from s2sad.normalize.loops.hoist_allocations import is_allocation
from s2sad.tree import (
    AST, Assign, Attribute, BinOp, Constant, For, Name, Subscript, Tuple, USub, UnaryOp, call_name,
    indices,
)


@dataclass(frozen=True)
class ArrayReference:
    """A use of an array at a statement: an element, or with fewer subscripts a region."""
    array: str
    subscripts: tuple[AST, ...]
    statement: AST

    @classmethod
    def to(cls, node: AST, statement: AST) -> ArrayReference:
        if isinstance(node, Name):
            return cls(node.id, (), statement)
        assert isinstance(node, Subscript) and isinstance(node.value, Name)
        kept = [s for s in indices(node) if not (isinstance(s, Constant) and s.value is Ellipsis)]
        return cls(node.value.id, tuple(kept), statement)


@dataclass(frozen=True)
class _ReferenceClass:
    """The number of all references of which the same holds under other names of their `counters`; `free` are the other
    names in it."""
    number: int
    counters: frozenset[str]
    free: frozenset[str]


class _LaterInstance(dict[str, str]):
    """Names for the later instance of everything that differs between iterations of loops not shared."""

    def __init__(self, structure: ProgramStructure, shared: list[AST], later: ArrayReference):
        self.structure, self.shared = structure, {id(loop) for loop in shared}
        self.around = {loop.target.id for loop in structure.place(later.statement).loops
                       if isinstance(loop, For) and id(loop) not in self.shared}

    def __missing__(self, number: str) -> str:
        self[number] = number + "'" if number in self.around or self._differs(number) else number
        return self[number]

    def _differs(self, number: str) -> bool:
        bound = self.structure.bindings.get(number)
        return bound is not None and number not in self.structure.loop_of and any(
            id(loop) not in self.shared for loop in self.structure.place(bound[0]).loops)


class Dependence:
    """Answers about the references of one function."""

    def __init__(self, structure: ProgramStructure):
        self.structure = structure
        self.extents: dict[str, list[Affine | None]] = {}
        self._known: dict[tuple[ArrayReference, ArrayReference, int, bool], bool] = {}
        self._classes: dict[ArrayReference, _ReferenceClass] = {}
        self._numbers: dict[tuple[tuple[Affine | None, ...], ...], int] = {}
        self._met: dict[tuple[int, int], bool] = {}
        self._outliving: dict[str, bool] = {}

    # -- affine forms ------------------------------------------------------------------------------------------------

    def form(self, node: AST, depth: int = 0) -> Affine | None:
        """The affine form of an integer expression, over counters, numbers bound once and shapes."""
        if isinstance(node, Constant):
            return Affine((), node.value) if isinstance(node.value, int) else None
        if isinstance(node, UnaryOp) and isinstance(node.op, USub):
            inner = self.form(node.operand, depth)
            return inner and inner.times(-1)
        if isinstance(node, BinOp):
            return self._binary(node, depth)
        if isinstance(node, Name):
            return self._name(node.id, depth)
        if call_name(node) == "builtins.len":
            return self._shape(node.args[0], 0, depth)
        if isinstance(node, Attribute) and node.attr == "size" and self.structure.typing.of(node.value).rank == 1:
            return self._shape(node.value, 0, depth)
        if isinstance(node, Subscript) and isinstance(node.value, Attribute) and node.value.attr == "shape":
            axis = node.slice.value if isinstance(node.slice, Constant) else None
            return self._shape(node.value.value, axis, depth) if isinstance(axis, int) else None
        return None

    def _binary(self, node: BinOp, depth: int) -> Affine | None:
        return combined(node.op, self.form(node.left, depth), self.form(node.right, depth))

    def _name(self, identifier: str, depth: int) -> Affine | None:
        if identifier in self.structure.loop_of:
            return Affine.symbol(identifier)
        bound = self.structure.bindings.get(identifier, [])
        if self.structure.typing.table.get(identifier, INT).is_array:
            return None
        if len(bound) > 1 or depth > 20 or "." in identifier and not identifier.startswith("const."):
            return None
        if bound and isinstance(bound[0], Assign) and isinstance(bound[0].targets[0], Name):
            inner = self.form(bound[0].value, depth + 1)
            if inner is not None and self._stable(inner):
                return inner
        return Affine.symbol(identifier)

    def _stable(self, form: Affine) -> bool:
        return all(s in self.structure.loop_of or len(self.structure.bindings.get(s, [])) <= 1 for s, _ in form.terms)

    def _shape(self, base: AST, axis: int, depth: int) -> Affine | None:
        if not isinstance(base, Name) or axis < 0:
            return None
        return self.extent(base.id, axis, depth)

    def extent(self, array: str, axis: int, depth: int = 0) -> Affine | None:
        """The size of an axis of an array."""
        made = self.structure.bindings.get(array, [])
        if not made or depth > 20:
            return Affine.symbol(f"{array}.shape[{axis}]")
        if len(made) > 1 or self.outlives_its_loop(array):
            return None                                 # no expression has its size at every use
        value = made[0].value
        if (call_name(value) or "").endswith("_like"):
            return self._shape(value.args[0], axis, depth + 1)
        shape = value.args[0]
        if isinstance(shape, Tuple):
            return self.form(shape.elts[axis], depth + 1)
        if isinstance(shape, Attribute) and shape.attr == "shape":
            return self._shape(shape.value, axis, depth + 1)
        return self.form(shape, depth + 1) if axis == 0 else None

    # -- systems -----------------------------------------------------------------------------------------------------

    def bounds(self, reference: ArrayReference) -> list[Affine]:
        """The inequalities of the loops around a statement for their counters."""
        system: list[Affine] = []
        for loop in self.structure.place(reference.statement).loops:
            if isinstance(loop, For):
                system += self.loop_bounds(loop)
        return system

    def loop_bounds(self, loop: For) -> list[Affine]:
        start, stop, step = range_parts(loop)
        low, high = self.form(start), self.form(stop)
        if not isinstance(step, int):
            return []
        counter = Affine.symbol(loop.target.id)
        if step < 0:
            low, high = (high.shift(1) if high else None), (low.shift(1) if low else None)
        return ([at_most(low, counter)] if low else []) + ([at_most(counter.shift(1), high)] if high else [])

    def subscript_cases(self, reference: ArrayReference, axis: int) -> list[tuple[Affine | None, list[Affine]]]:
        """The cell that a subscript names, with what holds then: as it is, or counted from the end."""
        form = self.form(reference.subscripts[axis])
        if form is None:
            return [(None, [])]
        extent = self.extent(reference.array, axis)
        bounds = self.bounds(reference)
        if extent is None:
            negative = [at_most(form, Affine((), -1))]
            return [(None, [])] if feasible(bounds + negative) else [(form, [])]
        inside = [at_most(form.shift(1), extent), at_most(extent.times(-1), form)]
        cases: list[tuple[Affine | None, list[Affine]]] = [(form, [at_most(Affine(), form), *inside])]
        negative = [at_most(form, Affine((), -1)), *inside]
        if feasible(bounds + negative):
            cases.append((form.plus(extent), negative))
        return cases

    def from_start(self, form: Affine, extent: Affine, reference: ArrayReference, valid: list[Affine]) -> Affine | None:
        """A place on an axis as it is counted from the start, where what is `valid` holds in the loops around a
        reference; None if it may be counted either way."""
        bounds = [*self.bounds(reference), *valid]
        if not feasible([*bounds, at_most(form.shift(1), Affine())]):
            return form
        return None if feasible([*bounds, form]) else form.plus(extent)

    def may_overwrite(self, first: ArrayReference, later: ArrayReference, within: AST | None = None,
                      same: bool = False) -> bool:
        """Whether `later`, executed after `first`, may be to a cell of `first`.

        `within` a loop: only in one iteration of it (and of the loops around it); `same` also counts `later` in the
        statement of `first`.
        """
        if first.array != later.array:
            return False
        key = first, later, id(within), same
        if key not in self._known:
            self._known[key] = self._may_overwrite(first, later, within, same)
        return self._known[key]

    def is_carried(self, first: ArrayReference, later: ArrayReference, loop: AST) -> bool:
        """Whether `later` may be to a cell of `first` in a later iteration of a loop around both."""
        common = [x for x, y in zip(self.structure.place(first.statement).loops,
                                    self.structure.place(later.statement).loops) if x is y]
        return self._overlap(first, later, common, next(k for k, x in enumerate(common) if x is loop))

    def _may_overwrite(self, first: ArrayReference, later: ArrayReference, within: AST | None, same: bool) -> bool:
        a, b = self.structure.place(first.statement), self.structure.place(later.statement)
        common = [x for x, y in zip(a.loops, b.loops) if x is y]
        fixed = common.index(within) + 1 if within is not None and within in common else 0
        fixed = max(fixed, self._allocation_level(first, later))
        if within is not None and within not in common:
            return False
        for level in range(fixed, len(common) + 1):
            if level == len(common):
                if not (b.order > a.order or same and a.order == b.order) or _exclusive(a.branches, b.branches):
                    continue
            if self._overlap(first, later, common, level):
                return True
        return False

    def _allocation_level(self, first: ArrayReference, later: ArrayReference) -> int:
        """The number of loops around both references in whose iterations the array is a new one."""
        own = allocation_loops(self.structure, first.array)
        places = [self.structure.place(r.statement) for r in (first, later)]
        inside = all(is_nested_in(p.loops, own) and not is_allocation(p.statement) for p in places)
        return len(own) if inside else 0

    def outlives_its_loop(self, array: str) -> bool:
        """Whether an array that a loop allocates is used after the loop."""
        if array not in self._outliving:
            self._outliving[array] = outlives_loop(self.structure, array)
        return self._outliving[array]

    def _reference_class(self, reference: ArrayReference) -> _ReferenceClass:
        if reference not in self._classes:
            axes = [self.subscript_cases(reference, axis) for axis in range(len(reference.subscripts))]
            forms = [tuple(self.bounds(reference))]
            for cases in axes:
                forms += [(None,), *((form, *held) for form, held in cases)]    # None begins an axis
            counters = [loop.target.id for loop in self.structure.place(reference.statement).loops
                        if isinstance(loop, For)]
            used = {s for form in chain(*forms) if form is not None for s, _ in form.terms}
            names = {s: s for s in used} | {c: f"{k}" for k, c in enumerate(counters)}
            key = tuple(tuple(form and form.renamed(names) for form in held) for held in forms)
            self._classes[reference] = _ReferenceClass(self._numbers.setdefault(key, len(self._numbers)),
                                                     frozenset(counters),
                                                     frozenset(used - {*counters}))
        return self._classes[reference]

    def _overlap(self, first: ArrayReference, later: ArrayReference, common: list[AST], level: int) -> bool:
        """The case in which the common loops are equal up to `level` and the next one is further on."""
        a, b = self._reference_class(first), self._reference_class(later)
        if common or not a.counters.isdisjoint(b.free):
            return self._has_common_cell(first, later, common, level)
        if (a.number, b.number) not in self._met:     # many statements have the same question
            self._met[a.number, b.number] = self._has_common_cell(first, later, common, level)
        return self._met[a.number, b.number]

    def _has_common_cell(self, first: ArrayReference, later: ArrayReference, common: list[AST], level: int) -> bool:
        primed = _LaterInstance(self.structure, common[:level], later)
        cells: list[list[tuple[Affine, Affine, list[Affine]]]] = []
        for axis in range(min(len(first.subscripts), len(later.subscripts))):
            options = []
            for (x, cx), (y, cy) in product(self.subscript_cases(first, axis), self.subscript_cases(later, axis)):
                if x is None or y is None:
                    options = []
                    break
                options.append((x, y.renamed(primed), [*cx, *(c.renamed(primed) for c in cy)]))
            if options:
                cells.append(options)
        system = self.bounds(first) + [f.renamed(primed) for f in self.bounds(later)]
        if level < len(common):
            system += self._in_later_iteration(common[level], primed)
        return any(feasible(system + [f for x, y, held in choice for f in [*equals(x, y), *held]])
                   for choice in product(*cells))

    def _in_later_iteration(self, loop: AST, primed: dict[str, str]) -> list[Affine]:
        if not isinstance(loop, For):
            return []
        step = range_parts(loop)[2]
        here, there = Affine.symbol(loop.target.id), Affine.symbol(primed[loop.target.id])
        if not isinstance(step, int):
            return []
        return [at_most(here.shift(1), there) if step > 0 else at_most(there.shift(1), here)]


def range_parts(loop: For) -> tuple[AST, AST, int | AST]:
    """The start, the stop and the step of a loop; the step as a number if it is one."""
    args = loop.iter.args
    start, stop = (Constant(0, None), args[0]) if len(args) == 1 else (args[0], args[1])
    step: int | AST = 1 if len(args) < 3 else args[2]
    if isinstance(step, UnaryOp) and isinstance(step.op, USub) and isinstance(step.operand, Constant):
        step = -step.operand.value
    elif isinstance(step, Constant):
        step = step.value
    return start, stop, step


def _exclusive(a: tuple[tuple[AST, bool], ...], b: tuple[tuple[AST, bool], ...]) -> bool:
    """Whether two statements stand in different branches of one If."""
    return any(x is y and p != q for x, p in a for y, q in b)
