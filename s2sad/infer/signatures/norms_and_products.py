"""The types of the results of functions of matrices, and of stacks of these; UNKNOWN where there is no rule."""
from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from s2sad.infer.types import UNKNOWN, Type, array, of_rank
from s2sad.tree import AST, Constant

Options = Mapping[str, AST]
_NEW_STACKS = np.lib.NumpyVersion(np.__version__) >= "2.0.0"    # before, b with one rank less was a stack of vectors


def common_dtype(args: list[Type]) -> str:
    order = ("bool", "int64", "float32", "float64", "complex64", "complex128")
    return max((a.dtype for a in args), key=lambda d: order.index(d) if d in order else 1)


def solved(args: list[Type], options: Options) -> Type:
    dtype = common_dtype(args)
    if args[0].rank != 2 or args[1].rank not in (1, 2):
        return UNKNOWN      # stacks of matrices
    return array(dtype if dtype == "float32" or dtype.startswith("complex") else "float64", args[1].rank)


def solution(args: list[Type], options: Options) -> Type:
    """Of stacks of matrices, too: the right-hand side is a vector, or matrices with the same leading axes, or with none
    where the other side has some."""
    a, b = args
    if a.rank < 2 or b.rank < 1 or b.rank > 1 and a.rank != b.rank and 2 not in (a.rank, b.rank):
        return UNKNOWN
    if a.rank == b.rank + 1 > 2 and not _NEW_STACKS:
        return UNKNOWN
    made = solved([replace(a, rank=2), replace(b, rank=1)], options)
    return array(made.dtype, a.rank - 1 if b.rank == 1 else max(a.rank, b.rank))


def of_matrix(rank: int) -> Callable[[list[Type], Options], Type]:
    """The type of a function of a float matrix (integers are for NumPy alone)."""
    def type_of(args: list[Type], options: Options) -> Type:
        return of_rank(args[0], rank) if args[0].is_inexact and args[0].rank == 2 else UNKNOWN
    return type_of


def of_matrices(rank: int) -> Callable[[list[Type], Options], Type]:
    """The type of a function of a float matrix, or of each matrix of a stack
    (`normalize/library/expansions/batched_matrices`)."""
    def type_of(args: list[Type], options: Options) -> Type:
        fits = args[0].is_array and args[0].is_inexact and args[0].rank >= 2
        return of_rank(args[0], args[0].rank - 2 + rank) if fits else UNKNOWN
    return type_of


def least_squares(args: list[Type], options: Options) -> Type:
    a, b = args[:2]
    return b if a.is_float and a.rank == 2 and b.dtype == a.dtype and b.rank in (1, 2) else UNKNOWN


def _mirrored(args: list[Type], options: Options) -> Type:
    return args[0] if _is_float(args[0], 2) and isinstance(options["lower"], Constant) else UNKNOWN


def _toeplitz(args: list[Type], options: Options) -> Type:
    alone = isinstance(options["r"], Constant) and options["r"].value is None
    both = args[:1] if alone else args
    return array(common_dtype(both), 2) if all(_is_float(a, 1) for a in both) else UNKNOWN


def _in_blocks(args: list[Type], options: Options) -> Type:
    return array(common_dtype(args), 2) if all(_is_float(a, 1) or _is_float(a, 2) for a in args) else UNKNOWN


def _in_bands(args: list[Type], options: Options) -> Type:
    a, b = args[:2]
    fits = _is_float(a, 2) and (_is_float(b, 1) or _is_float(b, 2)) and a.dtype == b.dtype
    return b if fits and isinstance(options["lower"], Constant) else UNKNOWN


def _is_float(kind: Type, rank: int) -> bool:
    return kind.is_array and kind.is_float and kind.rank == rank


# of functions that `normalize/library/expansions/structured_matrices` writes out
FORMS: dict[str, Callable[[list[Type], Options], Type]] = {
    "scipy.linalg.mirrored": _mirrored, "scipy.linalg.toeplitz": _toeplitz, "scipy.linalg.block_diag": _in_blocks,
    "scipy.linalg.solveh_banded": _in_bands, "scipy.linalg.qr.triangular": of_matrix(2)}
