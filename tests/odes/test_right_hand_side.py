"""Kernels as right-hand sides: what SciPy's integrators get, against the kernels and differences of them."""
from __future__ import annotations

import copy
import pickle

import numpy as np
import pytest

import s2sad
from tests.harness.engines import one_line, running
from tests.odes import kernels

P = np.array([1.5, 1.0, 0.7, 1.2])
Z = np.array([1.3, 0.8])
Y = np.linspace(0.5, 1.5, 6)
CASES = [(kernels.hunters, {}, Z, (P,)), (kernels.hunters_in_place, {}, Z, (P,)),
         (kernels.grid, {"shape": (2, 3)}, Y, (0.3,)), (kernels.number, {"shape": ()}, np.array([0.7]), ()),
         (kernels.number, {}, Y, (0.4,)), (kernels.overwrites_its_state, {}, Y, ()),
         (kernels.by_name, {"rate": "pace", "state": "x", "time": "clock"}, Y, (0.4,))]
NAMES = [f"{f.__name__}-{k}" for k, (f, *_) in enumerate(CASES)]


def differenced(fun, t, y, args):
    """The Jacobian by extrapolated central differences."""
    def central(e, h):
        return (fun(t, y + h * e, *args) - fun(t, y - h * e, *args)) / (2.0 * h)
    return np.stack([(4.0 * central(e, 5e-4) - central(e, 1e-3)) / 3.0 for e in np.eye(y.size)], axis=1)


@pytest.mark.parametrize("engine", ["numpy", "loops", "numba"])
@pytest.mark.parametrize("case", CASES, ids=NAMES)
def test_rates_and_their_jacobians(case, engine):
    f, options, y, args = case
    before = copy.deepcopy((y, args))
    with running(engine) as run_under:
        g = s2sad.differentiate(f, engine=run_under)
        fun, thin = s2sad.ode(g, **options), s2sad.ode(g, sparse=True, **options)
        rates, found = fun(0.4, y, *args), fun.jac(0.4, y, *args)
        assert rates.shape == y.shape and found.shape == (y.size, y.size)
        np.testing.assert_allclose(found, differenced(fun, 0.4, y, args), rtol=1e-8, atol=1e-9)
        np.testing.assert_allclose(thin.jac(0.4, y, *args).toarray(), found, rtol=1e-14, atol=1e-15)
        v, w = np.linspace(-1.0, 2.0, y.size), np.cos(np.arange(y.size))
        forwards, backwards = (s2sad.jacobian(fun.kernel, fun.state, fun.rate, mode=mode)(*fun.values(0.4, y, args))
                               for mode in ("forward", "reverse"))
        np.testing.assert_allclose(w @ (forwards.reshape(found.shape) @ v), (w @ backwards.reshape(found.shape)) @ v,
                                   rtol=1e-13)
    np.testing.assert_array_equal(y, before[0])
    np.testing.assert_array_equal(args[0] if args else 0.0, before[1][0] if args else 0.0)


def test_rates_are_the_kernel_s():
    u, du = Y.reshape(2, 3), np.zeros((2, 3))
    kernels.grid(du, u, 0.3, 0.4)
    np.testing.assert_allclose(s2sad.ode(kernels.grid, shape=(2, 3))(0.4, Y, 0.3), du.reshape(-1), rtol=1e-15)
    np.testing.assert_allclose(s2sad.ode(kernels.hunters)(0.0, Z, P), kernels.hunters(0.0, Z, P), rtol=1e-15)


def test_what_is_beside_the_state_may_be_a_structure():
    fun, model = s2sad.ode(kernels.in_a_model), {"k": 2.0, "source": np.ones(6)}
    np.testing.assert_allclose(fun(0.0, Y, model), 1.0 - 2.0 * Y ** 2, rtol=1e-15)
    np.testing.assert_allclose(fun.jac(0.0, Y, model), -4.0 * np.diag(Y), rtol=1e-15)
    assert s2sad.ode(kernels.in_a_model, sparse=True).jac(0.0, Y, model).nnz == 6


def test_what_y_may_be():
    fun = s2sad.ode(kernels.grid, shape=(2, 3))
    frozen, strided = np.arange(6.0), np.repeat(np.arange(6.0), 2)[::2]
    frozen.flags.writeable = False
    wanted = fun(0.4, np.arange(6.0), 0.3), fun.jac(0.4, np.arange(6.0), 0.3)
    for y in (np.arange(6), frozen, strided, [*range(6)], np.arange(6.0).astype("float32")):
        np.testing.assert_array_equal(fun(0.4, y, 0.3), wanted[0])
        np.testing.assert_array_equal(fun.jac(0.4, y, 0.3), wanted[1])
    fun = s2sad.ode(kernels.number)
    assert fun(0.0, np.zeros(0), 1.0).shape == (0,) and fun.jac(0.0, np.zeros(0), 1.0).shape == (0, 0)
    kept = fun(0.0, Y, 1.0)
    before = kept.copy()
    fun(0.0, Y + 1.0, 1.0)
    np.testing.assert_array_equal(kept, before)     # an integrator keeps what it was given


@pytest.mark.parametrize("method", ["BDF", "Radau", "LSODA"])
def test_integrators_take_it(method):
    integrate = pytest.importorskip("scipy.integrate")
    fun = s2sad.ode(kernels.grid, shape=(2, 3), sparse=method != "LSODA")
    ours, theirs = (integrate.solve_ivp(fun, (0.0, 2.0), Y, args=(0.3,), method=method, rtol=1e-8, atol=1e-10, jac=jac)
                    for jac in (fun.jac, None))
    assert ours.success and theirs.success
    np.testing.assert_allclose(ours.y[:, -1], theirs.y[:, -1], rtol=1e-6)


def test_it_is_pickled_as_its_kernel():
    fun = pickle.loads(pickle.dumps(s2sad.ode(kernels.grid, shape=(2, 3), sparse=True)))
    np.testing.assert_array_equal(fun.jac(0.4, Y, 0.3).toarray(), s2sad.ode(
        kernels.grid, shape=(2, 3)).jac(0.4, Y, 0.3))
    assert repr(fun) == "<ode of grid>"


@pytest.mark.parametrize(("wanted", "ask"), [
    ("'forgets' does not write 'du', which should be the rate of 'u': write f(du, u, ...), which writes du, or "
     "f(t, u, ...), which returns it; or name the parameters: rate=, state=, time=",
     lambda: s2sad.ode(kernels.forgets)(0.0, Y)),
    ("'swapped' does not write 'u', which should be the rate of 'du': write f(du, u, ...), which writes du, or "
     "f(t, u, ...), which returns it; or name the parameters: rate=, state=, time=",
     lambda: s2sad.ode(kernels.swapped)(0.0, Y)),
    ("'turned' returns an array of shape (3, 2), its state is of shape (2, 3): return the rate of each element of the "
     "state", lambda: s2sad.ode(kernels.turned, shape=(2, 3))(0.0, Y)),
    ("y is an array of float64 of shape (6,), the state of 'grid' is of shape (2, 2): give a flat array of floats of 4 "
     "elements", lambda: s2sad.ode(kernels.grid, shape=(2, 2))(0.0, Y, 0.3)),
    ("y is an array of object of shape (6,), the state of 'grid' is of shape (2, 3): give a flat array of floats of 6 "
     "elements", lambda: s2sad.ode(kernels.grid, shape=(2, 3))(0.0, Y.astype(object), 0.3)),
    ("'v' is no parameter of 'grid': its parameters are du, u, k, t", lambda: s2sad.ode(kernels.grid, state="v")),
    ("'number' has no parameter for its state: write f(du, u, ...) or f(t, u, ...), or name the parameters: rate=, "
     "state=, time=", lambda: s2sad.ode(kernels.number, state="t")),
    ("(2, -3) is no shape: give sizes: shape=u.shape", lambda: s2sad.ode(kernels.grid, shape=(2, -3))),
    ("3 is no function of Python's: give the kernel itself", lambda: s2sad.ode(3)),
])
def test_refusals(wanted, ask):
    with pytest.raises(s2sad.S2sadError) as caught:
        ask()
    assert one_line(caught.value) == wanted


def test_arguments_that_lack_or_are_too_many():
    fun = s2sad.ode(kernels.grid, shape=(2, 3))
    for args in ((), (0.3, 1.0)):
        with pytest.raises(TypeError, match=rf"'grid' takes 1 arguments beside its state \(k\), but {len(args)} were"):
            fun(0.0, Y, *args)
