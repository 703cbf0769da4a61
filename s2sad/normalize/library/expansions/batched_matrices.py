"""Expansions of functions of matrices over stacks of these: loops over the matrices.

    y = np.linalg.inv(a)            y = np.empty(a.shape)
                                    for place in range(a.shape[0]):
                                        y[place] = np.linalg.inv(a[place])

Several right sides of one matrix lie side by side, so that it is factored once.
"""
from __future__ import annotations

from collections.abc import Callable

from s2sad.infer.inference import Typing
from s2sad.normalize.library.expansions.templates import CallArguments, empty, guard, lines, size, sizes
from s2sad.tree import Call, call_name

_SQUARE = ("numpy.linalg.inv", "numpy.linalg.cholesky", "numpy.linalg.matrix_power", "runtime.eigenvectors",
           "runtime.exponential")
_NUMBERS = ("numpy.linalg.det", "runtime.log_det", "runtime.det_sign")
_LAST = {"rows": -2, "columns": -1}
# the sizes of the result for a matrix
_RESULT_SIZES: dict[str, tuple[str, ...]] = {
    **dict.fromkeys(_SQUARE, ("rows", "columns")), **dict.fromkeys(_NUMBERS, ()),
    "numpy.linalg.pinv": ("columns", "rows"), "numpy.linalg.eigvalsh": ("rows",), "runtime.singular_values": ("least",),
    "runtime.orthogonal_part": ("rows", "least"), "runtime.triangular_part": ("least", "columns"),
    "runtime.left_vectors": ("rows", "least"), "runtime.right_vectors": ("least", "columns")}
EQUAL = "stacks of different sizes: repeat the matrices of the shorter one, np.repeat(a, n, axis=0)"


def batched_expansion(node: Call, typing: Typing) -> Callable[[CallArguments], str] | None:
    """The expansion of such a call, None where its operands are single matrices."""
    called = call_name(node) or ""
    if called == "numpy.linalg.solve" and max(typing.of(a).rank for a in node.args) > 2:
        return _solutions
    if called in _RESULT_SIZES and typing.of(node.args[0]).rank > 2:
        return lambda args: _per_matrix(args, called)
    return None


def _per_matrix(args: CallArguments, called: str) -> str:
    rank = args.rank("a")
    rows, columns = size("a", rank - 2), size("a", rank - 1)
    known = {"rows": rows, "columns": columns, "least": f"min({rows}, {columns})"}
    rest = ", n" if "n" in args.arguments else ""
    whole = [*sizes("a", rank - 2), *(known[s] for s in _RESULT_SIZES[called])]
    return _matrix_loops(rank - 2, empty(whole, args.type("a").dtype), f"{called}(a[{{place}}]{rest})")


def _matrix_loops(depth: int, made: str, value: str) -> str:
    """The text that fills what is made, one matrix of the stack at a time."""
    counters = [f"place{k}" for k in range(depth)]
    place = ", ".join(counters)
    nest = [f"{'    ' * k}for {c} in range(result.shape[{k}]):" for k, c in enumerate(counters)]
    return lines(f"result = {made}", *nest, f"{'    ' * depth}result[{place}] = {value.format(place=place)}")


def _solutions(args: CallArguments) -> str:
    a, b = args.rank("a"), args.rank("b")
    if a == 2:
        return _many_right_sides(b)
    fits = [guard(f"{size('a', k)} == {size('b', k)}", EQUAL) for k in range(a - 2 if b > 2 else 0)]
    made = empty([*sizes("a", a - 1), *([size("b", b - 1)] if b > 1 else [])], args.type("a").dtype)
    side = "b[{place}]" if b > 2 else "b"       # of the same dtype: `array_anf` sees to it
    return lines(*fits, _matrix_loops(a - 2, made, f"numpy.linalg.solve(a[{{place}}], {side})"))


def _many_right_sides(rank: int) -> str:
    """The solutions with one matrix for a stack of right sides."""
    columns = [size("b", k) for k in range(rank) if k != rank - 2]
    return lines(f"across = numpy.moveaxis(b, {rank - 2}, 0)",
                 f"sides = numpy.reshape(across, (a.shape[0], {' * '.join(columns)}))",
                 "solutions = numpy.linalg.solve(a, sides)",
                 f"apart = numpy.reshape(solutions, (a.shape[0], {', '.join(columns)}))",
                 f"result = numpy.copy(numpy.moveaxis(apart, 0, {rank - 2}))")
