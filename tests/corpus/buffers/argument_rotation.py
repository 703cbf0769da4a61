"""Arguments that are given other names, which then take turns with their arrays."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case

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


def sizes(u, v, n):
    a, b = u, v
    total = 0.0
    for _ in range(n):
        b[1] = a[0] * u.size
        total += b[1] * v.size
        a, b = b, a
    return total


def cases():
    for turns in [0, 1, 2, 3]:
        for kernel in KERNELS:
            left = (U.copy(), V.copy())
            kernel(*left, turns)
            of = [n for n, a, b in zip("uv", left, (U, V)) if not np.array_equal(a, b)]
            yield Case(kernel, (U, V, turns), ("u", "v"), (*of, "return"))
    # short and single
    yield Case(two, (U.astype(np.float32), V.astype(np.float32), 3), ("u", "v"), ("u", "v", "return"))
    yield Case(two, (U[:2], V[:2], 3), ("u", "v"))
    # two sizes
    yield Case(sizes, (U, V[:4], 2), refused=(
        "S501 at `a, b = b, a`: 'u' may change its size from one iteration to the next: u_own.shape is (5,), "
        "v_own.shape is (4,)"))
    # an argument that is read again is refused
    yield Case(one_behind_the_other, (U, V, 2), refused=(
        "S201 at `b[:] = a * b + u[0] if n > 9 else a * b + 0.5`: an array is written that another name may stand "
        "for here, as it did before a loop or branch bound it anew: bind the name to a copy before the loop or "
        "branch: u = u.copy(); where names swap in a branch, swap what their arrays hold\nS201 at `b += 0.5`: an "
        "array is written that another name may stand for here, as it did before a loop or branch bound it anew: "
        "bind the name to a copy before the loop or branch: u = u.copy(); where names swap in a branch, swap what "
        "their arrays hold"))
