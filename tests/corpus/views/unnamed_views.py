"""Functions that write their argument, given a view that another function makes and that has no name."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case


def added(u):
    np.add.at(u.ravel(), np.array([0, 1, 0]), u[1, 2])
    return np.sum(u ** 2)


def added_across(u):
    np.add.at(u.T, np.array([0, 1, 0]), 1.5)
    np.subtract.at(u.T[1], np.array([0, 1, 0]), u[0, 0])
    np.add.at(u.T[1:], (0, 1), u[0, 1])
    return np.sum(u ** 2)


def scaled(u):
    np.multiply.at(u.T, 0, u[0, 1])
    np.divide.at(np.transpose(u, (1, 0)), 1, 2.0)
    np.add.at(u.swapaxes(0, 1)[1], 0, 1.5)
    np.maximum.at(np.asarray(u), 1, 3.5)
    return np.sum(u ** 2)


def diagonals(u):
    np.fill_diagonal(u.T, 2.0 * u[0, 1])
    np.fill_diagonal(np.flip(u, 0), u[1, 1])
    np.fill_diagonal(u.ravel().reshape(3, 2), u[1, 2] ** 2)
    return np.sum(u ** 3)


def rounds(u):
    for k in range(2):
        np.add.at(u.ravel(), np.array([0, k, 0]), u[1, 2])
        if u[0, 1] > 0.0:
            np.fill_diagonal(u.T, u[0, 1])
    return np.sum(u ** 2)


def parts(u):
    np.add.at(u[0], np.array([0, 1, 0]), u[1])
    np.add.at(u[:, 1:], 0, 1.5)
    np.fill_diagonal(u[:, 1:], u[0, 0])
    np.add.at(u.copy(), 0, 2.0)
    np.fill_diagonal(u * 2.0, 2.0)
    return np.sum(u ** 2)


def copied(u, v):
    np.copyto(u.T, v)
    np.exp(v * u.T, out=u.T)
    np.add(u.T, v, u.T)
    u.reshape(-1).sort()
    return np.sum(u ** 2 * np.array([1.0, 2.0, 3.0]))


def summed(u, v):
    u.T[1:].fill(u[0, 0])
    v.sum(axis=0, out=u.T[0])
    np.nan_to_num(u.ravel(), copy=False)
    return np.sum(u ** 2 * np.array([1.0, 2.0, 3.0]))


ONE = [added, added_across, scaled, diagonals, rounds, parts]


def array() -> np.ndarray:
    return np.array([[1.5, 0.7, 2.1], [0.4, 1.9, 0.3]])


def put(u):
    np.put(u.T, 0, 1.5)
    return np.sum(u ** 2)


def placed(u):
    np.place(u.T, u.T > 1.0, 1.5)
    return np.sum(u ** 2)


def masked(u):
    np.putmask(u.T, u.T > 1.0, 1.5)
    return np.sum(u ** 2)


def on_the_diagonal(u):
    np.add.at(np.diagonal(u), 0, 1.5)
    return np.sum(u ** 2)


def cases():
    # a view without a name is written
    for kernel in ONE:
        yield Case(kernel, (array(),), ("u",), ("u", "return"))
    # so is one that is filled
    for kernel in (copied, summed):
        v = np.array([[0.1, 0.5], [0.8, 0.2], [0.3, 0.6]])
        yield Case(kernel, (array(), v), ("u", "v"), ("u", "return"))
    # what is written through is
    for kernel in (put, masked):
        yield Case(kernel, (array(),), ("u",), ("u", "return"))
    # what is not written is refused
    for kernel, refused in (
            (placed,
             "S201 at `np.place(u.T, u.T > 1.0, 1.5)`: a call whose result is not used: write x[mask] = values"),
            (on_the_diagonal,
             "S201 at `np.add.at(np.diagonal(u), 0, 1.5)`: an array is written that NumPy shares with another "
             "one, which is a view of it by a function: write into the array itself, or take a copy: np.copy(...)")):
        yield Case(kernel, (array(),), of=None, refused=refused)
