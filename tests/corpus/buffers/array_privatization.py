"""Names that are written and then bound to another array, while an argument, or another name, keeps the first one."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case

U = np.array([0.3, 0.9, 0.7, 0.8, 0.2])
V = np.array([0.5, 0.1, 0.6, 0.4, 0.7])


def boundary_values(u, nu, n):
    for _ in range(n):
        u[0] = 0.5 * u[1]
        u[-1] = u[-2]
        u = u + nu * (np.roll(u, 1) - 2.0 * u + np.roll(u, -1))
    return np.sum(u ** 2)


def advanced(u, nu, n):
    for _ in range(n):
        u[0] = 0.5 * u[1]
        u = u + nu * (np.roll(u, 1) - 2.0 * u + np.roll(u, -1))
    return u


def of_a_helper(u, nu, n):
    """What the helper stored before its first step is there behind it, and no more."""
    w = advanced(u, nu, n) ** 2
    return np.sum(w) + u[0] * u[2]


def kept_by_a_helper(v):
    total = 0.0
    for k in range(3):
        v[k] *= 1.5
        v = v * 0.7
        total += v[k] ** 2
    return total


def rows_of_an_argument(a, n):
    s = 0.0
    for k in range(n):
        s += kept_by_a_helper(a[k])
    return s + a[1, 0] * a[0, 1]


def in_a_branch(u, c):
    u[1] *= 2.0
    if c > 0.5:
        u = u * c
    u[0] = 3.0 * u[1]
    return np.sum(u ** 2)


def at_times(u, n, m):
    s = 0.0
    for _ in range(n):
        for j in range(m):
            u[j] = u[j] * 1.3
            if u[j] > 1.0:
                u = u * 0.5
        s += np.sum(u ** 3)
    return s


def smaller(u, n):
    for _ in range(n):
        u[1] = u[1] * u[0]
        u = 0.5 * (u[1:] + u[:-1])
    return np.sum(u ** 2)


def until(u, tolerance):
    while np.max(u) > tolerance:
        u[0] = 0.9 * u[0]
        if u[0] < 0.1:
            break
        u = 0.8 * u + 0.01 * u[::-1]
    return np.sum(u ** 2)


def both(u, v, n):
    for _ in range(n):
        u[0] = v[1] * u[0]
        w = u * v
        u = w
        v = v * 0.9
        v[1] = u[0]
    return np.sum(u ** 2) + np.sum(v)


def another_name_of_this_round(u, n):
    """The means are written where the angles are, as in much published code."""
    for _ in range(n):
        mean = u
        for b in range(u.size):
            mean[b] = np.sum(np.cos(u[u < u[b] + 0.3]))
        u = mean + 0.1 * np.sin(u)
    return np.sum(u * np.cos(u))


def put_back_first(u, n):
    """What the caller's array held is read by nothing but what leaves it: it must be there all the same."""
    for k in range(n):
        u[k] = u[k] * u[k + 1]
        u = np.exp(-u)
    return u[0]


def bound_to_itself(u, n):
    """The name is bound, and keeps the caller's array."""
    s = 0.0
    for _ in range(n):
        u = u  # noqa: PLW0127
        z = u
        z = np.cos(u)
        s += np.sum(z)
    u[1] = u[1] * np.sin(u[1])
    return s + np.sum(u ** 2)


def bound_to_another_name_of_it(u, n):
    for k in range(n):
        w = u
        w[k] = w[k] * w[k + 1]
        if w[k] > 0.5:
            w = w * 0.5
        u = w
    return np.sum(u ** 2)


def moved(x):
    x[1] = 0.9 * x[0]
    if x[1] > 0.4:
        x = x * 0.8
    return x


def written_later(u, n):
    """What the helper gave may be the argument itself, into which is written behind the loop."""
    for _ in range(n):
        w = moved(u)
        u *= 0.9
    u[3] = w[3] * 0.5
    return np.sum(u * w)


def seen_by_a_view(u, n):
    v = u[1:]
    for _ in range(n):
        u[1] = u[1] * u[0]
        u = u * 0.5
    return np.sum(v ** 2) + u[0]


def seen_by_the_older_name(u, n):
    w = np.sin(u)
    a = w
    for k in range(n):
        a[k] = a[k] * a[k + 1]
        a = a * w[0]
    return np.sum(a)


def bound_to_another_argument(u, v, n):
    for _ in range(n):
        u[1] = u[1] * u[0]
        u = v
    return np.sum(u)


ALIAS = ("an array is written that another name may stand for here, as it did before a loop or branch "
         "bound it anew: bind the name to a copy before the loop or branch: u = u.copy(); where names swap in a "
         "branch, swap what their arrays hold")


def cases():
    for n in (0, 1, 3):
        yield Case(boundary_values, (U, 0.2, n), ("u", "nu") if n else ("u",), ("return", "u") if n else ("return",))
        yield Case(of_a_helper, (U, 0.2, n), ("u", "nu") if n else ("u",), ("return", "u") if n else ("return",))
    yield Case(rows_of_an_argument, (np.outer(U, V), 2), ("a",), ("return", "a"))
    yield Case(in_a_branch, (U, 0.7), ("u", "c"), ("return", "u"))
    yield Case(in_a_branch, (U, 0.3), ("u",), ("return", "u"))
    yield Case(at_times, (U, 3, 4), ("u",), ("return", "u"))
    yield Case(smaller, (U, 3), ("u",), ("return", "u"))
    yield Case(until, (U, 0.2), ("u",), ("return", "u"))
    yield Case(until, (U.astype(np.float32), 0.2), ("u",), ("return", "u"))
    yield Case(both, (U, V, 3), ("u", "v"), ("return", "u", "v"))
    yield Case(another_name_of_this_round, (U, 2), ("u",), ("return", "u"))
    yield Case(bound_to_itself, (U, 3), ("u",), ("return", "u"))
    yield Case(put_back_first, (U, 3), ("u",), ("return", "u"))
    for kernel, given, store in ((bound_to_another_name_of_it, (U, 3), "w[k] = w[k] * w[k + 1]"),
                                 (seen_by_a_view, (U, 3), "u[1] = u[1] * u[0]"),
                                 (bound_to_another_argument, (U, V, 3), "u[1] = u[1] * u[0]")):
        yield Case(kernel, given, refused=f"S201 at `{store}`: {ALIAS}")
    yield Case(seen_by_the_older_name, (U, 3), ("u",))
    yield Case(written_later, (U, 3), refused=(
        f"S201 at `u *= 0.9`: {ALIAS}\nS201 at `u[3] = w[3] * 0.5`: {ALIAS}"))
