"""arrays: what functions of NumPy's do that are given functions, or made of many of its others.

    y = np.piecewise(x, [x < 0.0], [lambda v: v * v, 1.0])      ->      y = np.zeros_like(x)
                                                                        y[x < 0.0] = x[x < 0.0] * x[x < 0.0]
                                                                        y[~(x < 0.0)] = 1.0
"""
from __future__ import annotations

import numpy as np


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
def masked_max(a, axis=None, *, keepdims=False, initial, where=None):
    first = np.full_like(a, initial)        # in the dtype of the array
    picked = a if where is None else np.where(where, a, first)
    return np.maximum(np.max(picked, axis=axis, keepdims=keepdims), np.max(first, axis=axis, keepdims=keepdims))


def masked_min(a, axis=None, *, keepdims=False, initial, where=None):
    first = np.full_like(a, initial)
    picked = a if where is None else np.where(where, a, first)
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
