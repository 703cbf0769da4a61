"""Functions that a string picks from a table."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case

X = np.array([0.3, 1.1, 0.7])


def cubed(x):
    return x ** 3


ACT = {"tanh": np.tanh, "sin": np.sin, "cubed": cubed}
MIXED = {"sin": np.sin, "number": 2.0}


def from_the_module(x, kind):
    return (ACT[kind](x) * x).sum() + ACT[kind](x[0])


def written_out(x, kind):
    return {"tanh": np.tanh, "sin": np.cos, "cubed": cubed}[kind](x * 2.0).sum()


def named(x, kind):
    act = ACT[kind]
    s = 0.0
    for i in range(3):
        s += act(x[i]) * act(s)
    return s


def layers(f, x, n):
    for _ in range(n):
        x = f(x) + 0.1
    return x


def handed(x, kind):
    act = ACT[kind]
    return layers(act, x, 2).sum() * layers(ACT[kind], x[1], 1)


def in_a_function(x, kind):
    act = ACT[kind]
    twice = lambda v: act(act(v))           # noqa: E731

    def layer(v, w):
        return act(v) * w
    return np.sum(layer(x, 2.0)) + twice(x[0]) + sum([act(v) for v in x])


def in_tests(x, kind, n=2):
    act = ACT[kind]
    s = 2.0 * x[1]
    while act(s) > 0.2 and n < 9:
        s = s * x[2]
        n += 1
    if act(x[0]) > 5.0 or ACT["sin"](x[0]) < act(x[1]):
        s *= act(x[0]) if s > 0.0 else act(x[1])
    return s


def asked_in_tests(x, kind):
    s = 2.0 * x[1]
    while ACT[kind](s) > 0.2 and s < 9.0:
        s = s * x[2]
    if ACT[kind](s) > 5.0:
        s = x[0]
    elif ACT[kind](x[0]) > 0.0:
        s = s * ACT[kind](x[1] if s > 0.0 else x[0])
    for v in ACT[kind](x):
        s += v
    return s


def in_a_branch(x, kind, other="cubed"):
    s = 0.0
    for k in range(3):
        if k > 0:
            f = ACT[kind]
            g = ACT[other]
            s += (f(x[k]) if k > 1 else g(x[0])) * layers(g, x[1], 2) + after(f, g, x[0])
    return s


def after(f, g, v):
    return f(g(v))


def mixed(x, kind):
    return MIXED[kind](x).sum()


def maybe(x, kind):
    return np.sum(ACT[kind](x) if x[0] > 0.0 else x)


def read_before(x, kind):
    s = 0.0
    for k in range(3):
        if k > 0:
            s += f(x[k])                    # noqa: F821
        f = ACT[kind]                       # noqa: F841
    return s


def used_as_a_value(x, kind):
    act = ACT[kind]
    other = act
    return other(x[0])


def anew(x, kind):
    s = ACT[kind](x).sum()
    kind = "sin"
    return s + ACT[kind](x).sum()


def bound_anew(x, kind):
    def g(v):
        return v * 2.0
    act = {"sin": g, "tanh": np.tanh}[kind]

    def g(v):
        return v * 3.0
    return np.sum(act(x)) * g(x[0])


def parameter_of_its_name(x, kind):
    act = ACT[kind]

    def layer(act, v):
        return act(v) * 2.0
    return act(x[0]) * layer(np.cos, x[1])


def cases():
    # picked functions
    for kernel in [from_the_module, written_out, named, handed, in_a_function, in_tests, asked_in_tests, in_a_branch]:
        for kind in ("tanh", "cubed"):
            yield Case(kernel, (X, kind), ("x",))
    for kernel in (maybe, read_before, used_as_a_value):
        yield Case(kernel, (X, "sin"), "x")
    # what is to be written
    # a name that means something else elsewhere
    yield Case(bound_anew, (X, "sin"), "x")
    # a parameter of its name is its own
    yield Case(parameter_of_its_name, (X, "sin"), ("x",))
    for kernel in (mixed, anew):
        yield Case(kernel, (X, "sin"), "x")
