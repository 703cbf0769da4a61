"""Many inputs: each is what it is alone, whatever the threads; arguments stay as they are."""
from __future__ import annotations

import copy
import pickle
from dataclasses import dataclass

import numpy as np
import pytest

import s2sad
from tests.harness.engines import one_line, running

U = np.random.default_rng(5).uniform(0.2, 1.3, (7, 4))
K = np.linspace(0.5, 1.5, 7)
WORK = np.zeros(4)


def chain(u, k):
    total = 0.0
    for i in range(1, u.size):
        u[i] = np.sin(k * u[i] * u[i - 1])
        total += u[i] ** 2
    return total


def parts(u, k):
    return u[1:] * k, np.sum(u), u.size


def outside(u, k):
    for i in range(u.size):
        WORK[i] = u[i] * k
    total = 0.0
    for i in range(u.size):
        total += WORK[i] * WORK[u.size - 1 - i]
    return total


@dataclass
class Spring:
    x: np.ndarray
    stiffness: float
    order: int


def spring(s, k):
    s.x[0] *= k
    return s.stiffness * np.sum(s.x ** s.order)


def silent(u, k):
    u[0] = k


def longer(u, n: int):
    return np.zeros(n) + u


ASKED = [lambda f: f, lambda f: s2sad.gradient(f, "u"), lambda f: s2sad.gradient(f, ("u", "k")),
         lambda f: s2sad.value_and_gradient(f, "k"), lambda f: s2sad.jacobian(f, "u", "return"),
         lambda f: s2sad.gradient(f, "u", backend="tangent")]


def same(ours, theirs, k):
    if isinstance(ours, dict):
        for n in ours:
            same(ours[n], theirs[n], k)
    elif isinstance(ours, tuple):
        for a, b in zip(ours, theirs):
            same(a, b, k)
    else:
        np.testing.assert_array_equal(ours[k], theirs)


@pytest.mark.parametrize("engine", ["numpy", "loops", "numba"])
@pytest.mark.parametrize("ask", ASKED)
@pytest.mark.parametrize("over", ["u", ("u", "k"), 1])
def test_each_is_what_it_is_alone(engine, ask, over):
    with running(engine) as run_under:
        one = ask(s2sad.differentiate(chain, engine=run_under))
        u, k = U if over != 1 else U[0], K if over != "u" else 0.7
        before = copy.deepcopy((u, k))
        for workers in (1, 3) if engine != "loops" else (1,):
            found = s2sad.batched(one, over, workers=workers)(u, k)
            for place in range(7):
                alone = (u if over == 1 else u[place]).copy(), k if over == "u" else k[place].item()
                wanted = s2sad.differentiate(chain, engine=run_under).primal(*alone) if one.__class__.__name__ == (
                    "Differentiated") else one(*alone)
                same(found, wanted, place)
        np.testing.assert_array_equal(u, before[0])
        np.testing.assert_array_equal(k, before[1])


@pytest.mark.parametrize("engine", ["numpy", "numba"])
def test_gradients_are_those_of_differences(engine):
    f, v = s2sad.differentiate(chain, engine=engine), np.random.default_rng(2).standard_normal(U.shape)
    value = s2sad.batched(f, ("u", "k"))

    def central(h):
        return (value(U + h * v, K) - value(U - h * v, K)) / (2.0 * h)
    wanted = (4.0 * central(5e-4) - central(1e-3)) / 3.0
    found = s2sad.batched(s2sad.gradient(f, "u"), ("u", "k"))(U, K)
    np.testing.assert_allclose(np.sum(found * v, axis=1), wanted, rtol=1e-9)
    tangents = [s2sad.jvp(f, (u.copy(), k.item()), {"u": d.copy()}, of="return")["return"] for u, k, d in zip(U, K, v)]
    np.testing.assert_allclose(np.sum(found * v, axis=1), tangents, rtol=1e-12)


def test_results_of_several_kinds():
    found = s2sad.batched(parts, "u")(U, 2.0)
    np.testing.assert_array_equal(found[0], 2.0 * U[:, 1:])
    np.testing.assert_allclose(found[1], U.sum(axis=1))
    np.testing.assert_array_equal(found[2], [4] * 7)


def test_inputs_in_structures():
    s = Spring(U, 2.0, 2)
    value = s2sad.batched(spring, ("s", "k"))(s, K)
    np.testing.assert_array_equal(s.x, U)
    for k in range(7):
        np.testing.assert_allclose(value[k], spring(Spring(U[k].copy(), 2.0, 2), K[k]), rtol=1e-14)
    found = s2sad.batched(s2sad.gradient(spring, "s"), ("s", "k"))(s, K)
    assert isinstance(found, Spring) and found.x.shape == U.shape and found.stiffness.shape == (7,) and found.order == 2
    alone = s2sad.gradient(spring, "s")(Spring(U[3].copy(), 2.0, 2), K[3].item())
    np.testing.assert_array_equal(found.x[3], alone.x)
    none = s2sad.batched(s2sad.gradient(spring, "s"), "s")(Spring(U[:0], 2.0, 2), 1.0)
    assert none.x.shape == (0, 4) and none.stiffness.shape == (0,)


def test_an_array_of_the_module_is_written_by_one_call_at_a_time():
    f = s2sad.differentiate(outside, engine="numba")
    many, ks = np.tile(U, (40, 1)), np.tile(K, 40)
    found = s2sad.batched(f, ("u", "k"), workers=4)(many, ks)
    np.testing.assert_allclose(found, [np.sum(u * k * (u * k)[::-1]) for u, k in zip(many, ks)], rtol=1e-13)
    slopes = s2sad.batched(s2sad.gradient(f, "u"), ("u", "k"), workers=4)(many, ks)
    np.testing.assert_allclose(slopes, [2.0 * k * k * u[::-1] for u, k in zip(many, ks)], rtol=1e-13)


def test_how_inputs_may_lie():
    ask = s2sad.batched(s2sad.gradient(chain, "u"), "u")
    wanted, frozen = ask(U, 0.7), U.copy()
    frozen.flags.writeable = False
    for u in (np.asfortranarray(U), frozen, np.repeat(U, 2, axis=0)[::2]):
        np.testing.assert_array_equal(ask(u, 0.7), wanted)
    same_rows = np.broadcast_to(U[0], (3, 4))
    for values in (ask(same_rows, 0.7), s2sad.batched(chain, "u")(same_rows, 0.7)):
        np.testing.assert_array_equal(values[0], values[2])
    np.testing.assert_array_equal(pickle.loads(pickle.dumps(ask))(U, k=0.7), wanted)
    assert repr(ask) == "<chain over u>"


def test_no_input():
    none = np.zeros((0, 4))
    assert s2sad.batched(s2sad.gradient(chain, "u"), "u")(none, 0.7).shape == (0, 4)
    value, by_name = s2sad.batched(s2sad.value_and_gradient(chain, ("u", "k")), "u")(none, 0.7)
    assert value.shape == (0,) and by_name["u"].shape == (0, 4) and by_name["k"].shape == (0,)
    with pytest.raises(s2sad.S2sadError) as caught:
        s2sad.batched(chain, "u")(none, 0.7)
    assert one_line(caught.value) == ("there is no input of 'chain', and only a run tells the shape of what it "
                                      "returns: give one, or take its gradient")


def fails(u, k):
    if k > 1.0:
        raise ValueError("too stiff")
    return np.sum(u) * k


def test_what_f_raises_is_raised():
    for workers in (1, 3):
        with pytest.raises(ValueError, match="too stiff"):
            s2sad.batched(fails, ("u", "k"), workers=workers)(U, K)


@pytest.mark.parametrize(("wanted", "ask"), [
    ("'u' has 7 inputs, 'k' has 3: give all of them as many", lambda: s2sad.batched(chain, ("u", "k"))(U, K[:3])),
    ("'k' has no axis of inputs: it is of type float: give an array of shape (k, ...), k inputs",
     lambda: s2sad.batched(chain, "k")(U[0], 0.7)),
    ("'u' has no axis of inputs: it is an array of shape (): give an array of shape (k, ...), k inputs",
     lambda: s2sad.batched(chain, "u")(np.array(1.0), 0.7)),
    ("parts of 's' have 7 inputs and 3: give all of them as many",
     lambda: s2sad.batched(spring, "s")({"x": U, "y": U[:3]}, 0.7)),
    ("over names 'q', which is no parameter of 'chain': its parameters are u, k", lambda: s2sad.batched(chain, "q")),
    ("over names no parameter: over=\"u\"", lambda: s2sad.batched(chain, ())),
    ("there are no 0 workers: give how many threads: 2", lambda: s2sad.batched(chain, "u", workers=0)),
    ("'silent' returns nothing: write a function that returns what it computes",
     lambda: s2sad.batched(silent, "u")(U, 0.7)),
    ("'longer' gives arrays of shapes (1,) and (2,): call it for each input",
     lambda: s2sad.batched(longer, "n")(1.0, np.array([1, 2]))),
    ("3 is no function of Python's: give the kernel itself", lambda: s2sad.batched(3, "u")),
    ("'chain' gives what has no axis of inputs, of type csr_array: call it for each input",
     lambda: s2sad.batched(s2sad.jacobian(chain, "u", "return", sparse=True), "u")(U, 0.7))])
def test_refusals(wanted, ask):
    with pytest.raises(s2sad.S2sadError) as caught:
        ask()
    assert one_line(caught.value) == wanted
