"""Features together: structures, arrays that are bound anew, functions that return arrays, derivatives of one's own."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

import s2sad
from tests.harness.seeds import generator

RNG = generator(5)
U, V, W = RNG.random(5) + 0.3, RNG.random(5) + 0.5, RNG.random(5) + 0.2


@dataclass
class State:
    u: np.ndarray
    v: np.ndarray
    t: float = 0.5
    log: Any = None


class Pair(NamedTuple):
    u: Any
    v: Any


def state():
    return State(U.copy(), V.copy())


def holds(kernel, *arguments, engine="numpy"):
    """Whether the derivatives of a kernel hold, and nothing that it writes is left out."""
    found = s2sad.check(kernel, *arguments, engine=engine)
    assert found and not found.unsure, str(found)


# -- tuples and lists inside structures -----------------------------------------------------------------------------

def nested(s):
    d = {"k": s.t, "cs": [0.1, s.t ** 2], "q": [{"z": s.t}, s.u * 2.0]}
    e = Pair([s.v, d["cs"][1]], (d, 3.0))
    d["q"][0]["z"] *= 2.0
    return e, {"x": s.u * s.v, "y": (s.t * d["cs"][1], [s.u ** 2])}, np.sum(e.u[0]) * e.v[0]["q"][0]["z"]


def test_tuples_inside_structures():
    holds(nested, state())
    first, second, _ = s2sad.differentiate(nested, engine="numpy")(state())
    assert type(first.u) is list and type(first.v) is tuple and type(second["y"][1]) is list


# -- arrays that are bound anew and then written --------------------------------------------------------------------

def bounded(u, value):
    u[0] = value
    inner = u[1:-1]
    inner *= value
    return u


def bound_and_written(s, n):
    u = s.u
    for _ in range(n):
        u = u + s.v * s.t
        u[-1] = s.t
        u = bounded(u, 0.3 * s.t)
    return u


def test_arrays_bound_anew_are_written():
    holds(bound_and_written, state(), 3)
    holds(bound_and_written, state(), 0)


# -- items of what is spelled out -----------------------------------------------------------------------------------

def spelled_out(u, v, c):
    x = [u, v][1]
    x[0] = c
    y = {"a": u, "b": v}["a"] * (c, 2.0)[0]
    return y * [c, u[1] * (c, (v, c))[1][0][2]][-1]


def kept(u, v, c, n):
    t = (c, u[0], n * c)
    w = [0.5, c, 2.0]
    shape = (n, n + 1)
    s = np.max(t)
    for k in range(3):
        c = c * v[k]
        n += 1
        u[k] = c
        s += np.sum(np.array(t) * v[:3]) * w[k] + np.dot(v[:3], t) + np.sum(w)
        u[:3] += t
        w = (s, c, w[0])
    return s * np.zeros(shape).size + np.sum(np.multiply(v[:2], (c, t[1])))


def picked(u, c, n):
    t = (u, u * c)
    return t[n] * (c, 2.0)[0]


def test_items_of_what_is_spelled_out():
    holds(spelled_out, U, V, 0.3)
    holds(kept, U, V, 0.3, 1)
    holds(picked, U, 0.3, 1)
    holds(picked, U, 0.3, 0)


# -- a list's name that becomes its array ---------------------------------------------------------------------------

def energies(u, c, n):
    e = [np.sum(u ** 2)]
    for _ in range(n):
        u = u * c
        e.append(np.sum(u ** 2))
    e = np.array(e)
    parts = [u * k * c for k in range(n)]
    parts = np.stack(parts)
    e = e[1:] - e[:-1]
    return e * parts[:, 0]


def test_the_name_of_a_list_becomes_its_array():
    holds(energies, U, 0.3, 3)
