"""Draws of NumPy's generators whose state is an array, so that a sequence can be run again from where it was.

A state of 6 integers is that of `numpy.random.default_rng` (PCG64), one of 627 that of `numpy.random.RandomState`
(MT19937). Each function draws into its last argument, as NumPy does from that state, and leaves the next state.
"""
from __future__ import annotations

import threading
from collections.abc import Callable
from operator import index
from typing import Any

import numpy as np

PCG64, MT19937 = 6, 627
_LOW = (1 << 64) - 1


def begin(state, seed):
    """The state in which a sequence begins.

    >>> state, out = np.empty(PCG64, np.int64), np.empty(2)
    >>> begin(state, 3)
    >>> standard_normal(state, out)
    >>> bool(np.all(out == np.random.default_rng(3).standard_normal(2)))
    True
    """
    _leave(state, np.random.default_rng(index(seed)) if state.size == PCG64 else np.random.RandomState(index(seed)))


class _Generators(threading.local):
    """One of each kind for every thread, since NumPy takes long to make one."""

    def __init__(self) -> None:
        self.of_size = {PCG64: np.random.Generator(np.random.PCG64(0)), MT19937: np.random.RandomState(0)}


_GENERATORS = _Generators()


def _generator(state: np.ndarray) -> Any:
    """The generator that goes on from a state."""
    made: Any = _GENERATORS.of_size[state.size]
    if state.size == PCG64:
        words = state.view(np.uint64).tolist()
        made.bit_generator.state = {"bit_generator": "PCG64", "state": {"state": words[0] << 64 | words[1],
                                                                        "inc": words[2] << 64 | words[3]},
                                    "has_uint32": words[4], "uinteger": words[5]}
    else:
        made.set_state(("MT19937", state[:624].astype(np.uint32), int(state[624]), int(state[625]),
                        float(state[626:].view(np.float64)[0])))
    return made


def _leave(state: np.ndarray, generator: Any) -> None:
    """The state in which a generator is."""
    if state.size == PCG64:
        found = generator.bit_generator.state
        both = found["state"]["state"], found["state"]["inc"]
        state.view(np.uint64)[...] = [*(w for n in both for w in (n >> 64, n & _LOW)),
                                      found["has_uint32"], found["uinteger"]]
        return
    _, key, position, has_gauss, gauss = generator.get_state()
    state[:624], state[624], state[625] = key, position, has_gauss
    state[626:].view(np.float64)[0] = gauss


def standard_normal(state, out):
    _draw(state, out, lambda g: g.standard_normal(out.shape))


def random(state, out):
    _draw(state, out, lambda g: g.random(out.shape) if state.size == PCG64 else g.random_sample(out.shape))


def standard_exponential(state, out):
    _draw(state, out, lambda g: g.standard_exponential(out.shape))


def standard_gamma(state, shape, out):
    _draw(state, out, lambda g: g.standard_gamma(shape, out.shape))


def beta(state, a, b, out):
    _draw(state, out, lambda g: g.beta(a, b, out.shape))


def poisson(state, lam, out):
    _draw(state, out, lambda g: g.poisson(lam, out.shape))


def binomial(state, n, p, out):
    _draw(state, out, lambda g: g.binomial(n, p, out.shape))


def integers(state, low, high, out):
    """Integers from `low` on, below `high`."""
    _draw(state, out, lambda g: g.integers(low, high, out.shape) if state.size == PCG64
          else g.randint(low, high, out.shape))


def choice(state, n, replace, out):
    """Indices below `n`."""
    _draw(state, out, lambda g: g.choice(n, out.shape, bool(replace)))


def weighted_choice(state, p, replace, out):
    """Indices of `p`, which has the probability of each."""
    _draw(state, out, lambda g: g.choice(p.size, out.shape, bool(replace), p))


def permutation(state, out):
    """The indices of `out` in another order."""
    _draw(state, out, lambda g: g.permutation(out.size))


def _draw(state: np.ndarray, out: np.ndarray, drawn: Callable[[Any], Any]) -> None:
    generator = _generator(state)
    out[...] = drawn(generator)
    _leave(state, generator)


def cleared(state, out, out_bar):
    """The adjoint of what is drawn into `out`."""
    out_bar[...] = 0.0


def standard_normal_tangent(state, out, out_dot):
    standard_normal(state, out)
    out_dot[...] = 0.0


def random_tangent(state, out, out_dot):
    random(state, out)
    out_dot[...] = 0.0


def standard_exponential_tangent(state, out, out_dot):
    standard_exponential(state, out)
    out_dot[...] = 0.0


FUNCTIONS = (begin, standard_normal, random, standard_exponential, standard_gamma, beta, poisson, binomial, integers,
             choice, weighted_choice, permutation)
TANGENTS = {standard_normal: standard_normal_tangent, random: random_tangent,
            standard_exponential: standard_exponential_tangent}
