"""Names that a branch binds to an array on one side and to a number, or an array of more axes, on the other."""
import numpy as np

from tests.corpus import Case


def switched_source(u, a, t):
    for k in range(4):
        if 0.1 * k < t:
            f = 0.0
        else:
            f = a * u
        u = u + 0.1 * f
    return np.sum(u ** 2)


def what_is_computed_of_it(u, a, t):
    f = 0.0 if t > 0.3 else np.sin(u)
    g = a * f
    h = g + 1.0
    u = u * h
    return np.sum(u ** 2 * h), a * np.sum(h)


def branch_in_branch(u, a, t):
    f = 0
    if a > t:
        f = u * a
    elif a > 0.1:
        f = u[0]
    s = np.sum(f * u)
    return s + np.sum(f)


def left_in_what_follows(u, a, t):
    total = 0.0
    for k in range(5):
        d = u[1:] - u[:-1] if k > 2 * t else a
        if np.max(d) > 0.39:
            break
        total += np.sum(d ** 2) * k
        u = u * 0.9
    return total + np.sum(u)


def of_more_axes(u, a, t):
    f = np.outer(u, u) if a > t else u
    r = np.sum(f, axis=0)
    return np.sum(a * r ** 2) if a > t else np.sum(r * a)


def damped(u, a, on):
    damping = a * u if a > 0.0 else 0.0
    source = np.sin(u) if on else 0.0
    return source - damping


def in_helpers(u, a, t):
    for k in range(4):
        u = u + t * damped(u, a - 0.3 * k, k % 2 == 0)
    return np.sum(u ** 2)


def other_name_of_the_argument(u, a, t):
    w = u
    if a > t:
        w = 2.0 * a
    w *= 3.0
    return np.sum(w * u)


def alias_that_is_written(u, a, t):
    v = np.zeros(3)
    f = 0.0
    if a > t:
        f = v
    v[0] = 5.0 * a
    g = f + u
    v[1] = a
    return np.sum(g ** 2) + np.sum(f * u)


def loop_in_what_follows(u, a, t):
    for _ in range(3):
        f = a * u if u[0] > t else a
        while np.sum(u) < 5.0:
            u = u + np.abs(f) + 0.2
        u = u - f
    return np.sum(u * u)


def carried_to_the_next_round(u, a, t):
    f = a
    for k in range(3):
        if k > 3 * t:
            f = u * a
        u = u + f
    return np.sum(u)


def cases():
    u = np.array([0.3, 0.7, 0.9])
    for kernel in (switched_source, what_is_computed_of_it, branch_in_branch, left_in_what_follows, of_more_axes,
                   in_helpers, other_name_of_the_argument, alias_that_is_written, loop_in_what_follows):
        for a, t in ((0.4, 0.2), (0.4, 0.45), (0.05, 0.15)):
            yield Case(kernel, (u, a, t), ("u", "a"))
    yield Case(carried_to_the_next_round, (u, 0.4, 0.2), ("u", "a"), refused=(
        "S203 at `f = u * a`: 'f' is bound to float64 and to float64[:]: start with an array: "
        "np.zeros_like(...); or give the second one another name"))
