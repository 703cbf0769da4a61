"""Sparse matrices of SciPy's in the heap: their entries, with the row and the column of each, and a shape.

    a = csr_matrix((v, j, p), shape=(n, n))     data: v, row: runtime.sparse_rows(p, j), col: j, shape: (n, n)
    def f(a, x): ...                            def f(a_data, a_indices, a_indptr, a_shape_0, a_shape_1, x): ...

Whatever its format, which is the kind of the object, a matrix is its entries here, and entries at one place add up: so
a change of the format changes nothing but what can be read of it. Of one in a compressed format that the kernel has in
this layout there are `indices` and `indptr`, too. "dia" is also whatever SciPy lays out by itself: its entries cannot
be read.
"""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, TypeGuard

from s2sad import tree
from s2sad.evaluate.effects import fresh_value
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator, operation
from s2sad.evaluate.specialize.signals import Reached
from s2sad.evaluate.specialize.heap import Heap, Object
from s2sad.evaluate.specialize.sparse.place_writes import COPIED, SHARED
from s2sad.evaluate.specialize.values import Data, Reference, TupleValue, Value, alike
from s2sad.pytree import SPARSE, PyTree
from s2sad.read.outside_values import Matrix
from s2sad.tree import AST

FORMATS = (*SPARSE, "dia")
FACTORS = "factors"             # a factorization of a matrix
KINDS = (*FORMATS, FACTORS)


def is_matrix(value: Value, heap: Heap) -> TypeGuard[Reference]:
    """Whether a value is a sparse matrix."""
    return isinstance(value, Reference) and heap[value].kind in FORMATS


def is_sparse(value: Value, heap: Heap) -> TypeGuard[Reference]:
    """Whether a value is a sparse matrix or a factorization of one."""
    return isinstance(value, Reference) and heap[value].kind in KINDS


def form_said(held: Object) -> str:
    return str(PyTree(held.kind, (), ()))


def spoken(held: Object) -> str:
    """A matrix in a sentence."""
    return f"'{held.label}'" if held.label else form_said(held).replace("a ", "the ", 1)


def said(held: Object) -> str:
    """What a matrix is, in a sentence."""
    return f"'{held.label}' is {form_said(held)}" if held.label else f"this is {form_said(held)}"


# -- parts -----------------------------------------------------------------------------------------------------------
def emitted(ev: Evaluator, path: str, *args: Value | AST, origin: AST) -> Data:
    """A call of the residual program that gives an array with one axis."""
    spelled = [a if isinstance(a, AST) else ev.spelled(a, origin) for a in args]
    return Data(tree.at(tree.call(ev.library(path), *spelled), origin), shape=(None,))


def entries(ev: Evaluator, base: Reference, origin: AST) -> list[AST]:
    """The entries, their rows and their columns, as expressions."""
    held = ev.heap[base]
    return [ev.spelled(held.items[k], origin) for k in ("data", "row", "col")]


def sizes(ev: Evaluator, base: Reference, origin: AST) -> list[AST]:
    """The number of rows and of columns."""
    return [ev.spelled(n, origin) for n in shape_of(ev, base).items]


def shape_of(ev: Evaluator, base: Reference) -> TupleValue:
    found = ev.heap[base].items["shape"]
    assert isinstance(found, TupleValue)
    return found


def matrix(ev: Evaluator, kind: str, parts: dict[str, Value], shape: TupleValue, origin: AST, label: str = ""
           ) -> Reference:
    """A sparse matrix of its data, row and col, and perhaps indices and indptr."""
    label = label or _wanted(ev, origin)
    held = {k: _vector(ev.atoms(v, f"{label}_{k}", origin)) for k, v in parts.items()}
    return ev.heap.new(Object(kind, {**held, "shape": ev.atoms(shape, f"{label}_shape", origin)}, site=origin))


def _vector(value: Value) -> Value:
    """A value that is known to be an array with one axis."""
    return replace(value, shape=(None,)) if isinstance(value, Data) and not value.shape else value


def _wanted(ev: Evaluator, origin: AST) -> str:
    """What a matrix is called that an expression makes."""
    return ev.wanted[origin][0] if origin in ev.wanted else "matrix"


def laid_out(ev: Evaluator, kind: str, parts: Sequence[Value], shape: TupleValue, origin: AST, label: str = ""
             ) -> Reference:
    """A matrix in a compressed format, of its data, indices and indptr: this says where the entries of a row end, of a
    column in csc."""
    label = label or _wanted(ev, origin)
    data, indices, indptr = (ev.atoms(v, f"{label}_{k}", origin) for k, v in zip(SPARSE["csr"], parts))
    major = emitted(ev, "runtime.sparse_rows", indptr, indices, origin=origin)
    row, col = (major, indices) if kind == "csr" else (indices, major)
    return matrix(ev, kind, {"data": data, "row": row, "col": col, "indices": indices, "indptr": indptr}, shape,
                  origin, label)


def places(ev: Evaluator, value: Value, origin: AST) -> Value:
    """The rows, columns or indices that a matrix is given: SciPy copies some and not others, so that they must not be
    written while the matrix is used."""
    if not isinstance(value, Data) or "." in value.name:        # nothing writes arrays of modules
        return value
    return emitted(ev, SHARED, value, origin=origin)


def transposed(ev: Evaluator, base: Reference) -> Reference:
    """The transpose, which has the same entries; the formats of rows and of columns change places."""
    held = ev.heap[base]
    kind = {"csr": "csc", "csc": "csr"}.get(held.kind, held.kind)
    items = {**held.items, "row": held.items["col"], "col": held.items["row"],
             "shape": TupleValue(shape_of(ev, base).items[::-1])}
    return ev.heap.new(replace(held, kind=kind, items=items, label="", path=""))


def in_format(ev: Evaluator, base: Reference, kind: str, origin: AST, own: bool = False) -> Reference:
    """The matrix in a format; in its own it is itself, in another one, or where it has to be its `own`, SciPy copies
    its entries."""
    held = ev.heap[base]
    if held.kind == kind and not own:
        return base
    data = held.items["data"]
    if not _is_alone(ev, base, data):
        data = emitted(ev, "numpy.copy", data, origin=origin)
    kept = ("row", "col", *(("indices", "indptr") if held.kind == kind else ()))
    parts = {k: emitted(ev, COPIED, held.items[k], origin=origin) for k in kept if k in held.items}
    opaque = kind if held.kind == kind else "dia" if kind == "coo" else kind
    return matrix(ev, opaque, {"data": data, **parts}, shape_of(ev, base), origin)


def _is_alone(ev: Evaluator, base: Reference, data: Value) -> bool:
    """Whether nothing else has the entries of a matrix that nothing holds."""
    if not isinstance(data, Data) or not ev.owns(data.name) or ev.heap.holders(base):
        return False
    made = [s.value for s in ev.block if isinstance(s, tree.Assign) and isinstance(s.targets[0], tree.Name)
            and s.targets[0].id == data.name]
    return len(made) == 1 and (fresh_value(made[0]) or (tree.call_name(made[0]) or "").startswith("scipy.sparse."))


# -- from outside ----------------------------------------------------------------------------------------------------
def given_matrix(ev: Evaluator, form: PyTree, items: Sequence[Value], path: str, wanted: str, origin: AST) -> Reference:
    """A matrix that is an argument, or lies in one."""
    data, *at, shape = items
    shared = [ev.named(emitted(ev, SHARED, v, origin=origin), wanted, origin) for v in at]
    return _of_parts(ev, form.kind, data, shared, shape, path, wanted, origin)


@operation
def outside_matrix(ev: Evaluator, meaning: Matrix, node: AST, f: Frame) -> Value:
    """A matrix of a module, which is made before everything else."""
    live: Any = meaning.value
    if id(live) not in ev.live:
        if ev.pending:
            raise Reached(meaning.name, live, ev.owning)
        arrays, numbers = meaning.parts()
        data, *at = (ev.meaning_value(a.name, a, node, f) for a in arrays)
        shape = TupleValue(tuple(ev.meaning_value(n.name, n, node, f) for n in numbers))
        ev.held.append(live)
        made = _of_parts(ev, live.format, data, at, shape, meaning.name, meaning.name, node)
        ev.live[id(live)], ev.outset[made.number] = made, ev.heap[made]
    return ev.live[id(live)]


def _of_parts(ev: Evaluator, kind: str, data: Value, at: Sequence[Value], shape: Value, label: str, wanted: str,
              origin: AST) -> Reference:
    assert isinstance(shape, TupleValue)
    if kind == "coo":
        made = matrix(ev, kind, {"data": data, "row": at[0], "col": at[1]}, shape, origin, wanted)
    else:
        made = laid_out(ev, kind, [data, *at], shape, origin, wanted)
    ev.heap.objects[made.number] = replace(ev.heap[made], label=label)
    return made


def same_places(ev: Evaluator, first: Reference, second: Reference) -> bool:
    """Whether two matrices are known to have their entries at the same places."""
    one, other = ev.heap[first].items, ev.heap[second].items
    return all(alike(one[k], other[k]) for k in ("row", "col"))
