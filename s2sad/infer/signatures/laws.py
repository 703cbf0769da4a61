"""laws: how the type and the shape of a function of whole arrays follow from its arguments, by the `law` of its rule.

A shape is a tuple of sizes, each an affine form or None where nothing is known of it.
"""
from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

from s2sad.infer.affine import Affine
from s2sad.infer.promotion import promote
from s2sad.infer.types import UNKNOWN, Type, array, of_rank
from s2sad.infer.signatures.norms_and_products import (
    common_dtype, least_squares, of_matrices, of_matrix, solution, solved,
)
from s2sad.tree import AST, Constant, List, Slice, Tuple, UnaryOp, USub

Shape = tuple["Affine | None", ...]
Options = Mapping[str, AST]
ONE = Affine((), 1)
_DEFAULT = Constant(None, None)
MOST_PAIRED = 7     # axes that two factors have together, of which one is summed over (`normalize/library/einsum`)
LEAST = Affine.symbol("the least")  # the least size of the first argument
SIZE_ARGUMENTS = {Affine.symbol(f"the argument {n}"): n for n in ("m", "n", "size")}    # sizes that are arguments
_M, _N, _SIZE = SIZE_ARGUMENTS


@dataclass(frozen=True)
class Law:
    """The type and the shape of a result; a shape of None leaves all sizes open."""
    type: Callable[[list[Type], Options], Type]
    shape: Callable[[list[Shape], Options], Shape | None]


def whole_number(node: AST) -> int | None:
    """The integer constant of an option, or None."""
    if isinstance(node, UnaryOp) and isinstance(node.op, USub):
        inner = whole_number(node.operand)
        return None if inner is None else -inner
    return node.value if isinstance(node, Constant) and type(node.value) is int else None


def items_of(node: AST) -> list[AST]:
    """The items of a tuple or list display, or the one node."""
    return list(node.elts) if isinstance(node, (Tuple, List)) else [node]


def constant_slice(node: Slice) -> slice | None:
    """The slice whose ends and step are constants, or None."""
    ends = [None if e is None else whole_number(e) for e in (node.lower, node.upper, node.step)]
    known = all((e is None) == (f is None) for e, f in zip((node.lower, node.upper, node.step), ends))
    return slice(*ends) if known and ends[2] != 0 else None


def axes_of(node: AST, rank: int) -> tuple[int, ...] | None:
    """The axes that an option names, from 0, all of them for None; None if they are no constants or out of range."""
    if isinstance(node, Constant) and node.value is None:
        return tuple(range(rank))
    found = [whole_number(p) for p in items_of(node)]
    if any(a is None or not -rank <= a < rank for a in found):
        return None
    return tuple(sorted({(a or 0) % rank for a in found}))


def paired_axes(node: AST | None, ranks: list[int]) -> list[tuple[int, int]] | None:
    """The axes that `np.tensordot` sums over, those of the first operand with those of the second; None if they are
    no constants or out of range."""
    if isinstance(node, (Tuple, List)) and len(node.elts) == 2:
        found = [[whole_number(p) for p in items_of(side)] for side in node.elts]
    else:
        count = 2 if node is None else whole_number(node)
        if count is None or count < 0:
            return None
        found = [list(range(ranks[0] - count, ranks[0])), list(range(count))]
    pairs = [(a, b) for a, b in zip(*found) if a is not None and b is not None
             and -ranks[0] <= a < ranks[0] and -ranks[1] <= b < ranks[1]]
    if len(found[0]) != len(found[1]) or len(pairs) != len(found[0]):
        return None
    return [(a % ranks[0], b % ranks[1]) for a, b in pairs]


def is_true(node: AST | None) -> bool:
    """Whether an option is a true constant."""
    return isinstance(node, Constant) and bool(node.value)


def _widened(kind: Type) -> Type:
    return replace(kind, dtype="int64") if kind.dtype in ("bool", "int8", "int16", "int32", "uint8", "uint16") else kind


def _reduced_type(args: list[Type], options: Options) -> Type:
    axes = axes_of(options["axis"], args[0].rank)
    if not axes or not args[0].is_array or not isinstance(options.get("keepdims", _DEFAULT), Constant):
        return UNKNOWN
    return of_rank(args[0], args[0].rank if is_true(options.get("keepdims")) else args[0].rank - len(axes))


def _reduced_shape(args: list[Shape], options: Options) -> Shape | None:
    axes = axes_of(options["axis"], len(args[0])) or ()
    if is_true(options.get("keepdims")):
        return tuple(ONE if k in axes else d for k, d in enumerate(args[0]))
    return tuple(d for k, d in enumerate(args[0]) if k not in axes)


def _averaged_type(args: list[Type], options: Options) -> Type:
    made = _reduced_type(args, options)
    return made if made.is_inexact or made.kind == "unknown" else replace(made, dtype="float64")


def _matmul_type(args: list[Type], options: Options) -> Type:
    a, b = args
    if not (a.is_array and b.is_array):
        return UNKNOWN
    rank = max(a.rank, b.rank, 2) - (a.rank == 1) - (b.rank == 1)
    return of_rank(Type("array", common_dtype(args)), rank)


def _dot_type(args: list[Type], options: Options) -> Type:
    """The last axis of the first with the last but one of the second; a number multiplies."""
    a, b = args
    if a.is_number and (b.is_number or b.is_array) or a.is_array and b.is_number:
        return promote(a, b) if {a.dtype, b.dtype} <= {"float64", "int64", "complex128"} else UNKNOWN
    fits = a.is_array and b.is_array and a.rank + b.rank <= MOST_PAIRED
    return of_rank(array(common_dtype(args), 1), a.rank + b.rank - 2) if fits else UNKNOWN


def _matmul_shape(args: list[Shape], options: Options) -> Shape | None:
    a, b = args
    if max(len(a), len(b)) > 2:
        return None
    return (a[:-1] if len(a) > 1 else ()) + (b[1:] if len(b) > 1 else ())


def _tensor_type(args: list[Type], options: Options) -> Type:
    ranks = [a.rank for a in args]
    pairs = paired_axes(options["axes"], ranks) if all(ranks) else None
    return UNKNOWN if pairs is None else of_rank(Type("array", common_dtype(args)), sum(ranks) - 2 * len(pairs))


def _places_type(args: list[Type], options: Options) -> Type:
    axis = whole_number(options["axis"])
    fits = args[0].is_array and axis is not None and -args[0].rank <= axis < args[0].rank
    return array("int64", args[0].rank) if fits else UNKNOWN


def _outer_type(args: list[Type], options: Options) -> Type:
    return array(common_dtype(args), 2)


def _of_matrices(rank: int, shape: Callable[[list[Shape], Options], Shape]) -> Law:
    """The law for a matrix, or each matrix of a stack; the sizes of a stack's results stay open."""
    return Law(of_matrices(rank), lambda args, options: shape(args, options) if len(args[0]) == 2 else None)


def _one_more(size: Affine | None) -> Affine | None:
    return size and size.shift(1)


def _reshaped_type(args: list[Type], options: Options) -> Type:
    shape = args[1]
    rank = len(shape.items) if shape.kind == "tuple" else 1
    if args[0].is_number:       # NumPy's, an array without axes
        return array(args[0].dtype, rank) if rank else args[0]
    return of_rank(args[0], rank) if args[0].is_array else UNKNOWN


def _spread_type(args: list[Type], options: Options) -> Type:
    return array(args[0].dtype, len(args[1].items)) if args[1].kind == "tuple" else array(args[0].dtype, 1)


def _along_type(args: list[Type], options: Options) -> Type:
    fits = axes_of(options["axis"], args[0].rank) is not None and not any(a.is_array for a in args[1:])
    return args[0] if fits else UNKNOWN


def _same_type(args: list[Type], options: Options) -> Type:
    return args[0]


def moveaxis_order(options: Options, rank: int) -> list[int] | None:
    """For each axis of the result of `np.moveaxis` the axis that it comes from; None if they are no constants."""
    source, destination = (distinct_axes(options[o], rank) for o in ("source", "destination"))
    if source is None or destination is None or len(source) != len(destination):
        return None
    order = [k for k in range(rank) if k not in source]
    for to, start in sorted(zip(destination, source)):
        order.insert(to, start)
    return order


def distinct_axes(node: AST, rank: int) -> list[int] | None:
    """The different axes that an argument names, from 0, in its order."""
    found = [whole_number(p) for p in items_of(node)]
    axes = [a % rank for a in found if a is not None and -rank <= a < rank]
    return axes if len(axes) == len(found) == len(set(axes)) else None


def _moveaxis_type(args: list[Type], options: Options) -> Type:
    return args[0] if args[0].is_array and moveaxis_order(options, args[0].rank) is not None else UNKNOWN


def _transformed_type(dtype: str) -> Callable[[list[Type], Options], Type]:
    """The type of a transform along one axis."""
    def type_of(args: list[Type], options: Options) -> Type:
        axis, norm = whole_number(options["axis"]), options["norm"]
        fits = args[0].is_array and axis is not None and -args[0].rank <= axis < args[0].rank
        known = isinstance(norm, Constant) and norm.value in (None, "backward", "ortho", "forward")
        if not fits or not known:
            return UNKNOWN
        return array("complex64" if args[0].dtype in ("float32", "complex64") else dtype, args[0].rank)
    return type_of


def _moveaxis_shape(args: list[Shape], options: Options) -> Shape | None:
    order = moveaxis_order(options, len(args[0]))
    return None if order is None else tuple(args[0][k] for k in order)


def _entries(args: list[Type]) -> bool:
    """Whether the first of these are the entries of a sparse matrix, their rows and their columns."""
    return args[0].rank == 1 and args[0].is_array and all(
        a.is_array and a.rank == 1 and a.dtype.startswith("int") for a in args[1:3]) and all(
        a.is_number for a in args[4:])


def _sparse_type(data: int, x: int) -> Callable[[list[Type], Options], Type]:
    """The type of a product or a solution; where `data` and `x` stand among the arguments."""
    def type_of(args: list[Type], options: Options) -> Type:
        fits = _entries(args[data:]) and args[x].is_array and args[x].rank in (1, 2)
        dtype = common_dtype([args[data], args[x]])
        return array(dtype, args[x].rank) if fits and dtype in ("float32", "float64") else UNKNOWN
    return type_of


def _sparse_matrix(rank: int) -> Callable[[list[Type], Options], Type]:
    def type_of(args: list[Type], options: Options) -> Type:
        return array(args[0].dtype, rank) if _entries(args) and args[0].is_float else UNKNOWN
    return type_of


def _joined_size(args: list[Shape], options: Options) -> Shape | None:
    first, second = args[0][0], args[1][0]
    return None if first is None or second is None else (first.plus(second, 1),)


# what must be equal of the operands of a function, by its law: a size along an axis, or a number
INNER = -3                   # of a second factor the axis that a product sums over: the last but one, or the only one
_SAME_ENTRIES = ((("data", 0), ("rows", 0)), (("data", 0), ("columns", 0)))
FITTING: dict[str, tuple[tuple[tuple[str, int], tuple[str, int]], ...]] = {
    **dict.fromkeys(("matmul", "dot"), ((("a", -1), ("b", INNER)),)),
    "stacked": ((("a", -1), ("b", INNER)),),
    "sparse product": (*_SAME_ENTRIES, (("x", 0), ("n", 0))),
    "sparse left product": (*_SAME_ENTRIES, (("x", -1), ("m", 0))),
    "sparse solve": (*_SAME_ENTRIES, (("b", 0), ("m", 0)), (("m", 0), ("n", 0))),
    "sparse dense": _SAME_ENTRIES, "sparse diagonal": _SAME_ENTRIES}


LAWS: dict[str, Law] = {
    "places": Law(_places_type, lambda args, options: args[0]),
    "counted": Law(lambda args, options: array("int64", 1), lambda args, options: None),
    "sought": Law(lambda args, options: array("int64", args[1].rank), lambda args, options: args[1]),
    "along": Law(_along_type, lambda args, options: args[0]),
    "same": Law(_same_type, lambda args, options: args[0]),
    "reduced": Law(_reduced_type, _reduced_shape),
    "summed": Law(lambda args, options: _widened(_reduced_type(args, options)), _reduced_shape),
    "averaged": Law(_averaged_type, _reduced_shape),
    "transposed": Law(_same_type, lambda args, options: args[0][::-1]),
    "moved": Law(_moveaxis_type, _moveaxis_shape),
    "reshaped": Law(_reshaped_type, lambda args, options: None),
    "raveled": Law(lambda args, options: array(args[0].dtype, 1), lambda args, options: None),
    "spread": Law(_spread_type, lambda args, options: None),
    "matmul": Law(_matmul_type, _matmul_shape),
    "dot": Law(_dot_type, _matmul_shape),
    "stacked": Law(_matmul_type, lambda args, options: (*args[0][:-1], args[1][-1])),
    "stacked transpose": Law(_same_type, lambda args, options: (*args[0][:-2], args[0][-1], args[0][-2])),
    "tensor": Law(_tensor_type, lambda args, options: None),
    "outer": Law(_outer_type, lambda args, options: (args[0] + args[1]) if len(args[0]) == len(args[1]) == 1 else None),
    "matrix": _of_matrices(2, lambda args, options: args[0]),
    "determinant": _of_matrices(0, lambda args, options: ()),
    "eigenvalues": _of_matrices(1, lambda args, options: args[0][:1]),
    "singular": _of_matrices(1, lambda args, options: (LEAST,)),
    "orthogonal": _of_matrices(2, lambda args, options: (args[0][0], LEAST)),
    "triangular": _of_matrices(2, lambda args, options: (LEAST, args[0][1])),
    "square": Law(lambda args, options: array(args[0].dtype, 2), lambda args, options: (args[0][0], args[0][0])),
    "inverted": _of_matrices(2, lambda args, options: args[0][::-1]),
    "least": Law(least_squares, lambda args, options: args[0][1:] + args[1][1:]),
    "factored": Law(of_matrix(2), lambda args, options: (_one_more(args[0][0]), args[0][1])),
    "unfactored": Law(of_matrix(2), lambda args, options: (args[0][1], args[0][1])),
    "gained": Law(lambda args, options: array(args[0].dtype, 2),
                  lambda args, options: (_one_more(args[0][0]), args[0][0])),
    **{law: Law(_transformed_type(dtype), lambda args, options: None)   # `Shapes.transformed` has their shapes
       for law, dtype in (("transformed", "complex128"), ("half", "complex128"), ("signal", "float64"))},
    "spectrum": Law(lambda args, options: array("complex128", args[0].rank), lambda args, options: None),
    "real": Law(lambda args, options: array("float64", args[0].rank), lambda args, options: None),
    "solved": Law(solved, lambda args, options: args[1]),
    "solution": Law(solution, lambda args, options: args[1] if len(args[0]) == 2 >= len(args[1]) else None),
    "sparse product": Law(_sparse_type(0, 3), lambda args, options: (_M, *args[3][1:])),
    "sparse left product": Law(_sparse_type(1, 0), lambda args, options: (*args[0][:-1], _N)),
    "sparse solve": Law(_sparse_type(0, 3), lambda args, options: args[3]),
    "sparse dense": Law(_sparse_matrix(2), lambda args, options: (_M, _N)),
    "sparse diagonal": Law(_sparse_matrix(1), lambda args, options: (_SIZE,)),
    "sparse entries": Law(lambda args, options: array(args[0].dtype, 1), lambda args, options: args[-1]),
    "sparse diagonal entries": Law(lambda args, options: array(args[0].dtype, 1), lambda args, options: args[1]),
    "sparse rows": Law(lambda args, options: array("int64", 1), lambda args, options: args[1]),
    "sparse span": Law(lambda args, options: array("int64", 1), lambda args, options: (_SIZE,)),
    "sparse joined": Law(lambda args, options: array("int64", 1), _joined_size),
}
