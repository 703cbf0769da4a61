"""The order in which arrays lie in memory: where NumPy makes a copy in another one, and where it takes a view."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case
from tests.harness.seeds import generator


def given(*shape: int) -> np.ndarray:
    return generator(4).uniform(0.3, 1.2, shape)


def lying(shape: tuple[int, ...], how: str) -> np.ndarray:
    """An array in C's order, in Fortran's, a part of a larger one, or one that is walked backwards."""
    base = given(*shape)
    if how == "F":
        return np.asfortranarray(base)
    if how == "strided":
        whole = np.zeros(tuple(2 * n for n in shape))
        part = whole[tuple(slice(None, None, 2) for _ in shape)]
        part[...] = base
        return part
    return base[::-1].copy()[::-1] if how == "reversed" else base


HOW = ("C", "F", "strided", "reversed")


# -- what is copied in C's order is contiguous, however its operand lies --------------------------------
def method(u):
    w = u.copy()
    f = w.ravel()
    f[1] *= u[0, 0]
    return np.sum(w ** 2 * u)


def method_by_name(u):
    w = u.copy(order="c")
    f = w.reshape(-1)
    f[1:] *= f[:-1]
    return np.sum(w ** 2 * u)


def method_by_place(u):
    w = u.T.copy("C")
    f = w.ravel()
    f[1] *= 5.0
    return np.sum(w.T ** 2 * u)


def function_by_place(u):
    w = np.copy(u, "C")
    f = w.ravel()
    f[1] *= u[0, 1]
    return np.sum(w ** 2 * u)


def array_in_order(u):
    w = np.array(u, order="C")
    f = w.ravel()
    f[1] *= u[0, 1]
    return np.sum(w ** 2 * u)


def alike(u):
    w = np.zeros_like(u, None, "C")
    f = w.ravel()
    f[1] = u[0, 1] ** 2
    return np.sum(w * u)


def filled_alike(u):
    w = np.full_like(u, 0.5, order="C")
    f = w.reshape(-1)
    f[:] *= f[::-1] + u[0, 0]
    return np.sum(w ** 2 * u)


def made(u):
    w = np.full(u.shape, 2.0, float, "C")
    f = w.ravel()
    f[1] *= u[0, 1]
    return np.sum(w ** 2 * u)


def of_a_copy(u):
    w = u.copy() * 2.0 + u.copy()
    f = w.ravel()
    f[1] *= u[0, 1]
    return np.sum(w ** 2)


def handed(f, c):
    f = f.reshape(-1)
    f[1:] *= c
    return f[1]


def through_a_helper(u):
    return handed(u.T.copy(), 3.0) + np.sum(u ** 2)


def one_axis(u):
    x = u[0].copy(order="F")
    f = x.reshape(1, -1)
    f[0, 1] *= x[0]
    z = np.asarray(x, order="F")
    z[2] *= x[1]
    return np.sum(x ** 2) + np.sum(u)


def taken_as_it_is(u):
    w = np.asarray(u, order="K")
    w[0, 0] *= u[1, 1]
    z = np.asarray(u, None, None)
    z[0, 1] *= 2.0
    return np.sum(w * u * z)


def only_read(u):
    w = np.copy(u, order="F")
    z = np.zeros_like(u, order="F") + w
    f = z.ravel()
    w[0] *= 2.0
    return np.sum(f[1:] * f[:-1]) + np.sum(w * z) + np.sum(np.asarray(u, order="F") * u)


COPIED = (method, method_by_name, method_by_place, function_by_place, array_in_order, alike, filled_alike, made,
          of_a_copy, through_a_helper, one_axis, taken_as_it_is, only_read)


# -- what is made in another order is not, nor may be what is made of it --------------------------------
def copied(u):
    w = np.copy(u, order="F")
    f = w.ravel()
    f[1] = 0.0
    return np.sum(w ** 2 * u)


def copied_by_place(u):
    w = u.copy("F")
    f = w.ravel()
    f[1] = 0.0
    return np.sum(w ** 2 * u)


def as_array(u):
    w = np.array(u, order="F")
    f = w.reshape(-1)
    f[1] = 0.0
    return np.sum(w ** 2 * u)


def zeros_alike(u):
    w = np.zeros_like(u, order="F")
    w += u
    f = w.reshape(-1)
    f[:] = u[0, 1]
    return np.sum(w ** 2)


def full_alike_by_place(u):
    w = np.full_like(u, 2.0, None, "F")
    f = w.reshape(-1)
    f[1] *= u[0, 1]
    return np.sum(w ** 2)


def zeros_by_place(u):
    w = np.zeros(u.shape, float, "F")
    f = w.reshape(-1)
    f[1] += u[0, 1]
    return np.sum(w ** 2)


def uncertain(u):
    w = np.copy(u, order="A")
    f = w.reshape(-1)
    f[1] *= u[0, 1]
    return np.sum(w ** 2)


def of_copies(u):
    v = u.copy(order="F")
    z = v + v
    f = z.reshape(-1)
    f[1] *= 3.0
    return np.sum(z ** 2)


def alias(u):
    w = np.asarray(u, order="F")
    w[0, 0] = 0.0
    return np.sum(u ** 2)


def alias_by_place(u):
    w = np.asarray(u, float, "F")
    w[0, 0] = 0.0
    return np.sum(u ** 2)


def alias_in_a_list(u):
    us = [np.asarray(u, order="F"), u]
    us[0][0, 0] = 0.0
    return np.sum(u ** 2)


def alias_through_a_helper(u):
    w = handed_back(u)
    w[0, 0] = 0.0
    return np.sum(u ** 2)


def handed_back(v):
    return np.asarray(v, order="F")


def copies_of_copies(u):
    return handed(np.copy(u, order="F"), 3.0)


def turned_product(u):
    z = np.einsum("ij,jk->ki", u, u.T)
    f = z.ravel()
    f[1] *= 2.0
    return np.sum(z ** 2)


def stacks(u):
    a = u.reshape(2, 2, 2, 1)
    w = a.transpose(1, 0, 2, 3) @ a.transpose(1, 0, 3, 2)
    f = w.ravel()
    f[1] = 0.0
    return np.sum(w ** 2)


def cases():
    # what is made in the order of c is contiguous
    for kernel in COPIED:
        for how in HOW:
            yield Case(kernel, (lying((2, 4), how),), ("u",))
    # matrices of one row and of one column
    for shape in ((1, 4), (4, 1), (1, 2)):
        yield Case(method_by_name, (lying(shape, "F"),), ("u",))
    yield Case(copies_of_copies, (given(2, 4),), "u")
    # what is made in another order is not written through a view
    for kernel, refused in (
            (turned_product,
             "S201 at `f[1] *= 2.0`: an array is written that NumPy shares with another one, which is a view of "
             "it by a function: write into the array itself, or take a copy: np.copy(...)"),
            (copied,
             "S201 at `f[1] = 0.0`: an array is written that NumPy shares with another one, which is a view of "
             "it by a function: write into the array itself, or take a copy: np.copy(...)"),
            (copied_by_place,
             "S201 at `f[1] = 0.0`: an array is written that NumPy shares with another one, which is a view of "
             "it by a function: write into the array itself, or take a copy: np.copy(...)"),
            (as_array,
             "S201 at `f[1] = 0.0`: an array is written that NumPy shares with another one, which is a view of "
             "it by a function: write into the array itself, or take a copy: np.copy(...)"),
            (zeros_alike,
             "S201 at `f[:] = u[0, 1]`: an array is written that NumPy shares with another one, which is a view "
             "of it by a function: write into the array itself, or take a copy: np.copy(...)"),
            (full_alike_by_place,
             "S201 at `f[1] *= u[0, 1]`: an array is written that NumPy shares with another one, which is a view "
             "of it by a function: write into the array itself, or take a copy: np.copy(...)"),
            (zeros_by_place,
             "S201 at `f[1] += u[0, 1]`: an array is written that NumPy shares with another one, which is a view "
             "of it by a function: write into the array itself, or take a copy: np.copy(...)"),
            (uncertain,
             "S201 at `f[1] *= u[0, 1]`: an array is written that NumPy shares with another one, which is a view "
             "of it by a function: write into the array itself, or take a copy: np.copy(...)"),
            (of_copies,
             "S201 at `f[1] *= 3.0`: an array is written that NumPy shares with another one, which is a view of "
             "it by a function: write into the array itself, or take a copy: np.copy(...)"),
            (alias,
             "S201 at `w[0, 0] = 0.0`: an array is written that NumPy shares with another one, which is a view "
             "of it by a function: write into the array itself, or take a copy: np.copy(...)"),
            (alias_by_place,
             "S201 at `w[0, 0] = 0.0`: an array is written that NumPy shares with another one, which is a view "
             "of it by a function: write into the array itself, or take a copy: np.copy(...)"),
            (alias_in_a_list,
             "S201 at `us[0][0, 0] = 0.0`: an array is written that NumPy shares with another one, which is a "
             "view of it by a function: write into the array itself, or take a copy: np.copy(...)"),
            (alias_through_a_helper,
             "S201 at `w[0, 0] = 0.0`: an array is written that NumPy shares with another one, which is a view "
             "of it by a function: write into the array itself, or take a copy: np.copy(...)"),
            (stacks,
             "S201 at `f[1] = 0.0`: an array is written that NumPy shares with another one, which is a view of "
             "it by a function: write into the array itself, or take a copy: np.copy(...)")):
        yield Case(kernel, (given(2, 4),), refused=refused)
