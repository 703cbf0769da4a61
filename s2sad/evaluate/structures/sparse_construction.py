"""How a kernel makes sparse matrices, while structures are taken apart: of entries, diagonals, or other matrices.

    csr_matrix((v, j, p), shape=(n, n))         entries v, rows runtime.sparse_rows(p, j), columns j
    coo_matrix((v, (i, j)), shape=(n, n))       entries v, rows i, columns j
    a.tocsc()                                   a copy of the entries of a, its rows and its columns
    diags([v, w], [0, 1], shape=(n, n))         entries v and w, rows and columns along the diagonals
"""
from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from s2sad.diagnostics import Report
from s2sad.evaluate.structures.static_tests import Decisions
from s2sad.evaluate.structures.groups import SPELLED, StructureValue, Plain, Value, listed, spelled
from s2sad.evaluate.effects import own_lists
from s2sad.evaluate.structures.sparse_values import FORMATS, Stores, is_matrix, joined, laid_out, matrix, opaque
from s2sad.program import Kernel
from s2sad.pytree import SPARSE
from s2sad.tree import (
    AST, Attribute, BinOp, Call, Constant, List, Name, Slice, Sub, Subscript, Tuple, add, at, attribute, call,
    call_name, const, copy, equal, index, negate, tuple_of,
)

_SHARED = "numpy.broadcast_to"      # a view that is never kept in step with what it shows


class Built(Decisions):
    """The sparse matrices that expressions make."""

    def __init__(self, kernel: Kernel, report: Report):
        super().__init__(kernel, report)
        self.stores = Stores(kernel.tree.body)
        self.lists = own_lists(kernel.tree)
        self.built: dict[str, Callable[[Call], Value | None]] = {
            **{f"{f}_{word}": self._made for f in SPARSE for word in ("matrix", "array")},
            "diags": self._diagonals, "diags_array": self._diagonals, "spdiags": self._columns,
            "identity": self._unit, "eye": self._unit, "eye_array": self._unit}

    def _made(self, node: Call) -> Value | None:
        """`csr_matrix(...)` and its like, of entries or of another sparse matrix."""
        kind = (call_name(node) or "").rpartition(".")[2][:3]
        options = {str(k.arg): k.value for k in node.keywords}
        given = [*node.args, *([options.pop("shape")] if "shape" in options else [])]
        if options or not 1 <= len(given) <= 2:
            return None
        other = self.structural(given[0])
        if isinstance(other, StructureValue) and is_matrix(other):
            return None if len(given) > 1 else self.in_format(other, kind)
        whole = self.whole(given[0])
        shape = self._shape(given[1]) if len(given) == 2 else None
        if not isinstance(whole, StructureValue) or shape is None or not whole.form.is_sequence:
            return None
        parts = [self._entries(p, node, k > 0) for k, p in enumerate(whole.items)]
        if len(parts) == 2 and isinstance(whole.items[1], StructureValue) and len(whole.items[1].items) == 2:
            row, col = (self._entries(p, node, True) for p in whole.items[1].items)
            found = matrix("coo", parts[0], row, col, shape)
            return found if kind == "coo" else self.in_format(found, kind)
        if len(parts) != 3 or kind == "coo":
            return None
        if any(call_name(spelled(p, node)) == _SHARED for p in parts[1:]):
            self.refuse(given[0], "the indices or the indptr of a sparse matrix are written after it was made",
                        "copy them before, or build it with coo_matrix")
        return laid_out(kind, parts, shape, node)

    def _entries(self, value: Value, origin: AST, places: bool) -> Value:
        """An array that is given, a list as an array. SciPy copies some places and not others: where one could tell,
        since they are written, it is refused (`viewing`)."""
        written = spelled(value, origin)
        if isinstance(written, (List, Tuple)) or isinstance(written, Name) and written.id in self.lists:
            return Plain(at(call("numpy.array", written), origin))
        if places and written is not None and self.stores.later(written, origin):
            return Plain(at(call(_SHARED, written, attribute(copy(written), "shape")), origin))
        return value

    def _shape(self, node: AST) -> StructureValue | None:
        found = self.whole(node)
        return found if isinstance(found, StructureValue) and found.form.is_sequence and len(found.items) == 2 else None

    def in_format(self, found: StructureValue, kind: str, own: bool = False) -> StructureValue:
        """The matrix in a format; in its own it is itself, in another one SciPy copies its entries."""
        if found.form.kind == kind and not own:
            return found
        data = self.part(found, "data")
        if isinstance(data, (Name, Subscript, Attribute)):      # an expression makes an array of its own
            data = at(call("numpy.copy", data), data)
        if found.form.kind == kind:
            return replace(found, items=(Plain(data), *found.items[1:]), path=SPELLED)
        row, col = map(_own, (found.item("row"), found.item("col")))
        return matrix(opaque(kind), Plain(data), row, col, found.item("shape"))

    def part(self, found: StructureValue, key: str) -> AST:
        """A part of a matrix as an expression."""
        return copy(spelled(found.item(key), const(0.0)))

    def size(self, found: StructureValue, axis: int) -> AST:
        shape = found.item("shape")
        assert isinstance(shape, StructureValue)
        return copy(spelled(shape.items[axis], const(0.0)))

    def places(self, found: StructureValue) -> tuple[AST, AST, AST]:
        """The entries, their rows and their columns, to be read at once: a copy of the entries is not needed."""
        data = self.part(found, "data")
        if call_name(data) == "numpy.copy":
            data = data.args[0]
        return data, self.part(found, "row"), self.part(found, "col")

    # -- diagonals -----------------------------------------------------------------------------------------------------

    def _diagonals(self, node: Call) -> Value | None:
        """`diags([a, b], [0, 1], shape=(m, n), format="csr")`."""
        given = dict(zip(("diagonals", "offsets", "shape", "format"), node.args))
        given |= {str(k.arg): k.value for k in node.keywords}
        kind = self.key(given.pop("format", const(None))) or "dia"
        values, offsets = given.pop("diagonals", None), given.pop("offsets", const(0))
        several = isinstance(values, (List, Tuple)) and isinstance(offsets, (List, Tuple))
        if several and len(values.elts) != len(offsets.elts) or not several and (isinstance(
                values, (List, Tuple)) or isinstance(offsets, (List, Tuple))) or kind not in FORMATS:
            return None
        pairs = list(zip(values.elts, offsets.elts)) if several else [(values, offsets)]
        pairs = [(self.plain(v), self.plain(k)) for v, k in pairs if v is not None]
        shape = self._shape(given.pop("shape")) if "shape" in given else self._square(*pairs[0]) if pairs else None
        if given or shape is None or not pairs:
            return None
        return self._on_diagonals(str(kind), pairs, shape, node)

    def _columns(self, node: Call) -> Value | None:
        """`spdiags(rows, [0, 1], m, n)`: an element of a row is in the column of its place in the row."""
        given = dict(zip(("data", "diags", "m", "n", "format"), node.args))
        given |= {str(k.arg): k.value for k in node.keywords}
        kind = self.key(given.pop("format", const(None))) or "dia"
        if given.keys() != {"data", "diags", "m", "n"} or kind not in FORMATS:
            return None
        data, offsets = given["data"], given["diags"]
        several = isinstance(offsets, (List, Tuple))
        starts = [self.key(k) for k in (offsets.elts if several else [offsets])]
        rows = data.elts if isinstance(data, (List, Tuple)) else [
            index(data, const(k)) if several else data for k in range(len(starts))]
        if not all(isinstance(k, int) for k in starts) or len(rows) != len(starts) or not all(
                isinstance(r, (Name, Subscript)) for r in rows):
            return None
        m, n = self.plain(given["m"]), self.plain(given["n"])
        pairs: list[tuple[AST, AST]] = []
        for row, offset in zip(rows, map(const, starts)):
            first, size = self._starts(offset)[1], self._length_along(copy(m), copy(n), offset)
            part = Slice(first, add(size, copy(first)) if first.value else size, None)
            pairs.append((at(index(self.plain(at(row, node)), part), node), at(offset, node)))
        return self._on_diagonals(str(kind), pairs, listed((Plain(m), Plain(n))), node)

    def _square(self, values: AST, offset: AST) -> StructureValue:
        """The shape of a matrix with a diagonal that is an array."""
        size = attribute(copy(values), "size") if isinstance(values, Name) else call("numpy.size", copy(values))
        size = size if self.key(offset) == 0 else add(size, call("builtins.abs", copy(offset)))
        return listed((Plain(size), Plain(copy(size))))

    def _on_diagonals(self, kind: str, pairs: list[tuple[AST, AST]], shape: StructureValue,
                      origin: AST) -> StructureValue:
        m, n = (spelled(i, origin) or const(0) for i in shape.items)
        data: list[AST] = []
        places: list[list[AST]] = [[], []]
        for values, offset in pairs:
            size = self._length_along(copy(m), copy(n), offset)
            data.append(call("scipy.sparse.along", values, size))
            for k, start in enumerate(self._starts(offset)):
                places[k].append(call("runtime.sparse_span", start, copy(size)))
        row, col = (Plain(at(joined(p), origin)) for p in places)
        values = data[0] if len(data) == 1 else call("numpy.concatenate", at(tuple_of(*data), origin))
        return matrix(opaque(kind), Plain(at(values, origin)), row, col, shape)

    def _starts(self, offset: AST) -> tuple[AST, AST]:
        """The row and the column in which a diagonal starts."""
        known = self.key(offset)
        if isinstance(known, int):
            return const(max(0, -known)), const(max(0, known))
        return call("builtins.max", const(0), negate(copy(offset))), call("builtins.max", const(0), copy(offset))

    def _length_along(self, m: AST, n: AST, offset: AST) -> AST:
        known = self.key(offset)
        if isinstance(known, int) and equal(m, n):
            return m if known == 0 else BinOp(m, Sub(), const(abs(known)))
        if known == 0:
            return call("builtins.min", m, n)
        row, col = self._starts(offset)
        return call("builtins.min", BinOp(m, Sub(), row), BinOp(n, Sub(), col))

    def _unit(self, node: Call) -> Value | None:
        """`identity(n)`, `eye(m, n, k)`."""
        identity = (call_name(node) or "").endswith("identity")
        given = dict(zip(("m",) if identity else ("m", "n", "k"), node.args))
        given |= {str(k.arg): k.value for k in node.keywords}
        if identity and "n" in given:
            given["m"] = given.pop("n")
        kind = self.key(given.pop("format", const(None))) or ("csr" if identity else "dia")
        m, n, offset = given.pop("m", None), given.pop("n", None), given.pop("k", const(0))
        if given or m is None or len(node.args) > 3 or kind not in FORMATS:
            return None
        rows = self.plain(m)
        columns = copy(rows) if n is None or isinstance(n, Constant) and n.value is None else self.plain(n)
        shape = listed((Plain(rows), Plain(columns)))
        return self._on_diagonals(str(kind), [(at(const(1.0), node), self.plain(offset))], shape, node)


def _own(places: Value) -> Value:
    """Places that SciPy copies, whatever their type."""
    if isinstance(places, Plain) and isinstance(places.node, Call) and call_name(places.node) == _SHARED:
        return Plain(at(call("numpy.copy", places.node.args[0]), places.node))
    return places
