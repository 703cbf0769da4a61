"""The output beside its Jacobian: what f leaves, and what `jacobian` gives."""
from __future__ import annotations

import copy
import pickle
from types import SimpleNamespace

import numpy as np
import pytest

import s2sad
from tests.harness.engines import one_line, running
from tests.jacobians import kernels
from tests.jacobians.test_jacobian import CASES, NAMES, X, several

MORE = [(kernels.arrow, (np.zeros(6), X.copy()), "u", "du"), (kernels.pick, (X.copy(), 2.0), "u", "u"),
        (kernels.pick, (X.copy(), 2.0), "k", "return"), (kernels.given_back, (X.copy(),), "u", "return")]
CALLS = {"auto": {}, "by rows": {"mode": "reverse"}, "sparse": {"sparse": True},
         "by both": {"sparse": True, "mode": "both"}, "in threads": {"batch": 2, "threads": 3}}


def output(f, args, of):
    """What f returns, or has left in an argument."""
    given = copy.deepcopy(args)
    result = f(*given)
    return result if of == "return" else given[f.__code__.co_varnames.index(of)]


@pytest.mark.parametrize("engine", ["numpy", "loops"])
@pytest.mark.parametrize("how", CALLS)
@pytest.mark.parametrize("case", CASES + MORE, ids=[*NAMES, *(f"{f.__name__}-{wrt}" for f, _, wrt, _ in MORE)])
def test_both_are_given(case, how, engine):
    f, args, wrt, of = case
    before = copy.deepcopy(args)
    with running(engine) as run_under:
        g = s2sad.differentiate(f, engine=run_under)
        both, J = s2sad.value_and_jacobian(g, wrt, of, **CALLS[how]), s2sad.jacobian(g, wrt, of, **CALLS[how])
        for _ in range(2):
            value, found = both(*args)
            wanted = output(f, args, of)
            assert type(value) is type(wanted) or isinstance(wanted, np.float64) and type(value) is float
            np.testing.assert_allclose(value, wanted, rtol=1e-15)
            np.testing.assert_array_equal(*(m.toarray() if "sparse" in CALLS[how] else m for m in (found, J(*args))))
            if isinstance(value, np.ndarray):
                assert not any(np.shares_memory(value, a) for a in args if isinstance(a, np.ndarray))
    for ours, theirs in zip(args, before):
        np.testing.assert_array_equal(ours, theirs)


def test_compiled_values():
    f = s2sad.differentiate(kernels.in_place, engine="numba", wrt="u")
    value, J = s2sad.value_and_jacobian(f, sparse=True)(X, 0.3)
    np.testing.assert_allclose(value, output(kernels.in_place, (X, 0.3), "u"), rtol=1e-15)
    np.testing.assert_array_equal(J.toarray(), s2sad.jacobian(f)(X, 0.3))


def squares(state):
    return state.u ** 2 * state.k


def test_of_structures_many_inputs_and_other_processes():
    f = s2sad.differentiate(squares, engine="numpy")
    value, J = s2sad.value_and_jacobian(f, "state.u")(SimpleNamespace(u=X, k=2.0))
    np.testing.assert_array_equal(value, 2.0 * X ** 2)
    np.testing.assert_array_equal(J, np.diag(4.0 * X))
    both = s2sad.value_and_jacobian(kernels.given_back)
    values, matrices = s2sad.batched(both, over="u")(np.stack([X, 2.0 * X]))
    np.testing.assert_array_equal(values, np.stack([X, 2.0 * X]))
    assert matrices.shape == (2, 6, 6)
    again = pickle.loads(pickle.dumps(s2sad.value_and_jacobian(kernels.in_place, "u", sparse=True, threads=2)))
    np.testing.assert_array_equal(again(X, 0.3)[1].toarray(), s2sad.jacobian(kernels.in_place, "u")(X, 0.3))
    assert repr(again) == "<value_and_Jacobian of in_place>"


def test_an_optimizer_takes_steps_with_it():
    """Newton's method."""
    both, u = s2sad.value_and_jacobian(s2sad.differentiate(cubes, engine="numpy")), np.ones(3)
    for _ in range(12):
        value, J = both(u)
        u = u - np.linalg.solve(J, value)
    np.testing.assert_allclose(cubes(u), np.zeros(3), atol=1e-13)


def cubes(u):
    return u ** 3 - np.array([1.0, 8.0, 27.0])


def fails(u):
    if u[0] > 0.0:
        raise ValueError("u is positive")
    return u * 2.0


def in_a_kernel(u):
    value, J = s2sad.value_and_jacobian(cubes)(u)
    return np.sum(J @ value)


def of_second_order(u):
    return np.sum(s2sad.hessian(kernels.to_a_number)(u))


@pytest.mark.parametrize(("wanted", "ask"), [
    ("'several' returns 2 values: a Jacobian is of one: write a function that returns it",
     lambda: s2sad.value_and_jacobian(several, "u")(X, X)),
    ("there is no mode 'diagonal': \"auto\", \"forward\", \"reverse\" or \"both\"",
     lambda: s2sad.value_and_jacobian(cubes, mode="diagonal")),
    ('a dense Jacobian is made by columns or by rows, not by both: mode="auto" takes what is cheaper; sparse=True '
     "takes both", lambda: s2sad.value_and_jacobian(cubes, mode="both")),
    ("there are no 0 threads: give how many: 1, 2, ...", lambda: s2sad.value_and_jacobian(cubes, threads=0)),
    ("there are no True threads: give how many: 1, 2, ...", lambda: s2sad.jacobian(cubes, threads=True)),
    ("there are no 2.0 threads: give how many: 1, 2, ...", lambda: s2sad.hessian(kernels.to_a_number, threads=2.0)),
    ("s2sad.value_and_jacobian is not supported in a kernel: call the function, and s2sad.jacobian of it",
     lambda: s2sad.gradient(in_a_kernel)(X[:3])),
    ('s2sad.hessian is not supported in a kernel: take products with it: s2sad.hvp(f, args, {"x": v})',
     lambda: s2sad.gradient(of_second_order)(X[:3]))])
def test_refusals(wanted, ask):
    with pytest.raises(s2sad.S2sadError) as caught:
        ask()
    assert one_line(caught.value) == wanted


def test_what_f_raises_comes_through():
    with pytest.raises(ValueError, match="u is positive"):
        s2sad.value_and_jacobian(s2sad.differentiate(fails, engine="numpy"))(np.ones(2))
