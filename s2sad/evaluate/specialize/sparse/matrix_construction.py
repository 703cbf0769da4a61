"""How a kernel makes sparse matrices: of entries, of diagonals, of other matrices.

    csr_matrix((v, j, p), shape=(n, n))         entries v, rows runtime.sparse_rows(p, j), columns j
    coo_matrix((v, (i, j)), shape=(n, n))       entries v, rows i, columns j
    a.tocsc()                                   a copy of the entries of a, its rows and its columns
    diags([v, w], [0, 1], shape=(n, n))         entries v and w, rows and columns along the diagonals
"""
from __future__ import annotations

from collections.abc import Callable
from typing import Any

from s2sad import tree
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator, operation
from s2sad.evaluate.specialize.functions.library_calls import Args, Options, function
from s2sad.evaluate.specialize.sparse.matrix_values import (
    FORMATS, emitted, in_format, is_matrix, is_sparse, laid_out, matrix, places,
)
from s2sad.evaluate.specialize.values import NONE, Data, Iteration, Reference, TupleValue, Value, alike, constant
from s2sad.pytree import SPARSE
from s2sad.tree import AST

ROOM = "scipy.sparse."
ENTRIES = "build it from its entries: coo_matrix((values, (rows, columns)), shape=(m, n)), whose duplicates add up"
FACTORIZATIONS = ("splu", "factorized")
_ITERATIVE = ("cg", "gmres", "bicg", "bicgstab", "minres", "lgmres", "cgs", "qmr")
Make = Callable[[Evaluator, Args, Options, AST, Frame], "Reference | Data | None"]


def sparse_function(*names: str) -> Callable[[Make], Make]:
    """Registers a function of `scipy.sparse`: None is said to have no derivative."""
    def register(made: Make) -> Make:
        def call(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Value:
            called = ev.called
            found = made(ev, args, options, node, f)
            return refused_sparse(ev, called, True, node) if found is None else found
        for name in names:
            function(ROOM + name)(call)
        return made
    return register


@operation
def refused_sparse(ev: Evaluator, path: str, known: bool, node: AST) -> Value:
    """Refuses a function of `scipy.sparse`, or the arguments of one that is `known`."""
    name = path.rpartition(".")[2]
    room = f"{ROOM}linalg." if name in (*FACTORIZATIONS, "spsolve") else ROOM
    if known:
        raise ev.refusal(node, f"no derivative rule for {room}{name} with these arguments", _help(name), "S301")
    raise ev.refusal(node, f"no derivative rule for {path}", "call it in a function of your own under "
                     "@s2sad.rule(implicit=residual): docs/own-derivatives.md" if name in _ITERATIVE else ENTRIES,
                     "S301")


def _help(name: str) -> str:
    if name in ("diags", "diags_array"):
        return "write diags([main, lower, upper], [0, -1, 1], shape=(n, n), format=\"csr\")"
    if name == "spdiags":
        return "write spdiags(rows, [0, 1], m, n)"
    if name in ("identity", "eye", "eye_array"):
        return f"write {name}(n, format=\"csr\")"
    if name in (*FACTORIZATIONS, "spsolve"):
        return "give it a sparse matrix that the kernel builds or takes, and a dense right side"
    compressed = "" if name.startswith("coo") else f", or {name}((data, indices, indptr), shape=(m, n))"
    return f"write {name}((data, (rows, columns)), shape=(m, n)){compressed}"


# -- of entries ------------------------------------------------------------------------------------------------------
@sparse_function(*(f"{kind}_{word}" for kind in SPARSE for word in ("matrix", "array")))
def _made(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Reference | None:
    """`csr_matrix(...)` and its like, of entries or of another sparse matrix."""
    kind = ev.called[:3]
    given = [*args, *([options.pop("shape")] if "shape" in options else [])]
    if options or not 1 <= len(given) <= 2:
        return None
    if is_matrix(given[0], ev.heap):
        return None if len(given) > 1 else in_format(ev, given[0], kind, node)
    parts = _items(ev, given[0], node, f)
    shape = _shape(ev, given[1], node, f) if len(given) == 2 else None
    if shape is None or parts is None or len(parts) not in (2, 3):
        return None
    data = _array(ev, parts[0], node, f)
    found = [_array(ev, p, node, f) for p in (parts[1:] if len(parts) == 3 else _items(ev, parts[1], node, f) or ())]
    if data is None or len(found) != 2 or None in found or len(parts) == 3 and kind == "coo":
        return None
    at = [places(ev, p, node) for p in found if p is not None]
    if len(parts) == 3:
        return laid_out(ev, kind, [data, *at], shape, node)
    made = matrix(ev, "coo", {"data": data, "row": at[0], "col": at[1]}, shape, node)
    return made if kind == "coo" else in_format(ev, made, kind, node)


def _items(ev: Evaluator, value: Value, node: AST, f: Frame) -> list[Value] | None:
    """The items of a tuple or a list; None for anything else."""
    whole = isinstance(value, TupleValue) or isinstance(value, Reference) and ev.heap[value].kind == "list"
    return ev.items_of(value, node, f) if whole or isinstance(value, Iteration) else None


def _array(ev: Evaluator, value: Value, node: AST, f: Frame) -> Data | None:
    """An array that is given, a list or a range as an array."""
    if isinstance(value, Iteration) and value.kind == "range":
        return ev.library_call("numpy.arange", value.parts, {}, node, f)
    if isinstance(value, (TupleValue, Iteration)) or isinstance(value, Reference) and ev.heap[value].kind == "list" or (
            isinstance(value, Data) and value.is_list):
        return ev.library_call("numpy.array", [value], {}, node, f)
    return value if isinstance(value, Data) and not value.is_known else None


def _shape(ev: Evaluator, value: Value, node: AST, f: Frame) -> TupleValue | None:
    """The number of rows and columns that a pair says, or `x.shape`."""
    if isinstance(value, Data) and isinstance(value.node, tree.Attribute) and value.node.attr == "shape":
        return TupleValue(tuple(ev.item_of(value, constant(k), node, f) for k in range(2)))
    items = _items(ev, value, node, f)
    fits = items is not None and len(items) == 2 and all(isinstance(i, Data) for i in items)
    return TupleValue(tuple(items)) if fits and items is not None else None


# -- of diagonals ----------------------------------------------------------------------------------------------------
def _given(names: tuple[str, ...], args: Args, options: Options) -> Options | None:
    """The arguments by name, without those that are None; None where there are others, or one twice."""
    if len(args) > len(names) or not options.keys() <= {*names[len(args):]}:
        return None
    given = {**dict(zip(names, args)), **options}
    return {k: v for k, v in given.items() if not (isinstance(v, Data) and v.known is None)}


def _format(ev: Evaluator, given: Options, otherwise: str, node: AST) -> str | None:
    """The format that is asked for; None where it is another one."""
    found = ev.known(given.pop("format", NONE), node, "the format of a sparse matrix") or otherwise
    return found if found in FORMATS else None


@sparse_function("diags", "diags_array")
def _diagonals(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Reference | None:
    """`diags([a, b], [0, 1], shape=(m, n), format="csr")`."""
    given = _given(("diagonals", "offsets", "shape", "format"), args, options)
    if given is None or "diagonals" not in given or ev.called == "diags_array" and len(args) > 1:
        return None
    kind = _format(ev, given, "dia", node)
    values, offsets = (_items(ev, given.get(k, constant(0)), node, f) for k in ("diagonals", "offsets"))
    if kind is None or (values is None) is not (offsets is None):
        return None
    pairs = list(zip(values or [given["diagonals"]], offsets or [given.get("offsets", constant(0))]))
    if values is not None and offsets is not None and len(values) != len(offsets) or not all(
            isinstance(v, Data) for pair in pairs for v in pair):
        return None
    pairs = [(ev.atoms(v, "diagonal", node), ev.atoms(k, "offset", node)) for v, k in pairs]
    shape = _shape(ev, given["shape"], node, f) if "shape" in given else _square(ev, *pairs[0], node, f)
    return None if shape is None else _on_diagonals(ev, kind, pairs, shape, node, f)


def _square(ev: Evaluator, values: Any, offset: Value, node: AST, f: Frame) -> TupleValue | None:
    """The shape of a matrix with a diagonal that is an array."""
    if values.is_known:
        return None
    size = ev.attribute_of(values, "size", node, f)
    if not (isinstance(offset, Data) and offset.known == 0):
        size = ev.binary(tree.Add(), size, ev.library_call("builtins.abs", [offset], {}, node, f), node, f)
    size = ev.atoms(size, "size", node)
    return TupleValue((size, size))


@sparse_function("spdiags")
def _columns(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Reference | None:
    """`spdiags(rows, [0, 1], m, n)`: an element of a row is in the column of its place in the row."""
    given = _given(("data", "diags", "m", "n", "format"), args, options) or {}
    kind = _format(ev, given, "dia", node)
    if given.keys() != {"data", "diags", "m", "n"} or kind is None:
        return None
    data, m, n = given["data"], given["m"], given["n"]
    several = _items(ev, given["diags"], node, f)
    offsets = [given["diags"]] if several is None else several
    rows = _items(ev, data, node, f)
    if rows is None:
        rows = [ev.item_of(ev.atoms(data, "rows", node), constant(k), node, f) for k in range(
            len(offsets))] if several is not None and isinstance(data, Data) else [data]
    if len(rows) != len(offsets) or not all(isinstance(r, Data) and not r.is_known for r in rows) or not all(
            isinstance(k, Data) and type(k.known) is int for k in offsets):
        return None
    pairs: list[tuple[Value, Value]] = []
    for row, offset in zip(rows, offsets):
        first, size = _start(ev, offset, 1, node, f), _length(ev, m, n, offset, node, f)
        end = ev.spelled(ev.binary(tree.Add(), size, first, node, f), node)
        whole = ev.spelled(ev.atoms(row, "row", node), node)
        part = tree.index(whole, tree.Slice(ev.spelled(first, node), end, None))
        pairs.append((ev.named(Data(tree.at(part, node), shape=(None,)), "diagonal", node), offset))
    return _on_diagonals(ev, kind, pairs, TupleValue((m, n)), node, f)


def _on_diagonals(ev: Evaluator, kind: str, pairs: list[tuple[Value, Value]], shape: TupleValue, node: AST, f: Frame
                  ) -> Reference:
    m, n = shape.items
    data: list[Data] = []
    at: list[list[Data]] = [[], []]
    for values, offset in pairs:
        size = ev.atoms(_length(ev, m, n, offset, node, f), "size", node)
        data.append(emitted(ev, "scipy.sparse.along", values, size, origin=node))
        for k in (0, 1):
            at[k].append(emitted(ev, "runtime.sparse_span", _start(ev, offset, k, node, f), size, origin=node))
    row, col = (joined(ev, p, node) for p in at)
    return matrix(ev, "dia" if kind == "coo" else kind, {"data": concatenated(ev, data, node), "row": row, "col": col},
                  shape, node)


def concatenated(ev: Evaluator, data: list[Data], node: AST) -> Data:
    """Several lots of entries, one behind the other."""
    if len(data) == 1:
        return data[0]
    return emitted(ev, "numpy.concatenate", tree.at(tree.tuple_of(*(ev.spelled(d, node) for d in data)), node),
                   origin=node)


def joined(ev: Evaluator, at: list[Data], node: AST) -> Data:
    """The rows or the columns of several lots of entries."""
    made = at[0]
    for more in at[1:]:
        made = emitted(ev, "runtime.sparse_joined", made, more, origin=node)
    return made


def _start(ev: Evaluator, offset: Value, axis: int, node: AST, f: Frame) -> Value:
    """The row, or the column, in which a diagonal starts."""
    back = ev.binary(tree.Sub(), constant(0), offset, node, f) if axis == 0 else offset
    return ev.library_call("builtins.max", [constant(0), back], {}, node, f)


def _length(ev: Evaluator, m: Value, n: Value, offset: Value, node: AST, f: Frame) -> Value:
    """How many elements a diagonal has."""
    known = offset.known if isinstance(offset, Data) else None
    if type(known) is int and alike(m, n):
        return m if known == 0 else ev.binary(tree.Sub(), m, constant(abs(known)), node, f)
    rows, columns = (size if known == 0 else ev.binary(tree.Sub(), size, _start(ev, offset, k, node, f), node, f)
                     for k, size in enumerate((m, n)))
    return ev.library_call("builtins.min", [rows, columns], {}, node, f)


@sparse_function("identity", "eye", "eye_array")
def _unit(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Reference | None:
    """`identity(n)`, `eye(m, n, k)`."""
    is_identity = ev.called == "identity"
    given = _given(("n", "dtype", "format") if is_identity else ("m", "n", "k", "dtype", "format"), args, options)
    kind = None if given is None else _format(ev, given, "csr" if is_identity else "dia", node)
    if given is None or kind is None or "dtype" in given:
        return None
    rows, offset = given.get("n" if is_identity else "m"), given.get("k", constant(0))
    columns = None if is_identity else given.get("n")
    if not isinstance(rows, Data) or not isinstance(offset, Data) or is_sparse(rows, ev.heap):
        return None
    rows = ev.atoms(rows, "size", node)
    shape = TupleValue((rows, rows if columns is None else ev.atoms(columns, "size", node)))
    return _on_diagonals(ev, kind, [(constant(1.0), ev.atoms(offset, "offset", node))], shape, node, f)


# -- questions -------------------------------------------------------------------------------------------------------
@function("scipy.sparse.issparse", "scipy.sparse.isspmatrix")
def _is_sparse(ev: Evaluator, args: Args, _: Options, node: AST, f: Frame) -> Value:
    return constant(is_matrix(args[0], ev.heap))
