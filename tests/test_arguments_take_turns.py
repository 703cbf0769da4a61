"""Arguments that are given other names, which then take turns with their arrays."""
from __future__ import annotations

import numpy as np
import pytest

import s2sad
from tests.derivatives import check_derivatives
from tests.engines import each

U = np.array([0.3, 0.9, 0.7, 0.8, 0.2])
V = np.array([0.5, 0.1, 0.6, 0.4, 0.7])


def smoothed(b, a):
    b[1:-1] = a[1:-1] + 0.1 * (a[2:] - 2.0 * a[1:-1] ** 2 + a[:-2])


def two(u, v, n):
    a, b = u, v
    for _ in range(n):
        smoothed(b, a)
        a, b = b, a
    return np.sum(a ** 2) + b[1]


def one_of_its_own(u, v, n):
    a = u
    b = v * 2.0
    for k in range(n):
        b[1:] = a[:-1] * b[1:] + k
        a, b = b, a
    return np.sum(a * v)


def three(u, v, n):
    old, now = u, v
    new = np.zeros_like(v)
    for _ in range(n):
        for i in range(1, u.size - 1):
            new[i] = 2.0 * now[i] - old[i] + 0.1 * (now[i + 1] * now[i] - 2.0 * now[i] + now[i - 1])
        old, now, new = now, new, old
    return np.sum(now * new)


def one_behind_the_other(u, v, n):
    """What has another name before, and is changed by it."""
    a = u
    a *= 1.5
    b = v
    for _ in range(n):
        b[:] = a * b + u[0] if n > 9 else a * b + 0.5
        a, b = b, a
    b += 0.5
    return np.sum(a ** 2)


def in_a_helper(u, v, n):
    r = two(u, v, n)
    return r * u[2] + v[1]


KERNELS = (two, one_of_its_own, three, in_a_helper)


@pytest.mark.parametrize("turns", [0, 1, 2, 3])
@pytest.mark.parametrize(("kernel", "engine"), each(KERNELS))
def test_derivatives(kernel, engine, turns):
    left = U.copy(), V.copy()
    kernel(*left, turns)
    of = [n for n, a, b in zip("uv", left, (U, V)) if not np.array_equal(a, b)]
    check_derivatives(kernel, (U, V, turns), ("u", "v"), (*of, "return"), engine)


def test_short_and_single():
    check_derivatives(two, (U.astype(np.float32), V.astype(np.float32), 3), ("u", "v"), ("u", "v", "return"))
    check_derivatives(two, (U[:2], V[:2], 3), ("u", "v"), ("return",), "loops")


def test_two_sizes():
    with pytest.raises(s2sad.S2sadError):
        s2sad.gradient(s2sad.differentiate(sizes, engine="numpy"))(U, V[:4], 2)


def sizes(u, v, n):
    a, b = u, v
    total = 0.0
    for _ in range(n):
        b[1] = a[0] * u.size
        total += b[1] * v.size
        a, b = b, a
    return total


def test_an_argument_that_is_read_again_is_refused():
    with pytest.raises(s2sad.S2sadError) as refused:
        s2sad.gradient(one_behind_the_other)(U, V, 2)
    assert "an array is written that another name may stand for here" in str(refused.value)
