"""Every variable is its own: comprehensions, lambdas and nested functions have scopes, as in Python.

Each kernel has one name for several variables, of which one is a structure, an array, a number, a function or a module.
"""
# ruff: noqa: B007, E731
from __future__ import annotations

import numpy as np

from tests.corpus import Case

G = 3.0


def helper(v):
    return v * v


def decay(layers, x):
    for w, b in layers:
        x = np.tanh(w * x + b)
    return np.sum(x) + 0.1 * sum(np.sum(w ** 2) for w, b in layers)


def nested_same(layers, x):
    for w, b in layers:
        x = np.tanh(w * x + b)
    s = sum(sum(np.sum(w * b) for w, b in layers) * np.sum(w) for w, b in layers)
    return np.sum(x) * s + np.sum(w)


def lambda_structure(layers, x):
    for w, b in layers:
        pass
    g = lambda w: w * x
    return g(x) + np.sum(w) + g(3.0)


def lambda_global(layers, x):
    g = lambda G: G * x
    return g(x) + G * x


def nested_capture_transitive(layers, x):
    a = x * 3.0
    def h(v):
        return a * v
    def g(v):
        a = v * v
        return h(a) * a
    return g(x) + a


def nested_param_transitive(layers, x):
    a = x * 3.0
    def h(v):
        return a * v
    def g(a):
        return h(a) * a
    return g(x) + g(a=2.0 * x) + a


def after_loop(layers, x):
    s = 0.0
    for w, b in layers:
        s += np.sum(w)
    z = [np.sum(w * b) for w, b in layers[::-1]]
    return s * x + z[0] + np.sum(w) * z[1]


def rebinding_kinds(layers, x):
    for w in layers:
        x = x + np.sum(w[0])
    w = x * 2.0
    return sum(np.sum(w[0]) for w in layers) * w


def enumerated(layers, x):
    for i, (w, b) in enumerate(layers):
        x = x + i * np.sum(w)
    t = sum(i * np.sum(w * b) for i, (w, b) in enumerate(layers))
    return t * x * i + np.sum(b)


def swapped_names(layers, x):
    for w, b in layers:
        x = x + np.sum(w)
    return sum(np.sum(w) * x - np.sum(b) for b, w in layers) + np.sum(w)


def cond_comp(layers, x):
    w = x
    t = sum(np.sum(w) for w, b in layers if np.sum(b) > 0.5)
    return t * w


def alias_after(layers, x):
    w, b = layers[0]
    s = sum(np.sum(w) * np.sum(b) for w, b in layers)
    w = w * x
    s += sum(np.sum(w) * np.sum(b) for w, b in layers)
    return s * np.sum(w) * np.sum(b)


def of_itself(w, x):
    t = [w * x for w in w]
    return np.sum(t[0]) + np.sum(t[1] ** 2) + np.sum(w[0])


def of_itself_summed(w, x):
    return sum(np.sum(w * x) for w in w) + np.sum(w[1])


def written_lists(us, x):
    u = us[0] * x
    vs = [u + v for v in us]
    ws = [u * x for u in us]
    u = sum(np.sum(v * w) for v, w in zip(vs, ws))
    return u + sum(np.sum(u) for u in vs)


def named_again(cs, x):
    for c in cs:
        pass
    return sum(c for c in cs) * x + c


def in_loop_of_same(w, x):
    s = 0.0
    for k in range(3):
        s += sum(w[k] * x * k for k in range(3)) * w[k] * k
    return s * k


def global_shadowed(w, x):
    return sum(G * x for G in w) * G


def np_shadowed(w, x):
    return sum(np * x for np in w) * np.sum(w)


def sum_shadowed(w, x):
    return np.sum(np.array([sum * x for sum in w])) * sum(v for v in w)


def function_shadowed(w, x):
    return sum(helper * x for helper in w) * helper(x)


def nested_comp_captured(w, x):
    a = x * 3.0
    def g(v):
        return a * sum(v * a for a in w)
    return g(x) + a


def nested_comp_of_captured(w, x):
    def g(v):
        return sum(v * w for w in w)
    return g(x) + w[0]


def any_all(w, x):
    v = 7.0
    s = 0.0
    if any(v * x > 5.0 for v in w):
        s += v * x
    if all(v * x > 5.0 for v in w):
        s += v * 100.0
    return s + max(v * x for v in w) * v + min(v * x * x for v in w)


def two_generators(w, x):
    i = 4.0
    j = 5.0
    s = sum(w[i] * w[j] * x for i in range(3) for j in range(i + 1))
    t = sum(w[j] * x for i in range(3) for j in range(i) if j != i)
    return s + t * i * j


def sum_of_functions(w, x):
    k = x * x
    e = sum(k * f(x) for f, k in ((np.sin, 2.0), (np.cos, 3.0)))
    return e * k


def rk(w, x):
    def f(y, t):
        return -y * t * x
    def step(f, y, t):
        k = f(y, t)
        return y + 0.1 * k
    y = x
    k = 3.0
    for t in range(3):
        y = step(f, y, w[t])
    return y * k


def given_lambda(w, x):
    y = x * x
    def apply(f, y):
        return f(y) * y
    return apply(lambda y: y * w[0], x) + apply(lambda x: x * y, w[1]) * y


def given_by_keyword(w, x):
    t = x * x
    def apply(f, v):
        return f(t=v, w=2.0) * t
    def g(t, w):
        return t * t * w
    return apply(g, x) + t + w[0]


def nested_in_nested(w, x):
    def outer(v):
        x = v * 2.0
        def inner(v):
            return v * x
        return inner(v * v) + x
    return outer(x) * x + outer(w[0])


def recursion_of_names(w, x):
    y = [y * x for y in [y * x for y in [y * x for y in w]]]
    return y[0] * y[1] + sum([y[k] for k in range(3)])


def default_reads_outer(w, x):
    k = 3.0
    g = lambda v, k=2.0: v * k
    return g(x) + g(x, k) + g(v=x, k=k)


def in_while(us, x):
    k = 0
    s = 0.0
    while k < 3:
        s += sum(us[k] * x for k in range(2)) * k
        k += 1
    return s * k


def nested_def_comp(a, x):
    def f(a):
        return sum(a * x for a in range(3)) * a
    v = 2.0
    def g(v):
        return f(v) * v + sum(v * a[k] for k, v in enumerate(a))
    return g(x) * v + f(a[0])


def shadow_function_name(a, x):
    def f(v):
        return v * v
    s = f(x)
    return s + sum(f * x for f in a) + f(s)


def nested_same_name_as_param(a, x):
    def g(a, x=2.0):
        return a * x
    return g(x) + g(a[0], x=x) + g(x=3.0, a=x)


def given_capturing(a, x):
    w = x * x
    def h(v):
        return w * v
    def app(f, w):
        return f(w) * w
    return app(h, x) + app(lambda w: w * x, a[0]) + w


def branch_functions(a, x):
    k = 2.0
    if a[0] > 0.0:
        f = lambda k: k * x
    else:
        f = lambda x: k * x
    return f(a[1]) + k * f(x)


def list_in_list2(a, x):
    b = np.array([[x * a[j] * i for j in range(3)] for i in range(2)])
    i = 4
    c = np.array([[x * a[i] * j for j in range(3)] for i in range(2)])
    return np.sum(b * c) * i


def enum(a, x):
    i, r = 5, x
    s = sum(i * np.sum(r) for i, r in enumerate(a))
    s += sum(i * v * r for i, v in enumerate(a[:, 0]))
    s += sum(i * r * x for i, r in zip(range(3), a[:, 1]))
    return s * i * r


GIVEN = {
    (decay, nested_same, lambda_structure, lambda_global, nested_capture_transitive, nested_param_transitive,
     after_loop, rebinding_kinds, enumerated, swapped_names, cond_comp, alias_after):
        lambda: [(np.array([1.0, 2.0]), np.array([0.1, 0.2])), (np.array([4.0, 5.0]), np.array([0.3, 0.4]))],
    (of_itself, of_itself_summed, written_lists):
        lambda: [np.array([1.0, 2.0]), np.array([3.0, 4.0])],
    (named_again,):
        lambda: [1.0, 10.0],
    (in_loop_of_same, global_shadowed, np_shadowed, sum_shadowed, function_shadowed, nested_comp_captured,
     nested_comp_of_captured, any_all, two_generators, sum_of_functions, rk, given_lambda, given_by_keyword,
     nested_in_nested, recursion_of_names, default_reads_outer, in_while, nested_def_comp, shadow_function_name,
     nested_same_name_as_param, given_capturing, branch_functions, list_in_list2):
        lambda: np.arange(1.0, 7.0),
    (enum,):
        lambda: np.arange(1.0, 7.0).reshape(3, 2),
}


def cases():
    # variables of one name
    for kernel, given in ((f, given) for fs, given in GIVEN.items() for f in fs):
        x = np.array([0.5, 0.6]) if kernel in (decay, nested_same) else 2.0
        yield Case(kernel, (given(), x), ("x",))
