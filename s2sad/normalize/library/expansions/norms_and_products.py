"""Expansions of norms and products of matrices, and of complete decompositions in reduced ones."""
from __future__ import annotations

from collections.abc import Callable, Sequence

from s2sad.infer.signatures.laws import distinct_axes
from s2sad.infer.signatures.options import norm_order
from s2sad.normalize.library.expansions.templates import CallArguments, guard, lines, size

Order = int | float | str | None
_LAST = (-2, -1)
WIDE = "more {} than the smaller size of the matrix are not determined: pass {}"


def matrix_axes(args: CallArguments) -> Sequence[int] | None:
    """The axes of the rows and the columns of a norm of matrices, from 0; None if it is one of vectors."""
    rank = args.rank("x")
    if not args.has("axis"):
        return (0, 1) if rank == 2 else None
    axes = distinct_axes(args.arguments["axis"], rank)
    return axes if axes is not None and len(axes) == 2 else None


def matrix_norm(order: Order, axes: Sequence[int], rank: int) -> str:
    """A norm of the matrices in these axes."""
    rows, columns = axes
    if order in (2, -2, "nuc"):
        moved = f"numpy.moveaxis(x, {(rows, columns)}, {_LAST})" if (rows, columns) != (rank - 2, rank - 1) else "x"
        along = ", axis=-1" if rank > 2 else ""
        found = {2: "max", -2: "min", "nuc": "sum"}[order]
        return lines(f"values = runtime.singular_values({moved})", f"result = numpy.{found}(values{along})")
    summed, other = (columns, rows) if order in ("inf", "-inf") else (rows, columns)
    along = f", axis={other - (other > summed)}" if rank > 2 else ""
    extreme = "min" if order in (-1, "-inf") else "max"
    return lines(f"sums = numpy.sum(numpy.abs(x), axis={summed})", f"result = numpy.{extreme}(sums{along})")


def _condition(args: CallArguments) -> str:
    """By singular values, or with the inverse."""
    order, stack = norm_order(args.arguments["p"]), args.rank("x") - 2
    if order in (None, 2, -2):
        deep, least = ":, " * stack, size("values", stack)
        large, small = f"values[{deep}0]", f"values[{deep}{least} - 1]"
        ratio = f"{small} / {large}" if order == -2 else f"{large} / {small}"
        return lines("values = runtime.singular_values(x)", guard(f"{least} > 0", "np.linalg.cond of empty matrices"),
                     f"result = {ratio}")
    spelled = {"inf": "numpy.inf", "-inf": "-numpy.inf"}.get(str(order), repr(order))
    return lines("inverse = numpy.linalg.inv(x)",
                 f"result = numpy.linalg.norm(x, ord={spelled}, axis={_LAST}) * "
                 f"numpy.linalg.norm(inverse, ord={spelled}, axis={_LAST})")


def _reduced_factor(args: CallArguments, function: str, least: int, message: str) -> str:
    """A factor of a complete decomposition, where it is that of the reduced one."""
    rank = args.rank("a")
    sizes = [size("a", rank - 2 + k) for k in (least, 1 - least)]
    return lines(guard(" <= ".join(sizes), message), f"result = runtime.{function}(a)")


def _inner(args: CallArguments) -> str:
    """Of vectors and matrices; others are sums (`einsum.batched_products`)."""
    a, b = args.rank("a"), args.rank("b")
    if b == 1:
        return "result = numpy.matmul(a, b)"
    return "result = numpy.matmul(b, a)" if a == 1 else "result = numpy.matmul(a, numpy.transpose(b))"


def _kron(args: CallArguments) -> str:
    """Of arrays of different ranks: the shorter shape has ones before it."""
    rank = max(args.rank(p) for p in "ab")
    parts, whole = {}, []
    for p, kept in (("a", ":, None"), ("b", "None, :")):
        missing = rank - args.rank(p)
        parts[p] = f"{p}[{', '.join(['None, None'] * missing + [kept] * args.rank(p))}]"
        whole.append([size(p, k - missing) if k >= missing else "1" for k in range(rank)])
    sizes = ", ".join(f"{m} * {n}" for m, n in zip(*whole))
    return f"result = numpy.reshape({parts['a']} * {parts['b']}, ({sizes},))"


_MANY = WIDE.format("singular vectors", "full_matrices=False")
_COMPLETE = WIDE.format("columns of q", "mode='reduced'")
EXPANSIONS: dict[str, Callable[[CallArguments], str]] = {
    "numpy.linalg.cond": _condition, "numpy.inner": _inner, "numpy.kron": _kron,
    "numpy.linalg.svd.left": lambda args: _reduced_factor(args, "left_vectors", 0, _MANY),
    "numpy.linalg.svd.right": lambda args: _reduced_factor(args, "right_vectors", 1, _MANY),
    "numpy.linalg.qr.orthogonal": lambda args: _reduced_factor(args, "orthogonal_part", 0, _COMPLETE),
    "numpy.linalg.qr.triangular": lambda args: _reduced_factor(args, "triangular_part", 0, _COMPLETE)}
