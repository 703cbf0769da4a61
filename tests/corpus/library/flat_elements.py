"""Elements by their number in row-major order, changed in place."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case
from tests.harness.seeds import generator


def changed(m, x):
    for i in range(m.size):
        m.flat[i] *= 2.0 * i
    return np.sum(m ** 2)


def by_others(m, x):
    m.flat[3] += m.flat[2] ** 2
    m.flat[-1] -= m[0, 0]
    m.flat[m.shape[0] + 1] /= m[2, 2]
    m.flat[5] **= 2
    return np.sum(m ** 2)


def by_places(m, x):
    """Of a place that stands twice the last value is stored."""
    k = np.array([0, 5, 5])
    m.flat[k] *= x
    m.flat[k] += m[1, :3]
    return np.sum(m ** 2)


def of_a_view(m, x):
    v = m[:, ::-2]
    v.flat[1] *= 5.0
    v.flat[-1] += x[0] * v.flat[0]
    return np.sum(m ** 2 * np.arange(12.0).reshape(3, 4))


def of_one(m, x):
    v = x[:1]
    v.flat[0] *= x[1]
    v.flat[-1] -= x[0] ** 2
    return np.sum(x ** 2)


def parts(m, x):
    m.flat[1:4] = x ** 2
    m.flat[2::3] *= x[0]
    m.flat[::-1] += m[0, 1]
    v = m[1:, ::2]
    v.flat = x * x[1]           # which begin again where they end
    v.flat[1:3] = x[2]
    n = np.ones((2, 1))
    n.flat = x
    return np.sum(m ** 2 * np.arange(12.0).reshape(3, 4)) + np.sum(n)


def of_itself(m, x):
    m.flat[1:] = m.flat[:-1]
    return np.sum(m ** 2)


def cases():
    rng = generator(23)
    m, x = rng.random((3, 4)), rng.random(3)
    for kernel in (changed, by_others, by_places, of_a_view, of_one, parts):
        yield Case(kernel, (m, x), ("m", "x"))
    yield Case(changed, (m.astype("float32"), x), ("m",))
    yield Case(by_others, (m.astype("float32"), x), ("m",))
    yield Case(of_itself, (m, x), refused="S201 at `m.flat[1:] = m.flat[:-1]`: a store by number of what may share "
               "memory with the array: np.put(m, k, values) copies the values before")
