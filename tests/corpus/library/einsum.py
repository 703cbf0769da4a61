"""Products over named axes in any order, and products along several axes."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case

T = np.arange(1.0, 25.0).reshape(2, 3, 4) / 10.0


def crossed(t):
    return np.sum(np.einsum("bij,bji->b", t, 2.0 * np.swapaxes(t, 1, 2)) ** 2) + np.sum(
        np.einsum("ij,kj,k->i", t[0], t[1], t[0, :, 0], optimize=True) ** 2)


def cycled(t):
    a = np.einsum("ijk->kij", t) * np.arange(24.0).reshape(4, 2, 3)
    return np.sum(a * np.einsum("kij,jk->ik", t, t[0, :2].T)[0, 0]) + np.sum(
        np.einsum("ijk,lj,mk->iml", t, t[0, :, :3], t[1, :2]) ** 2)


def a_view_of_one_operand(t):
    w = np.einsum("ijk->kij", t)
    w[0] = 0.5 * t[0, 0, 1]
    return np.sum(t ** 2)


def tensors(t):
    w = np.zeros((2, 4, 2, 4))
    for _ in range(2):
        w[...] = np.tensordot(t, t, axes=([1], [1]))
        t[0] += 0.01 * w[0, :3, 1]
        w[0] = 0.0
    return np.sum(w) + np.sum(t ** 2) + np.sum(np.tensordot(t[:, :2], t[:, :2], axes=([1], [0])))


def by_a_number(t):
    a = np.dot(t[0, 0, 0], t)
    a[0] = t[0].dot(2.5) - np.dot(t[1], t[0, 1, 2])
    t *= 0.5
    return np.sum(a ** 2)


def along_several_axes(t):
    return (np.sum(t.prod(axis=(0, 1)) ** 2) + np.sum(np.prod(t, axis=(0, -1), keepdims=True) * t)
            + np.prod(t, axis=(0, 1, 2)) * t[0, 0, 0] + np.sum(np.prod(np.array([[[1, 2], [3, 4]]]), axis=(0, 1))))


def of_no_rows(t):
    return np.sum(np.prod(t[:0], axis=(0, 1)) * t[0, 0])


def cases():
    # axes in any order
    for kernel in [crossed, cycled, a_view_of_one_operand, tensors, by_a_number, along_several_axes]:
        yield Case(kernel, (T,), ("t",))
    # other arrays
    for given in [T.astype(np.float32), T[::-1, :, ::-1]]:
        yield Case(crossed, (given,), ("t",))
        yield Case(along_several_axes, (given,), ("t",))
    # no rows
    yield Case(of_no_rows, (T,), ("t",))
