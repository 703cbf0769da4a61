"""Jacobians by batches of directions: of any width what single directions give, each entry."""
from __future__ import annotations

import copy
import inspect
import warnings
from zlib import crc32

import numpy as np
import pytest

import s2sad
from benchmarks.kernels.cases import CASES
from s2sad.interface.value_calls import PreparedCall
from tests import corpus
from s2sad.jacobians.matrix_drivers import FlatCall
from tests.harness.engines import one_line, running
from tests.jacobians import kernels

RNG = np.random.default_rng(11)
X = np.array([0.4, -0.7, 1.3, 0.2, -1.1, 0.9, 0.5])
ENGINES = pytest.mark.parametrize("engine", ["numpy", "loops"])


def columns(f, args, wrt, of):
    """The Jacobian from the derivatives for one direction each."""
    value = args[list(inspect.signature(f).parameters).index(wrt)]
    units = np.eye(np.size(value), dtype=getattr(value, "dtype", float)).reshape(np.size(value), *np.shape(value))
    # behind them one of zeros, which has the shape where there is none
    along = [s2sad.jvp(f, args, {wrt: u if u.ndim else u.item()}, of=of)[of] for u in (*units, 0.0 * np.array(value))]
    return np.stack(along, axis=-1)[..., :-1].reshape(np.shape(along[0]) + np.shape(value))


def compared(f, args, wrt, of, batches=(1, 3, 16, "auto"), modes=("forward", "reverse")):
    """Raises AssertionError unless dense and sparse Jacobians are the products of single directions; twice, since
    memory and plans are those of the call before."""
    before, wanted = copy.deepcopy(args), columns(f, args, wrt, of)
    scale = np.abs(wanted).max(initial=0.0, where=np.isfinite(wanted))
    for mode in modes:
        for batch in batches:
            for sparse in (False, True):
                J = s2sad.jacobian(f, wrt, of, mode=mode, sparse=sparse, batch=batch)
                for _ in range(2):
                    found = J(*args).toarray().reshape(wanted.shape) if sparse else J(*args)
                    np.testing.assert_allclose(found, wanted, rtol=1e-13, atol=1e-14 * scale)
    for ours, theirs in zip(args, before):
        np.testing.assert_array_equal(ours, theirs)


@ENGINES
@pytest.mark.parametrize("name", ["upwind", "brusselator", "advect", "seidel"])
def test_batches_of_any_width_give_the_products_of_single_directions(name, engine):
    case = CASES[name]
    with running(engine) as under:
        f = s2sad.differentiate(case.function, engine=under)
        compared(f, case.arguments("small"), case.wrt[0], case.of[0], batches=(3, "auto"))


@ENGINES
@pytest.mark.parametrize(("kernel", "args", "wrt", "of"), [
    (kernels.in_place, (X.copy(), 0.3), "u", "u"), (kernels.in_place, (X.copy(), 0.3), "c", "u"),
    (kernels.of_numbers, (0.7, 1.3), "a", "return"), (kernels.to_a_number, (X.copy(),), "x", "return"),
    (kernels.to_an_array, (RNG.uniform(0.1, 1.0, (4, 2)),), "x", "return"),
    (kernels.upwind, (np.zeros(7), X.copy()), "u", "du")])
def test_widths_with_and_without_a_remainder(kernel, args, wrt, of, engine):
    with running(engine) as under:
        compared(s2sad.differentiate(kernel, engine=under), args, wrt, of)


def test_compiled_batches():
    f = s2sad.differentiate(kernels.in_place, engine="numba")
    compared(f, (np.resize(X, 21), 0.3), "u", "u", batches=(3, "auto"))


def vectors():
    """Some kernels of the corpus with an array of float64, and an array that is written or returned, chosen by their
    names."""
    for name, case in corpus.cases():
        if crc32(name.encode()) % 70:
            continue
        names = list(inspect.signature(case.kernel).parameters)
        wrt = next((n for n, a in zip(names, case.arguments) if (case.wrt is None or n in case.wrt) and (
            isinstance(a, np.ndarray) and a.dtype == float)), None)
        if not case.refused and wrt is not None:
            yield pytest.param(case.kernel, case.arguments, wrt, (case.of or ("return",))[0], id=name)


@ENGINES
@pytest.mark.parametrize(("kernel", "args", "wrt", "of"), [*vectors()])
def test_of_the_corpus(kernel, args, wrt, of, engine):
    with running(engine) as under, warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        f = s2sad.differentiate(kernel, engine=under)
        try:
            s2sad.jacobian(f, wrt, of)(*copy.deepcopy(args))
        except s2sad.S2sadError as refused:
            assert refused.diagnostics[0].code in ("S401", "S405")
            return
        compared(f, args, wrt, of, batches=(3,))


def cubic(x, a):
    return x ** 3 - a


@s2sad.rule(implicit=cubic)
def cube_root(a):
    return np.cbrt(a)


def roots(y, x):
    for i in range(1, x.size):
        y[i] = x[i - 1] * cube_root(x[i])


def decays(u, steps):
    for _ in range(steps):
        for i in range(1, u.size):
            u[i] = u[i] - 0.1 * u[i] ** 2 * u[i - 1]


@ENGINES
@pytest.mark.parametrize(("kernel", "args", "wrt", "of", "recording", "modes"), [
    (roots, (np.zeros(5), np.arange(1.0, 6.0)), "x", "y", {}, ("forward", "reverse")),
    (decays, (X[:5].copy(), 6), "u", "u", {"checkpoint": "1 MB"}, ("reverse",))])
def test_what_batches_do_one_by_one(kernel, args, wrt, of, recording, modes, engine):
    """A derivative of the user's own, a limit for the memory."""
    with running(engine) as under:
        f = s2sad.differentiate(kernel, engine=under, **recording)
        for mode in modes:
            J = s2sad.jacobian(f, wrt, of, mode=mode)
            assert J.linear_map(FlatCall.of(J.__wrapped__, args, {})).width(9, mode == "reverse") == 1
        compared(f, args, wrt, of, batches=(3, "auto"), modes=modes)


@ENGINES
def test_a_plan_is_for_the_shapes_that_it_was_made_for(engine):
    with running(engine) as under:
        f = s2sad.differentiate(kernels.in_place, engine=under)
        J = s2sad.jacobian(f, "u", "u", sparse=True)
        for size in (7, 3, 7, 1):
            np.testing.assert_array_equal(J(X[:size].copy(), 0.3).toarray(), s2sad.jacobian(f, "u", "u")(
                X[:size].copy(), 0.3))
        given = s2sad.jacobian(f, "u", "u", sparse=J.plan(X, 0.3))
        with pytest.raises(s2sad.S2sadError, match=r"the plan is for a matrix from \(7,\) to \(7,\), here it is"):
            given(X[:3].copy(), 0.3)
        np.testing.assert_array_equal(given(X, 0.3).toarray(), J(X, 0.3).toarray())


@ENGINES
@pytest.mark.parametrize("batch", [1, 2, 3, "auto"])
@pytest.mark.parametrize("mode", ["forward", "reverse"])
def test_a_pattern_that_is_too_small_stays_an_error(engine, batch, mode):
    lacks = np.tri(7) - np.tri(7, k=-4)
    with running(engine) as under:
        f = s2sad.differentiate(kernels.in_place, engine=under)
        with pytest.raises(s2sad.S2sadError, match="S403.*lacks entries"):
            s2sad.jacobian(f, "u", "u", mode=mode, sparse=lacks, batch=batch)(X, 0.3)
        s2sad.jacobian(f, "u", "u", mode=mode, sparse=lacks, batch=batch, check=False)(X, 0.3)


def cancelling(x):
    """All but nothing is left of what the second element does, and that differs with the direction."""
    a = x[1] * 0.1
    b = x[1] * 0.2
    return x[0] * 3.0 + (a + b) * 0.7 - x[1] * 0.21


@ENGINES
@pytest.mark.parametrize("mode", ["forward", "reverse"])
def test_rounding_errors_are_no_entries_that_lack(engine, mode):
    with running(engine) as under:
        f, x = s2sad.differentiate(cancelling, engine=under), np.array([0.3, 0.7])
        found = s2sad.jacobian(f, mode=mode, sparse=True)(x).toarray()
        assert found[0, 0] == 3.0 and 0.0 < abs(found[0, 1]) < 1e-15
        with pytest.raises(s2sad.S2sadError, match="S403.*lacks entries"):
            s2sad.jacobian(f, mode=mode, sparse=np.array([[0, 1]]))(x)


def test_arguments_of_other_types_and_layouts():
    f = s2sad.differentiate(kernels.to_an_array, engine="numpy")
    J, x = s2sad.jacobian(f), RNG.uniform(0.1, 1.0, (4, 2))
    wanted = J(x)
    np.testing.assert_array_equal(J(np.asfortranarray(x)), wanted)
    np.testing.assert_array_equal(J(np.repeat(x, 2, axis=1)[:, ::2]), wanted)
    np.testing.assert_array_equal(J(x=x), wanted)
    np.testing.assert_allclose(J(x.astype("float32")), wanted, rtol=1e-5)
    g = s2sad.jacobian(s2sad.differentiate(kernels.of_numbers, engine="numpy"), "a")
    assert g(1.0, 2) == g(1.0, 2.0)


@pytest.mark.parametrize("batch", [0, -1, 2.0, True, "all", None])
def test_batches_that_are_none(batch):
    with pytest.raises(s2sad.S2sadError) as caught:
        s2sad.jacobian(kernels.in_place, "u", "u", batch=batch)
    assert one_line(caught.value) == (
        f'there is no batch of {batch!r} directions: "auto", or how many at once: 1, 2, ...')


@ENGINES
def test_the_primal_runs_once_for_a_batch(engine, monkeypatch):
    """The products of one batch, with the direction of the check, are one call of the derivative."""
    args, called = (np.zeros((5, 5, 2)), np.ones((5, 5, 2)), np.array([3.4, 1.0, 10.0])), []
    with running(engine) as under:
        J = s2sad.jacobian(s2sad.differentiate(kernels.brusselator, engine=under), "u", "du", sparse=True)
        plan = J.plan(*args)
        J(*args)
        call = PreparedCall.call
        monkeypatch.setattr(PreparedCall, "call", lambda *given: called.append(given) or call(*given))
        J(*args)
    assert plan.colors + 1 > 8
    assert len(called) == 1
