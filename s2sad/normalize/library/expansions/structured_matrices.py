"""Expansions of structured matrices of `scipy.linalg`: symmetric, Toeplitz, block diagonal, banded."""
from __future__ import annotations

from collections.abc import Callable

from s2sad.infer.promotion import common
from s2sad.normalize.library.expansions.templates import CallArguments, empty, lines, size, zeros


def _symmetric(args: CallArguments) -> str:
    """The symmetric matrix with one of the triangles."""
    if args.flag("lower"):
        return "result = numpy.tril(a) + numpy.transpose(numpy.tril(a, k=-1))"
    return "result = numpy.triu(a) + numpy.transpose(numpy.triu(a, k=1))"


def _toeplitz(args: CallArguments) -> str:
    """Each row is a slice of the reversed first row with the first column behind it, from index 1 on."""
    row = "r" if args.has("r") else "c"
    kind, rows, columns = common([args.type("c"), args.type(row)]), size("c", 0), size(row, 0)
    return lines(f"result = {empty([rows, columns], kind)}", f"turned = {zeros([f'{rows} + {columns} + 1'], kind)}",
                 f"turned[1:{columns} + 1] = numpy.flip({row})", f"turned[{columns}:{columns} + {rows}] = c",
                 f"for place in range({rows}):",
                 f"    result[place] = numpy.flip(turned[place + 1:place + 1 + {columns}])")


def _block_diag(args: CallArguments) -> str:
    """A vector is a row."""
    rows = {p: "1" if args.rank(p) == 1 else size(p, 0) for p in "ab"}
    columns = {p: size(p, args.rank(p) - 1) for p in "ab"}
    place = {p: ("0" if p == "a" else rows["a"]) if args.rank(p) == 1 else (
        f":{rows['a']}" if p == "a" else f"{rows['a']}:") for p in "ab"}
    whole = [f"{rows['a']} + {rows['b']}", f"{columns['a']} + {columns['b']}"]
    return lines(f"result = {zeros(whole, common([args.type('a'), args.type('b')]))}",
                 f"result[{place['a']}, :{columns['a']}] = a", f"result[{place['b']}, {columns['a']}:] = b")


def _solveh_banded(args: CallArguments) -> str:
    """The matrix is symmetric: the other diagonals are those of the argument."""
    n = size("a", 1)
    if args.flag("lower"):
        given, other = "bands[many:] = a", f"    bands[many - k, k:] = a[k, :{n} - k]"
    else:
        given, other = "bands[:many + 1] = a", f"    bands[many + k, :{n} - k] = a[many - k, k:]"
    return lines(f"many = {size('a', 0)} - 1", f"bands = {zeros(['2 * many + 1', n], args.type('a').dtype)}", given,
                 f"for k in range(1, min(many, {n}) + 1):", other,
                 "result = runtime.solve_banded(bands, b, many, many)")


EXPANSIONS: dict[str, Callable[[CallArguments], str]] = {
    "scipy.linalg.qr.triangular": lambda args: "result = numpy.linalg.qr.triangular(a)",
    "scipy.linalg.mirrored": _symmetric, "scipy.linalg.toeplitz": _toeplitz, "scipy.linalg.block_diag": _block_diag,
    "scipy.linalg.solveh_banded": _solveh_banded}
