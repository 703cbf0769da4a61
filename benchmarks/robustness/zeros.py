"""Zeros, choices and kinks: what is not taken and what has a zero seed gives nothing, in both modes."""
from __future__ import annotations

import math

import numpy as np

from benchmarks.robustness.cases import Case


def entropy(x):
    return np.sum(np.where(x > 0.0, x * np.log(x), 0.0))


def guarded_root(x):
    return math.sqrt(x) if x > 0.0 else 0.0


def capped_inverse(x):
    return min(1.0, 1.0 / x)


def unused_root(x):
    root = math.sqrt(x)
    return 0.0 * root + x


def in_a_mask(x):
    y = 1.0 / x
    return np.sum(y[x > 0.5])


def overwritten(x):
    y = np.log(x)
    y[x <= 0.0] = -7.0
    return np.sum(y)


def without_nan(x):
    return np.nansum(x * x)


def largest_number(x):
    return np.nanmax(x * x)


def of_two(x):
    return max(x[0], x[1]) + 10.0 * min(x[0], x[1])


def largest(x):
    return np.max(x) + 10.0 * np.min(x)


def sorted_sum(x):
    return np.sum(np.arange(1.0, 4.0) * np.sort(x))


def size(x):
    return abs(x[0]) + 2.0 * np.abs(x[1])


def between(x):
    return np.sum(np.clip(x, -1.0, 1.0))


def norm(x):
    return np.linalg.norm(x)


def squared_norm(x):
    return np.linalg.norm(x) ** 2


def by_hand(x):
    return np.sqrt(np.sum(x * x))


def distance(x):
    return math.hypot(x[0], x[1])


def deviation(x):
    return np.std(x)


def square_root(x):
    return x ** 0.5


def three_halves(x):
    return x ** 1.5


def square(x):
    return x ** 2.0


def nothing(x):
    return x ** 0


def exponent(p):
    return 0.0 ** p


def angle(x):
    return math.atan2(x[0], x[1])


def logistic(x):
    return 1.0 / (1.0 + math.exp(-x))


def bell(x):
    return math.exp(-x * x)


def arc(x):
    return math.tanh(x)


def through_infinity(x):
    return math.exp(-1.0 / x)


def cube(x):
    return x ** 3


def logarithm(x):
    return math.log1p(x)


def gained(x):
    return math.expm1(x)


def length(x):
    return math.hypot(x, 1e-200)


def from_above(x):
    return math.atan2(1e200, x)


def soft_positive(x):
    top = max(x, 0.0)
    return top + math.log(math.exp(x - top) + math.exp(-top))


def log_sum_exp(x):
    top = np.max(x)
    return top + np.log(np.sum(np.exp(x - top)))


def soft_maximum(x):
    return np.logaddexp(x[0], x[1])


def eigenvalues(a):
    return np.sum(np.linalg.eigvalsh(a))


def weighted_eigenvalues(a):
    return np.sum(np.arange(1.0, 4.0) * np.linalg.eigvalsh(a))


def first_vector(a):
    values, vectors = np.linalg.eigh(a)
    return vectors[0, 0] * values[2]


E = math.e
_POINTS = np.array([0.0, 1.0, 2.0])
_ZERO = np.zeros(3)
_NAN = np.array([1.0, np.nan, 3.0])

CASES = (
    Case("`where(x > 0, x * log(x), 0)` at 0, 1, 2", entropy, (_POINTS,), [0.0, 1.0, 1.0 + math.log(2.0)],
         "what is not taken gives nothing"),
    Case("`sqrt(x) if x > 0 else 0` at 0", guarded_root, (0.0,), 0.0, "what is not taken gives nothing"),
    Case("`min(1, 1 / x)` at 1e-310", capped_inverse, (1e-310,), 0.0, "what is not taken gives nothing"),
    Case("`0 * sqrt(x) + x` at 0", unused_root, (0.0,), 1.0, "a zero seed gives nothing"),
    Case("`(1 / x)[x > 0.5]` at 0, 1, 2", in_a_mask, (_POINTS,), [0.0, -1.0, -0.25], "what is not taken gives nothing"),
    Case("`log(x)`, overwritten where x is 0", overwritten, (_POINTS,), [0.0, 1.0, 0.5],
         "what is overwritten gives nothing"),
    Case("`nansum(x * x)` at 1, nan, 3", without_nan, (_NAN,), [2.0, 0.0, 6.0], "what is not taken gives nothing"),
    Case("`nanmax(x * x)` at 1, nan, 3", largest_number, (_NAN,), [0.0, 0.0, 6.0], "what is not taken gives nothing"),
    Case("`exp(-1 / x)` at 0", through_infinity, (np.float64(0.0),), 0.0, "a slope of 0 gives nothing"),
    Case("`sqrt(sum(x * x))` at 0", by_hand, (_ZERO,), _ZERO, "a root of squares has the derivative 0 at 0"),
    Case("`1 / (1 + exp(-x))` at -800", logistic, (-800.0,), 0.0, "what overflows behind a slope of 0 gives nothing"),
    Case("`1 / (1 + exp(-x))` at 40", logistic, (40.0,), math.exp(-40.0) / (1.0 + math.exp(-40.0)) ** 2,
         "partials in their stable forms"),
    Case("`tanh(x)` at 19", arc, (19.0,), 4.0 * math.exp(-38.0) / (1.0 + math.exp(-38.0)) ** 2,
         "partials in their stable forms"),
    Case("`tanh(x)` at 800", arc, (800.0,), 0.0, "partials in their stable forms"),
    Case("`exp(-x * x)` at 30", bell, (30.0,), 0.0, "partials in their stable forms"),
    Case("`top + log(sum(exp(x - top)))` at 1000, 999, -1000", log_sum_exp, (np.array([1e3, 999.0, -1e3]),),
         [1.0 / (1.0 + 1.0 / E), 1.0 / (1.0 + E), 0.0], "the derivative of the form as it is written"),
    Case("the same at -1000, -1001, -3000", log_sum_exp, (np.array([-1e3, -1001.0, -3e3]),),
         [1.0 / (1.0 + 1.0 / E), 1.0 / (1.0 + E), 0.0], "the derivative of the form as it is written"),
    Case("`logaddexp(a, b)` at 1000, 999", soft_maximum, (np.array([1e3, 999.0]),),
         [1.0 / (1.0 + 1.0 / E), 1.0 / (1.0 + E)], "partials in their stable forms"),
)

EXTREMES = (
    Case("`1 / (1 + exp(-x))` at -300", logistic, (-300.0,), math.exp(-300.0)),
    Case("the same at -400, where it is 1.9e-174", logistic, (-400.0,), 0.0,
         "the square of the divisor is no number: the slope of the quotient is 0; `scipy.special.expit` has none"),
    Case("`x ** 3` at -1e100", cube, (-1e100,), 3e200),
    Case("`log1p(x)` at 1e-17", logarithm, (1e-17,), 1.0),
    Case("`expm1(x)` at -50", gained, (-50.0,), math.exp(-50.0)),
    Case("`hypot(x, 1e-200)` at 1e-200", length, (1e-200,), math.sqrt(0.5)),
    Case("`hypot(x, 1e-200)` at 1e200", length, (1e200,), 1.0),
    Case("`atan2(1e200, x)` at 1e200", from_above, (1e200,), -0.5e-200),
    Case("`log(exp(x) + 1)`, shifted by its maximum, at 1000", soft_positive, (1000.0,), 1.0),
    Case("the same at -700", soft_positive, (-700.0,), math.exp(-700.0)),
)

KINKS = (
    Case("`max(a, b) + 10 * min(a, b)` at a = b", of_two, (np.ones(2),), [11.0, 0.0], "the first argument is followed",
         kink="at a tie max(a, b) is a"),
    Case("`np.max(x) + 10 * np.min(x)` of equal elements", largest, (np.ones(3),), [11.0, 0.0, 0.0],
         "the first of the extreme elements is followed"),
    Case("`np.sort(x)` of equal elements", sorted_sum, (np.ones(3),), [1.0, 2.0, 3.0],
         "equal elements keep their order"),
    Case("`abs(x)` at 0", size, (np.zeros(2),), [0.0, 0.0], "0", kink="the derivative of abs at 0 is taken as 0"),
    Case("`np.clip(x, -1, 1)` at -2, -1, 1, 2", between, (np.array([-2.0, -1.0, 1.0, 2.0]),), [0.0, 1.0, 1.0, 0.0],
         "at its bounds `clip(x)` is x", kink="at its bounds clip(x) is x"),
    Case("`np.linalg.norm(x)` at 0", norm, (_ZERO,), _ZERO, "0"),
    Case("`np.linalg.norm(x) ** 2` at 0", squared_norm, (_ZERO,), _ZERO, "0"),
    Case("`hypot(a, b)` at (0, 0)", distance, (np.zeros(2),), [0.0, 0.0], "0",
         kink="the derivatives of hypot at (0, 0) are taken as 0"),
    Case("`np.std(x)` of equal elements", deviation, (np.ones(3),), _ZERO, "0"),
    Case("`x ** 0.5` at 0", square_root, (0.0,), math.inf, "infinite, as it is",
         kink="not differentiable at a base of 0"),
    Case("`x ** 1.5` at 0", three_halves, (0.0,), 0.0, "0, as it is", kink="not differentiable at a base of 0"),
    Case("`x ** 2.0` at 0", square, (0.0,), 0.0, "0, as it is"),
    Case("`x ** 0` at 0", nothing, (0.0,), 0.0, "0, as it is"),
    Case("`0 ** p` by p, at 2", exponent, (2.0,), 0.0, "0, as it is"),
    Case("`atan2(a, b)` at (0, 1)", angle, (np.array([0.0, 1.0]),), [1.0, 0.0], "as it is",
         kink="arctan2 jumps across b < 0, a = 0"),
    Case("`atan2(a, b)` at (1, 0)", angle, (np.array([1.0, 0.0]),), [0.0, -1.0], "as it is"),
    Case("`atan2(a, b)` at (0, -1), its cut", angle, (np.array([0.0, -1.0]),), [-1.0, 0.0],
         "that of the side it is on", kink="arctan2 jumps across b < 0, a = 0"),
    Case("`atan2(a, b)` at (0, 0)", angle, (np.zeros(2),), [math.nan, math.nan], "nan: there is no direction",
         kink="arctan2 jumps across b < 0, a = 0"),
)
