"""What matrices of a certain form are made of, as `scipy.linalg` has them: symmetric, Toeplitz, of blocks, banded."""
from __future__ import annotations

from collections.abc import Callable

from s2sad.infer.promotion import common
from s2sad.normalize.library.expansions.templates import CallArguments, empty, lines, size, zeros


def _mirrored(asked: CallArguments) -> str:
    """The symmetric matrix with one of the triangles."""
    if asked.true("lower"):
        return "result = numpy.tril(a) + numpy.transpose(numpy.tril(a, k=-1))"
    return "result = numpy.triu(a) + numpy.transpose(numpy.triu(a, k=1))"


def _toeplitz(asked: CallArguments) -> str:
    """Each row is a part of the first row, turned round, with the first column behind it, from place 1 on."""
    row = "r" if asked.given("r") else "c"
    kind, rows, columns = common([asked.type("c"), asked.type(row)]), size("c", 0), size(row, 0)
    return lines(f"result = {empty([rows, columns], kind)}", f"turned = {zeros([f'{rows} + {columns} + 1'], kind)}",
                 f"turned[1:{columns} + 1] = numpy.flip({row})", f"turned[{columns}:{columns} + {rows}] = c",
                 f"for place in range({rows}):",
                 f"    result[place] = numpy.flip(turned[place + 1:place + 1 + {columns}])")


def _in_blocks(asked: CallArguments) -> str:
    """A vector is a row."""
    rows = {p: "1" if asked.rank(p) == 1 else size(p, 0) for p in "ab"}
    columns = {p: size(p, asked.rank(p) - 1) for p in "ab"}
    place = {p: ("0" if p == "a" else rows["a"]) if asked.rank(p) == 1 else (
        f":{rows['a']}" if p == "a" else f"{rows['a']}:") for p in "ab"}
    whole = [f"{rows['a']} + {rows['b']}", f"{columns['a']} + {columns['b']}"]
    return lines(f"result = {zeros(whole, common([asked.type('a'), asked.type('b')]))}",
                 f"result[{place['a']}, :{columns['a']}] = a", f"result[{place['b']}, {columns['a']}:] = b")


def _in_bands(asked: CallArguments) -> str:
    """The other diagonals are those that are given."""
    n = size("a", 1)
    if asked.true("lower"):
        given, other = "bands[many:] = a", f"    bands[many - k, k:] = a[k, :{n} - k]"
    else:
        given, other = "bands[:many + 1] = a", f"    bands[many + k, :{n} - k] = a[many - k, k:]"
    return lines(f"many = {size('a', 0)} - 1", f"bands = {zeros(['2 * many + 1', n], asked.type('a').dtype)}", given,
                 f"for k in range(1, min(many, {n}) + 1):", other,
                 "result = runtime.solve_banded(bands, b, many, many)")


FORMS: dict[str, Callable[[CallArguments], str]] = {
    "scipy.linalg.qr.triangular": lambda asked: "result = numpy.linalg.qr.triangular(a)",
    "scipy.linalg.mirrored": _mirrored, "scipy.linalg.toeplitz": _toeplitz, "scipy.linalg.block_diag": _in_blocks,
    "scipy.linalg.solveh_banded": _in_bands}
