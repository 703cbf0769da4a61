"""Elements left out, repeated, put between; bins, places; stores by the number of an element."""
from __future__ import annotations

from collections import deque

import numpy as np

from tests.corpus import Case
from tests.harness.seeds import generator

X = np.array([-1.2, 0.7, 1.4, 0.3])
A = np.array([[0.3, -0.9, 0.7], [0.5, 0.2, -0.6]])
K = np.array([3, 1, 3, 0])


def left_out(x, a, k):
    total = np.sum(np.delete(x, 1) ** 2) + np.sum(np.delete(x, -1) * x[1:])
    total += np.sum(np.delete(a, 1, axis=1) ** 2 * x[0])
    total += np.sum(np.delete(x, [0, 2]) * np.array([1.0, 3.0])) + np.sum(np.delete(a, 2) * np.arange(5.0))
    total += np.sum(np.delete(x, x > 1.0) ** 3) + np.sum(np.delete(a, k[1:2], axis=0) ** 2)
    return total + np.sum(np.delete(x, k[3]) ** 2 * np.arange(3.0))


def put_between(x, a, k):
    total = np.sum(np.insert(x, 1, x[0] * x[1]) * np.arange(5.0))
    total += np.sum(np.insert(x, k[0], a[0]) ** 2 * np.arange(7.0))
    total += np.sum(np.insert(a, 0, 2.0 * a[1], axis=0) ** 2) + np.sum(np.insert(a, -1, x[:2], axis=1)[:, 2] * x[2:])
    return total + np.sum(np.insert(a, 6, 1.0) * np.arange(7.0)) + np.sum(np.insert(x, 4, 3.0) ** 2)


def repeated(x, a, k):
    total = np.sum(np.repeat(x, [1, 0, 2, 3]) * np.arange(6.0)) + np.sum(np.repeat(x, k) ** 2 * np.arange(7.0))
    return total + np.sum(np.repeat(a, k[1:3], axis=0) ** 2) + np.sum(np.repeat(a, [0, 2, 1], axis=1) * a)


def chosen(x, a, k):
    total = np.sum(np.compress(x > 0.5, x) ** 2) + np.sum(np.compress(a[:, 0] > 0.4, a, axis=0) ** 2)
    total += np.sum(np.compress([True, False, True], a, axis=1) ** 2)
    total += np.sum(np.choose(k, [x, x ** 2, 1.0, x * x[0]]))
    total += np.sum(np.extract(np.array([True, False, True]), a) ** 2) + np.sum(np.extract(a > 0.0, a) * a[0, 0])
    return total


def placed(x, a, k):
    bins = np.array([0.0, 0.55, 1.0])
    total = np.sum(x[np.digitize(x, bins)] * x) + x[np.digitize(0.7, bins)] + np.sum(
        x[np.digitize(a, bins, right=True)] * a)
    total += np.sum(x[np.isin(k, [0, 3])] ** 2) + np.sum(x[np.isin(k, k[:1], invert=True)] ** 3)
    total += np.sum(x[np.lexsort((x, k))] * np.arange(4.0))
    total += np.sum(x[np.lexsort((x, x ** 2, k))] ** 2 * np.arange(4.0))
    where = np.argwhere(a > 0.0)
    for n in range(where.shape[0]):
        total += a[where[n, 0], where[n, 1]] ** 2 * n
    return total + np.sum(x[np.argwhere(x > 0.0)[:, 0]] ** 2)


def distinct(x, a, k):
    values, inverse, counts = np.unique(k, return_inverse=True, return_counts=True)
    total = np.sum(x[values] ** 2 * counts) + np.sum(x * x[inverse])
    _, first = np.unique(k, return_index=True)
    return total + np.sum(x[first] * np.arange(3.0)) + np.sum(np.unique(x) ** 2 * np.arange(4.0))


def binned(x, a, k):
    sums, edges = np.histogram(x, bins=3, range=(-1.5, 1.45), weights=x ** 2)
    ends = np.histogram(np.array([0.0, 1.0, 2.0, 2.5]), 2, (0.0, 2.0), weights=x)[0]
    sums = sums + np.append(ends, x[0])
    counts, _ = np.histogram(a[0], bins=np.array([-1.0, 0.0, 1.0]))
    return np.sum(sums ** 2 * edges[1:]) + np.sum(counts * x[:2]) + np.sum(np.histogram(x, 2, (0.0, 1.0))[0] * x[2:])


def stored(x, a, k):
    y = np.zeros(4)
    np.put(y, [0, 2], x[:2])
    np.putmask(y, y > 0, 2.0 * y)
    np.putmask(y, y < 0, x[3])
    y.put(1, x[2] ** 2)
    np.place(y, y > 1.0, [x[0]])
    b = a * a
    np.put(b, k[:2] + 1, x)
    np.put(b, -1, x[1] * b[0, 1])
    np.put(b, [0, 3, 5], x[:2])
    return np.sum(y ** 2) + np.sum(b ** 2 * np.array([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]))


def of_one(x, k):
    return (np.sum(np.delete(x, 0)) + np.sum(np.insert(x, 0, x) ** 2) + np.sum(np.repeat(x, k) ** 2)
            + np.sum(np.unique(x) ** 2) + np.sum(x[np.digitize(x, np.array([5.0]))]))


def of_none(x, k, c):
    total = np.sum(np.insert(x, 0, c) ** 2) + np.sum(np.repeat(x, k)) + np.sum(np.unique(x))
    return total + np.sum(np.compress(x > 0, x))


def gone(x, k):
    return np.sum(np.delete(x, k))


def widened(x, k):
    return np.sum(np.insert(x, k, 0.0))


def counted(x, k):
    return np.sum(np.repeat(x, np.array([k, 1])))


def picked(x, k):
    return np.sum(np.choose(np.array([k, 0]), [x[:2], x[2:]]))


def falling(x, k):
    return x[np.digitize(0.3, np.array([1.0, 0.0 * k]))]


def shaped(x, k):
    np.putmask(x, x > 0, x[:k])
    return np.sum(x)


def empty_range(x, k):
    return np.sum(np.histogram(x, bins=3, range=(1.0 * k, 1.0), weights=x)[0])


GUARDED = [
    (gone, 4, "np.delete: the place is not in the array"), (widened, -5, "np.insert: the place is not in the array"),
    (counted, 1, "np.repeat with another number of counts than of elements"),
    (picked, 2, "np.choose: a number that no choice has"),
    (falling, 1, "np.digitize with bins that decrease: turn them around, bins[::-1]"),
    (shaped, 2, "np.putmask with values of another shape"),
    (empty_range, 2, "np.histogram with a range whose ends are equal or exchanged"),
]


def free_by_a_list(a, x, fixed):
    """As it is written without `setdiff1d`: the list is as long as the run says."""
    free = [i for i in range(x.size) if x[i] > 0.4 and i not in fixed]
    u = np.zeros(x.size)
    u[free] = np.linalg.solve(a[np.ix_(free, free)], x[free])
    a[np.ix_(free, free)] *= 2.0 if 1 in free else 3.0
    return np.sum(a[0] * a[1]) + u * u


def of_the_last_ones(x, n):
    """A number that a queue has had lately counts no more."""
    seen = deque(maxlen=2)
    s = 0.0
    for k in range(n):
        j = int(10.0 * abs(x[k % 4]) + 0.5) % 3
        if j not in seen:
            s += x[k % 4] ** 2
        seen.append(j)
    return s if 0.25 in x else s * x[0]


def of_a_number(x, k):
    return x[0] if 3.0 in k * x[1] else x[1]


def free_of(a, x, fixed):
    """Degrees of freedom that are not held: the rows and columns that are left are solved with."""
    free = np.setdiff1d(np.arange(x.size), fixed)
    u = np.zeros(x.size)
    u[free] = np.linalg.solve(a[np.ix_(free, free)], x[free])
    return u


def others(a, x, fixed):
    y = x[np.setdiff1d(np.arange(4), [0, 2])] ** 2
    return np.sum(x[np.setdiff1d(np.array([3, 1, 1, 2]), fixed)] ** 3) * a[0] + np.sum(y * x[:2])


def unsorted(x):
    return np.sum(x[np.setdiff1d(np.arange(4), np.array([1]), True)])


def by_a_matrix(x):
    return np.sum(np.delete(x, np.array([[0, 1]])))


def several(x):
    return np.sum(np.insert(x, [0, 1], 0.0))


def bins_by_rule(x):
    return np.sum(np.histogram(x, bins="auto", weights=x)[0] ** 2)


def parted(x):
    return np.partition(x, 2)[2]


def overlapping(x):
    x = 2.0 * x
    x.flat[[1, 2]] = x[:2]
    return x[2]


REFUSED = [
    (overlapping, "a store by number of what may share memory with the array",
     "np.put(x, k, values) copies the values before"),
    (by_a_matrix, "no derivative rule for numpy.delete",
     "leave out the elements at an integer, a list or an array of integers, or a mask"),
    (several, "no derivative rule for numpy.insert",
     "insert at one place, into floats: a number, or along an axis a row"),
    (bins_by_rule, "no derivative rule for numpy.histogram",
     "give numbers with one axis, and a number of bins or an array of edges"),
    (unsorted, "no derivative rule for numpy.setdiff1d with assume_unique=",
     "give two arrays of integers, without assume_unique="),
    (parted, "no derivative rule for numpy.partition", "write np.sort(x), whose order is determined"),
]


def cases():
    for kernel in (left_out, put_between, repeated, chosen, placed, distinct, binned, stored):
        yield Case(kernel, (X, A, K), ("x", "a"))
    # single precision
    for kernel in (left_out, put_between, repeated, stored):
        yield Case(kernel, (X.astype("float32"), A.astype("float32"), K), ("x", "a"))
    # sizes
    yield Case(of_one, (np.array([0.7]), np.array([2])), ("x",))
    yield Case(of_none, (np.zeros(0), np.zeros(0, int), 0.5), ("x", "c"))
    # guards
    for kernel, k, refused in (
            (gone, 4, "S501 at `np.delete(x, k)`: np.delete: the place is not in the array"),
            (widened, -5, "S501 at `np.insert(x, k, 0.0)`: np.insert: the place is not in the array"),
            (counted, 1,
             "S501 at `np.repeat(x, np.array([k, 1]))`: np.repeat with another number of counts than of elements: "
             "array_value.shape[0] is 2, x.shape[0] is 4"),
            (picked, 2,
             "S501 at `np.choose(np.array([k, 0]), [x[:2], x[2:]])`: np.choose: outside is 1: a number that no "
             "choice has"),
            (falling, 1,
             "S501 at `np.digitize(0.3, np.array([1.0, 0.0 * k]))`: np.digitize with bins that decrease: turn them "
             "around, bins[::-1]"),
            (shaped, 2,
             "S501 at `np.putmask(x, x > 0, x[:k])`: np.putmask with values of another shape: position(k, "
             "x.shape[0]) is 2, x.shape[0] is 4"),
            (empty_range, 2,
             "S501 at `np.histogram(x, bins=3, range=(1.0 * k, 1.0), weights=x)`: np.histogram with a range whose "
             "ends are equal or exchanged: operand is 2.0, 1.0 is 1.0")):
        yield Case(kernel, (X, k), "x", refused=refused)
    # membership
    yield Case(of_the_last_ones, (X, 6), "x")
    yield Case(of_the_last_ones, (X[::-1].copy(), 5), "x")
    yield Case(of_a_number, (X, 2.0), refused=(
        "S201 at `3.0 in k * x[1]`: whether an array has an element is asked: write np.any(a == x)"))
    # numbers that are left
    for kernel in [free_of, free_by_a_list, others]:
        for fixed in [np.array([0, 3]), np.zeros(0, int), np.array([2, 1, 5, 1])]:
            a = generator(2).normal(size=(4, 4)) + 4.0 * np.eye(4)
            yield Case(kernel, (a, X, fixed), ("a", "x"))
    for kernel, refused in (
            (overlapping,
             "S201 at `x.flat[[1, 2]] = x[:2]`: a store by number of what may share memory with the array: "
             "np.put(x, k, values) copies the values before"),
            (by_a_matrix,
             "S301 at `np.delete(x, np.array([[0, 1]]))`: no derivative rule for numpy.delete: leave out the "
             "elements at an integer, a list or an array of integers, or a mask"),
            (several,
             "S301 at `np.insert(x, [0, 1], 0.0)`: no derivative rule for numpy.insert: insert at one place, into "
             "floats: a number, or along an axis a row"),
            (bins_by_rule,
             "S301 at `np.histogram(x, bins=\"auto\", weights=x)`: no derivative rule for numpy.histogram: give "
             "numbers with one axis, and a number of bins or an array of edges"),
            (unsorted,
             "S301 at `np.setdiff1d(np.arange(4), np.array([1]), True)`: no derivative rule for numpy.setdiff1d "
             "with assume_unique=: give two arrays of integers, without assume_unique="),
            (parted,
             "S301 at `np.partition(x, 2)`: no derivative rule for numpy.partition: write np.sort(x), whose order "
             "is determined")):
        yield Case(kernel, (X,), refused=refused)
