"""Options that NumPy's functions take: each is followed, or refused by its name."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case

X, Y = np.array([0.9, 0.31, 1.4, 0.55, 1.13]), np.array([0.7, 1.1, 0.8, 1.4, 1.3])
M = np.arange(1.0, 10.0).reshape(3, 3) / 5.0


def left_where_it_is(x, y, m):
    v = np.nan_to_num(x, copy=False)
    v[0] = y[0]
    w = np.nan_to_num(m[1], False, 2.0)
    w[0] *= y[1]
    np.nan_to_num(m[0], copy=False)
    y = np.nan_to_num(y[1:4], copy=False)
    y[0] += x[2]
    return np.sum(x ** 2) + np.sum(m ** 2) * np.sum(np.nan_to_num(y, copy=False))


def left_or_made(x, y, m):
    picked = np.nan_to_num(x[x > 0.6], copy=False)
    picked[0] = y[0]
    made = np.nan_to_num(x * y[0], copy=False)
    made[1] = y[1]
    cleaned(x)
    return np.sum(x ** 2) * np.sum(picked) + np.sum(made ** 2) + np.sum(m)


def cleaned(x):
    np.nan_to_num(x, copy=False, posinf=3.0)
    x[0] *= 2.0


def sums_of_some(x, y, m):
    some, wide = m > 0.65, m[:, 0:1] > 0.65
    total = np.sum(np.sum(m ** 2, axis=0, where=some) ** 2) + np.sum(m, where=wide) * x.sum(where=x > 1.0, initial=2)
    total += np.prod(x, where=x > 0.5)
    total += np.sum(x ** 2, dtype=np.float64) * np.mean(y, dtype=float) + np.sum(np.cumsum(x, dtype=np.float64) * y)
    return total + x[0].item() * np.sum(y).item() * x[2:3].item() * m.item(1, 2) * m.item((0, 1)) * y.item(3)


def turned_and_converted(x, y, m):
    stack = np.zeros((2, 3, 3))
    stack[0], stack[1] = m, m * y[0]
    total = np.sum(stack.mT[1, 0] ** 2) + np.sum(np.permute_dims(stack, (2, 0, 1))[0] ** 2) + np.sum(m.mT[0] * x[:3])
    total += np.sum(np.einsum("ii->i", m) ** 2) * np.einsum("ii", m) + np.sum(np.einsum("ii,i->i", m, x[:3]) ** 2)
    total += np.sum(x.astype(float, copy=False) ** 2) * np.sum(y.astype(np.float64, copy=True))
    kept = m.copy("F")
    kept[0] = x[:3]
    return total + np.sum(kept * m)


def added_at(x, y, m):
    z = x * 1.0
    np.add.at(z, x > 0.6, 2.0 * x[0])
    np.multiply.at(z, y > 1.0, y[y > 1.0] ** 2)
    np.maximum.at(z, y > 1.0, 1.5)
    np.add.at(z, [0, 0, 1], x[:3])
    np.subtract.at(z, [4, 0, 4], [x[0], 2.0, y[1]])
    np.add.at(m, ([0, 0, 1], [1, 1, 2]), x[1:4])
    np.add.at(z, 2, x[0])
    return np.sum(z ** 2) + np.sum(m ** 3)


def pythons_own(x, y, m):
    q, r = divmod(7, 4)
    total = q * x[0] + r * x[1]
    for k in range(-3, 5):
        i, j = divmod(k, 3)
        total += m[i, j] * x[j]
    f, g = divmod(x[2] * 4.0, 1.0)
    total += f * g * x[2]
    if any(v > 1.2 for v in x):
        total += np.sum(x ** 2)
    if all(y[k] > 0.0 for k in range(5)):
        total *= y[0]
    if any([x[0] > 9.0, y[0] < 3.0]) and not any(x > 7.0):  # noqa: C419
        total *= y[1]
    total += max(v * v for v in x) * min(x[k] * m[k, 0] for k in range(3)) + max([v * 2.0 for v in y])
    seen = [x[0]]
    for k in range(4):
        seen.append(np.sin(seen[k]) * y[k])
    for k in range(4):
        total += seen[k] * seen[k - 1]
    return total


def by_a_flag(x, y):
    v = np.nan_to_num(x, copy=y[0] > 0.0)
    v[0] = y[0]
    return np.sum(x ** 2)


def mean_of_some(x, y):
    return np.mean(x, where=x > 1.0) * y[0]


def one_place(x, y):
    k = np.unravel_index(np.argmax(x), x.shape)
    return x[k] * y[k]


def cases():
    for kernel in [left_where_it_is, left_or_made, sums_of_some, turned_and_converted, added_at, pythons_own]:
        yield Case(kernel, (X, Y, M), ("x", "y", "m"))
    for kernel in (mean_of_some, one_place):
        yield Case(kernel, (X, Y), ("x", "y"))
    yield Case(by_a_flag, (X, Y), "x", refused=(
        "S301 at `np.nan_to_num(x, copy=y[0] > 0.0)`: no derivative rule for numpy.nan_to_num with copy= that is not "
        "written out: write it as a loop over the elements"))
