"""Functions among the arguments of a kernel: its derivative is that for these functions."""
from __future__ import annotations

import functools

import numpy as np

from tests.corpus import Case

X = np.array([0.3, 0.9, 0.7])


def square(u):
    return u * u


def scaled(c):
    def by(u):
        return c * u * u
    return by


def apply(f, u):
    return np.sum(f(u) * u)


def handed_on(f, u):
    return apply(f, u) + sum(f(x) for x in u)


def rebound(f, u):
    f = f if u.size > 2 else abs
    return np.sum(f(u))


def cases():
    for kernel in (functools.partial(apply, square), functools.partial(apply, scaled(2.5)),
                   functools.partial(handed_on, scaled(1.5))):
        yield Case(kernel, (X,), ("u",))
    yield Case(rebound, (square, X), refused=(
            "S101 at `f`: 'f' was given already, and is assigned: assign to another name, or give the argument with "
            "each call"))
