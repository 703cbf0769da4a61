"""Plain Python around arrays: lists, dicts, records and functions as values, as people write them."""
from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np

from tests.corpus import Case

X = np.array([0.3, 0.7, 1.1, 1.9])


@dataclass
class Part:
    k: float
    w: np.ndarray


def list_appended_in_literal_loop(x):
    us = []
    for k in (1.0, 2.0, 3.0):
        us.append(k * x)
    return np.sum(us[0] * us[2])


def list_of_dataclasses(x):
    ps = [Part(1.0, x * 2.0), Part(2.0, x * x)]
    s = 0.0
    for p in ps:
        s += p.k * np.sum(p.w)
    return s


def list_of_dataclasses_appended(x):
    ps = []
    for k in range(3):
        ps.append(Part(float(k), x * k))
    s = 0.0
    for p in ps:
        s += p.k * np.sum(p.w ** 2)
    return s


def dict_filled(x):
    d = {}
    for k in ("a", "b"):
        d[k] = x * 2.0
    d["b"] = d["a"] * x
    return np.sum(d["b"])


def dict_literal_local(x):
    d = {"a": x[0], "b": x[1]}
    d["a"] = d["a"] * x[2]
    return d["a"] * d["b"]


def dict_of_lists(x):
    d = {"a": [x, 2.0 * x], "b": [x * x]}
    s = 0.0
    for k in d:
        for v in d[k]:
            s += np.sum(v * v)
    return s


def list_alias(x):
    us = [x[0], x[1]]
    vs = us
    vs[0] = x[2] * x[3]
    return us[0] * us[1]


def nested_alias(x):
    us = [x[0], x[1]]
    t = (us, 2.0)
    us[0] = x[2]
    return t[0][0] * x[1]


def functions_in_list(x):
    fs = [np.sin, np.cos]
    s = 0.0
    for f in fs:
        s += np.sum(f(x))
    return s


def functions_in_dict_local(x):
    act = {"sin": np.sin, "cos": np.cos}
    s = 0.0
    for name in ("sin", "cos"):
        s += np.sum(act[name](x))
    return s


def zip_list_functions(x):
    ws = [0.1 * x, 0.2 * x]
    s = 0.0
    for f, w in zip((np.sin, np.exp), ws):
        s += np.sum(f(w))
    return s


def list_pop(x):
    us = [x, 2.0 * x, x * x]
    last = us.pop()
    return np.sum(last * us[0])


def list_concat(x):
    us = [x, 2.0 * x] + [x * x]
    return np.sum(us[2] * us[1])


def list_insert(x):
    us = [x]
    us.insert(0, 2.0 * x)
    return np.sum(us[0] * us[1] ** 2)


def tuple_swap_in_list(x):
    us = [x.copy(), 2.0 * x]
    us[0], us[1] = us[1], us[0] * x
    return np.sum(us[0] * us[1])


def star_call(x):
    def f(a, b):
        return np.sum(a * b)
    args = (x, 2.0 * x)
    return f(*args)


def namedtuple_loop(x):
    return x[0]


def reduce(x):
    return np.sum(functools.reduce(lambda a, b: a * b, [x, 2.0 * x, x + 1.0]))


def mapped(x):
    return np.sum(sum(map(np.sin, [x, 2.0 * x])))


def sorted_keys(x):
    d = {"b": x, "a": 2.0 * x}
    s = 0.0
    for k in sorted(d):
        s += np.sum(d[k] ** 2)
    return s


def list_of_tuples_mutated(x):
    layers = [(x, 1.0), (2.0 * x, 2.0)]
    layers[1] = (layers[0][0] * x, 3.0)
    s = 0.0
    for w, c in layers:
        s += c * np.sum(w)
    return s


def mlp_params_list_of_dicts(x):
    ps = [{"w": x, "b": 0.1 * x}, {"w": 2.0 * x, "b": x * x}]
    h = x
    for p in ps:
        h = np.tanh(p["w"] * h + p["b"])
    return np.sum(h)


def grads_list_of_dicts_updated(x):
    ps = [{"w": x.copy()}, {"w": 2.0 * x}]
    for _t in range(2):
        for p in ps:
            p["w"] = p["w"] - 0.1 * np.sin(p["w"])
    return np.sum(ps[0]["w"] * ps[1]["w"])


def enumerate_dict_items(x):
    d = {"a": x, "b": x * x}
    s = 0.0
    for k, (_name, v) in enumerate(d.items()):
        s += (k + 1.0) * np.sum(v * v)
    return s


def while_pop(x):
    todo = [x, 2.0 * x]
    s = 0.0
    while todo:
        s += np.sum(todo.pop() ** 2)
    return s


def conditional_list(x):
    us = [x, 2.0 * x]
    if x[0] > 0.0:
        us[1] = x * x
    return np.sum(us[1])


def str_dispatch(x):
    method = "rk" + "2"
    if method == "rk2":
        return np.sum(x * x)
    return np.sum(x)


def list_extend(x):
    us = [x]
    us.extend([2.0 * x, x * x])
    return np.sum(us[2] * us[1])


def comp_of_dataclass(x):
    ps = [Part(float(k), k * x) for k in range(3)]
    return sum(p.k * np.sum(p.w ** 2) for p in ps)


def butcher(x):
    a = [[], [0.5], [0.0, 0.75]]
    b = [2/9, 1/3, 4/9]
    u = x
    for _n in range(2):
        ks = []
        for s in range(3):
            v = u
            for j in range(s):
                v = v + 0.1 * a[s][j] * ks[j]
            ks.append(np.sin(v))
        for s in range(3):
            u = u + 0.1 * b[s] * ks[s]
    return np.sum(u)


def history(x):
    us = [x]
    for _n in range(x.size):
        us.append(np.sin(us[-1]))
    return np.sum(us[-1] * us[1])


def slices_list(x):
    parts = [slice(0, 2), slice(2, 4)]
    s = 0.0
    for p in parts:
        s += np.sum(x[p]) ** 2
    return s


def list_reversed_del(x):
    us = [x, 2.0 * x, x * x]
    us.reverse()
    del us[0]
    return np.sum(us[0] * us[1])


def nested_comp(x):
    g = [[x[i] * x[j] for j in range(2)] for i in range(2)]
    return g[0][1] * g[1][1]


def list_in_helper(x):
    def add(us, v):
        us.append(v)
    us = []
    add(us, x)
    add(us, 2.0 * x)
    return np.sum(us[0] * us[1])


def record_method_list(x):
    p = Part(2.0, x)
    ps = [p, p]
    ps[0].k = 3.0
    return ps[1].k * np.sum(p.w)


def cases():
    for kernel in (
            list_appended_in_literal_loop, list_of_dataclasses, list_of_dataclasses_appended, dict_filled,
            dict_literal_local, dict_of_lists, list_alias, nested_alias, functions_in_list,
            functions_in_dict_local, zip_list_functions, list_pop, list_concat, list_insert,
            tuple_swap_in_list, star_call, namedtuple_loop, reduce, mapped, sorted_keys, list_of_tuples_mutated,
            mlp_params_list_of_dicts, grads_list_of_dicts_updated, enumerate_dict_items, while_pop,
            conditional_list, str_dispatch, list_extend, comp_of_dataclass, butcher, history, slices_list,
            list_reversed_del, nested_comp, list_in_helper, record_method_list):
        yield Case(kernel, (X,), "x")
