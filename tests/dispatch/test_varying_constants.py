"""Numbers outside that change from call to call become arguments; what must be known is compared with each call."""
from __future__ import annotations

import gc
import math
import sys

import numpy as np
import pytest

import s2sad
from s2sad import read
from s2sad.run.compiled import available
from tests.dispatch.test_guards import MODEL, of_a_closure

THIS = sys.modules[__name__]
RATE, POWER, AXES = 2.0, 2, 2


def with_numbers(x, n):
    total = 0.0
    for i in range(n):
        total += scaled_by_the_module(x, i)
    return total ** POWER + MODEL.k * MODEL.part.scale


def scaled_by_the_module(x, i):
    return x * RATE / (1.0 + i)


def of_a_square(x):
    return x * (POWER * POWER)


def of_an_integer(x):
    return x * POWER


def of_options(x):
    return np.sum(np.ones((AXES, 3)) * x, axis=AXES - 2)[0]


def modules():
    gc.collect()
    return {name for name in sys.modules if name.startswith("s2sad_")}


@pytest.mark.usefixtures("own_garbage")
@pytest.mark.parametrize("engine", ["numpy", pytest.param("numba", marks=pytest.mark.skipif(
    not available(), reason="needs Numba"))])
def test_numbers_that_change_in_each_call_become_arguments(monkeypatch, engine):
    readings = []
    monkeypatch.setattr(read, "load", lambda *given, load=read.load: readings.append(given) or load(*given))
    before = modules()
    g = s2sad.value_and_gradient(s2sad.differentiate(with_numbers, engine=engine), wrt="x")
    for k in range(12 if engine == "numba" else 60):
        monkeypatch.setattr(THIS, "RATE", 0.5 + k)
        monkeypatch.setattr(MODEL, "k", 3.0 - k)
        value, slope = g(1.5, 3)
        total = (0.5 + k) * 1.5 * (1.0 + 0.5 + 1.0 / 3.0)
        assert value == pytest.approx(with_numbers(1.5, 3)) and slope == pytest.approx(2.0 * total ** 2 / 1.5)
    assert len(readings) < 12 and len(modules() - before) <= 8
    monkeypatch.setattr(THIS, "RATE", 2)
    assert g(1.5, 3)[0] == pytest.approx(with_numbers(1.5, 3))
    monkeypatch.setattr(THIS, "RATE", np.float32(2.0))
    assert g(1.5, 3)[0] == pytest.approx(with_numbers(1.5, 3))


def test_what_must_be_known_stays_a_constant(monkeypatch):
    g = s2sad.gradient(s2sad.differentiate(of_options, engine="numpy"))
    for axes in (2, 3, 2, 3, 2, 3, 2, 3):
        monkeypatch.setattr(THIS, "AXES", axes)
        if axes == 2:
            assert g(1.0) == 2.0
        else:
            assert g(1.0) == 3.0


def test_integers_that_change(monkeypatch):
    g = s2sad.gradient(s2sad.differentiate(with_numbers, engine="numpy"), wrt="x")
    for power in range(1, 9):
        monkeypatch.setattr(THIS, "POWER", power)
        total = RATE * 1.5 * (1.0 + 0.5 + 1.0 / 3.0)
        assert g(1.5, 3) == pytest.approx(power * total ** power / 1.5)


@pytest.mark.skipif(not available(), reason="needs Numba")
def test_integers_that_change_are_computed_with_exactly(monkeypatch):
    g = s2sad.gradient(s2sad.differentiate(of_a_square, engine="numba"))
    for power in (1, 2, 3, 4, 5, 2 ** 40, 6):
        monkeypatch.setattr(THIS, "POWER", power)
        if power < 2 ** 32:
            assert g(1.0) == power ** 2
        else:
            with pytest.raises(s2sad.S2sadError, match="an integer that does not fit 64 bits"):
                g(1.0)


def test_texts_and_bare_functions_have_no_argument_more(monkeypatch):
    f = s2sad.differentiate(of_an_integer, engine="numpy")
    text = None
    for power in (1, 2, 3, 4, 5, 6, 1):
        monkeypatch.setattr(THIS, "POWER", power)
        assert s2sad.gradient(f)(1.0) == power == f.compiled("adjoint", 1.0, 1.0)(1.0, 1.0)[0]
        text = text or f.adjoint_source(1.0)
    assert f.adjoint_source(1.0) == text


def test_integers_that_become_wide_are_constants_again(monkeypatch):
    g = s2sad.gradient(s2sad.differentiate(of_an_integer, engine="numpy"))
    for power in (1, 2, 3, 4, 5, 2 ** 62, 2 ** 63, 6, -1):
        monkeypatch.setattr(THIS, "POWER", power)
        assert g(1.0) == float(power)


@pytest.mark.usefixtures("own_garbage")
def test_the_dead_free_what_they_took():
    before = modules()
    for k in range(3):
        def local(x, k=k):
            return math.sin(x) * k
        assert s2sad.gradient(s2sad.differentiate(local, engine="numpy"), wrt="x")(0.0) == k
        del local
    assert modules() == before
    inner, assign = of_a_closure()
    for k in range(40):
        assign((float(k), 1.0))     # no number: a tuple stays a constant
        with pytest.raises(s2sad.S2sadError):
            s2sad.gradient(s2sad.differentiate(inner, engine="numpy"))(1.0)
    assert modules() == before
