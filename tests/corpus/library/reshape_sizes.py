"""A size of -1 of a reshape is what is left, however it is spelled; a number that may be -1 unseen is an error."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case

M1 = -1
SH = (-1, 4)


def joined(w):
    t = w.reshape(w.shape[:1] + (-1,))
    return np.sum(t ** 2 * np.arange(t.size).reshape(t.shape))


def joined_before(w):
    return np.sum(w.reshape((-1,) + w.shape[2:])[1:] ** 2) + np.sum(np.reshape(w, w.shape[:2] + (3, -1))[1:] ** 3)


def by_name(w):
    s = (w.shape[0], -1)
    k = -1
    r = w.shape[:1] + (k,)
    return np.sum(w.reshape(s)[:, 1:] ** 2) + np.sum(w.reshape(k)[1:] ** 3) + np.sum(w.reshape(r)[1] * w[1, 0, 0])


def by_rank(w):
    k = w.ndim - 4
    t = w.reshape(k, 4)
    return np.sum(t[1:] ** 2)


def rows_of(w, k=-1):
    return w.reshape(k, 4)


def by_default(w):
    return np.sum(rows_of(w)[1:] ** 2)


def by_module(w):
    return np.sum(w.reshape(M1, 4)[1:] ** 2) + np.sum(w.reshape(SH)[2] ** 3) + np.sum(w.reshape([-1, 4])[1] ** 2)


def stored(w):
    v = np.zeros((3, 4))
    k = -1
    v[:] = w.reshape(k, 4) * 2.0
    v[0] = w.reshape((k, 4))[1]
    return np.sum(v ** 2)


def written(w):
    s = w.shape[:1] + (-1,)
    t = w.reshape(s)
    t[0, 4] = w[1, 0, 0] ** 2
    return np.sum(w ** 2)


def counted(w):
    t = w.reshape(w.shape[:-1] + (w.shape[-1],))
    n = w.shape[0] * w.shape[1]
    return np.sum(t[1:] ** 2) + np.sum(w.reshape(n, w.size // n)[1:] ** 3)


def given(w, k):
    return np.sum(w.reshape(k, 4)[1:] ** 2)


def array() -> np.ndarray:
    return np.arange(1.0, 13.0).reshape(2, 2, 3)


def several(w):
    s = (-1,) + w.shape[2:]
    k = -1
    return np.sum(w.reshape(s)[1:] ** 2) + np.sum(w.reshape(w.shape[:1] + (k,))[1] ** 3) + np.sum(rows_of(w)[2])


def cases():
    for kernel in (joined, joined_before, by_name, by_rank, by_default, by_module, stored, counted, several):
        yield Case(kernel, (array(),), ("w",))
    yield Case(written, (array(),), ("w",), ("w", "return"))
    # a size that is given
    yield Case(given, (array(), 3), ("w",))
    yield Case(given, (array(), -1), "w", refused=(
            "S501 at `w.reshape(k, 4)`: a size of np.reshape is negative: k is -1: write -1 where it stands, or bind "
            "it to a name of its own: n = -1"))
