"""Lists of which only the run knows how long they become."""
from __future__ import annotations

from collections import deque

import numpy as np

from tests.corpus import Case

X = np.array([1.3, 2.2, 0.7, 0.4])


def adaptive_times(x):
    ts, ys = [0.0], [x]
    t, y = 0.0, x
    while t < x[0] * 2.0:
        dt = 0.11 * x[3]
        y = y + dt * np.sin(y) * x[1]
        t = t + dt
        ts.append(t)
        ys.append(y)
    ts = np.array(ts)
    ys = np.array(ys)
    return np.sum(ys[:, 0] * ts) + ys[-1, 2]


def left_by_break(x):
    h = []
    v = x[0]
    while True:
        v = v * 1.1 + x[1]
        h.append(v)
        if v > 90.0:
            break
    s = 0.0
    for a in h:
        s += a**2
    for i, a in enumerate(h):
        s += a * i
    for a, b in zip(h[:-1], h[1:]):
        s += a * b
    return s + len(h) * x[2] + max(h)


def pairs(x):
    h = []
    v = x[0]
    while v < 30.0:
        v = v * 1.7 + x[1]
        h.append((v, v * x[2]))
    return sum(a * b for a, b in h) + h[-1][0]


def of_helpers(x):
    def run(a, b):
        h = [a]
        while h[-1] < 30.0:
            h.append(h[-1] * 1.2 + b)
        return h
    r = run(x[0], x[1])
    q = run(x[2], x[3])
    return np.sum(r) + q[-1] * len(q)


def element_is_written(x):
    h = []
    v = x[0]
    k = 0
    while k < 40:
        h.append(v * k)
        if k > 2:
            h[k-2] *= x[1]
        k += int(1 + 0 * v)
    return sum(h)


def rows_are_written(x):
    h = []
    v = x[0]
    while v < 60:
        h.append(x * v)
        h[-1][0] *= 2.0
        v *= 1.2
    A = np.array(h)
    return np.sum(A**2)


def made_in_a_loop(x):
    s = 0.0
    for j in range(3):
        h = []
        v = x[j]
        while v < 20.0:
            v = v * 1.15 + x[3]
            h.append(v)
        s += np.sum(np.array(h) * x[1]) + len(h)
    return s


def appended_in_an_inner_loop(x):
    h = []
    v = x[0]
    while v < 20.0:
        for j in range(3):
            h.append(v * x[j])
        v = v * 1.15
    return np.mean(h)


def under_a_condition(x):
    h = []
    v = x[0]
    while v < 50.0:
        v = v * 1.15
        if v > 5.0:
            h.append(v * x[1])
    return np.sum(np.array(h)) if len(h) > 0 else 0.0


def accepted_steps(x):
    t, y, dt = 0.0, x[0], 0.1
    ts, ys = [t], [y]
    while t < 1.0:
        k1 = -x[1] * y
        yn = y + dt * k1
        k2 = -x[1] * yn
        err = abs(0.5 * dt * (k2-k1))
        if err < 1e-2:
            t += dt
            y = y + 0.5 * dt * (k1 + k2)
            ts.append(t)
            ys.append(y)
            dt = min(dt * 1.2, 1.0 - t) if t < 1.0 else dt
        else:
            dt = dt * 0.5
    return ys[-1] + 0.5 * ys[len(ys)//2] + np.trapezoid(ys, ts)


class Sim:
    def __init__(self, x):
        self.u = x.copy()
        self.t = 0.0
        self.hist = []
        self.times=[]
    def step(self):
        dt = 0.1 / np.max(np.abs(self.u))
        self.u = self.u + dt * np.cos(self.u)
        self.t += dt
        self.hist.append(self.u.copy())
        self.times.append(self.t)
    def run(self, T):
        while self.t < T:
            self.step()
        return np.array(self.hist)


def history_of_an_object(x):
    s = Sim(x)
    h = s.run(1.0)
    return h.sum() + s.times[-1]


def descent_path(x):
    path = [x[:2]]
    def g(p):
        return np.array([2 * p[0] * x[2], 4 * p[1] * x[3]])
    p = x[:2] * 1.0
    while np.linalg.norm(g(p)) > 0.3:
        p = p - 0.1 * g(p)
        path.append(p)
    P = np.array(path)
    return np.sum(np.sqrt(np.sum(np.diff(P, axis=0)**2, axis=1)))


def two_names(x):
    a = []
    b = a
    v = x[0]
    while v < 40.0:
        a.append(v)
        v *= 1.3
    return sum(b) + len(b)


def two_lists_in_a_list(x):
    h = [[], []]
    v = x[0]
    while v < 40.0:
        h[0].append(v)
        h[1].append(v * x[1])
        v *= 1.3
    return sum(h[0]) + h[1][-1]


def lists_in_a_dict(x):
    d = {"t": [], "v": []}
    v = x[0]
    while v < 40.0:
        d["t"].append(v)
        d["v"].append(x * v)
        v *= 1.3
    return sum(d["t"]) + np.array(d["v"])[-1].sum()


def relaxation(x):
    h = [x * 0.1]
    while True:
        prev = h[-1]
        new = prev + 0.1 * (x - prev)
        h.append(new)
        if np.max(np.abs(new - prev)) < 0.05:
            break
    return np.sum(np.array(h)**2)


def old_row_across_the_append(x):
    h = [x * 0.1]
    err = 1.0
    while err > 0.05:
        prev = h[-1]
        h.append(prev + 0.1 * (x - prev))
        err = np.max(np.abs(h[-1] - prev))
    return np.sum(h[-1] * h[0]) + len(h)


def old_number(x):
    h = [x[0]]
    err = 1.0
    while err > 0.01:
        prev = h[-1]
        h.append(prev + 0.1 * (x[1] - prev))
        err = abs(h[-1] - prev)
    return h[-1] * h[0] + len(h)


def old_array(x):
    u = x * 0.1
    h = [u]
    err = 1.0
    while err > 0.05:
        old = u
        u = old + 0.1 * (x - old)
        h.append(u)
        err = np.max(np.abs(u - old))
    return np.sum(h[-1] * h[1]) + len(h)


def copies_of_one(x):
    u = x * 0.1
    h = []
    n = 0
    while n < 20:
        u += 0.1 * (x - u)
        h.append(u.copy())
        n += 1
    return np.sum(h[-1] * h[1]) + len(h)


def one_array_many_times(x):
    u = x * 0.1
    h = []
    n = 0
    while n < 20:
        u += 0.1 * (x - u)
        h.append(u)
        n += 1
    return np.sum(h[-1] * h[1]) + len(h)


def constants_and_numbers(x):
    v = 1.0
    vs = [1.0]
    while v > 0.1 * x[0]:
        v = v * 0.9
        vs.append(v)
    return vs[3] * x[1] + sum(vs) * x[0]


def integers(x):
    ints = [0]
    k = 1
    while k < 30 * x[0]:
        ints.append(k)
        k = k * 2
    return sum(x[i % 4]**2 for i in ints)


def bisection(x):

    a, b = 0.0, 4.0
    mids = []
    while b - a > 0.3:
        m = 0.5 * (a + b)
        mids.append(m)
        if m * m - x[1] > 0:
            b = m
        else:
            a = m
    root = mids[-1]
    return root - (root * root - x[1]) / (2 * root)


def rows_of_numbers(x):
    pts = []
    v = x[0]
    while v < 60:
        pts.append([v, v**2, x[1]])
        v *= 1.1
    P = np.array(pts)
    return P[:,1].sum() + P[-1, 2]


def backwards(x):
    ev = []
    v = x[0]
    while v < 60:
        v *= 1.1
        if v > 10 and v < 30:
            ev.append(v)
        elif v > 40:
            ev.append(-v)
    total = 0.0
    for e in reversed(ev):
        total = 0.5 * total + e
    return total


def parts(x):
    h = []
    v = x[0]
    while v < 60.0:
        v = v * 1.1 + x[1]
        h.append(v)
    s = sum(h[::2]) + np.mean(h[-3:])
    for a, b in zip(h[:-1], h[1:]):
        s += a * b
    return s


def truth_of_lists(x):
    out = []
    for k in range(5):
        if x[0] * k > 2.0:
            if not out and k > 1:
                out.append(x[2])
            out.append(x[1] * k)
    while out and out[-1] < 0.0:
        out.append(1.0)
    return out[-1] * out[0] if out else 0.0


def extended(x):
    h = []
    v = x[0]
    while v < 60.0:
        v = v * 1.1
        h.extend([v, v * x[1]])
        h += [v * x[2]]
    return sum(h) * h[-1]


def grows_while_gone_through(x):
    us = [x[0]]
    s = 0.0
    for u in us:
        s += u
        if s < 8.0:
            us.append(u * x[1])
    return s


def part_that_changes(x):
    h = []
    v = x[0]
    while v < 60.0:
        v = v * 1.1 + x[1]
        h.append(v)
    s = 0.0
    for a in h[:-1]:
        h[1] = 7.0 * a
        s += a * a
    return s


def arrays_of_a_list(x):
    h = []
    v = x[0]
    while v < 60.0:
        v = v * 1.1 + x[1]
        h.append(v)
    a, b, c = np.asarray(h), np.ravel(h), np.flip(h)
    parts = np.asarray(h[1:])
    a[1] = 50.0 * x[1]
    b[0] = c[0] = parts[2] = x[2]
    h[2] = 3.0
    return a.sum() + np.sum(b * c) + parts.sum() + sum(h)


def row_with_a_name(x):
    h = []
    v = x[0]
    while v < 60.0:
        row = [v, v * x[1]]
        h.append(row)
        v = v * 1.2 + row[0] * x[2]
    return sum(a * b for a, b in h)


def row_that_is_written(x):
    h = []
    v = x[0]
    while v < 60.0:
        row = [v, v * x[1]]
        h.append(row)
        row[1] += x[2]
        v *= 1.2
    return sum(a * b for a, b in h)


def row_many_times(x):
    h = []
    row = [x[0], x[1]]
    for k in range(len(x)):
        row[k % 2] += x[k]
        h.append(row)
    return sum(a * b for a, b in h)


def row_that_is_copied(x):
    h = []
    row = [x[0], x[1]]
    for k in range(len(x)):
        row[1] += x[k]
        h.append(list(row))
    return sum(a * b for a, b in h)


def row_in_a_comprehension(x):
    row = [x[0], x[1]]
    h = [row for k in range(len(x))]
    row[0] += x[2]
    h[1][1] = x[3]
    return sum(a * b for a, b in h)


def least_with_a_first(x):
    return min([x[0] * 3.0] + [v / 2.0 for v in x if v > 0.6]) + max([v for v in x if v > 9.0] + [x[1]])


def added_to_itself(x):
    us = [v * 2.0 for v in x if v > 0.5]
    vs = us
    us += us
    us.extend(x)
    return sum(v * k for k, v in enumerate(vs))


def joined_again_and_again(x):
    us, ws = [], [x]
    for v in x:
        if v > 0.5:
            us = us + [v]
    ws = ws + [x * v for v in x if v > 0.5]
    return sum(u * k for k, u in enumerate(us, 1)) + sum(np.sum(w ** 2) for w in ws)


def pairs_joined(x):
    return sum(a * b * b for a, b in [(x[0], x[1])] + [(v, v * v) for v in x if v > 0.5])


def added_to_a_deque(x):
    last = deque([x[0]], maxlen=2)
    for v in x:
        if v > 0.5:
            last.append(v)
    last.extend([v * 2.0 for v in x if v > 0.6])
    return sum(last)


def stacked_along_an_axis(x):
    def both(v):
        return np.array([v[0] * v[1], np.sin(v[2]) + v[3]])
    slopes = np.stack([both(x + e) for e in np.eye(x.size)], axis=1)
    us = []
    for v in x:
        if v > 0.5:
            us.append(np.outer(x, x * v))
    return np.sum(slopes @ x) + np.sum(np.stack(us, axis=-1)[:, :, 1] * x) + np.stack(us, 1)[0, 1, 2]


def cases():
    for kernel in (adaptive_times, left_by_break, pairs, of_helpers, element_is_written, rows_are_written,
                   made_in_a_loop, appended_in_an_inner_loop, under_a_condition, accepted_steps,
                   history_of_an_object, descent_path, two_names, two_lists_in_a_list, lists_in_a_dict,
                   relaxation, old_row_across_the_append, old_number, old_array, copies_of_one,
                   one_array_many_times, constants_and_numbers, integers, bisection, rows_of_numbers,
                   backwards):
        yield Case(kernel, (X,), "x")
    for kernel in (least_with_a_first, added_to_itself, joined_again_and_again, pairs_joined,
                   stacked_along_an_axis, row_that_is_written, row_in_a_comprehension, part_that_changes,
                   added_to_a_deque):
        yield Case(kernel, (X,), "x")
    for kernel in (parts, truth_of_lists, extended, arrays_of_a_list, row_with_a_name, row_that_is_copied):
        yield Case(kernel, (X,), "x")
    yield Case(row_many_times, (X,), "x", refused="S201 at `h.append(row)`: a list holds another list that is written, "
               "not a copy of it: append a copy: .append(list(w))")
    yield Case(grows_while_gone_through, (X,), "x", refused="S201 at `us`: a list that grows while it is gone through: "
               "write a while loop: while k < len(us)")
