"""Sparse matrices as structures, while structures are taken apart: entries, rows, columns and a shape.

    csr_matrix((v, j, p), shape=(n, n))     data: v, row: runtime.sparse_rows(p, j), col: j, shape: (n, n)
    def f(a, x): ...                        def f(a_data, a_indices, a_indptr, a_shape_0, a_shape_1, x):
                                                a_row = runtime.sparse_rows(a_indptr, a_indices)
"""
from __future__ import annotations

from dataclasses import replace
from typing import Protocol

from s2sad.normalize.groups import SPELLED, Conflict, Group, Ordinary, Plain, Value, listed, pattern, spelled
from s2sad.program import Kernel
from s2sad.read.link import header_of
from s2sad.structure import SPARSE, Structure
from s2sad.tree import AST, at, call, const, copy

ROOM = "scipy.sparse."
FORMATS = (*SPARSE, "dia")                # "dia" is also whatever SciPy lays out by itself: its entries cannot be read


class Kept(Protocol):
    """The names of one kernel, and how a structure is given some."""
    env: dict[str, Value | Conflict | Ordinary]

    def kept(self, group: Group, origin: AST, wanted: str) -> tuple[list[AST], Group]: ...


def is_matrix(value: object) -> bool:
    """Whether a value is a sparse matrix."""
    return isinstance(value, Group) and value.form.kind in FORMATS


def is_sparse(value: Group) -> bool:
    return is_matrix(value) or value.form.kind == "factors"


def matrix(kind: str, data: Value, row: Value, col: Value, shape: Value, **places: Value) -> Group:
    """A sparse matrix; of one in a compressed format that the kernel has in this layout also `indices` and `indptr`."""
    held = {"data": data, "row": row, "col": col, "shape": shape, **places}
    return Group(Structure(kind, tuple(held), tuple(map(pattern, held.values())), None, True), tuple(held.values()),
                 SPELLED)


def laid_out(kind: str, data: Value, indices: Value, ends: Value, shape: Value, origin: AST) -> Group:
    """A matrix in a compressed format: `ends` says where the entries of a row end, of a column in csc."""
    written = [spelled(v, origin) or const(0) for v in (ends, indices)]
    major = Plain(at(call("runtime.sparse_rows", *map(copy, written)), origin))
    row, col = (major, indices) if kind == "csr" else (indices, major)
    return matrix(kind, data, row, col, shape, indices=indices, indptr=ends)


def given_matrices(kept: Kept, kernel: Kernel) -> list[AST]:
    """The statements that bind the rows and the columns of the entries of matrices that are arguments."""
    made: list[AST] = []
    for parameter, value in list(kept.env.items()):
        if isinstance(value, Group):
            found = _by_entries(value, kernel.tree)
            before, kept.env[parameter] = kept.kept(found, kernel.tree, parameter) if found is not value else ([], value)
            made += before
    place = header_of(kernel.tree)
    return [at(s, place) for s in made]


def _by_entries(group: Group, origin: AST) -> Group:
    """A structure with the matrices in it by their entries."""
    if group.form.kind in SPARSE and "row" not in group.form.keys:
        return replace(laid_out(group.form.kind, *group.items, origin), path=group.path)
    items = tuple(_by_entries(i, origin) if isinstance(i, Group) else i for i in group.items)
    return group if items == group.items else replace(group, items=items)


def transposed(found: Group) -> Group:
    """The transpose, which has the same entries; the formats of rows and of columns change places."""
    kind = {"csr": "csc", "csc": "csr"}.get(found.form.kind, found.form.kind)
    shape = found.item("shape")
    assert isinstance(shape, Group)
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

