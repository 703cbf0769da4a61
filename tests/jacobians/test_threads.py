"""Threads share the directions of a matrix: the same digits for any number of them, and what one raises."""
from __future__ import annotations

import threading

import numpy as np
import pytest

import s2sad
from s2sad.interface.value_calls import PreparedCall
from tests.harness.engines import running
from tests.jacobians import kernels

X = np.linspace(0.3, 1.7, 23)
U = np.random.default_rng(5).uniform(0.5, 1.5, (4, 4, 2))
CASES = [(kernels.in_place, (X, 0.3), "u", "u"), (kernels.to_a_number, (X,), "x", "return"),
         (kernels.brusselator, (np.zeros_like(U), U, np.array([3.4, 1.0, 10.0])), "u", "du"),
         (kernels.arrow, (np.zeros(23), X), "u", "du")]


def matrices(f, args, wrt, of, threads):
    """Matrices of every kind: by columns, by rows, by colours."""
    for mode in ("forward", "reverse"):
        yield s2sad.jacobian(f, wrt, of, mode=mode, batch=3, threads=threads)(*args)
    for mode in ("forward", "reverse", "both"):
        yield s2sad.jacobian(f, wrt, of, mode=mode, sparse=True, batch=2, threads=threads)(*args).toarray()


@pytest.mark.parametrize("engine", ["numpy", "loops", "numba"])
@pytest.mark.parametrize("case", CASES, ids=[f.__name__ for f, *_ in CASES])
def test_the_same_digits_for_any_number_of_threads(case, engine):
    f, args, wrt, of = case
    with running(engine) as run_under:
        g = s2sad.differentiate(f, engine=run_under)
        wanted = [*matrices(g, args, wrt, of, 1)]
        for threads in (2, 3, 50):
            for ours, theirs in zip(matrices(g, args, wrt, of, threads), wanted):
                np.testing.assert_array_equal(ours, theirs)


@pytest.mark.parametrize("engine", ["numpy", "loops"])
def test_hessians(engine):
    with running(engine) as run_under:
        f = s2sad.differentiate(kernels.energy, engine=run_under)
        for sparse in (False, True):
            one, three = (s2sad.hessian(f, "x", sparse=sparse, threads=n)(X, 0.5) for n in (1, 3))
            np.testing.assert_array_equal(*(m.toarray() if sparse else m for m in (one, three)))


def test_so_many_threads_call(monkeypatch):
    """Each has its part of the batches; the first of all is the caller's."""
    J, called = s2sad.jacobian(s2sad.differentiate(kernels.in_place, engine="numba"), "u", "u", batch=2, threads=3), []
    wanted, call = J(X, 0.3), PreparedCall.call
    monkeypatch.setattr(PreparedCall, "call", lambda *given: called.append(threading.get_ident()) or call(*given))
    np.testing.assert_array_equal(J(X, 0.3), wanted)
    assert len(called) == 12 and called[0] == threading.get_ident()
    assert called.count(threading.get_ident()) == 1


def roots(x):
    return np.sqrt(x)


def test_what_a_thread_raises():
    """Each thread has the caller's way with floating-point errors."""
    x = np.append(np.ones(9), 0.0)
    J = s2sad.jacobian(s2sad.differentiate(roots, engine="numpy"), mode="forward", batch=1, threads=2)
    with np.errstate(all="ignore"):
        assert np.isinf(J(x)[9, 9])
    with np.errstate(all="raise"), pytest.raises(FloatingPointError):
        J(x)
