"""Every variable is its own: comprehensions, lambdas and nested functions have scopes, as in Python.

Each kernel has one name for several variables, of which one is a structure, an array, a number, a function or a module.
"""
# ruff: noqa: B007, E731
from __future__ import annotations

import numpy as np
import pytest

import s2sad
from s2sad.read.capture import capture
from s2sad.read.unique_names import unique_names
from s2sad.tree import written
from tests.corpus.language.desugared import M, X
from tests.harness.engines import running


def of_a_dict(p, x):
    s = 0.0
    for k, v in p.items():
        s += np.sum(v * x)
    s += sum(np.sum(v ** 2) for k, v in p.items()) + np.sum(v)
    v = x
    q = [v * 2.0 for v in p.values()]
    for k in p:
        s += np.sum(p[k]) * x
    return s + np.sum(q[0] * q[1]) + v


@pytest.mark.parametrize("engine", ["numpy", "loops"])
def test_items_of_a_dict(engine):
    given = {"a": np.array([1.0, 2.0]), "b": np.array([3.0, 4.0])}
    with running(engine) as run_under:
        value, slope = s2sad.value_and_gradient(s2sad.differentiate(of_a_dict, engine=run_under), wrt="x")(given, 2.0)
    assert value == of_a_dict(given, 2.0) == 123.0 and slope == 21.0


def test_names_made_unique():
    def kernel(w, x):
        k = 2.0
        f = lambda w: w * k
        return f(x) + sum(w * k for w in w for k in range(3)) + k

    found = unique_names(capture(kernel))
    assert [written(s.value) for s in found.tree.body[1:]] == [
        "lambda w_2: w_2 * k", "f(x) + sum((w_3 * k_2 for w_3 in w for k_2 in range(3))) + k"]
    assert found.renamed == {"w_2": "w", "w_3": "w", "k_2": "k"}
    assert unique_names(found).tree is found.tree


def test_names_that_do_not_clash_stay():
    def kernel(us, x):
        return sum(u * x for u in us)

    captured = capture(kernel)
    assert unique_names(captured) is captured
    text = s2sad.differentiate(kernel, engine="numpy").adjoint_source(np.ones(3), 2.0)
    assert "u_bar" in text and "u_2" not in text


def test_names_of_comprehensions():
    def nested(nets, x):
        for layers in nets:
            x = x * layers[0]
        return sum(sum(b * x for b in layers) for layers in nets)

    def binds(us, x):
        return sum((last := u * x) for u in us) * last

    assert s2sad.check(nested, [[1.0, 2.0], [3.0, 4.0]], 2.0)
    assert s2sad.check(binds, np.array([0.5, 1.5, 2.0]), 2.0)


def names_that_swap(x, m):
    w, v = 2.0 * x, 3.0 * x
    for k in range(4):
        v[1:] = x[:-1] * 0.5
        x, v = v, x
        if k > 1:
            x, w = w, x
    return np.sum(x * x)


def test_names_are_the_users():
    with pytest.raises(s2sad.S2sadError) as caught:
        s2sad.gradient(names_that_swap, wrt="x")(X, M)
    assert "_own" not in str(caught.value)
