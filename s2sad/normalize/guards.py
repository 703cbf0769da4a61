"""guards: what generated code asserts of sizes, with what to do where it does not hold.

    x[n - 5:] *= 2.0                assert n - 5 >= 0, "a slice starts before ..."
                                    x[n - 5:] *= 2.0
    u += v                          assert u.shape == v.shape, "shapes that differ ..."
                                    u += v
"""
from __future__ import annotations

from s2sad.tree import AST, Assert, Eq, GtE, compare, const

INSIDE = "a slice reaches out of its array, where NumPy takes less: bound it by max(..., 0) or min(..., n)"
EQUAL = "shapes differ: a length of 1 repeats only where it is written, as in x[:, None] or x[:1], or an argument's"

SPARSE = "a sparse matrix and what it meets differ in size"


def matching(a: AST, b: AST) -> Assert:
    """The guard that a size is that of a sparse matrix."""
    return Assert(compare(a, Eq(), b), const(SPARSE))


def equal(a: AST, b: AST) -> Assert:
    """The guard that two shapes, or two sizes, are equal."""
    return Assert(compare(a, Eq(), b), const(EQUAL))


def inside(room: AST) -> Assert:
    """The guard that there is room in an array for a slice."""
    return Assert(compare(room, GtE(), const(0)), const(INSIDE))
