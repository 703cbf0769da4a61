"""Functions that give several results: the parts that are taken, and tuples that cannot be taken apart."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case

X = np.array([0.3, 0.9, 0.7, 0.62])
K = np.array([0, 2, 1, 2, 0, 1])


def by_place(x, k):
    values, first = np.unique(k, True)
    same, inverse = np.unique(k, False, True)
    total = np.sum(x[first // 2] * first) + np.sum(x[inverse] * np.arange(6.0)) + np.sum(x[values] * x[same])
    return total + np.sum(np.unique(k, True, False, True)[2] * x[:3]) + np.sum(x[np.unique(k, False, False, False)])


def from_the_end(x, k):
    found = np.unique(k, return_counts=True)
    sums = np.histogram(k, 3, (0.0, 3.0))
    sign, size = np.linalg.slogdet(np.outer(x[:2], x[2:]) + np.eye(2))
    pair = np.linalg.slogdet(np.outer(x, x) + np.eye(4))
    return np.sum(found[-1] * x[found[-2]]) + np.sum(sums[-1] * x) + sign * size * pair[-1]


def values_of_both(x, k):
    values, first = np.unique(x, True)
    return np.sum(values * np.arange(4.0)) + np.sum(np.unique(x, False, True)[0] ** 3) + x[first[0]]


def use(found, x):
    return np.sum(found[1]) * x[0]


def handed(x, k):
    return use(np.unique(k, return_counts=True), x)


def counted(x, k):
    found = np.unique(k, return_counts=True)
    return len(found) * x[0]


def in_branches(x, k):
    if x[0] > 0.1:
        found = np.unique(k, return_counts=True)
    else:
        found = np.unique(k, return_index=True)
    return np.sum(found[1]) * x[0]


def walked(x, k):
    total = 0.0
    for part in np.unique(k, False, True):
        total += np.sum(part) * x[0]
    return total


def summed(x, k):
    return np.sum(np.unique(k, True)) * x[0]


def named_anew(x, k):
    found = np.unique(k, return_counts=True)
    other = found
    return np.sum(other[1]) * x[0]


def by_a_variable(x, k):
    found = np.unique(k, return_counts=True)
    return np.sum(found[k[2]]) * x[0]


def too_far(x, k):
    found = np.unique(k, return_counts=True)
    return np.sum(found[-3]) * x[0]


def taken_for_distinct(x, k):
    return np.sum(x[:3][np.isin(np.arange(3), k[:3], True)])


def along_an_axis(x, k):
    return np.sum(x[np.unique(k, False, False, False, 0)])


def cases():
    # parts
    for x, k in ((X, K), (X, K[::-1].copy())):
        for kernel in (by_place, from_the_end, values_of_both):
            yield Case(kernel, (x, k), ("x",))
    for kernel in (handed, named_anew):
        yield Case(kernel, (X, K), "x")
    # refused
    for kernel, refused in (
            (counted,
             "S203 at `found = np.unique(k, return_counts=True)`: the type of 'found' cannot be inferred: what "
             "numpy.unique gives with return_counts= is not known: leave the option out"),
            (in_branches,
             "S203 at `found = np.unique(k, return_counts=True)`: the type of 'found' cannot be inferred: what "
             "numpy.unique gives with return_counts= is not known: leave the option out\nS203 at `found = "
             "np.unique(k, return_index=True)`: the type of 'found' cannot be inferred: what numpy.unique gives "
             "with return_index= is not known: leave the option out"),
            (walked,
             "S203 at `np.unique(k, False, True)`: the type of 'items' cannot be inferred: what numpy.unique "
             "gives with return_inverse= is not known: leave the option out\nS203 at `part`: the type of 'part' "
             "cannot be inferred: write it with operations on numbers and arrays that are known"),
            (summed,
             "S301 at `np.unique(k, True)`: no derivative rule for numpy.unique: write it as a loop over the "
             "elements"),
            (by_a_variable,
             "S203 at `found = np.unique(k, return_counts=True)`: the type of 'found' cannot be inferred: what "
             "numpy.unique gives with return_counts= is not known: leave the option out"),
            (too_far,
             "S203 at `found = np.unique(k, return_counts=True)`: the type of 'found' cannot be inferred: what "
             "numpy.unique gives with return_counts= is not known: leave the option out"),
            (taken_for_distinct,
             "S301 at `np.isin(np.arange(3), k[:3], True)`: no derivative rule for numpy.isin with "
             "assume_unique=: write it as a loop over the elements"),
            (along_an_axis,
             "S301 at `np.unique(k, False, False, False, 0)`: no derivative rule for numpy.unique with axis=: "
             "write it as a loop over the elements")):
        yield Case(kernel, (X, K), "x", refused=refused)
