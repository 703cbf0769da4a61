"""Failures that other tools have had, as they were reported or are documented, written as NumPy kernels.

For the counterexamples of Lee, Yu, Rival and Yang (On correctness of automatic differentiation for non-differentiable
functions, NeurIPS 2020) what is right is right for almost all inputs: at the kinks a derivative is one of an
intensional sort, and `explain` lists the places.
"""
from __future__ import annotations

import math

import numpy as np

from benchmarks.robustness.cases import Case


def cloth(x):
    """Springs between all points of a cloth: the length of one to itself is 0."""
    total = 0.0
    for i in range(x.size):
        for j in range(x.size):
            total += (np.sqrt((x[i] - x[j]) ** 2) - 1.0) ** 2
    return total


def norm(x):
    return np.linalg.norm(x)


def squared_norm(x):
    return np.linalg.norm(x) ** 2


def deviation_without_nan(x):
    return np.nanstd(x)


def double_where(x):
    return np.sum(np.where(x > 0.0, np.sqrt(x), 0.0))


def masked_quotient(x):
    return np.sum(np.where(x != 0.0, np.sin(x) / x, 1.0))


def distances(x):
    """Between all points, and 0 from each to itself."""
    apart = x[:, None] - x[None]
    return np.sum(np.where(apart[:, :, 0] != 0.0, np.linalg.norm(apart, axis=-1), 0.0))


def maximum_of_parts(x):
    return np.max(np.where(x > 0.0, np.log(x), -1.0))


def overwritten_input(x):
    """A work array is overwritten after its values were read."""
    work = x.copy()
    total = 0.0
    for i in range(work.size):
        total += work[i] * work[i]
        work[i] = 3.0 * work[i]
        total += work[i] * work[i]
    return total


def overwritten_later(x):
    work = 2.0 * x
    result = np.sum(work ** 2)
    work[...] = 7.0
    return result


def added_in_place(x):
    y = np.zeros(x.size)
    for i in range(x.size):
        y[i] += x[i]
        y[i] *= y[i]
    return np.sum(y)


def trips_by_the_input(x):
    """The number of trips follows from values that the loop itself changes."""
    total, k = 1.0, 0
    while total < 20.0:
        total *= 1.0 + x[k % x.size]
        k += 1
    return total


def exponent_in_a_loop(x, n):
    result = 1.0
    for _ in range(n):
        result = result * x
    return result


def read_and_added(x):
    """An accumulator is read between what is added to it."""
    loss = np.zeros(1)
    factor = np.ones(1)
    for i in range(x.size):
        loss[0] += x[i] * factor[0]
        factor[0] += loss[0]
    return loss[0]


def statements_around_a_loop(x):
    total = 0.0
    for i in range(x.size):
        scale = x[i]
        for _ in range(3):
            scale = scale * x[i]
        total += scale
    return total


def rectifier(x):
    return max(x, 0.0)


def difference_of_rectifiers(x):
    """x itself: relu(x) - relu(-x)."""
    return max(x, 0.0) - max(-x, 0.0)


def identity_by_branches(x):
    """x itself, but at 0, where it is written as a constant."""
    if x == 0.0:
        return 0.0
    return x


def choice_between_powers(x):
    return x ** 2 if x > 0.0 else x ** 3


def rectified_square(x):
    return max(x, 0.0) ** 2


_ZERO = np.zeros(3)
_ONE = np.array([1.0, 2.0, 4.0])
_WITH_NAN = np.array([np.nan, 1.0, 2.0, 3.0, 4.0])
_SPREAD = np.array([0.0, -1.5, -0.5, 0.5, 1.5]) / (4.0 * math.sqrt(1.25))
_MAX = "the first argument is followed at a tie"
_LEE = "Lee et al. 2020"

CASES = (
    Case("lengths of springs from a point to itself", cloth, (np.array([0.0, 3.0, 7.0]),), [-32.0, -4.0, 36.0],
         source="jax 3058"),
    Case("`norm(x)` at 0", norm, (_ZERO,), _ZERO, source="jax 3058, pytorch 2421, autograd 268"),
    Case("`norm(x) ** 2` at 0", squared_norm, (_ZERO,), _ZERO, source="jax 21723, jax 4177"),
    Case("`norm(x)` of one number that is 0", norm, (np.zeros(1),), [0.0], source="pytorch 2421"),
    Case("`nanstd(x)` with a nan", deviation_without_nan, (_WITH_NAN,), _SPREAD, source="jax 8128", limit=16.0),
    Case("`where(x > 0, sqrt(x), 0)` at 0, 1, 4", double_where, (np.array([0.0, 1.0, 4.0]),), [0.0, 0.5, 0.25],
         source="jax, questions asked often"),
    Case("`where(x != 0, sin(x) / x, 1)` at 0, 1", masked_quotient, (np.array([0.0, 1.0]),),
         [0.0, math.cos(1.0) - math.sin(1.0)], source="jax, questions asked often", limit=16.0),
    Case("distances of points, chosen to be 0 from each to itself", distances, (np.array([[0.0, 0.0], [3.0, 4.0]]),),
         [[-1.2, -1.6], [1.2, 1.6]], source="jax 5798"),
    Case("`max(where(x > 0, log(x), -1))` at 0, 1, 2", maximum_of_parts, (np.array([0.0, 1.0, 2.0]),), [0.0, 0.0, 0.5],
         source="jax 13600"),
    Case("an array overwritten after it was read", overwritten_input, (_ONE,), 20.0 * _ONE,
         source="Warp: array overwrites"),
    Case("a result overwritten at the end", overwritten_later, (_ONE,), 8.0 * _ONE, source="Warp: array overwrites"),
    Case("`+=` and `*=` on elements", added_in_place, (_ONE,), 2.0 * _ONE, source="Warp: in-place arithmetic"),
    Case("a product in a loop over n", exponent_in_a_loop, (np.float64(1.5), 5), 5.0 * 1.5 ** 4,
         source="Warp: loops whose length is not known"),
    Case("a loop that runs until a sum is large", trips_by_the_input, (np.array([1.0, 1.0]),), [48.0, 32.0],
         source="Warp: loops whose length is not known", kink="an active value is compared"),
    Case("an accumulator that is read between", read_and_added, (_ONE,), [19.0, 10.0, 7.0],
         source="Taichi: global data access rule"),
    Case("statements around an inner loop", statements_around_a_loop, (_ONE,), 4.0 * _ONE ** 3,
         source="Taichi: kernel simplicity rule"),
    Case("`max(x, 0)` at 0", rectifier, (0.0,), 1.0, _MAX, _LEE, "at a tie max(a, b) is a"),
    Case("`max(x, 0) - max(-x, 0)` at 0: x, but the sum of two choices", difference_of_rectifiers, (0.0,), 2.0, _MAX,
         _LEE, "at a tie max(a, b) is a"),
    Case("the same at 1e-300", difference_of_rectifiers, (1e-300,), 1.0, "", _LEE),
    Case("`0 if x == 0 else x` at 0: the branch is a constant", identity_by_branches, (0.0,), 0.0,
         "a branch is differentiated as it is taken", _LEE, "an active value is compared"),
    Case("the same at 1e-300", identity_by_branches, (1e-300,), 1.0, "", _LEE),
    Case("`x ** 2 if x > 0 else x ** 3` at 0", choice_between_powers, (0.0,), 0.0, "", _LEE,
         "an active value is compared"),
    Case("`max(x, 0) ** 2` at 0", rectified_square, (0.0,), 0.0, "", _LEE),
)
