"""The types of what functions of matrices give, and of what they give for stacks of these; UNKNOWN where there is no
rule."""
from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from s2sad.infer.types import UNKNOWN, Type, array, of_rank
from s2sad.tree import AST

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
    """Of stacks of matrices, too: what is solved for is a vector, or matrices with the same leading axes, or with none
    where the other side has some."""
    a, b = args
    if a.rank < 2 or b.rank < 1 or b.rank > 1 and a.rank != b.rank and 2 not in (a.rank, b.rank):
        return UNKNOWN
    if a.rank == b.rank + 1 > 2 and not _NEW_STACKS:
        return UNKNOWN
    made = solved([replace(a, rank=2), replace(b, rank=1)], options)
    return array(made.dtype, a.rank - 1 if b.rank == 1 else max(a.rank, b.rank))


def of_matrix(rank: int) -> Callable[[list[Type], Options], Type]:
    """The type of what a float matrix gives (integers are for NumPy alone)."""
    def made(args: list[Type], options: Options) -> Type:
        return of_rank(args[0], rank) if args[0].is_inexact and args[0].rank == 2 else UNKNOWN
    return made


def of_matrices(rank: int) -> Callable[[list[Type], Options], Type]:
    """The type of what a float matrix gives, or each matrix of a stack (`normalize/pieces_of_stacks`)."""
    def made(args: list[Type], options: Options) -> Type:
        fits = args[0].is_array and args[0].is_inexact and args[0].rank >= 2
        return of_rank(args[0], args[0].rank - 2 + rank) if fits else UNKNOWN
    return made


def least(args: list[Type], options: Options) -> Type:
    a, b = args[:2]
    return b if a.is_float and a.rank == 2 and b.dtype == a.dtype and b.rank in (1, 2) else UNKNOWN
