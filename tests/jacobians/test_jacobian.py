"""Jacobians against differences and against each other: by columns, by rows, by colours."""
from __future__ import annotations

import copy
import pickle
import threading

import numpy as np
import pytest

import s2sad
from tests.harness.engines import running
from tests.jacobians import kernels

RNG = np.random.default_rng(7)
U = RNG.uniform(0.5, 1.5, (3, 3, 2))
X = np.array([0.4, -0.7, 1.3, 0.2, -1.1, 0.9])
CASES = [
    (kernels.brusselator, (np.zeros_like(U), U, np.array([3.4, 1.0, 10.0])), "u", "du"),
    (kernels.brusselator, (np.zeros_like(U), U, np.array([3.4, 1.0, 10.0])), "p", "du"),
    (kernels.in_place, (X.copy(), 0.3), "u", "u"), (kernels.in_place, (X.copy(), 0.3), "c", "u"),
    (kernels.of_numbers, (0.7, 1.3), "a", "return"),
    (kernels.to_an_array, (RNG.uniform(0.1, 1.0, (4, 2)),), "x", "return"),
    (kernels.to_a_number, (X.copy(),), "x", "return"), (kernels.upwind, (np.zeros_like(X), X.copy()), "u", "du")]
NAMES = [f"{f.__name__}-{wrt}" for f, _, wrt, _ in CASES]


def differenced(f, args, wrt, of):
    """The Jacobian by extrapolated central differences."""
    place = f.__code__.co_varnames.index(wrt)

    def at(direction, h):
        given = [*copy.deepcopy(args)]
        given[place] = given[place] + h * direction
        result = f(*given)
        return np.array(result if of == "return" else given[f.__code__.co_varnames.index(of)])

    def along(direction, h):
        return (at(direction, h) - at(direction, -h)) / (2.0 * h)
    columns = []
    for k in range(np.size(args[place])):
        direction = np.zeros(np.size(args[place]))
        direction[k] = 1.0
        direction = direction.reshape(np.shape(args[place])) if np.ndim(args[place]) else 1.0
        columns.append((4.0 * along(direction, 5e-4) - along(direction, 1e-3)) / 3.0)
    return np.stack(columns, axis=-1).reshape(columns[0].shape + np.shape(args[place]))


@pytest.mark.parametrize("engine", ["numpy", "loops", "numba"])
@pytest.mark.parametrize("case", CASES, ids=NAMES)
def test_every_way_gives_the_same(case, engine):
    f, args, wrt, of = case
    before, wanted = copy.deepcopy(args), differenced(*case)
    with running(engine) as run_under:
        g = s2sad.differentiate(f, engine=run_under)
        for mode in ("forward", "reverse", "auto"):
            found = s2sad.jacobian(g, wrt, of, mode=mode)(*args)
            assert found.shape == wanted.shape
            np.testing.assert_allclose(found, wanted, rtol=1e-8, atol=1e-9)
            for form in ("csr", "csc", "coo"):
                sparse = s2sad.jacobian(g, wrt, of, mode=mode, sparse=True, format=form)(*args)
                assert sparse.format == form
                np.testing.assert_allclose(sparse.toarray(), found.reshape(sparse.shape), rtol=1e-14, atol=1e-15)
    for ours, theirs in zip(args, before):
        np.testing.assert_array_equal(ours, theirs)


def test_the_pattern_is_exact_and_its_colours_are_few():
    args = np.zeros((32, 32, 2)), np.ones((32, 32, 2)), np.array([3.4, 1.0, 10.0])
    plan = s2sad.jacobian(s2sad.differentiate(kernels.brusselator), "u", "du", sparse=True).plan(*args)
    assert (plan.shape, len(plan.indices), plan.colors, plan.mode) == ((2048, 2048), 6 * 2048, 8, "forward")
    assert repr(plan) == "<plan of a 2048 x 2048 matrix: 12288 entries, 8 forward products>"


def test_a_partial_that_is_zero_here_is_an_entry():
    """The products of the pattern are with nan, and zero times nan is nan."""
    J = s2sad.jacobian(s2sad.differentiate(kernels.to_an_array, engine="numpy"), sparse=True)
    assert len(J.plan(np.zeros((4, 2))).indices) == len(J.plan(np.ones((4, 2))).indices) == 12


def test_one_row_is_made_by_an_adjoint():
    f = s2sad.differentiate(kernels.to_a_number, engine="numpy")
    assert s2sad.jacobian(f, sparse=True).plan(X).mode == "reverse"
    assert s2sad.jacobian(f, sparse=True).plan(X).colors == 1


@pytest.mark.parametrize("engine", ["numpy", "loops", "numba"])
def test_what_everything_meets_goes_by_rows_and_columns(engine, tmp_path):
    args = np.zeros(80), np.linspace(0.3, 1.7, 80)
    with running(engine) as run_under:
        f = s2sad.differentiate(kernels.arrow, engine=run_under)
        wanted = s2sad.jacobian(f, "u", "du", mode="forward")(*args)
        for mode in ("both", "auto"):
            J = s2sad.jacobian(f, "u", "du", sparse=True, mode=mode)
            np.testing.assert_allclose(J(*args).toarray(), wanted, rtol=1e-14, atol=1e-15)
        plan = J.plan(*args)
        assert repr(plan) == "<plan of a 80 x 80 matrix: 238 entries, 2 forward and 1 reverse products>"
        plan.save(tmp_path / "plan.npz")
        plan.picture(tmp_path / "plan.svg")
        again = s2sad.jacobian(f, "u", "du", sparse=s2sad.Plan.load(tmp_path / "plan.npz"))
        np.testing.assert_array_equal(again(*args).toarray(), J(*args).toarray())
        for lacking in ((0, 3), (3, 3), (3, 0)):        # of the long row, the diagonal, the long column
            smaller = wanted != 0.0
            smaller[lacking] = False
            with pytest.raises(s2sad.S2sadError, match="S403.*lacks entries"):
                s2sad.jacobian(f, "u", "du", sparse=smaller, mode="both")(*args)


def test_what_data_change_is_found_anew():
    J = s2sad.jacobian(s2sad.differentiate(kernels.upwind, engine="numpy"), "u", "du", sparse=True)
    for x in (np.abs(X), -np.abs(X), X):
        np.testing.assert_allclose(J(np.zeros(6), x).toarray(), differenced(
            kernels.upwind, (np.zeros(6), x), "u", "du"), atol=1e-9)


def test_a_plan_serves_other_points_threads_and_processes(tmp_path):
    f = s2sad.differentiate(kernels.in_place, engine="numpy", wrt="u")
    plan = s2sad.jacobian(f, sparse=True).plan(X, 0.3)
    plan.save(tmp_path / "plan.npz")
    plan.picture(tmp_path / "plan.svg")
    assert (tmp_path / "plan.svg").read_text().startswith("<?xml")
    J = s2sad.jacobian(f, sparse=s2sad.Plan.load(tmp_path / "plan.npz"))
    found = {}
    threads = [threading.Thread(target=lambda k=k: found.update({k: J(X + k, 0.3).toarray()})) for k in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for k in range(3):
        np.testing.assert_array_equal(found[k], s2sad.jacobian(f)(X + k, 0.3))
    again = pickle.loads(pickle.dumps(s2sad.jacobian(kernels.in_place, "u", sparse=True)))
    np.testing.assert_array_equal(again(X, 0.3).toarray(), s2sad.jacobian(f)(X, 0.3))


def test_a_pattern_of_the_users():
    f = s2sad.differentiate(kernels.in_place, engine="numpy", wrt="u")
    band = np.tri(6) - np.tri(6, k=-3)
    np.testing.assert_allclose(s2sad.jacobian(f, sparse=np.tri(6))(X, 0.3).toarray(), s2sad.jacobian(f)(X, 0.3))
    with pytest.raises(s2sad.S2sadError, match="S403") as caught:
        s2sad.jacobian(f, sparse=band)(X, 0.3)
    assert caught.value.diagnostics[0].message == (
        "the pattern of the Jacobian of 'in_place' lacks entries: for one more direction the matrix gives something "
        "else than the derivative")
    s2sad.jacobian(f, sparse=band, check=False)(X, 0.3)


def roots(x):
    return np.sqrt(x) + 2.0 * x[::-1]


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_an_entry_that_lacks_may_be_infinite():
    f = s2sad.differentiate(roots, engine="numpy")
    x = np.array([0.0, 1.0])
    with pytest.raises(s2sad.S2sadError, match="S403.*lacks entries"):
        s2sad.jacobian(f, sparse=np.array([[0, 1], [1, 1]]))(x)
    np.testing.assert_array_equal(s2sad.jacobian(f, sparse=True)(x).toarray(), [[np.inf, 2.0], [2.0, 0.5]])


def test_precision_and_emptiness():
    f = s2sad.differentiate(kernels.in_place, engine="numpy", wrt="u")
    single = s2sad.jacobian(f, sparse=True)(X.astype("float32"), 0.3)
    assert single.dtype == s2sad.jacobian(f)(X.astype("float32"), 0.3).dtype == np.float32
    assert s2sad.jacobian(f)(np.zeros(0), 0.3).shape == s2sad.jacobian(f, sparse=True)(np.zeros(0), 0.3).shape == (0, 0)


def several(u, v):
    return u * 2.0, v


def phase(z):
    return np.abs(z)


def holds(model, u):
    return u * model["k"]


@pytest.mark.parametrize(("wanted", "ask"), [
    ("S401: 'of_numbers' has several arguments to differentiate with respect to: a, b",
     lambda: s2sad.jacobian(kernels.of_numbers)(0.7, 1.3)),
    ("S401: wrt names 2 parameters", lambda: s2sad.jacobian(kernels.of_numbers, ("a", "b"))(0.7, 1.3)),
    ("S401: wrt names 'c', which is no parameter of 'of_numbers'",
     lambda: s2sad.jacobian(kernels.of_numbers, "c")(0.7, 1.3)),
    ("S401: 'b' is no output of 'of_numbers', which does not write it",
     lambda: s2sad.jacobian(kernels.of_numbers, "a", "b")(0.7, 1.3)),
    ("S401: 'several' returns 2 values", lambda: s2sad.jacobian(several, "u")(X, X)),
    ("S401: 'z' of 'phase' is complex, and a complex number has two directions",
     lambda: s2sad.jacobian(phase, "z")(1.0 + 1.0j)),
    ("S401: wrt names 'model', which holds 2 floats: model['k'], model['b']",
     lambda: s2sad.jacobian(holds, "model")({"k": 2.0, "b": 1.0}, X)),
    ("S401: 'holds' was given 2 floats: model['k'], u", lambda: s2sad.jacobian(holds)({"k": 2.0}, X)),
    ("S401: wrt names 'model.b', and 'model' has no such part",
     lambda: s2sad.jacobian(holds, "model.b")({"k": 2.0}, X)),
    ("S405: there is no mode 'diagonal'", lambda: s2sad.jacobian(phase, mode="diagonal")),
    ("S405: there is no format 'lil'", lambda: s2sad.jacobian(phase, format="lil")),
    ("S405: the pattern is of shape (2, 2), the matrix of shape (6, 6)",
     lambda: s2sad.jacobian(kernels.in_place, "u", sparse=np.ones((2, 2)))(X, 0.3)),
    ("S405: the plan is for a matrix from (6,) to (6,), here it is from (4,) to (4,)", lambda: s2sad.jacobian(
        kernels.in_place, "u", sparse=s2sad.jacobian(kernels.in_place, "u", sparse=True).plan(X, 0.3))(X[:4] * 1, 0.3)),
    ("S401: second derivatives are of a function that returns one float; 'to_an_array' returns float64[:, :]",
     lambda: s2sad.hessian(kernels.to_an_array)(np.ones((3, 2)))),
    ("S403: directions holds none", lambda: s2sad.hvp(kernels.to_a_number, (X,), {})),
    ("S403: the seed of 'x' is an array of float64 of shape (2,), its output one of float64 of shape (6,)",
     lambda: s2sad.hvp(kernels.to_a_number, (X,), {"x": X[:2].copy()})),
])
def test_refusals(wanted, ask):
    with pytest.raises(s2sad.S2sadError) as caught:
        ask()
    found = caught.value.diagnostics[0]
    assert f"{found.code}: {found.message}" == wanted
    assert found.help


def test_an_integrator_takes_it():
    from scipy.integrate import solve_ivp
    du, p, u = np.zeros((3, 3, 2)), np.array([3.4, 1.0, 10.0]), U.reshape(-1)
    f = s2sad.differentiate(kernels.brusselator, engine="numpy")

    def rhs(t, y):
        kernels.brusselator(du, y.reshape(3, 3, 2), p)
        return du.reshape(-1).copy()
    J = s2sad.jacobian(f, "u", "du", sparse=True)
    ours, theirs = (solve_ivp(rhs, (0.0, 0.3), u, method="BDF", jac=jac, rtol=1e-8, atol=1e-10) for jac in (
        lambda t, y: J(du, y.reshape(3, 3, 2), p), None))
    assert ours.success and theirs.success
    np.testing.assert_allclose(ours.y[:, -1], theirs.y[:, -1], rtol=1e-6)
