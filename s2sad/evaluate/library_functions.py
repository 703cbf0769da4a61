"""library_functions: what functions of NumPy's do that are given functions, or made of many of its others, and
iterators of Python's, as functions that the evaluator reads.

    y = np.piecewise(x, [x < 0.0], [lambda v: v * v, 1.0])      ->      y = np.zeros_like(x)
                                                                        y[x < 0.0] = x[x < 0.0] * x[x < 0.0]
                                                                        y[~(x < 0.0)] = 1.0

Parameters are called as NumPy calls them. `WRITTEN` has the functions by their paths, `WITH_OPTION` those that are read
where an option is given that the function's own rule does not know.
"""
from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np


_END = "the end of an iterator"


def piecewise(x, condlist, funclist):
    whole = np.zeros_like(x)
    one = isinstance(condlist, np.ndarray) and condlist.ndim == 1
    conditions = [condlist] if one else list(condlist)
    if len(funclist) == len(conditions) + 1:
        taken = conditions[0]
        for condition in conditions[1:]:
            taken = taken | condition
        conditions.append(~taken)
    if len(funclist) != len(conditions):
        raise ValueError("piecewise: as many functions as conditions, or one more")
    for condition, value in zip(conditions, funclist):
        whole[condition] = value(x[condition]) if callable(value) else value
    return whole


def fromfunction(function, shape, dtype=float):
    if len(shape) == 1:
        return function(np.arange(shape[0], dtype=dtype))
    return function(*np.meshgrid(*[np.arange(n, dtype=dtype) for n in shape], indexing="ij"))


def apply_along_axis(func1d, axis, arr):
    if arr.ndim == 1:
        return func1d(arr)
    if arr.ndim > 2:
        raise NotImplementedError("apply_along_axis: arrays of more than two axes")
    if axis == 0 or axis == -2:
        return np.moveaxis(np.array([func1d(column) for column in arr.T]), 0, -1)
    return np.array([func1d(row) for row in arr])


def stack(arrays, axis=0):
    return np.moveaxis(np.stack(arrays), 0, axis)


def tolist(a):
    if np.ndim(a) == 0:
        return a
    return list(a) if a.ndim == 1 else [tolist(row) for row in a]


def linspace(start, stop, num=50, endpoint=True):
    first = np.asarray(start)
    return first + np.multiply.outer(np.linspace(0.0, 1.0, num, endpoint=endpoint), np.asarray(stop) - first)


def count(start=0, step=1):
    k = start
    while True:
        yield k
        k += step


def cycle(iterable):
    saved = []
    for item in iterable:
        yield item
        saved.append(item)
    while True:
        for item in saved:
            yield item


def repeat(object):
    while True:
        yield object


def pairwise(iterable):
    last = None
    for item in iterable:
        if last is not None:
            yield last, item
        last = item


def islice(iterable, start, stop, step):
    for k, item in enumerate(iterable):
        if k >= start and (k - start) % step == 0:
            yield item
        if stop is not None and k == stop - 1:
            break


def takewhile(predicate, iterable):
    for item in iterable:
        if not predicate(item):
            break
        yield item


def starmap(function, iterable):
    for item in iterable:
        yield function(*item)


def groupby(iterable, key=None):
    iterator = iter(iterable)
    is_left, item, found, groups = True, None, None, 0

    def advance():
        nonlocal is_left, item, found
        item = next(iterator, _END)
        is_left = item is not _END
        if is_left:
            found = item if key is None else key(item)

    def group(number, target):
        while is_left and number == groups and found == target:
            yield item
            advance()
    advance()
    while is_left:
        target = found
        yield target, group(groups, target)
        while is_left and found == target:      # what has not been taken is gone
            advance()
        groups += 1


def zip_longest(*iterables, fillvalue=None):
    columns = [list(iterable) if isinstance(iterable, (dict, set)) else iterable for iterable in iterables]
    k = 0
    while any(k < len(column) for column in columns):
        yield tuple([column[k] if k < len(column) else fillvalue for column in columns])
        k += 1


def itemgetter(*items):
    def get(obj):
        return obj[items[0]] if len(items) == 1 else tuple([obj[item] for item in items])
    return get


def attrgetter(*attrs):
    def resolved(obj, attr):
        for name in attr.split("."):
            obj = getattr(obj, name)
        return obj

    def get(obj):
        return resolved(obj, attrs[0]) if len(attrs) == 1 else tuple([resolved(obj, attr) for attr in attrs])
    return get


def methodcaller(name, *args, **kwargs):
    def called(obj):
        return getattr(obj, name)(*args, **kwargs)
    return called


def diag_indices_from(arr):
    if arr.ndim != 2:
        raise NotImplementedError("diag_indices_from: an array of another number of axes than two")
    if arr.shape[0] != arr.shape[1]:
        raise ValueError("diag_indices_from: an array with axes of different lengths")
    return np.diag_indices(arr.shape[0])


def triu_indices_from(arr, k=0):
    if arr.ndim != 2:
        raise ValueError("triu_indices_from: an array of another number of axes than two")
    return np.triu_indices(arr.shape[0], k, arr.shape[1])


def tril_indices_from(arr, k=0):
    if arr.ndim != 2:
        raise ValueError("tril_indices_from: an array of another number of axes than two")
    return np.tril_indices(arr.shape[0], k, arr.shape[1])


def from_iterable(iterable):
    for items in iterable:
        yield from items


def of_complex(function):
    def of_number(z):
        return function(complex(z))
    return of_number


def polar(z):
    return abs(complex(z)), np.angle(complex(z))


def rect(r, phi):
    return complex(r * np.cos(phi), r * np.sin(phi))


def vectorized(function, numbers, *args):
    arrays = [a for a, one in zip(args, numbers) if not one]
    whole = np.zeros(np.shape(arrays[0]))
    for a in arrays[1:]:
        whole = whole + np.zeros(np.shape(a))
    rows = [a if one else np.ravel(np.broadcast_to(a, np.shape(whole))) for a, one in zip(args, numbers)]
    found = [float(function(*[a if one else a[k] for a, one in zip(rows, numbers)])) for k in range(whole.size)]
    return np.reshape(np.array(found), np.shape(whole))


def rollaxis(a, axis, start=0):
    source = axis + a.ndim if axis < 0 else axis
    place = start + a.ndim if start < 0 else start
    return np.moveaxis(a, source, place - 1 if place > source else place)


def expand_dims(a, axis):
    rank = a.ndim + len(axis)
    for k in sorted([place + rank if place < 0 else place for place in axis]):
        a = np.expand_dims(a, k)
    return a


def broadcast_arrays(*args):
    whole = np.zeros(np.shape(args[0]))
    for a in args[1:]:
        whole = whole + np.zeros(np.shape(a))
    return [np.broadcast_to(a, whole.shape) for a in args]


def unravel_index(indices, shape):
    rest, places = indices, []
    for length in reversed(shape):
        places.append(rest % length)
        rest = rest // length
    return tuple(reversed(places))


def unwrap(p, discont=None, *, period=2.0 * np.pi):
    jumps = np.diff(p)
    turned = (jumps + 0.5 * period) % period - 0.5 * period
    turned = np.where((turned == -0.5 * period) & (jumps > 0.0), 0.5 * period, turned)
    least = 0.5 * period if discont is None else max(0.5 * period, discont)
    added = np.where(np.abs(jumps) < least, 0.0, turned - jumps)
    whole = p + 0.0
    whole[..., 1:] += np.cumsum(added, axis=-1)
    return whole


def ediff1d(ary, to_end=None, to_begin=None):
    first = np.zeros(0) if to_begin is None else np.ravel(np.asarray(to_begin) + np.zeros(1))
    last = np.zeros(0) if to_end is None else np.ravel(np.asarray(to_end) + np.zeros(1))
    return np.concatenate((first, np.diff(np.ravel(ary)), last))


# -- reductions of what a mask picks, or that begin with a number ----------------------------------------------------
def masked_max(a, axis=None, *, keepdims=False, initial, where=True):
    first = np.full_like(a, initial)        # in the dtype of the array
    picked = a if where is True else np.where(where, a, first)
    return np.maximum(np.max(picked, axis=axis, keepdims=keepdims), np.max(first, axis=axis, keepdims=keepdims))


def masked_min(a, axis=None, *, keepdims=False, initial, where=True):
    first = np.full_like(a, initial)
    picked = a if where is True else np.where(where, a, first)
    return np.minimum(np.min(picked, axis=axis, keepdims=keepdims), np.min(first, axis=axis, keepdims=keepdims))


def masked_mean(a, axis=None, *, keepdims=False, where=True):
    counted = np.sum(np.where(where, np.ones_like(a), 0.0), axis=axis, keepdims=keepdims)
    return np.sum(np.where(where, a, 0.0), axis=axis, keepdims=keepdims) / counted


def masked_var(a, axis=None, *, ddof=0, keepdims=False, where=True):
    counted = np.sum(np.where(where, np.ones_like(a), 0.0), axis=axis, keepdims=keepdims)
    apart = a - masked_mean(a, axis=axis, keepdims=True, where=where)
    return np.sum(np.where(where, apart * apart, 0.0), axis=axis, keepdims=keepdims) / (counted - ddof)


def masked_std(a, axis=None, *, ddof=0, keepdims=False, where=True):
    return np.sqrt(masked_var(a, axis=axis, ddof=ddof, keepdims=keepdims, where=where))


# -- polynomials: sums of coefficients times functions of a recurrence, from the last on (Clenshaw) ------------------
def clenshaw(x, c, factor, behind):
    """The last two of b[k] = c[k] + factor(k, x) * b[k + 1] - behind(k) * b[k + 2] before c[0] is added."""
    given = np.asarray(c)
    if given.ndim != 1:
        raise NotImplementedError("series of coefficients with several axes")
    ahead, second = 0.0 * x, 0.0 * x
    for k in range(len(given) - 1, 0, -1):
        ahead, second = given[k] + factor(k, x) * ahead - behind(k) * second, ahead
    return given[0], ahead, second


def chebval(x, c):
    first, ahead, second = clenshaw(x, c, lambda k, v: 2.0 * v, lambda k: 1.0)
    return first + x * ahead - second


def legval(x, c):
    first, ahead, second = clenshaw(x, c, lambda k, v: (2 * k + 1) / (k + 1) * v, lambda k: (k + 1) / (k + 2))
    return first + x * ahead - 0.5 * second


def hermval(x, c):
    first, ahead, second = clenshaw(x, c, lambda k, v: 2.0 * v, lambda k: 2.0 * (k + 1))
    return first + 2.0 * x * ahead - 2.0 * second


def hermeval(x, c):
    first, ahead, second = clenshaw(x, c, lambda k, v: v, lambda k: 1.0 * (k + 1))
    return first + x * ahead - second


def lagval(x, c):
    first, ahead, second = clenshaw(x, c, lambda k, v: (2 * k + 1 - v) / (k + 1), lambda k: (k + 1) / (k + 2))
    return first + (1.0 - x) * ahead - 0.5 * second


def polyadd(a1, a2):
    left, right = np.atleast_1d(a1), np.atleast_1d(a2)
    n = max(len(left), len(right))
    whole = np.zeros(n)
    whole[n - len(left):] += left
    whole[n - len(right):] += right
    return whole


def polysub(a1, a2):
    return polyadd(a1, -np.asarray(a2))


class poly1d:   # noqa: PLW1641
    """A polynomial by its coefficients, the highest power first."""

    def __init__(self, c_or_r):
        self._given = np.asarray(c_or_r)

    def __call__(self, val):
        return np.polyval(self._given, val)

    def __add__(self, other):
        return poly1d(polyadd(self._given, other._given))

    def __sub__(self, other):
        return poly1d(polysub(self._given, other._given))

    def __mul__(self, other):
        return poly1d(np.polymul(self._given, other._given) if isinstance(other, poly1d) else self._given * other)

    def __rmul__(self, other):
        return poly1d(self._given * other)

    def __eq__(self, other):
        raise NotImplementedError("polynomials that are compared")

    def deriv(self):
        return poly1d(np.polyder(self._given))

    def integ(self):
        return poly1d(np.polyint(self._given))


class Polynomial:   # noqa: PLW1641
    """A polynomial by its coefficients, the lowest power first."""

    def __init__(self, coef):
        self.coef = np.asarray(coef)

    def __call__(self, arg):
        return np.polynomial.polynomial.polyval(arg, self.coef)

    def __eq__(self, other):
        raise NotImplementedError("polynomials that are compared")


def _by_path(room: str, *found: Any) -> Iterable[tuple[str, Any]]:
    return ((f"{room}.{f.__name__}", f) for f in found)


_OF_NUMPY = {"phase": "angle", **{f"a{name}": f"arc{name}" for name in ("sin", "cos", "tan", "sinh", "cosh", "tanh")}}
_OF_COMPLEX = ("exp", "log", "log10", "sqrt", "sin", "cos", "tan", "sinh", "cosh", "tanh", *_OF_NUMPY)

WRITTEN: dict[str, Callable[..., Any]] = dict((
    *_by_path("itertools", count, cycle, repeat, pairwise, islice, takewhile, starmap, groupby,
              zip_longest),
    *_by_path("operator", itemgetter, attrgetter, methodcaller),
    *_by_path("itertools.chain", from_iterable), *_by_path("cmath", polar, rect),
    *((f"cmath.{name}", of_complex(getattr(np, _OF_NUMPY.get(name, name)))) for name in _OF_COMPLEX),
    *_by_path("numpy", piecewise, fromfunction, apply_along_axis, vectorized, rollaxis, broadcast_arrays, unwrap,
              tolist, polyadd, polysub, poly1d, diag_indices_from,
              triu_indices_from, tril_indices_from),
    *_by_path("numpy.polynomial", Polynomial),
    *_by_path("numpy.polynomial.polynomial", Polynomial), *_by_path("numpy.polynomial.chebyshev", chebval),
    *_by_path("numpy.polynomial.legendre", legval), *_by_path("numpy.polynomial.hermite", hermval),
    *_by_path("numpy.polynomial.hermite_e", hermeval), *_by_path("numpy.polynomial.laguerre", lagval)))

_MASKED = ("where", "initial")
WITH_OPTION: dict[str, tuple[Callable[..., Any], tuple[str, ...]]] = {
    "numpy.ediff1d": (ediff1d, ("to_begin", "to_end")),
    **{f"numpy.{name}": (made, _MASKED) for name, made in (
        ("max", masked_max), ("min", masked_min), ("amax", masked_max), ("amin", masked_min), ("mean", masked_mean),
        ("var", masked_var), ("std", masked_std))}}
