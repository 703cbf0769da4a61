"""random_numbers: what NumPy's generators of random numbers do, as functions and classes that the evaluator reads.

    rng = np.random.default_rng(3)              ->      state = np.empty(6, np.int64)
    noise = rng.normal(0.0, 0.1, n)                     begin(state, 3)
                                                        out = np.empty(n)
                                                        standard_normal(state, out)
                                                        noise = 0.0 + 0.1 * out

A sequence is an array that holds its state, which each draw changes: what is run again draws again what it drew. Draws
are data; derivatives go through what scales and shifts them, as differences with the same seed do.
"""
from __future__ import annotations

from types import FunctionType
from typing import Any

import numpy as np

from s2sad.live_objects.registry import GIVEN, RegisteredDerivative, RegisteredRule, RuleText
from s2sad.runtime.random_sequences import (
    FUNCTIONS, TANGENTS, begin, beta, binomial, choice, cleared, integers, permutation, poisson, random,
    standard_exponential, standard_gamma, standard_normal, weighted_choice,
)


def size_of(size, *parameters):
    """How many are drawn: where no size is given one for each element of the parameters."""
    if size is None and any(isinstance(p, np.ndarray) for p in parameters):
        total: Any = sum(parameters)
        return total.shape
    return size


class Sequence:
    """What the two kinds have alike."""
    state: np.ndarray

    def filled(self, fill, size):
        if size is None:
            out = np.empty(1)
            fill(self.state, out)
            return out[0]
        out = np.empty(size)
        fill(self.state, out)
        return out

    def counted(self, fill, size):
        if size is None:
            out = np.empty(1, np.int64)
            fill(self.state, out)
            return out[0]
        out = np.empty(size, np.int64)
        fill(self.state, out)
        return out

    def random(self, size=None):
        return self.filled(random, size)

    def standard_normal(self, size=None):
        return self.filled(standard_normal, size)

    def standard_exponential(self, size=None):
        return self.filled(standard_exponential, size)

    def normal(self, loc=0.0, scale=1.0, size=None):
        return loc + scale * self.standard_normal(size_of(size, loc, scale))

    def uniform(self, low=0.0, high=1.0, size=None):
        return low + (high - low) * self.random(size_of(size, low, high))

    def exponential(self, scale=1.0, size=None):
        return scale * self.standard_exponential(size_of(size, scale))

    def lognormal(self, mean=0.0, sigma=1.0, size=None):
        return np.exp(self.normal(mean, sigma, size))

    def standard_gamma(self, shape, size=None):
        return self.filled(lambda state, out: standard_gamma(state, shape, out), size_of(size, shape))

    def gamma(self, shape, scale=1.0, size=None):
        return scale * self.standard_gamma(shape, size_of(size, shape, scale))

    def beta(self, a, b, size=None):
        return self.filled(lambda state, out: beta(state, a, b, out), size_of(size, a, b))

    def poisson(self, lam=1.0, size=None):
        return self.counted(lambda state, out: poisson(state, lam, out), size_of(size, lam))

    def binomial(self, n, p, size=None):
        return self.counted(lambda state, out: binomial(state, n, p, out), size_of(size, n, p))

    def choice(self, a, size=None, replace=True, p=None):
        of = np.asarray(a) if isinstance(a, (list, tuple)) else a
        n = len(of) if isinstance(of, np.ndarray) else of
        if p is None:
            found = self.counted(lambda state, out: choice(state, n, replace, out), size)
        else:
            found = self.counted(lambda state, out: weighted_choice(state, np.asarray(p), replace, out), size)
        if not isinstance(of, np.ndarray):
            return found
        return of.copy()[found] if size is None and of.ndim > 1 else of[found]      # a row of its own

    def permutation(self, x):
        of = np.asarray(x) if isinstance(x, (list, tuple)) else x
        out = np.empty(len(of) if isinstance(of, np.ndarray) else of, np.int64)
        permutation(self.state, out)
        return of[out] if isinstance(of, np.ndarray) else out

    def shuffle(self, x):
        x[:] = x[self.permutation(len(x))]


class Generator(Sequence):
    """`numpy.random.default_rng(seed)`."""

    def __init__(self, seed):
        self.state = np.empty(6, np.int64)
        begin(self.state, seed)

    def integers(self, low, high=None, size=None, *, endpoint=False):
        first, end = (0, low) if high is None else (low, high)
        return self.counted(lambda state, out: integers(state, first, end + int(endpoint), out),
                            size_of(size, first, end))


class RandomState(Sequence):
    """`numpy.random.RandomState(seed)`."""

    def __init__(self, seed):
        self.state = np.empty(627, np.int64)
        begin(self.state, seed)

    def seed(self, seed):
        begin(self.state, seed)

    def rand(self, *size):
        return self.random(size if size else None)

    def randn(self, *size):
        return self.standard_normal(size if size else None)

    def random_sample(self, size=None):
        return self.random(size)

    def randint(self, low, high=None, size=None):
        first, end = (0, low) if high is None else (low, high)
        return self.counted(lambda state, out: integers(state, first, end, out), size_of(size, first, end))


def _registered(function: FunctionType) -> None:
    """A draw is called as it is; what its last argument held is lost, and so has no derivative."""
    parameters = function.__code__.co_varnames[:function.__code__.co_argcount]
    primal = tuple(("primal", p) for p in parameters)
    found = {"primal": function}
    roles = {"primal": primal}
    if function in TANGENTS:
        found |= {"adjoint": cleared, "tangent": TANGENTS[function]}
        roles |= dict.fromkeys(("adjoint", "tangent"), (*primal, ("shadow", parameters[-1])))
    rules = {what: RegisteredRule(f"{f.__module__}.{f.__name__}", f, f, False) for what, f in found.items()}
    own = RegisteredDerivative(function.__name__, rules, roles, dict.fromkeys(rules, RuleText()), repeatable=True,
                               writes=("state",) if function is begin else ("state", "out"))
    GIVEN.add(RegisteredRule(rules["primal"].path, function, function, False, own=own))


for _function in FUNCTIONS:
    _registered(_function)
