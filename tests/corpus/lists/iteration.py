"""Loops and comprehensions through written lists of arrays: steps of optimisers, weights of several shapes."""
# ruff: noqa: PLW2901
from __future__ import annotations

import numpy as np

from tests.corpus import Case

X = np.array([0.3, 0.9, 0.7, 0.8, 0.2, 0.4])


def of_one_shape(x, n):
    ws, h = [x[:2].copy(), x[2:4].copy()], []
    m = [np.zeros_like(w) for w in ws]
    for _ in range(n):
        g = [2.0 * w for w in ws]
        for w, d in zip(ws, g):
            w -= 0.1 * d ** 2
        for k, (w, v) in enumerate(zip(ws, m)):
            v[:] = 0.9 * v + g[k] ** 2 * (k + 1)
            w -= 0.1 * v
        ws = [w - 0.1 * d for w, d in zip(ws, reversed(g))]
        h.append(np.sum(ws[0] * g[1]))
    return np.sum(np.array(h)) + ws[1][0] * ws[0][1]


def of_several_shapes(x, n):
    w1, b1 = np.outer(x[:2], x[2:5]), x[:2].copy()
    params = [w1, b1]
    velocities = [np.zeros_like(p) for p in params]
    for _ in range(n):
        h = np.tanh(w1 @ x[2:5] + b1)
        grads = [np.outer(h, x[2:5]), h]
        for p, v, g in zip(params, velocities, grads):
            v *= 0.9
            v -= 0.1 * g
            p += v
        for k in range(len(params)):
            params[k] *= 0.9
            velocities[k] = velocities[k] * 0.5 + params[k]
    a, b = velocities
    return np.sum(w1 * a) + b1 @ b


def of_an_arguments_parts(x, n):
    ws = [x[:2], x[2:4]]
    g = [np.sum(w) * w for w in ws]
    for k in range(len(ws)):
        ws[k][:] -= 0.1 * g[k]
        for j in range(2):
            ws[k][j] *= g[k][1 - j] * (k + n)
    ws[-1][0] *= 2.0


def of_one_array_twice(x, n):
    z = x[:2].copy()
    ws = [z, x[2:4].copy(), z]
    g, kept = [2.0 * w for w in ws], [w for w in ws]
    for w, d in zip(ws, g):
        w -= 0.1 * d ** 2
    kept[0][1] *= x[3]
    ws[0], ws[1] = ws[1], ws[0]
    for k, d in enumerate(g):
        ws[k] = ws[k] * d
        z[0] += ws[k][0] * n
    return np.sum(ws[0] * ws[2]) + z[0] * kept[2][1]


def changed_on_the_way(x, n):
    ws, s = [x[:2].copy(), x[2:4].copy()], 0.0
    for w in ws:
        ws[1] = w * 2.0
        s += np.sum(w ** 2) * n
    return s * np.sum(ws[0] * ws[1])


def changed_until_a_break(x, n):
    ws = [x[:2].copy(), x[2:4].copy()]
    for w in ws:
        ws[1] = w * 2.0
        if w[0] > 5.0:
            break
    return np.sum(ws[0] * ws[1])


def descended(x, n):
    ws = [x * 1.0, x * 2.0]
    for _ in range(n):
        g = [w * w for w in ws]
        ws = [w - 0.1 * d for w, d in zip(ws, g)]
    return np.sum(ws[0] * ws[1])


def of_numbers(x, n):
    ws, vs = [x[0] * 1.0, x[1]], [1, 2]
    for k in range(n):
        ws = [w - 0.1 * w * x[2] for w in ws]
        if k % 2:
            vs = [v * 0.5 + w for v, w in zip(reversed(vs), ws)]
    while ws[0] > 0.1:
        ws = [0.5 * ws[1] * w for w in ws]
    return ws[0] * ws[1] + vs[0] * vs[1]


def of_one_element(x, n):
    ws = [-x]
    for _ in range(n):
        ws = [np.sin(w) - ws[0] ** 2 for w in ws]
    return ws[0]


def of_rows(x, n):
    rows = x.reshape(2, 3)
    ws = [rows[0], rows[1] / 2.0, rows[0] ** 2]
    for _ in range(n):
        ws = [w * ws[1] for w in ws]
        ws[1][0] *= 2.0
    return ws[0] @ ws[1] + np.sum(ws[2])


KERNELS = [(of_one_shape, ("return",)), (of_several_shapes, ("return",)), (of_an_arguments_parts, ("x",)),
           (of_one_array_twice, ("return",)), (changed_on_the_way, ("return",)),
           (changed_until_a_break, ("return",)), (descended, ("return",)), (of_numbers, ("return",)),
           (of_one_element, ("return",)), (of_rows, ("return",))]


def bound_anew_on_the_way(x):
    ws = [x[:2].copy(), x[2:4].copy()]
    for w in ws:
        ws = [v * w for v in ws]        # the loop goes on through the old list
    return np.sum(ws[0] * ws[1])


def under_two_names(x):
    ws = [x[:2].copy(), x[2:4].copy()]
    old = ws
    ws = [2.0 * w for w in ws]
    ws[0][0] = 5.0
    return np.sum(old[0] * ws[0])


def picked_by_a_variable(x):
    ws, s = [x * 1.0, x * 2.0], 0.0
    for _ in range(3):
        ws = [w * w for w in ws]
    for k in range(x.size):
        s += ws[k % 2][0]
    return s


def appended_and_bound_anew(x):
    ws = [x]
    for _ in range(3):
        ws.append(x)
        ws = [2.0 * w for w in ws]
    return np.sum(ws[0])


def beside_one_that_grows(x, n):
    """Two numbers, and a list that has fewer of them first, and more then: the rounds are those of the shorter one."""
    h = [x[0], x[2]]
    q = []
    s = 0.0
    for k in range(n + 1):
        for a, b in zip(h, q):
            s += a * b
        q.append(s * 0.3 + x[k])
    return s


def cases():
    # derivatives
    for kernel, of in KERNELS:
        yield Case(kernel, (X.copy(), 3), ("x",), of)
    # of several types
    for kernel in (descended, of_one_element):
        for x in (X[:1].copy(), X[:0].copy(), X.astype("float32"), 0.7):
            yield Case(kernel, (x, 3), ("x",))
    for kernel in (bound_anew_on_the_way, under_two_names, appended_and_bound_anew,
                   picked_by_a_variable):
        yield Case(kernel, (X,), "x")
    yield Case(beside_one_that_grows, (X, 3), "x")
