"""shape_guards: what generated code asserts of sizes, with what to do where it does not hold.

    x[n - 5:] *= 2.0                assert n - 5 >= 0, "a slice starts before ..."
                                    x[n - 5:] *= 2.0
    u += v                          assert u.shape == v.shape, "shapes that differ ..."
                                    u += v
"""
from __future__ import annotations

from s2sad.tree import (
    AST, And, Assert, BoolOp, Constant, Eq, Gt, GtE, Lt, attribute, compare, const, copy,
)

INSIDE = "a slice reaches out of its array, where NumPy takes less: bound it by max(..., 0) or min(..., n)"
EQUAL = "shapes differ: a length of 1 repeats only where it is written, as in x[:, None] or x[:1], or an argument's"

ROWS = ("an array of another size than the others is put into a list, whose arrays have one size: give arrays of "
        "different sizes different names")
TRIPS = "a loop in which a number becomes an array has no trip: start with an array, np.zeros(...), not with a number"
UNSHARED = ("a loop that binds an array anew has no trip, and the array from before it is written: bind the name to a "
            "copy before the loop: u = u.copy()")
COUNTS = "a bound of a slice counts from the end, where parts of an array are to lie side by side: give it from 0"
CONTIGUOUS = ("an array that is reshaped and written is not contiguous, where NumPy writes a copy: pass "
              "np.ascontiguousarray(...), or write it as a loop")
FORWARDS = "the step of a slice is not positive, where it is not a written number: write a loop"
EXCHANGED = "names swap arrays of different sizes in a branch: swap what arrays of one size hold"
LEFT = "a size of np.reshape is negative: write -1 where it stands, or bind it to a name of its own: n = -1"
ELEMENTS = "an array is reshaped to another number of elements: give np.reshape sizes that multiply to its own"
EMPTY = "there is no maximum or minimum of no elements: ask whether there are any before"
MASK = "an array of bools has another size than what it picks from"
SPARSE = "a sparse matrix and what it meets differ in size"


def sparse_size_matches(a: AST, b: AST) -> Assert:
    """The guard that a size is that of a sparse matrix."""
    return Assert(compare(a, Eq(), b), const(SPARSE))


def shapes_equal(a: AST, b: AST) -> Assert:
    """The guard that two shapes, or two sizes, are equal."""
    return Assert(compare(a, Eq(), b), const(EQUAL))


def mask_fits(a: AST, b: AST) -> Assert:
    """The guard that an array of bools is as long as the axis that it picks from."""
    return Assert(compare(a, Eq(), b), const(MASK))


def same_element_count(a: AST, b: AST) -> Assert:
    """The guard that a reshape leaves the number of elements as it is."""
    return Assert(compare(a, Eq(), b), const(ELEMENTS))


def same_size_in_list(guard: AST) -> AST:
    """A guard that two sizes are equal, where an array is put into a list."""
    same = isinstance(guard, Assert) and isinstance(guard.msg, Constant) and guard.msg.value == EQUAL
    return Assert(guard.test, const(ROWS)) if same else guard


def has_iteration(start: AST, stop: AST, step: int, message: str) -> Assert:
    """The guard that a loop has a trip, with what it says if there is none."""
    return Assert(compare(copy(start), Lt() if step > 0 else Gt(), copy(stop)), const(message))


def slice_in_bounds(room: AST, text: str) -> Assert:
    """The guard that there is room in an array for a slice of a statement, with the first line of its text."""
    return Assert(compare(room, GtE(), const(0)), const(f"{INSIDE}: {text}"))


def contiguous(array: AST) -> Assert:
    """The guard that an array lies in memory element after element, so that NumPy reshapes it without a copy."""
    return Assert(attribute(attribute(array, "flags"), "c_contiguous"), const(CONTIGUOUS))


def positive_step(rest: AST) -> Assert:
    """The guard that the step of a slice is positive."""
    return Assert(compare(rest, GtE(), const(0)), const(FORWARDS))


def nonnegative(size: AST) -> Assert:
    """The guard that what the bounds of slices are made of is not negative: parts of an array lie side by side then."""
    return Assert(compare(copy(size), GtE(), const(0)), const(COUNTS))


def written(size: AST) -> Assert:
    """The guard that a size of a reshape is one, not -1 for what is left."""
    return Assert(compare(copy(size), GtE(), const(0)), const(LEFT))


def has_elements(sizes: list[AST]) -> Assert:
    """The guard that axes of these sizes have elements."""
    tests = [*(compare(copy(s), Gt(), const(0)) for s in sizes)]
    return Assert(tests[0] if len(tests) == 1 else BoolOp(And(), tests), const(EMPTY))
