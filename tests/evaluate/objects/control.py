"""Objects, lists and dicts in loops, branches and calls."""
from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from tests.corpus import Case

X = np.array([0.3, 0.7, 1.1, 1.9])


class Counter:

    def __init__(self):
        self.n = 0
        self.w = np.ones(4)

    def bump(self):
        self.n += 1
        return self.n


@dataclass
class P:
    a: float = 1.0
    h: list = field(default_factory=list)


def time_loop_over_a_dict(x):
    st = {'t': 0.0, 'u': x.copy()}
    while st['t'] < 1.0:
        dt = min(0.3, 1.0 - st['t'])
        st['u'] = st['u'] + dt * np.sin(st['u'])
        st['t'] += dt
    return np.sum(st['u']) * st['t']


def default_factories(x):
    p = P()
    q = P(2.0)
    p.h.append(x[0])
    q.h.append(x[1])
    p.a = p.a * x[2]
    return sum(p.h) * q.a + sum(q.h) * p.a + len(q.h) * x[3]


def views_in_a_list(x):
    a = np.zeros(3)
    rows = [a[0:2], a[1:3]]
    rows[0][:] = x[:2]
    rows[1][0] *= x[3]
    return a[0] * a[1] + np.sum(rows[0])


def counter_in_nested_loops(x):
    n = 0
    acc = x * 0
    for i in range(3):
        for j in range(i + 1):
            n += 1
            acc = acc + n * x * j
    return np.sum(acc) * n


def targets_in_order(x):
    u = [x[0], x[1]]
    u[0], u[1] = (u[1], u[0])
    i = 0
    i, u[i] = (1, x[2])
    return u[0] * 3 + u[1] * x[3]


def attribute_before_a_call_changes_it(x):
    c = Counter()

    def h():
        c.w = c.w * x
        return c.w
    return np.sum(c.w * h() * c.w)


def insert_and_del(x):
    v = [x]
    for k in range(3):
        v.insert(0, v[0] * x[k])
    del v[1]
    return np.sum(v[0] * v[-1]) + len(v)


def read_in_the_next_round(x):
    s = 0.0
    for i in range(5):
        if i > 0:
            s = s + prev * x[1]  # noqa: F821
        prev = x[0] * i
    return s * prev


def results_that_are_gathered(x):

    class S:

        def __init__(s):
            s.t = 0.0

        def step(s):
            s.t = s.t + x[0]
            return s.t
    o = S()
    v = [o.step() for k in range(3)]
    return v[0] * v[1] * v[2] + o.t


def loop_with_else_and_break(x):
    u = x.copy()
    for _i in range(4):
        u = u * x[1]
        if np.sum(u) > 2.0:
            best_u = u
            break
    else:
        best_u = x
    return np.sum(best_u) + np.sum(u)


def tree_of_objects(x):

    class N:

        def __init__(s, v, kids=()):
            s.v = v
            s.kids = list(kids)

        def total(s):
            return s.v + sum(k.total() * 2 for k in s.kids)
    t = N(x[0], [N(x[1]), N(x[2], [N(x[3])])])
    t.kids[0].v = t.kids[0].v * t.total()
    return t.total()


def while_in_a_helper(x):

    def it(f, n):
        v = 1.0
        while n > 0:
            v = v * f(n)
            n -= 1
        return v
    return it(lambda k: x[k], 3)


def values_when_their_round_comes(x):
    d = {'u': x, 'v': 2 * x}
    for _k, v in d.items():
        d['v'] = v * x
    return np.sum(d['v'] * d['u'])


def ragged_rows(x):
    r = []
    for i in range(3):
        row = []
        for j in range(i + 1):
            row.append(x[i] * x[j])
        r.append(row)
    return sum(sum(q) * len(q) for q in r)


def inheritance_and_properties(x):

    class Base:
        k = 3.0

        def f(s, v):
            return s.k * v

        @property
        def d(s):
            return s.a * 2

        @staticmethod
        def g(v):
            return v * v

        @classmethod
        def mk(c, a):
            o = c()
            o.a = a
            return o

        def __init__(s):
            s.a = 1.0

    class D(Base):
        k = 5.0

        def f(s, v):
            return super().f(v) + s.a

        def __call__(s, v):
            return s.f(v) * s.d

        def __getitem__(s, i):
            return x[i] * s.a

        def __len__(s):
            return 3
    o = D.mk(x[0])
    o.a *= x[1]
    return o(x[2]) + Base.g(x[3]) + o[2] * len(o) + sum(o[i] for i in range(len(o)))


def list_that_grows_with_time(x):
    t = 0.0
    n = 0
    out = []
    while t < 1.0:
        t += 0.3
        n += 1
        out.append(x * t)
    return np.sum(out[0] * out[-1]) * n


def with_and_finally(x):
    s = 0.0
    with np.errstate(all='ignore'):
        for (i, j), c in {(0, 1): 2.0, (1, 2): 3.0}.items():
            s += c * x[i] * x[j]
    try:
        s = s * 1
    finally:
        s += x[3]
    return s


def recursion_that_ends(x):

    def rec(n, v):
        return v if n == 0 else rec(n - 1, v * x[n])
    return rec(3, x[0])


def best_of_all(x):
    best = x[0]
    arg = 0
    for i in range(1, 4):
        if x[i] > best:
            best, arg = (x[i], i)
    return best * (arg + 1)


def dict_by_numbers(x):
    m = {}
    m[0] = x[0]
    for i in range(1, 4):
        m[i] = m[i - 1] * x[i] + 1
    return m[3]


def history(x):
    h = []
    u = x
    for _n in range(3):
        h.append(u)
        u = np.sin(u)
    return sum((np.sum(a * b) for a, b in zip(h, h[1:])))


def closure_over_a_list(x):
    st = [0.0, x[0]]

    def upd():
        st[0] += 1.0
        st[1] *= x[1]
        return st[1]
    return upd() + st[0] * upd() + st[0]


def array_under_several_names(x):
    u = x.copy()
    v = u
    u += 1
    w = u
    w *= 2
    u = u + v
    return np.sum(u * v * w)


def copied_lists(x):
    a = [x.copy() for _ in range(2)]
    b = list(a)
    b[0] *= 2
    a[1] = a[1] * 3
    return np.sum(a[0] * b[1]) + np.sum(b[0] * a[1])


def jumps_in_nested_loops(x):
    s = 0
    for i in range(2):
        for j in range(3):
            if j == 1:
                continue
            if i == 1 and j == 2:
                break
            s += x[i] * x[j] * (i + j + 1)
    return s


def best_of_an_array(x):
    best, counter = None, Counter()
    for v in x:
        if best is None or v * v > best:
            best = v * v
            counter.n += 1
    return best * x[0] * counter.n


def cases():
    for kernel in (
            time_loop_over_a_dict, default_factories, views_in_a_list, counter_in_nested_loops,
            targets_in_order, attribute_before_a_call_changes_it, insert_and_del, read_in_the_next_round,
            results_that_are_gathered, loop_with_else_and_break, tree_of_objects, while_in_a_helper,
            values_when_their_round_comes, ragged_rows, inheritance_and_properties, list_that_grows_with_time,
            with_and_finally, recursion_that_ends, best_of_all, dict_by_numbers, history, closure_over_a_list,
            array_under_several_names, copied_lists, jumps_in_nested_loops, best_of_an_array):
        yield Case(kernel, (X,), "x")
