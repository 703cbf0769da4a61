"""Sparse matrices as structures, while structures are taken apart: entries, rows, columns and a shape.

    csr_matrix((v, j, p), shape=(n, n))     data: v, row: runtime.sparse_rows(p, j), col: j, shape: (n, n)
    def f(a, x): ...                        def f(a_data, a_indices, a_indptr, a_shape_0, a_shape_1, x):
                                                a_row = runtime.sparse_rows(a_indptr, a_indices)
"""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Protocol

from s2sad.evaluate.argument_binding import user_call
from s2sad.evaluate.structures.items import spoken
from s2sad.evaluate.structures.groups import (
    SPELLED, Conflict, StructureValue, Ordinary, Plain, Value, listed, pattern, spelled,
)
from s2sad.program import Kernel
from s2sad.read.linker import header_of
from s2sad.pytree import SPARSE, PyTree
from s2sad.tree import (
    AST, Assign, Attribute, AugAssign, Call, Expr, For, Name, Store, Subscript, While, at, call, const, copy, walk,
    walk_statements,
)

ROOM = "scipy.sparse."
FORMATS = (*SPARSE, "dia")                # "dia" is also whatever SciPy lays out by itself: its entries cannot be read
DIAGONALS = (f"{ROOM}diags", f"{ROOM}diags_array", f"{ROOM}spdiags")

PLACES = ("indices", "indptr", "row", "col")


class Stores:
    """Where a kernel may store to elements of arrays: in subscripts, in calls that stand alone or of other kernels, and
    where it adds to a name."""

    def __init__(self, body: list[AST]):
        self.loops = [(s.lineno or 0, s.end_lineno or 0) for s in walk_statements(body) if isinstance(s, (For, While))]
        self.places = [(node.lineno, _base(part)) for node in walk(body) for part in _written(node)]
        self.taken = {t.id for s in walk_statements(body) if isinstance(s, Assign) for t in s.targets
                      if isinstance(t, Name) and _is_places(s.value)}

    def later(self, array: AST, origin: AST) -> bool:
        """Whether an array may be written after a statement, or in a loop around it."""
        base, line = _base(array), origin.lineno
        return bool(base) and any(name == base and (store >= line or any(
            first <= store <= last and first <= line <= last for first, last in self.loops))
            for store, name in self.places)

    @property
    def to_places(self) -> bool:
        """Whether the arrays may be written that say where the entries of a matrix are."""
        return any(name in self.taken for _, name in self.places)


def _written(node: AST) -> list[AST]:
    """The arrays that a node may write."""
    if isinstance(node, Subscript) and isinstance(node.ctx, Store):
        return [node.value]
    if isinstance(node, AugAssign):
        return [node.target]
    called = node.value if isinstance(node, Expr) else node if user_call(node) is not None else None
    if not isinstance(called, Call):
        return [k.value for k in node.keywords if k.arg == "out"] if isinstance(node, Call) else []
    method = [called.func.value] if isinstance(called.func, Attribute) else []
    return [*method, *called.args, *(k.value for k in called.keywords)]


def _is_places(node: AST) -> bool:
    """Whether an expression is an array, or a part of one, that says where the entries of a matrix are."""
    while isinstance(node, Subscript):
        node = node.value
    return isinstance(node, Attribute) and node.attr in PLACES


def _base(node: AST) -> str:
    """The name that an array is a part of; empty for an expression."""
    while isinstance(node, (Subscript, Attribute)):
        node = node.value
    return node.id if isinstance(node, Name) else ""


def said(value: StructureValue) -> str:
    """What a matrix is, in a sentence."""
    return f"{spoken(value)} is {value.form}" if value.path != SPELLED else f"this is {value.form}"


class StructureNames(Protocol):
    """The names of one kernel, and how a structure is given some."""
    env: dict[str, Value | Conflict | Ordinary]

    def kept(self, group: StructureValue, origin: AST, wanted: str) -> tuple[list[AST], StructureValue]: ...


def is_matrix(value: object) -> bool:
    """Whether a value is a sparse matrix."""
    return isinstance(value, StructureValue) and value.form.kind in FORMATS


def is_sparse(value: StructureValue) -> bool:
    """Whether a structure is a sparse matrix or a factorization of one."""
    return is_matrix(value) or value.form.kind == "factors"


def has_matrix(value: Value) -> bool:
    """Whether a structure is a sparse matrix or a factorization, or has one in it."""
    return isinstance(value, StructureValue) and (is_sparse(value) or any(map(has_matrix, value.items)))


def matrix(kind: str, data: Value, row: Value, col: Value, shape: Value, **places: Value) -> StructureValue:
    """A sparse matrix; of one in a compressed format that the kernel has in this layout also `indices` and `indptr`."""
    held = {"data": data, "row": row, "col": col, "shape": shape, **places}
    return StructureValue(PyTree(kind, tuple(held), tuple(map(pattern, held.values())), None, True),
                          tuple(held.values()),
                          SPELLED)


def laid_out(kind: str, parts: Sequence[Value], shape: Value, origin: AST) -> StructureValue:
    """A matrix in a compressed format, of its data, indices and indptr: this says where the entries of a row end, of a
    column in csc."""
    data, indices, ends = parts
    written = [spelled(v, origin) or const(0) for v in (ends, indices)]
    major = Plain(at(call("runtime.sparse_rows", *map(copy, written)), origin))
    row, col = (major, indices) if kind == "csr" else (indices, major)
    return matrix(kind, data, row, col, shape, indices=indices, indptr=ends)


def given_matrices(kept: StructureNames, kernel: Kernel) -> list[AST]:
    """The statements that bind the rows and the columns of the entries of matrices that are arguments."""
    made: list[AST] = []
    for parameter, value in list(kept.env.items()):
        if isinstance(value, StructureValue):
            found = _by_entries(value, kernel.tree)
            if found is not value:
                before, kept.env[parameter] = kept.kept(found, kernel.tree, parameter)
                made += before
    place = header_of(kernel.tree)
    return [at(s, place) for s in made]


def _by_entries(group: StructureValue, origin: AST) -> StructureValue:
    """A structure with the matrices in it by their entries."""
    if group.form.kind in SPARSE and "row" not in group.form.keys:
        return replace(laid_out(group.form.kind, group.items[:3], group.items[3], origin), path=group.path)
    items = tuple(_by_entries(i, origin) if isinstance(i, StructureValue) else i for i in group.items)
    return group if items == group.items else replace(group, items=items)


def transposed(found: StructureValue) -> StructureValue:
    """The transpose, which has the same entries; the formats of rows and of columns change places."""
    kind = {"csr": "csc", "csc": "csr"}.get(found.form.kind, found.form.kind)
    shape = found.item("shape")
    assert isinstance(shape, StructureValue)
    places = {k: found.item(k) for k in ("indices", "indptr") if k in found.form.keys}
    return matrix(kind, found.item("data"), found.item("col"), found.item("row"), listed(shape.items[::-1]), **places)


def joined(places: list[AST]) -> AST:
    """The rows or the columns of several lots of entries, one behind the other."""
    made = places[0]
    for more in places[1:]:
        made = call("runtime.sparse_joined", made, more)
    return made


def opaque(kind: str) -> str:
    """The format of a matrix that SciPy lays out: nothing of its entries can be read then."""
    return "dia" if kind == "coo" else kind

