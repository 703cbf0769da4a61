"""Written lists of arrays, and of numbers, of which a variable picks the one that is read or written."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case

X = np.array([0.3, 0.9, 0.7, 0.8, 0.2, 0.4])


def in_turn(x, n):
    m = [np.zeros_like(x), np.zeros_like(x)]
    for t in range(n):
        m[t % 2][:] = 0.5 * m[(t + 1) % 2] + x ** 2
        m[t % 2][0] += m[t % 2 - 1][1] ** 2
    bufs = (x[:3].copy(), x[3:].copy())
    k = 0
    for _ in range(n):
        w = bufs[k]
        w[1:] *= bufs[1 - k][:-1]
        bufs[k][0] *= 1.5
        k = 1 - k
    return np.sum(m[0] * m[1]) + bufs[0] @ bufs[1]


def under_names(u, n):
    for k in range(2):
        bufs = [np.outer(u, u), np.zeros((u.size, u.size))]
        for t in range(n):
            cur, new = bufs[t % 2], bufs[1 - t % 2]
            new[1:-1, 1:-1] = 0.25 * (cur[:-2, 1:-1] + cur[2:, 1:-1] ** 2 + cur[1:-1, 2:] * k)
        u[k] += np.sum(bufs[n % 2] ** 2)
    old = bufs[0]
    for t in range(n):
        new = bufs[(t + 1) % 2]
        new[0] = old[1] ** 2 + u
        old = new
    return old, bufs[n % 2]


def moved(v, w):
    v[0] += w[1] ** 2
    return v[1]


def given_to_helpers(x, n):
    m, s = [x.copy(), x * 2.0, x ** 2], 0.0
    for t in range(n):
        s += moved(m[(t + 1) % 3], m[t % 3]) + moved(m[t % 3], m[(t - 1) % 3])
        k = t % 2
        s += moved(m[k], m[1 - k]) + moved(m[k], m[k]) * moved(m[k], x)
    return s + m[0] @ m[1] + m[2][0]


def put_anew(x, n):
    m = [None, None]
    m[0] = x.copy()
    m[1] = x ** 2
    for t in range(n):
        m[t % 2] = 0.5 * m[(t + 1) % 2] + x[t]
    s = 0.0
    for v in m:
        v[0] *= 3.0
        s += np.sum(v ** 2)
    w = [0.0, x[0], 2]
    for t in range(n):
        w[t % 2] += w[1 - t % 2] * x[t]
    return s * w[0] * w[1] * w[2]


def read_alone(x, n):
    m, s = [x[:3], x[3:]], 0.0
    for t in range(n):
        s += np.sum(m[t % 2] * x[t])
    return s


def made_element_by_element(x, n):
    low, high = np.clip(np.tanh(x), 0.1, 0.6), np.square(x)
    m = [low, high]
    for t in range(n):
        m[(t + 1) % 2][0] = 0.5 * m[t % 2][1] * m[t % 2][2]
    return m[0][0] + m[1][0] * m[1][1]


KERNELS = [(made_element_by_element, "x", ("return",)), (in_turn, "x", ("return",)),
           (under_names, "u", ("u", "return")), (given_to_helpers, "x", ("return",)),
           (put_anew, "x", ("return",)), (read_alone, "x", ("return",))]


def put_anew_of_one(x, n):
    m = [x.copy(), x * 2.0]
    for t in range(n):
        m[t % 2] += x
        m[t % 2] = m[1 - t % 2] * m[t % 2]
    return m[0] @ m[1]


def under_its_own_name(x, n):
    z = np.zeros_like(x)
    m = [z, x.copy()]
    for t in range(n):
        m[t % 2][:] = 0.5 * m[(t + 1) % 2] + x ** 2
        z[0] = 3.0 * x[1]
    return np.sum(m[0] * m[1]) + z[1]


def twice(x, n):
    z = x.copy()
    m = [z, z]
    for t in range(n):
        m[t % 2][:] = 0.5 * m[(t + 1) % 2] + x ** 2
    return np.sum(m[0] * m[1])


def parts_of_arguments(x, n):
    m = [x[:3], x[3:]]
    for t in range(n):
        m[t % 2][:] = m[1 - t % 2] * 1.5


def argument_written(x, n):
    m, s = [x[:3], x[3:]], 0.0
    for t in range(n):
        x[t] += 0.1 * x[0]
        s += np.sum(m[t % 2] * x[t])
    return s


def in_two_lists(x, n):
    a, b = x.copy(), x * 2.0
    m, w = [a, b], [b, a]
    for t in range(n):
        m[t % 2][0] += w[t % 2][1] ** 2
    return np.sum(m[0] * m[1] ** 2)


def in_a_list_twice(x, n):
    m = [x.copy(), x * 2.0]
    w = [m, m]
    for t in range(n):
        w[t % 2][0][0] += 2.0 * x[1]
    return np.sum(m[0] * m[1] ** 2)


def kept_and_put_anew(x, n):
    m = [np.zeros_like(x), x.copy()]
    for t in range(n):
        w = m[t % 2]
        m[t % 2] = 0.5 * m[(t + 1) % 2] + x ** 2
        w[0] = 5.0
    return np.sum(m[0] * m[1])


def one_becomes_the_other(x, n):
    m, k = [np.zeros_like(x), x.copy()], n % 2
    m[k] = m[1 - k]
    m[k][0] = x[1] ** 2
    return np.sum(m[0] * m[1] ** 2)


def swapped(x, n):
    m = [np.zeros_like(x), x.copy()]
    for t in range(n):
        m[t % 2], m[1 - t % 2] = m[1 - t % 2], m[t % 2]
        m[t % 2][0] += x[1] ** 2
    return np.sum(m[0] * m[1] ** 2)


def becomes_an_argument(x, n):
    m, k = [np.zeros_like(x), x.copy()], n % 2
    m[k] = x
    m[k][0] = x[1] ** 2
    return np.sum(m[0] * m[1] ** 2)


def of_one_element(x, n):
    m = [x.copy(), np.zeros(1)]
    for t in range(n):
        m[t % 2][:] += 2.0 * x[1]
    return np.sum(m[0]) * np.sum(m[1] ** 2)


def row_of_one_element(x, n):
    us, s = [x * 2.0], 0.0
    for t in range(n):
        us.append(x[:1] * t)
    for u in us:
        s += np.sum(u)
    return s


def number_for_a_row(x, n):
    m = [x * (k + 1.0) for k in range(2)]
    for t in range(n):
        m[t % 2] = x[0] * t
    return np.sum(m[0]) * np.sum(m[1] ** 2)


def of_other_rank(x, n):
    m = [np.zeros((2, 6)), np.zeros(6)]
    for t in range(n):
        m[t % 2][:] += x
    return np.sum(m[0]) * np.sum(m[1] ** 2)


def integers_written(x, n):
    m = [x.copy(), np.zeros(6, dtype=np.int64)]
    for t in range(n):
        m[t % 2][0] = 2.5
    return np.sum(m[0]) * np.sum(m[1] ** 2)


def singles(x, n):
    m = [x.copy(), np.zeros(6, dtype=np.float32)]
    return np.sum(m[n % 2])


def not_known_to_differ(x, n):
    m, s = [x.copy(), x * 2.0, x ** 2], 0.0
    for t in range(n):
        s += moved(m[(t + 2) % 3], m[(t - 1) % 3])
    return s + m[0] @ m[1]


def of_two_sizes(x, n):
    m = [x[:n].copy(), x.copy()]
    return np.sum(m[n % 2])


def of_two_shapes(x, n):
    """Written out: each element is a name."""
    m, s = [x[:3].copy(), x.copy()], 0.0
    m[1][1:] *= 2.0
    for w in m:
        s += np.sum(w ** 2)
    return s * n


def cases():
    # derivatives
    for kernel, wrt, of in KERNELS:
        yield Case(kernel, (X.copy(), 4), (wrt,), of)
    yield Case(in_a_list_twice, (X.copy(), 4), "x")
    # one element in each
    yield Case(put_anew_of_one, (X[:1], 3), ("x",))
    yield Case(not_known_to_differ, (X, 4), "x")
    # arrays that become others, and of two dtypes
    for n in (3, 4):
        yield Case(one_becomes_the_other, (X, n), ("x",))
        yield Case(becomes_an_argument, (X, n), ("x",), ("x", "return"))
        yield Case(singles, (X, n), ("x",))
    # refused
    for kernel, refused in (
            (under_its_own_name,
             "S201 at `m = [z, x.copy()]`: a list holds an array that is written, not a copy of it: append a "
             "copy: .append(x.copy())"),
            (twice,
             "S201 at `m[t % 2][:] = 0.5 * m[(t + 1) % 2] + x ** 2`: the list 'm' holds views of an array, or "
             "one array several times, and what it holds is written: append a copy: .append(x.copy())"),
            (parts_of_arguments,
             "S201 at `m[t % 2][:] = m[1 - t % 2] * 1.5`: the list 'm' holds views of an array, or one array "
             "several times, and what it holds is written: append a copy: .append(x.copy())"),
            (argument_written,
             "S201 at `m, s = [x[:3], x[3:]], 0.0`: a list holds an array that is written, not a copy of it: "
             "append a copy: .append(x.copy())"),
            (in_two_lists,
             "S201 at `m[t % 2][0] += w[t % 2][1] ** 2`: the list 'm' holds views of an array, or one array "
             "several times, and what it holds is written: append a copy: .append(x.copy())"),
            (kept_and_put_anew,
             "S201 at `m[t % 2] = 0.5 * m[(t + 1) % 2] + x ** 2`: an element of the list 'm' becomes another "
             "array, and what it was is read later: name a copy of what it was: x = xs[k].copy()"),
            (swapped,
             "S201 at `m[t % 2], m[1 - t % 2] = m[1 - t % 2], m[t % 2]`: a list holds an array that is written, "
             "not a copy of it: append a copy: .append(x.copy())"),
            (of_one_element,
             "S201 at `m = [x.copy(), np.zeros(1)]`: an array of another size than the others is put into a "
             "list: give arrays of different sizes different names"),
            (row_of_one_element,
             "S201 at `us.append(x[:1] * t)`: an array of another size than the others is put into a list: give "
             "arrays of different sizes different names"),
            (number_for_a_row,
             "S201 at `m[t % 2] = x[0] * t`: the list 'm' holds arrays of several numbers of axes: give them "
             "names of their own, or make an array of each that is like the others"),
            (of_other_rank,
             "S201 at `m = [np.zeros((2, 6)), np.zeros(6)]`: the list 'm' holds arrays of several numbers of "
             "axes: give them names of their own, or make an array of each that is like the others"),
            (integers_written,
             "S201 at `m = [x.copy(), np.zeros(6, dtype=np.int64)]`: the list 'm' holds arrays of several "
             "dtypes: give them names of their own, or make an array of each that is like the others")):
        yield Case(kernel, (X, 4), of=None, refused=refused)
    # sizes
    yield Case(of_two_sizes, (X, 4), "x")
    yield Case(of_two_shapes, (X, 2), ("x",))
