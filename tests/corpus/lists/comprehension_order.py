"""Comprehensions whose items are calls that write run where Python runs them: after what stands to their left."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case


def bump(v):
    v[0] += 1.0
    return v[0] * 2.0


def marked(p, k):
    p[0] = k
    return k


def moved_on(p):
    p[0] += 1
    return p[0]


# -- x: (3,), p: integers (3,), a: (4, 3) ----------------------------------------------------------------------------

def beside_operands(x, p, a):
    s = x[0] * sum([bump(x) for k in range(3)])
    s += x[0] * max([bump(x) for k in range(2)]) + x[0] * np.sum(np.array([bump(x) for k in range(2)]))
    y = np.array([x[0], sum(bump(x) for k in range(2)), x[0]])
    return s + y[0] * y[1] * y[2] + np.sum(x[:2] * sum(bump(x) for k in range(2)))


def updated(x, p, a):
    x[0] *= sum(bump(x) for k in range(3))
    x[p[0]] += sum(marked(p, k) * x[k] for k in range(3))
    a[1] *= sum(bump(a[k]) for k in range(2))
    return x[0] + 2 * x[1] * x[2] + np.sum(a)


def in_lists(x, p, a):
    u, v = x[0], sum([bump(x) for k in range(3)])
    us = [x[0], sum(bump(x) for k in range(2))]
    us.append(us[0] * x[0] * sum(bump(x) for k in range(2)))
    us[1] *= sum(us[k] * bump(x) for k in range(2))
    return u * v + us[0] * us[1] * us[2] * x[0]


def in_tests(x, p, a):
    if x[0] * sum(bump(x) for k in range(2)) > 8.0:
        return x[0] * x[1]
    return x[0]


def within_others(x, p, a):
    us = [x[0] * sum(bump(x) for k in range(2)) for j in range(2)]
    vs = [v for v in [bump(x) for j in range(2)]]
    t = sum(bump(x) * sum(x[k] for k in range(3)) for j in range(2))
    t += sum(v * x[0] for k in range(2) for v in [bump(x) for j in range(k + 1)] if sum([x[j] for j in range(2)]) < 30)
    return us[0] * us[1] + vs[0] * vs[1] + t


def of_rows(x, p, a):
    s = a[1, 0] * sum(bump(r) * q for r, q in zip(a, a[0]))
    return s + np.sum(a[0, 1:] * sum(bump(r) for r in a)) + a[2, 0] * sum(bump(r) for r in a)


def arguments():
    return (np.array([0.7, 1.2, 0.4]), np.array([0, 1, 2]),
            np.array([[0.9, 0.31, 1.4], [0.55, 1.13, 0.7], [0.2, 0.4, 1.7], [0.8, 1.2, 0.6]]))


def place_by_a_call(x, p, a):
    x[moved_on(p)] += sum(bump(x) * x[k] for k in range(3))
    return x[0]


def cases():
    for kernel in (beside_operands, updated, in_lists, in_tests, within_others, of_rows):
        yield Case(kernel, arguments(), ("x", "a"))
    yield Case(place_by_a_call, arguments(), ("x",), ("x", "return"))
