"""Identity, aliases and order of evaluation of objects, lists and functions."""
from __future__ import annotations

import math

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


def counted_operands(x):
    c = Counter()
    return c.n + c.bump() * np.sum(x) + c.n * x[0]


def appended_through_an_alias(x):
    a = [x[0], x[1]]
    b = a
    b.append(x[2])
    return a[2] * a[0]


def added_to_an_array_that_is_listed_twice(x):
    u = x.copy()
    us = [u, u]
    us[0] += x
    return np.sum(us[1] * u)


def added_to_a_number_that_is_listed_twice(x):
    us = [x[0], x[0]]
    us[0] += x[1]
    return us[0] * us[1]


def lambdas_over_one_variable(x):
    fs = [lambda v: k * v for k in (1.0, 2.0, 3.0)]  # noqa: B023
    return np.sum(fs[0](x) * fs[2](x))


def default_that_grows(x):

    def f(v, acc=None):
        if acc is None:
            acc = []
        acc.append(v)
        return len(acc) * v
    return f(x[0]) + f(x[1]) + f(x[2])


def list_that_grows_while_it_is_gone_through(x):
    s = 0.0
    us = [x[0]]
    for u in us:
        s = s + u
        if len(us) < 4:
            us.append(u * x[len(us)])
    return s


def operators_of_a_class(x):

    class A:
        c = 2.0

        def __init__(self, v):
            self.v = v

        def __add__(self, o):
            return A(self.v + o.v)

        def __mul__(self, o):
            return A(self.v * o) if isinstance(o, float) else A(self.v * o.v)
    a = A(x)
    b = A(2 * x)
    return np.sum(((a + b) * b * 3.0).v) * A.c


def object_under_two_names(x):
    o = Counter()
    p = o
    p.w = x * 2
    if x[0] > 0.2:
        o.w = o.w * x
    else:
        p.w = p.w + 1
    return np.sum(o.w * p.w)


def object_in_a_loop(x):
    o = Counter()
    s = 0.0
    for i in range(x.size):
        o.w = o.w * x[i]
        o.n += 1
        s += o.w[i] * o.n
    return s


def early_returns(x):

    def early(v):
        if v > 0.5:
            return v * v
        return 3 * v
    return early(x[0]) + early(x[1]) * early(x[2])


def early_returns_of_what_changes_an_object(x):

    def early(v, o):
        if v > 0.5:
            o.w = o.w * v
            if v > 1.0:
                return v
            o.n += 1
        return o.n * v
    o = Counter()
    return sum(early(v, o) for v in (x[0], x[1], x[2], x[3])) + np.sum(o.w)


def break_and_else_over_texts(x):
    s = 0.0
    for k, _name in enumerate(('a', 'b', 'c')):
        if x[k] > 1.0:
            break
        s = s + x[k] * x[k]
    else:
        s = s * 2
    return s + k * x[3]


def continue_over_functions(x):
    s = 0.0
    for f in (np.sin, np.cos, np.exp):
        if x[0] > 0.25:
            if x[1] > 3:
                continue
            s = s + f(x[2])
        s = s * x[3]
    return s


def list_in_a_tuple_that_is_bound_anew(x):
    o = [x[0]]
    t = (o, o)
    o = [x[1]]
    t[0][0] = x[2]
    return t[1][0] * o[0]


def copied_dict(x):
    d = {'a': x, 'b': [x[0]]}
    e = dict(d)
    e['b'].append(x[1])
    e['a'] = e['a'] * 2
    return np.sum(d['a']) * d['b'][1]


def array_bound_anew(x):
    u = x.copy()
    v = u
    u = u * 2
    v[0] = 5 * x[1]
    return np.sum(u * v)


def number_bound_anew(x):
    a = x[0]
    b = a
    a += x[1]
    return a * b


def array_repeated_in_a_list(x):
    us = [0.0 * x] * 3
    us[0] += x
    return np.sum(us[1] * us[2])


def setdefault(x):
    m = {}
    for i, k in enumerate('abc'):
        m.setdefault(k, []).append(x[i])
        m.setdefault('a', []).append(x[3])
    return sum(math.prod([1.0]) * v for k in m for v in m[k]) + len(m['a']) * m['a'][1]


def calls_that_count(x):

    def gen(o):
        o.n += 1
        return o.n * x[0]
    o = Counter()
    return [gen(o), gen(o)][0] - o.n * x[1] + (gen(o) if x[0] > 0 else 0.0) * o.n


def list_extended_on_one_way_under_another_name(x):
    us = [x[1] * 1.5, 0.75, x[2]]
    vs = us
    if x[0] > 0.1:
        vs += [x[0] - 1.5]
    return sum(us) * us[0] + sum(vs)


def list_turned_around_in_a_loop(x):
    us = [x.copy(), x[3] * x]
    for _ in range(x.size):
        us[0] = x[2] * us[1]
        us = us[::-1]
    return np.sum(us[0] * us[1] * x)


def cases():
    for kernel in (
            counted_operands, appended_through_an_alias, added_to_an_array_that_is_listed_twice,
            added_to_a_number_that_is_listed_twice, lambdas_over_one_variable, default_that_grows,
            list_that_grows_while_it_is_gone_through, operators_of_a_class, object_under_two_names,
            object_in_a_loop, early_returns, early_returns_of_what_changes_an_object,
            break_and_else_over_texts, continue_over_functions, list_in_a_tuple_that_is_bound_anew,
            copied_dict, array_bound_anew, number_bound_anew, array_repeated_in_a_list, setdefault,
            calls_that_count, list_extended_on_one_way_under_another_name, list_turned_around_in_a_loop):
        yield Case(kernel, (X,), "x")
