"""What a choice does not take gets no gain, whatever the gain is: no nan where a partial behind it is infinite."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case

V = np.array([-1.0, 4.0, -0.3, 2.5])


def number(v):
    return np.sqrt(max(v, 0.0)) + v


def angle(v):
    return np.arccos(min(v, 1.0))


def array(v):
    return np.sum(np.sqrt(np.maximum(v, 0.0))) + v[0]


def clipped(v):
    return np.sum(np.sqrt(np.clip(v, 0.0, 9.0)))


def chosen(v):
    return np.sum(np.where(v > 0, v, 0.0) ** 0.5)


def selected(v):
    return np.sum(np.select([v > 2, v > 0], [v, 2 * v], 0.0) ** 0.5)


def power(v):
    return np.sum(np.fmax(v, 0.0) ** 0.6)


def greatest(v):
    return np.sum(np.sqrt(np.max(np.stack((v, np.zeros_like(v))), axis=0)))


def in_a_loop(v):
    t = 0.0
    for i in range(v.size):
        t += np.sqrt(max(v[i], 0.0)) + np.sqrt(v[i] if v[i] > 0 else 0.0)
    return t


def into_an_array(v):
    out = np.empty_like(v)
    np.maximum(v, 0.0, out=out)
    return np.sum(np.sqrt(out))


CASES = [(number, -1.0), (angle, 2.0), (array, V), (clipped, V), (chosen, V), (selected, V), (power, V), (greatest, V),
         (in_a_loop, V), (into_an_array, V)]


def cases():
    # gradients
    for kernel, argument in CASES:
        yield Case(kernel, (argument,), ("v",))
