"""How the type and the shape of a function of whole arrays follow from its arguments, by the name that its rule gives.

A shape is a tuple of sizes, each an affine form or None where nothing is known of it.
"""
from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

from s2sad.infer.affine import Affine
from s2sad.infer.types import UNKNOWN, Type, array
from s2sad.tree import AST, Constant, List, Tuple, UnaryOp, USub

Shape = tuple["Affine | None", ...]
Options = Mapping[str, AST]
ONE = Affine((), 1)


@dataclass(frozen=True)
class Law:
    """The type and the shape of a result; a shape of None leaves all sizes open."""
    type: Callable[[list[Type], Options], Type]
    shape: Callable[[list[Shape], Options], Shape | None]


def whole_number(node: AST) -> int | None:
    """The integer that an option spells, or None."""
    if isinstance(node, UnaryOp) and isinstance(node.op, USub):
        inner = whole_number(node.operand)
        return None if inner is None else -inner
    return node.value if isinstance(node, Constant) and type(node.value) is int else None


def axes_of(node: AST, rank: int) -> tuple[int, ...] | None:
    """The axes that an option names, from 0, all of them for None; None if they are not written out or out of range."""
    if isinstance(node, Constant) and node.value is None:
        return tuple(range(rank))
    parts = list(node.elts) if isinstance(node, (Tuple, List)) else [node]
    found = [whole_number(p) for p in parts]
    if any(a is None or not -rank <= a < rank for a in found):
        return None
    return tuple(sorted({(a or 0) % rank for a in found}))


def is_true(node: AST | None) -> bool:
    return isinstance(node, Constant) and node.value is True


def of_rank(kind: Type, rank: int) -> Type:
    """The type with another rank: a number for 0."""
    return array(kind.dtype, rank) if rank else Type("number", kind.dtype)


def _widened(kind: Type) -> Type:
    return replace(kind, dtype="int64") if kind.dtype in ("bool", "int8", "int16", "int32", "uint8", "uint16") else kind


def _reduced_type(args: list[Type], options: Options) -> Type:
    axes = axes_of(options["axis"], args[0].rank)
    if axes is None or not args[0].is_array:
        return UNKNOWN
    return of_rank(args[0], args[0].rank if is_true(options.get("keepdims")) else args[0].rank - len(axes))


def _reduced_shape(args: list[Shape], options: Options) -> Shape | None:
    axes = axes_of(options["axis"], len(args[0])) or ()
    if is_true(options.get("keepdims")):
        return tuple(ONE if k in axes else d for k, d in enumerate(args[0]))
    return tuple(d for k, d in enumerate(args[0]) if k not in axes)


def _averaged_type(args: list[Type], options: Options) -> Type:
    made = _reduced_type(args, options)
    return made if made.is_float or made.kind == "unknown" else replace(made, dtype="float64")


def _common(args: list[Type]) -> str:
    order = ("bool", "int64", "float32", "float64")
    return max((a.dtype for a in args), key=lambda d: order.index(d) if d in order else 1)


def _matmul_type(args: list[Type], options: Options) -> Type:
    a, b = args
    if not (a.is_array and b.is_array):
        return UNKNOWN
    rank = max(a.rank, b.rank, 2) - (a.rank == 1) - (b.rank == 1)
    return of_rank(Type("array", _common(args)), rank)


def _matmul_shape(args: list[Shape], options: Options) -> Shape | None:
    a, b = args
    if max(len(a), len(b)) > 2:
        return None
    return (a[:-1] if len(a) > 1 else ()) + (b[1:] if len(b) > 1 else ())


def _outer_type(args: list[Type], options: Options) -> Type:
    return array(_common(args), 2)


def _solved_type(args: list[Type], options: Options) -> Type:
    return array("float64" if _common(args) != "float32" else "float32", args[1].rank)


def _shape_option(options: Options) -> list[AST]:
    shape = options["shape"]
    return list(shape.elts) if isinstance(shape, (Tuple, List)) else [shape]


def _reshaped_type(args: list[Type], options: Options) -> Type:
    shape = args[1]
    rank = len(shape.items) if shape.kind == "tuple" else 1
    return array(args[0].dtype, rank) if args[0].is_array else UNKNOWN


def _spread_type(args: list[Type], options: Options) -> Type:
    return array(args[0].dtype, len(args[1].items)) if args[1].kind == "tuple" else array(args[0].dtype, 1)


def _same_type(args: list[Type], options: Options) -> Type:
    return args[0]


def moved_axes(options: Options, rank: int) -> list[int] | None:
    """For each axis of the result of `np.moveaxis` the axis that it comes from; None if they are not written out."""
    source, destination = (written_axes(options[o], rank) for o in ("source", "destination"))
    if source is None or destination is None or len(source) != len(destination):
        return None
    order = [k for k in range(rank) if k not in source]
    for to, start in sorted(zip(destination, source)):
        order.insert(to, start)
    return order


def written_axes(node: AST, rank: int) -> list[int] | None:
    """The different axes that an argument names, from 0, in its order."""
    parts = list(node.elts) if isinstance(node, (Tuple, List)) else [node]
    found = [whole_number(p) for p in parts]
    axes = [a % rank for a in found if a is not None and -rank <= a < rank]
    return axes if len(axes) == len(found) == len(set(axes)) else None


def _moved_type(args: list[Type], options: Options) -> Type:
    return args[0] if args[0].is_array and moved_axes(options, args[0].rank) is not None else UNKNOWN


def _moved_shape(args: list[Shape], options: Options) -> Shape | None:
    order = moved_axes(options, len(args[0]))
    return None if order is None else tuple(args[0][k] for k in order)


LAWS: dict[str, Law] = {
    "same": Law(_same_type, lambda args, options: args[0]),
    "reduced": Law(_reduced_type, _reduced_shape),
    "summed": Law(lambda args, options: _widened(_reduced_type(args, options)), _reduced_shape),
    "averaged": Law(_averaged_type, _reduced_shape),
    "transposed": Law(_same_type, lambda args, options: args[0][::-1]),
    "moved": Law(_moved_type, _moved_shape),
    "reshaped": Law(_reshaped_type, lambda args, options: None),
    "raveled": Law(lambda args, options: array(args[0].dtype, 1), lambda args, options: None),
    "spread": Law(_spread_type, lambda args, options: None),
    "matmul": Law(_matmul_type, _matmul_shape),
    "outer": Law(_outer_type, lambda args, options: (args[0] + args[1]) if len(args[0]) == len(args[1]) == 1 else None),
    "solved": Law(_solved_type, lambda args, options: args[1]),
}
