"""Second derivatives against differences of gradients, and against their own transposes."""
from __future__ import annotations

import copy
import inspect
import warnings
from zlib import crc32

import numpy as np
import pytest

import s2sad
from s2sad.run.module_loader import load
from tests import corpus
from tests.corpus.recording import rounded_values
from tests.corpus.structures import choices
from tests.harness.engines import one_line, running
from tests.jacobians import kernels

X = np.array([0.4, 1.7, 1.3, 0.2, 2.1, 0.9])
P = np.array([0.7, 1.2])
CASES = [(kernels.energy, (X, 0.5), "x"), (kernels.after_steps, (X, P, 4), "u"), (kernels.after_steps, (X, P, 4), "p"),
         (kernels.fields, (X,), "u"), (kernels.of_numbers, (0.7, 1.3), "a"), (kernels.to_a_number, (X,), "x")]


def along(f, args, wrt, direction):
    """How the gradient changes along a direction, by extrapolated central differences."""
    gradient, place = s2sad.gradient(f, wrt=wrt), list(inspect.signature(f).parameters).index(wrt)

    def at(h):
        given = [*copy.deepcopy(args)]
        given[place] = given[place] + h * direction
        return gradient(*given)

    def central(h):
        return (at(h) - at(-h)) / (2.0 * h)
    return (4.0 * central(5e-5) - central(1e-4)) / 3.0


@pytest.mark.parametrize("engine", ["numpy", "loops", "numba"])
@pytest.mark.parametrize("case", CASES, ids=[f"{f.__name__}-{wrt}" for f, _, wrt in CASES])
def test_hessians(case, engine):
    f, args, wrt = case
    before = copy.deepcopy(args)
    with running(engine) as run_under:
        g = s2sad.differentiate(f, engine=run_under)
        found = s2sad.hessian(g, wrt)(*args)
        value = args[list(inspect.signature(f).parameters).index(wrt)]
        assert found.shape == 2 * np.shape(value)
        np.testing.assert_allclose(found, found.T, rtol=1e-13, atol=1e-14)
        direction = np.linspace(-1.0, 1.0, np.size(value)).reshape(np.shape(value)) if np.ndim(value) else 1.0
        wanted = along(g, args, wrt, direction)
        np.testing.assert_allclose(found @ direction if np.ndim(value) else found, wanted, rtol=1e-7, atol=1e-8)
        np.testing.assert_allclose(s2sad.hvp(g, args, {wrt: direction}), wanted, rtol=1e-7, atol=1e-8)
        sparse = s2sad.hessian(g, wrt, sparse=True)(*args)
        np.testing.assert_allclose(sparse.toarray(), found.reshape(sparse.shape), rtol=1e-13, atol=1e-14)
    for ours, theirs in zip(args, before):
        np.testing.assert_array_equal(ours, theirs)


def test_directions_of_several_arguments():
    f = s2sad.differentiate(kernels.after_steps, engine="numpy")
    found = s2sad.hvp(f, (X, P, 4), {"u": np.ones(6), "p": np.ones(2)}, wrt=("u", "p"))
    mixed = s2sad.hvp(f, (X, P, 4), {"p": np.ones(2)}, wrt="u")
    assert {*found} == {"u", "p"}
    np.testing.assert_allclose(found["u"], s2sad.hessian(f, "u")(X, P, 4) @ np.ones(6) + mixed, rtol=1e-13)


def test_a_chain_has_a_band_for_a_hessian():
    plan = s2sad.hessian(s2sad.differentiate(kernels.energy, engine="numpy"), "x", sparse=True).plan(
        np.linspace(0.0, 3.0, 40), 0.5)
    assert len(plan.indices) == 40 + 2 * 39
    assert plan.colors == 3


def hub(x):
    """All with the first one: an arrow."""
    total = x[0] ** 2
    for i in range(1, x.size):
        total += np.sin(x[i] * x[0]) + x[i] ** 3
    return total


@pytest.mark.parametrize("engine", ["numpy", "loops", "numba"])
def test_an_arrow_takes_two_products(engine):
    x = np.linspace(0.2, 1.4, 20)
    with running(engine) as run_under:
        f = s2sad.differentiate(hub, engine=run_under)
        dense, sparse = s2sad.hessian(f)(x), s2sad.hessian(f, sparse=True)
        plan, made = sparse.plan(x), sparse(x)
        assert repr(plan) == "<plan of a 20 x 20 matrix: 58 entries, 2 symmetric products>"
        np.testing.assert_allclose(made.toarray(), dense, rtol=1e-14, atol=1e-14)
        np.testing.assert_array_equal(made.toarray(), made.toarray().T)
        upper = np.triu(np.ones((20, 20))) * (dense != 0.0)     # of a user's pattern one side will do
        np.testing.assert_array_equal(s2sad.hessian(f, sparse=upper)(x).toarray(), made.toarray())


def test_plans_of_symmetric_matrices(tmp_path):
    x = np.linspace(0.2, 1.4, 20)
    plan = s2sad.hessian(hub, sparse=True).plan(x)
    plan.save(tmp_path / "plan.npz")
    again = s2sad.hessian(hub, sparse=s2sad.Plan.load(tmp_path / "plan.npz"))
    np.testing.assert_allclose(again(x).toarray(), s2sad.hessian(hub)(x), rtol=1e-14, atol=1e-14)
    plan.picture(tmp_path / "plan.svg")
    with pytest.raises(s2sad.S2sadError) as caught:
        s2sad.jacobian(kernels.fields, sparse=plan)
    assert one_line(caught.value) == "the plan is for a symmetric matrix: make one for this Jacobian: J.plan(*args)"
    with pytest.raises(s2sad.S2sadError, match="S403.*the pattern of the Hessian of 'hub' lacks entries"):
        s2sad.hessian(hub, sparse=np.eye(20))(x)
    assert s2sad.hessian(kernels.energy, "x", sparse=True)(np.zeros(0), 0.5).shape == (0, 0)


def numbers():
    """Some kernels of the corpus that return a float, with an argument of float64, chosen by their names: what is added
    to the corpus leaves them. A bisection is none: it is linear between numbers closer than differences tell."""
    for name, case in corpus.cases():
        if crc32(name.encode()) % 60 or case.kernel is choices.a_root_that_may_not_be:
            continue
        names = list(inspect.signature(case.kernel).parameters)
        wrt = next((n for n, a in zip(names, case.arguments) if (case.wrt is None or n in case.wrt) and (
            isinstance(a, float) or isinstance(a, np.ndarray) and a.dtype == float)), None)
        if not case.refused and wrt is not None:
            yield pytest.param(case, wrt, id=name)


@pytest.mark.parametrize("engine", ["numpy", "loops"])
@pytest.mark.parametrize(("case", "wrt"), numbers())
def test_of_the_corpus(case, wrt, engine):
    """Right, or refused: second derivatives of everything that has first ones."""
    args = copy.deepcopy(case.arguments)
    value = args[list(inspect.signature(case.kernel).parameters).index(wrt)]
    direction = np.random.default_rng(3).standard_normal(np.shape(value)) if np.ndim(value) else 1.0
    with running(engine) as run_under, warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        f = s2sad.differentiate(case.kernel, engine=run_under)
        try:
            found = s2sad.hvp(f, args, {wrt: direction})
        except s2sad.S2sadError as refused:
            assert refused.diagnostics[0].code != "S901"
            return
        wanted = along(f, case.arguments, wrt, direction)
    np.testing.assert_allclose(found, wanted, rtol=2e-5, atol=2e-6 * max(1.0, np.abs(wanted).max(initial=0.0)))


@pytest.mark.parametrize("kernel", [rounded_values.product, rounded_values.by_arrays, rounded_values.numbers])
def test_tangents_of_a_written_adjoint(kernel):
    """The text of an adjoint, read as a kernel, has the Hessian for its tangent."""
    text = s2sad.differentiate(kernel, wrt="x", engine="numpy").adjoint_source(X, 3)
    adjoint = s2sad.differentiate(getattr(load(text, "adjoint"), f"{kernel.__name__}_adjoint"), engine="numpy")
    direction = np.linspace(-1.0, 1.0, X.size)
    found = s2sad.jvp(adjoint, (X, np.zeros_like(X), 3, 1.0), {"x": direction}, of=("x_bar",))["x_bar"]
    np.testing.assert_allclose(found, s2sad.hvp(kernel, (X, 3), {"x": direction}), rtol=1e-10, atol=1e-13)


def test_a_direction_that_is_the_argument_itself():
    x = np.array([0.5, 1.5, -1.0])
    for kernel in (rounded_values.product, rounded_values.by_arrays):
        found, expected = (s2sad.hvp(kernel, (x, 3), {"x": v}) for v in (x, x.copy()))
        np.testing.assert_array_equal(found, expected)
        np.testing.assert_array_equal(x, [0.5, 1.5, -1.0])
