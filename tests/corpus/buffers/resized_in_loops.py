"""Arrays that a loop carries and that change their size from one iteration to the next."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case

X = np.array([1.3, 2.2, 0.7, 0.4, 1.1])


def size_from_before(x):
    V = x * 1.0
    n = len(V)
    w = np.zeros(n)
    for i in range(3):
        V = V[1:] * x[i]
        w[:len(V)] += V
    u = np.ones(n) * x[0]
    return np.sum(w * u) + V.sum()


def size_of_an_earlier_iteration(x):
    V = x * 1.0
    n = 0
    for i in range(3):
        n = V.shape[0]
        V = V[1:] * x[i]
    w = np.zeros(n) + x[1]
    return np.sum(w[:V.shape[0]] * V) + n * x[0]


def elements_of_each(x):
    V = x * 1.0
    s = 0.0
    while len(V) > 1:
        for j in range(len(V)-1):
            V[j] = V[j] * V[j + 1]
            s += np.sin(V[j]) * x[0]
        V = V[:-1].copy()
    return s + V[0]


def grows_or_shrinks(x):
    V = x * 1.0
    for k in range(4):
        if x[k] > 0.9:
            V = np.append(V, x[k] * V[0])
        else:
            V = V[:-1] * V[1:]
    return V.sum()


def two_that_follow(x):
    a = x * 1.0
    b = x[:2] * 2.0
    for k in range(3):
        a, b = np.concatenate((b, a[:1] * x[k])), a
    return a.sum() + (b * b).sum()


def old_in_the_iteration(x):
    V = x * 1.0
    s = 0.0
    for k in range(3):
        old = V
        V = V[1:] * V[:-1]
        s = s + np.sum(old) * x[k]
    return s + V.sum()


def old_after_the_loop(x):
    V = x * 1.0
    old = V
    for _k in range(3):
        old = V
        V = V[1:] * V[:-1]
    return old.sum() * V.sum()


def views(x):
    V = x * 1.0
    for _k in range(3):
        V = V[1:]
    return V.sum() * V[0]


def parameter(x):
    for _k in range(3):
        x = x[1:] * x[:-1]
    return x.sum()


def nested(x):
    s = 0.0
    for k in range(3):
        V = x * (k + 1.0)
        for _i in range(2):
            V = V[1:] * V[:-1]
        s += V.sum()
    return s


def carried_by_both_loops(x):
    V = x * 1.0
    s = 0.0
    for k in range(2):
        for _i in range(2):
            V = 0.5 * (V[1:] + V[:-1] * V[1:])
            s += V[0]
        V = np.append(V, s * x[k])
        V = np.append(V, s * x[k + 1])
    return s + V.sum()


def leaves(x):
    V = x * 1.0
    for k in range(9):
        if len(V) < 2:
            break
        if k == 1:
            continue
        V = V[1:] * V[:-1]
    return V.sum() * len(V)


def schur_complements(x):
    A = np.outer(x, x)
    while A.shape[0] > 1:
        A = A[1:, 1:] - np.outer(A[1:, 0], A[0, 1:]) / (A[0, 0] + 3.0)
    return A[0, 0]


def coarser_grids(x):
    u = np.sin(np.outer(x[:4], x[:4]))
    s = 0.0
    while u.shape[0] > 1:
        s += (u**2).sum()
        u = 0.25 * (u[::2, ::2] + u[1::2, ::2] + u[::2, 1::2] + u[1::2, 1::2])
    return s * u[0,0]


def written_in_place(x):
    V = x * 1.0
    for _k in range(3):
        V = V[1:].copy()
        V[0] *= V[1] + x[0]
        V += 0.5
    return (V * V).sum()


def returns_early(x):
    V = x * 1.0
    for _k in range(4):
        V = V[1:] * V[:-1]
        if V.size == 2:
            return V.sum() * x[0]
    return V.sum()


def coarse(u):
    return 0.5 * (u[:-1] + u[1:]) * u[0]


def helper(x):
    u = x * 2.0
    while len(u) > 2:
        u = coarse(u)
    return u.sum()


def active_set(x):
    p = x.copy()
    t = 0.0
    for k in range(3):
        p = p[p > 0.2 * (k + 1)]
        p = p * 0.7
        t += p.sum() * x[0]
    return t


def queue(x):
    todo = np.array([0])
    s = 0.0
    while todo.size > 0:
        i = todo[0]
        todo = todo[1:]
        s += x[i]**2 * (i + 1)
        if i + 2 < 5:
            todo = np.append(todo, i + 2)
    return s


def sizes_as_numbers(x):
    V = x * 1.0
    s = 0.0
    for _k in range(3):
        n = len(V)
        s += V.sum() / n * x[0]
        V = V[1:]
        s += V.mean() * n
    return s


def binomial_tree(x):
    values = np.maximum(x[0] * 1.1 ** np.arange(-5, 6, 2.0) - 1.0, 0.0)
    for _ in range(5):
        values = x[1] * (0.4 * values[1:] + 0.6 * values[:-1]) * x[2]
    return values[0]


def history(x):
    kept = np.array([x[0]])
    v = x[0]
    while v < 30.0:
        v = v * 1.7 + x[1]
        kept = np.append(kept, v)
    return kept.sum() * kept[-1]


def rows(x):
    kept = x[None, :].copy()
    for _ in range(4):
        kept = np.vstack((kept, kept[-1] * x[0]))
    return kept.sum()


def wavefront(x):
    at, s, k = np.arange(5), 0.0, 0
    while len(at) > 0:
        s = s + np.sum(x[at] ** 2)
        at = at[x[at] < 2.0 - k]
        k += 1
    return s


def cases():
    for kernel in (size_from_before, size_of_an_earlier_iteration, elements_of_each, grows_or_shrinks,
                   two_that_follow, old_in_the_iteration, old_after_the_loop, views, parameter, nested,
                   carried_by_both_loops, leaves, schur_complements, coarser_grids, written_in_place,
                   returns_early, helper, active_set, queue, sizes_as_numbers, binomial_tree, history, rows,
                   wavefront):
        yield Case(kernel, (X,), "x")
