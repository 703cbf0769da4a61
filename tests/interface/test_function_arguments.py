"""Functions among the arguments of a kernel: its derivative is that for these functions."""
from __future__ import annotations

import enum
import functools
from dataclasses import dataclass

import numpy as np
import pytest

import s2sad
from s2sad import Active, Const, Duplicated, Reverse
from tests.corpus.calls.function_arguments import X, apply, scaled, square

ENGINES = ("numpy", "numba")


def steps(u, f, n, g=np.sin):
    for _ in range(n):
        u[:] = u + 0.1 * f(u) * g(u)
    return np.sum(u ** 2)


@dataclass
class Params:
    k: float
    u: np.ndarray


def of_structures(f, p):
    return p.k * np.sum(f(p.u))


@pytest.mark.parametrize("engine", ENGINES)
def test_each_function_has_a_derivative_of_its_own(engine):
    kernel = s2sad.differentiate(apply, wrt="u", engine=engine)
    for c in (2.0, 3.0):
        assert np.allclose(s2sad.gradient(kernel)(scaled(c), X), 3.0 * c * X ** 2)
    assert np.allclose(s2sad.gradient(kernel)(square, X), 3.0 * X ** 2)
    assert np.allclose(s2sad.gradient(kernel)(u=X, f=np.sin), np.sin(X) + X * np.cos(X))
    assert np.allclose(s2sad.gradient(kernel)(lambda u: u ** 3, X), 4.0 * X ** 3)
    assert np.allclose(s2sad.gradient(kernel)(kernel_of_its_own, X), 3.0 * X ** 2)
    assert kernel.primal(square, X) == pytest.approx(np.sum(X ** 3))
    assert s2sad.value_and_gradient(kernel)(square, X)[0] == pytest.approx(np.sum(X ** 3))


kernel_of_its_own = s2sad.differentiate(square)


@pytest.mark.parametrize("engine", ENGINES)
def test_every_way_to_a_derivative(engine):
    kernel = s2sad.differentiate(steps, engine=engine)
    by_hand = functools.partial(steps, f=square, g=np.cos)
    for arguments, f in (((X, square, 3, np.cos), by_hand), ((X, square, 3), functools.partial(steps, f=square))):
        left = [a for a in arguments if not callable(a)]
        wanted = s2sad.vjp(f, left, {"return": 1.0, "u": X})["u"]
        assert np.array_equal(s2sad.vjp(kernel, arguments, {"return": 1.0, "u": X}, wrt="u")["u"], wanted)
        assert s2sad.jvp(kernel, arguments, {"u": X})["return"] == s2sad.jvp(f, left, {"u": X})["return"]
        assert s2sad.check(kernel, *arguments)
        assert "steps_adjoint" in str(s2sad.explain(kernel, *arguments))
        assert "def steps_adjoint(u, u_bar, n" in kernel.adjoint_source(*arguments)
    bar = np.zeros(3)
    s2sad.autodiff(Reverse, s2sad.differentiate(apply, engine=engine), Const(square), Duplicated(X, bar), seed=1.0)
    assert np.allclose(bar, 3.0 * X ** 2)
    assert s2sad.autodiff(Reverse, of_a_number, square, Active(0.5)) == (1.0,)


def of_a_number(f, x):
    return f(x)


def test_beside_structures():
    found = s2sad.gradient(of_structures)(square, Params(2.0, X))
    assert np.allclose(found.u, 4.0 * X) and found.k == pytest.approx(np.sum(X ** 2))


def square_sum(u):
    return np.sum(u * u)


def test_an_argument_that_is_a_type():
    with pytest.raises(s2sad.S2sadError, match="the argument 'u' is a type"):
        s2sad.gradient(square_sum)(float)


class Flux(enum.Enum):
    UPWIND = enum.auto()
    CENTRAL = enum.auto()


def transported(u, c, flux=Flux.UPWIND):
    if flux is Flux.UPWIND:
        return c * np.sum(u[:-1] * u[1:])
    match flux:
        case Flux.CENTRAL:
            return c * c * np.sum(u ** 2)
        case _:
            raise ValueError(flux)


@pytest.mark.parametrize("engine", ENGINES)
def test_members_of_enumerations(engine):
    kernel = s2sad.differentiate(transported, engine=engine)
    assert s2sad.gradient(kernel, wrt="c")(X, 2.0) == pytest.approx(np.sum(X[:-1] * X[1:]))
    assert s2sad.gradient(kernel, wrt=("c",))(X, 2.0, Flux.CENTRAL) == pytest.approx(4.0 * np.sum(X ** 2))
    assert np.allclose(s2sad.gradient(kernel)(X, 2.0, flux=Flux.CENTRAL)["u"], 8.0 * X)
