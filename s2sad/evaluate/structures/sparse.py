"""Sparse matrices of SciPy's while structures are taken apart: their entries, with the row and the column of each.

    a = csr_matrix((v, j, p), shape=(n, n))     a_data = v; a_row = runtime.sparse_rows(p, j); a_col = j; a_shape_0 = n
    y = a @ x                                   y = runtime.sparse_product(a_data, a_row, a_col, x, a_shape_0, ...)
    z = spsolve(a.T, y)                         z = runtime.sparse_solve(a_data, a_col, a_row, y, a_shape_0, False)

Whatever its format, a matrix is its entries here, and entries at one place add up: so a change of the format changes
nothing but what can be read of it, and a sum of two matrices has the entries of both.
"""
from __future__ import annotations

from dataclasses import replace

from s2sad.evaluate.structures.sparse_construction import Built
from s2sad.evaluate.structures.items import spoken
from s2sad.evaluate.structures.groups import SPELLED, StructureValue, Plain, Value
from s2sad.evaluate.structures.sparse_values import (
    FORMATS, PLACES, ROOM, is_matrix, is_sparse, joined, matrix, said, transposed,
)
from s2sad.tree import (
    AST, Add, Attribute, BinOp, Call, Constant, Div, MatMult, Mult, Sub, Subscript, UnaryOp, USub, at, call, const,
    copy, equal, tuple_of,
)

_LAID_OUT = {"csr": ("indices", "indptr"), "csc": ("indices", "indptr"), "coo": ("row", "col")}
_ENTRIES = "build it from its entries: coo_matrix((values, (rows, columns)), shape=(m, n)), whose duplicates add up"
_OPERATIONS = "sparse matrices have A @ x, x @ A, A + B, A - B, A * number and A / number"
_SOLVER = "a factorization has lu.solve(b)"
_FACTORS = ("splu", "factorized")
_ITERATIVE = ("cg", "gmres", "bicg", "bicgstab", "minres", "lgmres", "cgs", "qmr")


class Matrices(Built):
    """What expressions with sparse matrices stand for."""

    def field_of(self, base: StructureValue, node: Attribute) -> Value:
        return self.matrix_field(base, node) if is_sparse(base) else super().field_of(base, node)

    def item_of(self, base: StructureValue, node: Subscript) -> Value | None:
        if not is_sparse(base):
            return super().item_of(base, node)
        self.refuse(node, f"an element of {spoken(base)}, a sparse matrix, has no derivative rule", _ENTRIES, "S301")
        return None

    def plainly(self, value: Value, node: AST) -> AST:
        if not isinstance(value, StructureValue) or not is_sparse(value):
            return super().plainly(value, node)
        self.refuse(node, f"{said(value)}, which is used as a whole here", _SOLVER if value.form.kind == "factors" else
                    _OPERATIONS, "S203")
        return at(const(0.0), node)

    def _length(self, node: Call) -> Value | None:
        found = self.structural(node.args[0]) if len(node.args) == 1 else None
        return None if isinstance(found, StructureValue) and is_sparse(found) else super()._length(node)

    # -- how a matrix is made ------------------------------------------------------------------------------------------

    def of_scipy(self, node: Call, called: str) -> Value:
        """What a call of a function of `scipy.sparse` gives."""
        function = called.removeprefix(ROOM).removeprefix("linalg.")
        if function in self.built:
            found = self.built[function](node)
        elif function in _FACTORS or function == "spsolve":
            found = self._solving(function, node)
        else:
            self.refuse(node, f"no derivative rule for {called}", "call it in a function of your own under "
                        "@s2sad.rule(implicit=residual): docs/own-derivatives.md" if function in _ITERATIVE else
                        _ENTRIES, "S301")
            return Plain(at(const(0.0), node))
        if found is None:
            self.refuse(node, f"no derivative rule for {called} with these arguments", self._help(function), "S301")
        return Plain(at(const(0.0), node)) if found is None else found

    def _help(self, function: str) -> str:
        if function in ("diags", "diags_array"):
            return "write diags([main, lower, upper], [0, -1, 1], shape=(n, n), format=\"csr\")"
        if function == "spdiags":
            return "write spdiags(rows, [0, 1], m, n)"
        if function in ("identity", "eye", "eye_array"):
            return f"write {function}(n, format=\"csr\")"
        if function in (*_FACTORS, "spsolve"):
            return "give it a sparse matrix that the kernel builds or takes, and a dense right side"
        compressed = "" if function.startswith("coo") else f", or {function}((data, indices, indptr), shape=(m, n))"
        return f"write {function}((data, (rows, columns)), shape=(m, n)){compressed}"

    # -- what is computed with one -------------------------------------------------------------------------------------

    def operated(self, node: BinOp) -> Value | None:
        """A product, a sum or a quotient with a sparse matrix; None where there is none."""
        left, right = self.structural(node.left), self.structural(node.right)
        sparse = [v for v in (left, right) if isinstance(v, StructureValue) and is_matrix(v)]
        if not sparse:
            return None
        if len(sparse) == 2:
            if isinstance(node.op, (Add, Sub)):
                return self._sum(sparse[0], sparse[1], isinstance(node.op, Sub), node)
        elif isinstance(node.op, MatMult):
            dense = self.plain(node.right if sparse[0] is left else node.left)
            return self.product(sparse[0], dense, sparse[0] is left, node)
        elif isinstance(node.op, Mult):
            return self._scaled(sparse[0], self.plain(node.right if sparse[0] is left else node.left), node)
        elif isinstance(node.op, Div) and sparse[0] is left:
            return self._scaled(sparse[0], BinOp(const(1.0), Div(), self.plain(node.right)), node)
        self.refuse(node, "this operation with a sparse matrix has no derivative rule", _OPERATIONS, "S301")
        return Plain(at(const(0.0), node))

    def negated(self, node: UnaryOp) -> Value | None:
        found = self.structural(node.operand) if isinstance(node.op, USub) else None
        return self._scaled(found, const(-1.0), node) if isinstance(found,
                                                                    StructureValue) and is_matrix(found) else None

    def product(self, found: StructureValue, dense: AST, first: bool, origin: AST) -> Plain:
        sizes = self.size(found, 0), self.size(found, 1)
        if first:
            return Plain(at(call("runtime.sparse_product", *self.places(found), dense, *sizes), origin))
        return Plain(at(call("runtime.sparse_left_product", dense, *self.places(found), *sizes), origin))

    def _scaled(self, found: StructureValue, factor: AST, origin: AST) -> StructureValue:
        data, _, _ = self.places(found)
        scaled = Plain(at(call("scipy.sparse.entries", data, factor), origin))
        return replace(found, items=(scaled, *found.items[1:]), path=SPELLED)

    def _sum(self, first: StructureValue, second: StructureValue, negative: bool, origin: AST) -> StructureValue:
        """The sum has the entries of both matrices; of two with their entries at the same places, those added."""
        one, other = self.places(first), self.places(second)
        kind = first.form.kind if first.form.kind != "coo" else "csr"
        op = Sub() if negative else Add()
        if self._differ(first, second):
            self.refuse(origin, "a sum of sparse matrices of different shapes", "give both the same shape", "S301")
        if all(equal(a, b) for a, b in zip(one[1:], other[1:])):
            return matrix(kind, Plain(at(BinOp(one[0], op, other[0]), origin)), first.item("row"), first.item("col"),
                          first.item("shape"))
        added = call("scipy.sparse.entries", other[0], const(-1.0)) if negative else other[0]
        data = at(call("numpy.concatenate", at(tuple_of(one[0], added), origin)), origin)
        row, col = (Plain(at(joined([a, b]), origin)) for a, b in zip(one[1:], other[1:]))
        return matrix(kind, Plain(data), row, col, first.item("shape"))

    def _differ(self, first: StructureValue, second: StructureValue) -> bool:
        """Whether the sizes of two matrices are known to be different."""
        sizes = [(self.key(self.size(first, k)), self.key(self.size(second, k))) for k in (0, 1)]
        return any(None not in pair and pair[0] != pair[1] for pair in sizes)

    # -- solutions -----------------------------------------------------------------------------------------------------

    def _solving(self, function: str, node: Call) -> Value | None:
        """`spsolve(A, b)`, or a factorization."""
        count = 2 if function == "spsolve" else 1
        options = {str(k.arg): k.value for k in node.keywords}
        given = [*node.args, *(options.pop(n) for n in ("A", "b")[len(node.args):] if n in options)]
        found = self.structural(given[0]) if given else None
        plain = options.keys() <= {"permc_spec", "use_umfpack"} and all(
            isinstance(v, Constant) for v in options.values())
        if len(given) != count or not plain or not isinstance(found, StructureValue) or not is_matrix(found):
            return None
        if count == 2:
            return self.solution(found, given[1], False, False, node)
        found = self.in_format(found, found.form.kind, own=True)
        return replace(found, form=replace(found.form, kind="factors"), path=SPELLED)

    def solution(self, found: StructureValue, b: AST, transposed: bool, kept: bool, origin: AST) -> Plain | None:
        right = self.structural(b)
        if isinstance(right, StructureValue):
            return None
        data, row, col = self.places(found)
        places = (col, row) if transposed else (row, col)
        sizes = self.size(found, 0), self.size(found, 1)
        return Plain(at(call("runtime.sparse_solve", data, *places, self.plain(b), *sizes, const(kept)), origin))

    def solved(self, found: StructureValue, node: Call) -> Value | None:
        """`lu.solve(b, trans="T")`, or a call of what `factorized` gave."""
        options = {str(k.arg): k.value for k in node.keywords}
        given = [*node.args, *([options.pop("trans")] if "trans" in options else [])]
        trans = self.key(given[1]) if len(given) > 1 else "N"
        if options or not 1 <= len(given) <= 2 or trans not in ("N", "T", "H"):
            return None
        return self.solution(found, given[0], trans != "N", True, node)

    def called_factors(self, found: StructureValue, node: Call) -> Value:
        """A call of what `factorized` gave."""
        made = self.solved(found, node) if found.form.kind == "factors" and len(node.args) == 1 else None
        if made is None:
            self.refuse(node, f"a call of {spoken(found)}", "call what factorized(A) gave, with a "
                        "dense right side")
        return Plain(at(const(0.0), node)) if made is None else made

    # -- what is read of one -------------------------------------------------------------------------------------------

    def matrix_field(self, found: StructureValue, node: Attribute) -> Value:
        """`A.data`, `A.T`, `A.shape`, ..."""
        held = _LAID_OUT.get(found.form.kind, ())
        whole = set(held) <= set(found.form.keys)
        if found.form.kind in FORMATS:
            if node.attr == "T":
                return transposed(found)
            if node.attr == "shape":
                return found.item("shape")
            if whole and node.attr in ("data", *held):
                if node.attr in PLACES and self.stores.to_places:
                    self.refuse(node, "the places of the entries of a sparse matrix are written", _ENTRIES)
                return found.item(node.attr)
            if whole and node.attr in ("nnz", "size"):
                return Plain(at(call("numpy.size", self.part(found, "data")), node))
        help = "" if node.attr not in ("data", "indices", "indptr", "row", "col", "nnz", "size") else (
            "SciPy sorts and joins the entries here: keep the arrays that it is built from")
        return self._none(found, node, f"the attribute '{node.attr}'", help)

    def matrix_method(self, found: StructureValue, node: Call) -> Value:
        """`A.dot(x)`, `A.tocsr()`, `A.toarray()`, ..."""
        method = node.func.attr
        made = self.solved(found, node) if found.form.kind == "factors" and method == "solve" else \
            self._method_of(found, method, node) if found.form.kind != "factors" else None
        return self._none(found, node, f"the method '{method}'", "") if made is None else made

    def _method_of(self, found: StructureValue, method: str, node: Call) -> Value | None:
        if method in ("dot", "__matmul__") and len(node.args) == 1 and not node.keywords:
            return None if self.structural(node.args[0]) is not None and isinstance(
                self.structural(node.args[0]), StructureValue) else self.product(found, self.plain(node.args[0]), True,
                                                                                 node)
        if method == "asformat" and len(node.args) == 1 and not node.keywords:
            kind = self.key(node.args[0])
            return self.in_format(found, str(kind)) if kind in FORMATS else None
        if node.args or node.keywords:
            return None
        if method in ("tocsr", "tocsc", "tocoo", "todia"):
            return self.in_format(found, method[2:])
        if method == "transpose":
            return transposed(found)
        if method == "copy":
            return self.in_format(found, found.form.kind, own=True)
        sizes = self.size(found, 0), self.size(found, 1)
        if method == "toarray":
            return Plain(at(call("runtime.sparse_dense", *self.places(found), *sizes), node))
        if method == "diagonal":
            size = copy(sizes[0]) if equal(*sizes) else call("builtins.min", *map(copy, sizes))
            return Plain(at(call("runtime.sparse_diagonal", *self.places(found), *sizes, size), node))
        return Plain(at(call("numpy.sum", self.places(found)[0]), node)) if method == "sum" else None

    def _none(self, found: StructureValue, node: AST, what: str, help: str) -> Value:
        self.refuse(node, f"{what} of {spoken(found)} has no derivative rule here: {said(found)}", help or (
            _SOLVER if found.form.kind == "factors" else "sparse matrices have A @ x, A.T, A.dot(x), A.diagonal(), "
            "A.toarray(), A.sum() and A.tocsr()"), "S301")
        return Plain(at(const(0.0), node))
