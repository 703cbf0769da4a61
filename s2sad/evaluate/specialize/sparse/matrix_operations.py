"""What is computed with sparse matrices: products, sums, solutions, and what is read of one.

    y = a @ x                   y = runtime.sparse_product(a_data, a_row, a_col, x, m, n)
    b = 2.0 * a                 b_data = scipy.sparse.entries(a_data, 2.0)
    z = spsolve(a.T, y)         z = runtime.sparse_solve(a_data, a_col, a_row, y, n, m, False)

A sum of two matrices has the entries of both.
"""
from __future__ import annotations

from dataclasses import replace
from typing import NoReturn

from s2sad import tree
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator, operation
from s2sad.evaluate.specialize.functions.library_calls import Args, Options
from s2sad.evaluate.specialize.sparse.matrix_values import (
    FACTORS, FORMATS, emitted, entries, in_format, is_matrix, is_sparse, matrix, said, same_places, shape_of, sizes,
    spoken, transposed,
)
from s2sad.evaluate.specialize.sparse.matrix_construction import ENTRIES, concatenated, joined, sparse_function
from s2sad.evaluate.specialize.values import (
    Data, MethodValue, Reference, Value, alike, constant,
)
from s2sad.tree import AST

_LAID_OUT = {"csr": ("indices", "indptr"), "csc": ("indices", "indptr"), "coo": ("row", "col")}
_OPERATIONS = "sparse matrices have A @ x, x @ A, A + B, A - B, A * number and A / number"
_SOLVER = "a factorization has lu.solve(b)"


# -- operators -------------------------------------------------------------------------------------------------------
@operation
def matrix_operator(ev: Evaluator, op: AST, left: Value, right: Value, node: AST) -> Value:
    """A product, a sum or a quotient with a sparse matrix."""
    found = [v for v in (left, right) if is_matrix(v, ev.heap)]
    other = right if found and found[0] is left else left
    if len(found) == 2 and isinstance(op, (tree.Add, tree.Sub)):
        return _sum(ev, found[0], found[1], isinstance(op, tree.Sub), node)
    if len(found) == 1 and isinstance(other, Data):
        if isinstance(op, tree.MatMult):
            return _product(ev, found[0], other, found[0] is left, node)
        if isinstance(op, (tree.Mult, tree.Div)) and other.shape:
            raise ev.refusal(node, "a sparse matrix times something that is no number",
                             "A @ x is the product with a vector", "S203")
        if isinstance(op, tree.Mult):
            return _scaled(ev, found[0], ev.spelled(other, node), node)
        if isinstance(op, tree.Div) and found[0] is left:
            return _scaled(ev, found[0], tree.BinOp(tree.const(1.0), op, ev.spelled(other, node)), node)
    if any(is_sparse(v, ev.heap) and not is_matrix(v, ev.heap) for v in (left, right)):
        refuse_whole(ev, next(v for v in (left, right) if is_sparse(v, ev.heap)), node)
    raise ev.refusal(node, "this operation with a sparse matrix has no derivative rule", _OPERATIONS, "S301")


def _product(ev: Evaluator, base: Reference, dense: Value, first: bool, node: AST) -> Data:
    at, size = entries(ev, base, node), sizes(ev, base, node)
    shape = None if not isinstance(dense, Data) or dense.shape is None else (None,) * len(dense.shape)
    if first:
        made = emitted(ev, "runtime.sparse_product", *at, dense, *size, origin=node)
    else:
        made = emitted(ev, "runtime.sparse_left_product", dense, *at, *size, origin=node)
    return replace(made, shape=shape)


def _scaled(ev: Evaluator, base: Reference, factor: AST, node: AST) -> Reference:
    held = ev.heap[base]
    data = emitted(ev, "scipy.sparse.entries", held.items["data"], factor, origin=node)
    parts = {str(k): v for k, v in held.items.items() if k != "shape"}
    return matrix(ev, held.kind, {**parts, "data": data}, shape_of(ev, base), node)


def _sum(ev: Evaluator, first: Reference, second: Reference, negative: bool, node: AST) -> Reference:
    """The sum has the entries of both matrices; of two with their entries at the same places, those added."""
    held, other = ev.heap[first], ev.heap[second]
    kind = held.kind if held.kind != "coo" else "csr"
    if _differ(ev, first, second):
        raise ev.refusal(node, "a sum of sparse matrices of different shapes", "give both the same shape", "S301")
    data = [ev.spelled(h.items["data"], node) for h in (held, other)]
    if same_places(ev, first, second):
        op = tree.Sub() if negative else tree.Add()
        added = Data(tree.at(tree.BinOp(data[0], op, data[1]), node), shape=(None,))
        parts: dict[str, Value] = {"data": added, "row": held.items["row"], "col": held.items["col"]}
        return matrix(ev, kind, parts, shape_of(ev, first), node)
    more = other.items["data"]
    if negative:
        more = emitted(ev, "scipy.sparse.entries", more, tree.const(-1.0), origin=node)
    row, col = (joined(ev, [h.items[k] for h in (held, other)], node) for k in ("row", "col"))  # pyright: ignore
    data = concatenated(ev, [held.items["data"], more], node)  # pyright: ignore[reportArgumentType]
    return matrix(ev, kind, {"data": data, "row": row, "col": col}, shape_of(ev, first), node)


def _differ(ev: Evaluator, first: Reference, second: Reference) -> bool:
    """Whether the sizes of two matrices are known to be different."""
    pairs = zip(shape_of(ev, first).items, shape_of(ev, second).items)
    return any(isinstance(a, Data) and isinstance(b, Data) and a.is_known and b.is_known and a.known != b.known
               for a, b in pairs)


@operation
def matrix_in_place(ev: Evaluator, op: AST, base: Reference, value: Value, node: AST) -> Value | None:
    """`A += B` makes another matrix; `A *= c` writes the entries of the one that there is."""
    if isinstance(op, (tree.Add, tree.Sub)) and is_matrix(base, ev.heap) and is_matrix(value, ev.heap):
        return matrix_operator(ev, op, base, value, node)
    number = isinstance(value, Data) and not value.shape
    if not is_matrix(base, ev.heap) or not number or not isinstance(op, (tree.Mult, tree.Div)):
        refuse_whole(ev, base, node)
    data = ev.spelled(ev.heap[base].items["data"], node)
    factor = ev.spelled(value, node)
    factor = factor if isinstance(op, tree.Mult) else tree.BinOp(tree.const(1.0), op, factor)
    scaled = emitted(ev, "scipy.sparse.entries", data, factor, origin=node)
    place = tree.index(tree.copy(data), tree.Slice(None, None, None))
    ev.emit(tree.assign(place, scaled.node), node, True)
    return None


@operation
def refuse_whole(ev: Evaluator, base: Reference, node: AST) -> NoReturn:
    """Refuses a matrix where it would be needed as a whole."""
    held = ev.heap[base]
    raise ev.refusal(node, f"{said(held)}, which is used as a whole here",
                     _SOLVER if held.kind == FACTORS else _OPERATIONS, "S203")


@operation
def refuse_element(ev: Evaluator, base: Reference, node: AST) -> NoReturn:
    """Refuses an element or a part of a matrix."""
    raise ev.refusal(node, f"an element of {spoken(ev.heap[base])}, a sparse matrix, has no derivative rule", ENTRIES,
                     "S301")


# -- solutions -------------------------------------------------------------------------------------------------------
@sparse_function("linalg.spsolve")
def _solve(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Data | None:
    """`spsolve(A, b)`."""
    given = _operands(args, options, ("A", "b"))
    if given is None or len(given) != 2 or not is_matrix(given[0], ev.heap):
        return None
    return _solution(ev, given[0], given[1], False, False, node)


@sparse_function("linalg.splu", "linalg.factorized")
def _factors(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Reference | None:
    """A factorization, which is of the entries as they are now."""
    given = _operands(args, options, ("A",))
    if given is None or len(given) != 1 or not is_matrix(given[0], ev.heap):
        return None
    made = in_format(ev, given[0], ev.heap[given[0]].kind, node, own=True)
    items = {k: v for k, v in ev.heap[made].items.items() if k in ("data", "row", "col", "shape")}
    return ev.heap.new(replace(ev.heap[made], kind=FACTORS, items=items))


def _operands(args: Args, options: Options, names: tuple[str, ...]) -> Args | None:
    """What is solved with; None where there are options of which the solution may depend."""
    options = dict(options)
    given = [*args, *(options.pop(n) for n in names[len(args):] if n in options)]
    plain = options.keys() <= {"permc_spec", "use_umfpack"} and all(
        isinstance(v, Data) and v.is_known for v in options.values())
    return given if plain else None


def _solution(ev: Evaluator, base: Reference, b: Value, is_transposed: bool, kept: bool, node: AST) -> Data | None:
    if not isinstance(b, Data):
        return None
    data, row, col = entries(ev, base, node)
    at = (col, row) if is_transposed else (row, col)
    made = emitted(ev, "runtime.sparse_solve", data, *at, b, *sizes(ev, base, node), tree.const(kept), origin=node)
    return replace(made, shape=None if b.shape is None else (None,) * len(b.shape))


def _solved(ev: Evaluator, base: Reference, args: Args, options: Options, node: AST) -> Data | None:
    """`lu.solve(b, trans="T")`, or a call of what `factorized` gave."""
    options = dict(options)
    given = [*args, *([options.pop("trans")] if "trans" in options else [])]
    trans = given[1].known if len(given) > 1 and isinstance(given[1], Data) else "N"
    if options or not 1 <= len(given) <= 2 or trans not in ("N", "T", "H"):
        return None
    return _solution(ev, base, given[0], trans != "N", True, node)


@operation
def called_factors(ev: Evaluator, base: Reference, args: Args, options: Options, node: AST) -> Value:
    """A call of what `factorized` gave."""
    held = ev.heap[base]
    made = _solved(ev, base, args, options, node) if held.kind == FACTORS and len(args) == 1 else None
    if made is None:
        raise ev.refusal(node, f"a call of {spoken(held)}", "call what factorized(A) gave, with a dense right side")
    return made


# -- what is read of one ---------------------------------------------------------------------------------------------
@operation
def matrix_attribute(ev: Evaluator, base: Reference, name: str, node: AST, f: Frame) -> Value:
    """`A.data`, `A.T`, `A.shape`, ..., or a method."""
    held = ev.heap[base]
    laid_out = _LAID_OUT.get(held.kind, ())
    if held.kind in FORMATS:
        whole = bool(laid_out) and {*laid_out} <= held.items.keys()
        if name == "T":
            return transposed(ev, base)
        if name == "shape":
            return held.items["shape"]
        if name == "ndim":
            return constant(2)
        if whole and name in ("data", *laid_out):
            return held.items[name]
        if whole and name in ("nnz", "size"):
            return ev.attribute_of(held.items["data"], "size", node, f)
    if name in _METHODS if held.kind in FORMATS else name == "solve":
        return MethodValue(base, name)
    return _none(ev, base, node, f"the attribute '{name}'", "" if name not in (
        "data", "indices", "indptr", "row", "col", "nnz", "size") else
        "SciPy sorts and joins the entries here: keep the arrays that it is built from")


@operation
def matrix_method(ev: Evaluator, base: Reference, name: str, args: Args, options: Options, node: AST, f: Frame
                  ) -> Value:
    """`A.dot(x)`, `A.tocsr()`, `A.toarray()`, ..."""
    if ev.heap[base].kind == FACTORS:
        made = _solved(ev, base, args, options, node) if name == "solve" else None
    else:
        made = _method(ev, base, name, args, options, node, f)
    return _none(ev, base, node, f"the method '{name}'") if made is None else made


_METHODS = ("tocsr", "tocsc", "tocoo", "todia", "asformat", "transpose", "copy", "toarray", "diagonal", "sum", "dot",
            "__matmul__", "__neg__")


def _method(ev: Evaluator, base: Reference, name: str, args: Args, options: Options, node: AST, f: Frame
            ) -> Value | None:
    if name in ("dot", "__matmul__") and len(args) == 1 and not options:
        return _product(ev, base, args[0], True, node) if isinstance(args[0], Data) else None
    if name == "asformat" and len(args) == 1 and not options:
        kind = ev.known(args[0], node, "the format of a sparse matrix")
        return in_format(ev, base, kind, node) if kind in FORMATS else None
    if args or options:
        return None
    if name in ("tocsr", "tocsc", "tocoo", "todia"):
        return in_format(ev, base, name[2:], node)
    if name == "transpose":
        return transposed(ev, base)
    if name == "copy":
        return in_format(ev, base, ev.heap[base].kind, node, own=True)
    if name == "__neg__":
        return _scaled(ev, base, tree.const(-1.0), node)
    if name == "toarray":
        made = emitted(ev, "runtime.sparse_dense", *entries(ev, base, node), *sizes(ev, base, node), origin=node)
        return replace(made, shape=(None, None))
    if name == "diagonal":
        return _diagonal(ev, base, node, f)
    return ev.library_call("numpy.sum", [ev.heap[base].items["data"]], {}, node, f) if name == "sum" else None


def _diagonal(ev: Evaluator, base: Reference, node: AST, f: Frame) -> Data:
    m, n = shape_of(ev, base).items
    size = m if alike(m, n) else ev.library_call("builtins.min", [m, n], {}, node, f)
    return emitted(ev, "runtime.sparse_diagonal", *entries(ev, base, node), *sizes(ev, base, node), size, origin=node)


def _none(ev: Evaluator, base: Reference, node: AST, what: str, help: str = "") -> NoReturn:
    held = ev.heap[base]
    raise ev.refusal(node, f"{what} of {spoken(held)} has no derivative rule here: {said(held)}", help or (
        _SOLVER if held.kind == FACTORS else "sparse matrices have A @ x, A.T, A.dot(x), A.diagonal(), "
        "A.toarray(), A.sum() and A.tocsr()"), "S301")


