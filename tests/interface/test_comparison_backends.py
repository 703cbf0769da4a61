"""Gradients by tangents, differences and the complex step: those of the adjoint, in its shape, or refused."""
from __future__ import annotations

import copy
import pickle
import sys

import numpy as np
import pytest

import s2sad
from tests.harness.engines import located, one_line, running

U = np.array([0.3, 0.8, 1.2])


def steps(u, c, n):
    v = u.copy()
    for _ in range(n):
        for i in range(1, v.size):
            v[i] = np.sin(v[i] * v[i - 1]) + c
    return np.sum(v * u)


def written(out, u):
    for i in range(u.size):
        out[i] = u[i] ** 3
    return out[0] * out[1]


def model(m, u):
    return np.sum(m["k"] * u ** 2) + m["b"][0][1]


def branches(u):
    total = 0.0
    for i in range(u.size):
        if u[i] > 0.5:
            total += u[i] ** 2
    return total


def distances(u):
    return np.sum(np.abs(u) * u)


def real_parts(u):
    return np.sum(u * np.real(u))


def farthest(u):
    return abs(u[0])


def in_floats(u):
    work = np.zeros(u.size)
    for i in range(u.size):
        work[i] = u[i] ** 2
    return np.sum(work)


def stairs(u):
    return float(int(u[0] * 40.0)) * u[1]


CASES = [(steps, (U, 0.4, 3), None), (steps, (U, 0.4, 3), ("c", "u")), (steps, (U, 0.4, 3), "u"),
         (written, (np.zeros(3), U), None), (written, (np.zeros(3), U), "u"),
         (model, ({"k": 2.0, "b": [np.ones(3)]}, U), None),
         (model, ({"k": 2.0, "b": [np.ones(3)]}, U), ("m.k", "u")), (steps, (np.zeros(0), 0.3, 2), None),
         (steps, (U.astype("float32"), 0.4, 3), "u"), (steps, (np.repeat(U, 2)[::2], 0.4, 3), None)]


def same(ours, theirs, rtol):
    assert type(ours) is type(theirs)
    if isinstance(ours, dict):
        assert list(ours) == list(theirs)
        for k in ours:
            same(ours[k], theirs[k], rtol)
    elif isinstance(ours, list):
        for a, b in zip(ours, theirs):
            same(a, b, rtol)
    else:
        assert getattr(ours, "dtype", None) == getattr(theirs, "dtype", None)
        np.testing.assert_allclose(ours, theirs, rtol=rtol, atol=rtol)


@pytest.mark.parametrize("engine", ["numpy", "loops", "numba"])
@pytest.mark.parametrize("case", CASES, ids=[f"{c[0].__name__}-{k}" for k, c in enumerate(CASES)])
def test_every_way_gives_the_same(case, engine):
    f, args, wrt = case
    before = copy.deepcopy(args)
    single = any(getattr(a, "dtype", None) == np.float32 for a in args)
    with running(engine) as run_under:
        g = s2sad.differentiate(f, engine=run_under)
        wanted = s2sad.gradient(g, wrt)(*args)
        for backend, rtol in (("adjoint", 0.0), ("tangent", 1e-13), ("finite", 1e-9), ("complex", 1e-13)):
            found = s2sad.gradient(g, wrt, backend=backend)(*copy.deepcopy(args))
            same(found, wanted, 1e-6 if single else rtol)
            s2sad.gradient(g, wrt, backend=backend)(*args)
    for ours, theirs in zip(args, before):
        same(ours, theirs, 0.0)


@pytest.mark.parametrize("backend", ["tangent", "finite", "complex"])
def test_odd_arguments(backend):
    frozen = U.copy()
    frozen.flags.writeable = False
    wide = np.asfortranarray(np.array([[0.3, 0.5, 0.2], [0.1, 0.7, 0.4]]))
    ask, exact = s2sad.gradient(written, "u", backend=backend), s2sad.gradient(written, "u")
    np.testing.assert_allclose(ask(np.zeros(3), frozen), exact(np.zeros(3), U), rtol=1e-9, atol=1e-10)
    plane = s2sad.gradient(lambda u: np.sum(u * u[0]), backend=backend)(wide)
    np.testing.assert_allclose(plane, s2sad.gradient(lambda u: np.sum(u * u[0]))(wide), rtol=1e-9)
    with pytest.raises(s2sad.S2sadError, match="S404"):
        ask(U, U)
    again = pickle.loads(pickle.dumps(ask))
    np.testing.assert_array_equal(again(np.zeros(3), U), ask(np.zeros(3), U))
    assert again.names == ("u",)


def test_what_has_a_comparison_has_differences_and_tangents():
    for backend in ("tangent", "finite"):
        np.testing.assert_allclose(s2sad.gradient(branches, backend=backend)(U), [0.0, 1.6, 2.4], atol=1e-9)


CAUSE = (": the complex step would give another number: abs, conj, real or imag are the cause: take "
         "backend=\"tangent\", or write np.sqrt(x * x) for abs(x)")


@pytest.mark.parametrize(("wanted", "kernel"), [
    ("S201 at `u[i] > 0.5`: a comparison of complex values: compare np.abs(z), z.real or z.imag", branches),
    (f"S405: 'distances' is not analytic, it has other slopes beside the real line than along it in 'u'{CAUSE}",
     distances),
    (f"S405: 'real_parts' is not analytic, it has other slopes beside the real line than along it in 'u'{CAUSE}",
     real_parts), (f"S405: 'farthest' is not analytic, it has a float of complex numbers{CAUSE}", farthest),
    ("S201 at `work[i] = u[i] ** 2`: a complex value is stored in float64, where its imaginary part is lost: store its "
     "real part: .real", in_floats)])
@pytest.mark.parametrize("engine", ["numpy", "numba"])
def test_no_complex_step(wanted, kernel, engine):
    with pytest.raises(s2sad.S2sadError) as caught:
        s2sad.gradient(s2sad.differentiate(kernel, engine=engine), backend="complex")(U)
    assert located(caught.value) == wanted


def phase(z):
    return np.sum(np.abs(z))


@pytest.mark.parametrize(("wanted", "ask"), [
    ("there is no backend 'reverse': \"adjoint\", \"tangent\", \"finite\" or \"complex\"",
     lambda: s2sad.gradient(steps, backend="reverse")),  # pyright: ignore[reportArgumentType]
    ("'z' of 'phase' is complex, and only the adjoint has a gradient for it: backend=\"adjoint\"",
     lambda: s2sad.gradient(phase, backend="tangent")(U + 1j)),
    ("what a call takes is said of the adjoint of 'steps': backend=\"adjoint\"",
     lambda: s2sad.gradient(steps, backend="finite").memory(U, 0.4, 3))])
def test_refusals(wanted, ask):
    with pytest.raises(s2sad.S2sadError) as caught:
        ask()
    assert one_line(caught.value) == wanted


def test_differences_that_are_not_sure():
    with pytest.raises(s2sad.S2sadError, match="S405.*differences of 'stairs' say nothing sure of 'u' at element 0"):
        s2sad.gradient(stairs, backend="finite")(U)


def test_differences_need_scipy(monkeypatch):
    monkeypatch.setitem(sys.modules, "scipy.differentiate", None)
    with pytest.raises(s2sad.S2sadError) as caught:
        s2sad.gradient(steps, "c", backend="finite")(U, 0.4, 3)
    assert one_line(caught.value) == ('backend="finite" needs SciPy, which is not installed: pip install "s2sad[jit]", '
                                      'or take backend="tangent"')
