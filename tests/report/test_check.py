"""What check finds: a derivative beside differences, the statement that is wrong, and where nothing can be said."""
from __future__ import annotations

import importlib
import math
import re

import numpy as np
import pytest

import s2sad
from benchmarks.kernels.cases import CASES
from s2sad import check
from s2sad.report.check import Checked
from s2sad.report.differences import differences
from s2sad.report.measured_call import MeasuredCall
from s2sad.rules.rule import TABLE, Rule, template


@pytest.mark.parametrize("name", ["advect", "first_crossing", "nbody"])
def test_check_agrees(name):
    case = CASES[name]
    report = check(case.function, *case.arguments("small"), wrt=case.wrt, of=case.of, engine="numpy")
    assert report, str(report)
    assert "agrees" in str(report) and "PARTS" not in str(report)


def test_check_agrees_in_single_precision():
    case = CASES["upwind"]
    du, u, v = case.arguments("small")
    assert check(case.function, du.astype("float32"), u.astype("float32"), v, engine="numpy")


def wave(u, c):
    w = np.empty_like(u)
    for i in range(u.size):
        w[i] = u[i] * c
    for i in range(u.size):
        u[i] = math.sin(w[i]) + u[i]
    scale = math.exp(c)
    return scale * u[0]


FIELD = np.array([0.3, 0.5, 0.9])


def test_check_names_the_first_wrong_statement_of_the_tangent(monkeypatch):
    sine = TABLE.rules["math.sin"]
    wrong = Rule(**{**vars(sine), "partials": {"x": template("1.01 * numpy.cos(x)")}})
    monkeypatch.setitem(TABLE.rules, "math.sin", wrong)
    report = check(wave, FIELD, 1.3, engine="numpy")
    assert not report and report.adjoint_holds and not report.tangent_holds
    assert re.search(r"the tangent parts from the differences first at .*test_check.py:\d+: "
                     r"u\[i\] = math.sin\(w\[i\]\) \+ u\[i\]", str(report))


def test_check_names_the_first_wrong_statement_of_the_adjoint(monkeypatch):
    adjoint = importlib.import_module("s2sad.differentiate.adjoint")
    right = adjoint._Adjoint.store

    def wrong(self, target, statement):
        return right(self, target, statement)[:-1 if target.value.id == "w" else None]
    monkeypatch.setattr(adjoint._Adjoint, "store", wrong)
    report = check(wave, FIELD, 1.3, engine="numpy")
    assert not report.adjoint_holds and report.tangent_holds
    assert re.search(r"the adjoint is wrong first, going backwards, at .*:\d+: for i in range\(u.size\):$", str(report))


def misfit(r, x, k, b):
    for i in range(x.size):
        r[i] = k[i] * x[i] - 1.1 * b[i]


@s2sad.rule(implicit=misfit)
def scaled_down(x, k, b):
    x[:] = b / k


def scaled_twice(x, u, y):
    scaled_down(x, u * u, y)
    x *= u


@pytest.mark.parametrize("engine", ["numpy", "numba"])
def test_check_runs_the_functions_beside_a_derivative_with_its_probes(engine):
    report = check(scaled_twice, np.zeros(3), FIELD, 2.0 * FIELD, engine=engine)
    assert report.adjoint_holds and not report.tangent_holds
    assert re.search(r"the tangent parts from the differences first at .*test_check.py:\d+: r\[i\] = ", str(report))


def test_check_changes_nothing_and_checks_bounds():
    u = FIELD.copy()
    check(wave, u, 1.3, engine="numba")
    assert np.array_equal(u, FIELD)
    with pytest.raises(IndexError):
        check(beyond, u, engine="numba")


def beyond(u):
    return u[0] * u[u.size]


def test_a_notebook_shows_the_check():
    shown = check(wave, FIELD, 1.3, engine="numpy")._repr_html_()
    assert "<table" in shown and shown.count("agrees") == 3 and "parts" not in shown
    assert "d(return, u) / d(u, c)" in shown or "d(u, return) / d(u, c)" in shown
    wrong = Checked("<script>", 1.0, 1e-12, {}, 1e-6, 0, 1, where="at x < y")._repr_html_()
    assert "parts" in wrong and "&lt;script&gt;" in wrong and "at x &lt; y" in wrong and "<script>" not in wrong


def absolute(x):
    return abs(x)


def test_check_says_where_differences_say_nothing():
    report = check(absolute, 0.0, engine="numpy")
    assert report and report.unsure == 1
    assert "the differences say nothing of 1 of 1 numbers: a kink or a jump is near" in str(report)


def test_differences_find_a_kink():
    _, error = differences(lambda h: np.array([abs(h)]))
    assert math.isinf(error[0])


def decays(u, n):
    for k in range(n):
        u *= 1.0 - 0.1 * u * k


def test_loops_that_keep_snapshots_keep_them():
    kept = s2sad.differentiate(decays, checkpoint={"k": 2}, engine="numpy")
    measured = MeasuredCall.for_call(kept, (np.ones(3), 5), None, None, None)
    assert "revolve" in measured.reverse().rv.generated.text
    assert s2sad.check(kept, np.ones(3), 5)
