"""Rules far out and near the edges: true values in closed form, nan, infinite partials, powers."""
from __future__ import annotations

import math

import numpy as np
import pytest

from s2sad import rules, tree
from s2sad.rules.rule import signature
from tests.rules.test_rules import TABLE_ROWS, partial, primal

TRUE_VALUES = [
    ("numpy.tanh(x)", "x", (20.0,), 4 * math.exp(-40.0)),
    ("numpy.tanh(x)", "x", (-300.0,), 4 * math.exp(-600.0)),
    ("numpy.tanh(x)", "x", (900.0,), 0.0),
    ("numpy.expm1(x)", "x", (-50.0,), math.exp(-50.0)),
    ("numpy.expm1(x)", "x", (-1e-12,), 1 - 1e-12),
    ("numpy.log1p(x)", "x", (1e300,), 1e-300),
    ("numpy.log1p(x)", "x", (-1 + 2.0 ** -52,), 2.0 ** 52),
    ("numpy.log(x)", "x", (1e-300,), 1e300),
    ("numpy.sqrt(x)", "x", (1e-300,), 0.5e150),
    ("numpy.cbrt(x)", "x", (1e-300,), 1e200 / 3),
    ("numpy.cbrt(x)", "x", (1e300,), 1e-200 / 3),
    ("numpy.cbrt(x)", "x", (-8.0,), 1 / 12),
    ("numpy.hypot(a, b)", "a", (3e300, 4e300), 0.6),
    ("numpy.hypot(a, b)", "b", (3e-310, 4e-310), 0.8),
    ("numpy.hypot(a, b)", "a", (0.0, 0.0), 0.0),
    ("numpy.hypot(a, b)", "a", (0.0, 2.0), 0.0),
    ("numpy.arctan2(a, b)", "a", (3e200, 4e200), 0.16e-200),
    ("numpy.arctan2(a, b)", "b", (3e-200, 4e-200), -0.12e200),
    ("numpy.arctan2(a, b)", "a", (0.0, -1.0), -1.0),
    ("numpy.arctan(x)", "x", (1e160,), 0.0),
    ("numpy.arcsin(x)", "x", (1 - 2.0 ** -53,), 1 / math.sqrt(2.0 ** -53 * (2 - 2.0 ** -53))),
    ("numpy.arccos(x)", "x", (-1 + 2.0 ** -53,), -1 / math.sqrt(2.0 ** -53 * (2 - 2.0 ** -53))),
    ("numpy.arctanh(x)", "x", (1 - 2.0 ** -53,), 1 / (2.0 ** -53 * (2 - 2.0 ** -53))),
    ("numpy.arcsinh(x)", "x", (1e300,), 1e-300),
    ("numpy.arccosh(x)", "x", (1e300,), 1e-300),
    ("numpy.arccosh(x)", "x", (1 + 2.0 ** -52,), 1 / math.sqrt(2.0 ** -52 * (2 + 2.0 ** -52))),
    ("numpy.logaddexp(a, b)", "a", (1000.0, 1010.0), 1 / (1 + math.exp(10.0))),
    ("numpy.logaddexp(a, b)", "a", (-600.0, 0.0), math.exp(-600.0)),
    ("numpy.logaddexp(a, b)", "a", (-math.inf, 0.0), 0.0),
    ("numpy.logaddexp(a, b)", "b", (-math.inf, 0.0), 1.0),
    ("numpy.logaddexp2(a, b)", "a", (-900.0, 0.0), 2.0 ** -900),
    ("numpy.reciprocal(x)", "x", (1e-150,), -1e300),
    ("numpy.sinc(x)", "x", (0.0,), 0.0),
    ("numpy.sinc(x)", "x", (1e-9,), -math.pi ** 2 / 3 * 1e-9),
    ("numpy.sinc(x)", "x", (2.0,), 0.5),
    ("a / b", "b", (1e200, 1e300), -1e-400),
    ("a / b", "b", (1e300, 1e160), -1e-20),
    ("math.erfc(x)", "x", (10.0,), -2 / math.sqrt(math.pi) * math.exp(-100.0)),
    ("scipy.special.expit(x)", "x", (40.0,), math.exp(-40.0) / (1 + math.exp(-40.0)) ** 2),
    ("scipy.special.expit(x)", "x", (-600.0,), math.exp(-600.0)),
    ("scipy.special.expit(x)", "x", (-math.inf,), 0.0),
    ("scipy.special.logit(x)", "x", (1e-300,), 1e300),
    ("scipy.special.logit(x)", "x", (1.5,), math.nan),
    ("scipy.special.xlogy(a, b)", "a", (0.0, 2.0), math.log(2.0)),
    ("scipy.special.xlogy(a, b)", "b", (0.0, 0.0), 0.0),
    ("scipy.special.xlogy(a, b)", "b", (1.0, -1.0), math.nan),
    ("scipy.special.xlog1py(a, b)", "a", (0.0, 1e-12), 1e-12 - 5e-25),
    ("scipy.special.xlog1py(a, b)", "b", (0.0, -1.0), 0.0),
    ("scipy.special.entr(x)", "x", (0.0,), math.inf),
    ("scipy.special.rel_entr(a, b)", "b", (0.0, 0.0), 0.0),
    ("scipy.special.kl_div(a, b)", "b", (0.0, 0.0), 1.0),
    ("scipy.special.kl_div(a, b)", "a", (0.0, -1.0), math.nan),
    ("scipy.special.erf(x)", "x", (20.0,), 2 / math.sqrt(math.pi) * math.exp(-400.0)),
    ("numpy.absolute(x)", "x", (0.0,), 0.0),
    ("numpy.maximum(a, b)", "a", (1.0, 1.0), 1.0),
    ("numpy.maximum(a, b)", "b", (1.0, 1.0), 0.0),
    ("numpy.minimum(a, b)", "a", (1.0, 1.0), 1.0),
    ("numpy.maximum(a, b)", "a", (math.nan, 1.0), 1.0),
    ("numpy.fmax(a, b)", "a", (math.nan, 1.0), 0.0),
    ("numpy.fmax(a, b)", "b", (math.nan, 1.0), 1.0),
    ("numpy.fmin(a, b)", "a", (1.0, math.nan), 1.0),
    ("numpy.clip(x, low, high)", "high", (0.5, 2.0, 1.0), 1.0),
    ("numpy.clip(x, low, high)", "low", (0.5, 2.0, 1.0), 0.0),
    ("numpy.clip(x, low, high)", "x", (0.5, 2.0, 1.0), 0.0),
    ("a % b", "b", (5.0, 1.0), -5.0),
    ("a % b", "b", (-0.5, 1.0), 1.0),
    ("a % b", "b", (6.0 - 2.0 ** -50, 0.1), -59.0),
    ("a ** b", "a", (0.0, 0.0), 0.0),
    ("a ** b", "a", (0.0, 1.0), 1.0),
    ("a ** b", "a", (0.0, 0.5), math.inf),
    ("a ** b", "a", (1e-300, 1.5), 1.5e-150),
    ("a ** b", "b", (0.0, 2.0), 0.0),
    ("a ** b", "b", (-2.0, 3.0), math.nan),
    ("a % b", "a", (1.0, 0.0), math.nan),
    ("a % b", "b", (1.0, 0.0), math.nan),
    ("numpy.fmod(a, b)", "a", (1.0, 0.0), math.nan),
    ("numpy.fmod(a, b)", "b", (1.0, 0.0), math.nan),
    ("numpy.log(x)", "x", (-1.0,), math.nan),
    ("numpy.log2(x)", "x", (-1.0,), math.nan),
    ("numpy.log10(x)", "x", (-1.0,), math.nan),
    ("numpy.log1p(x)", "x", (-2.0,), math.nan),
    ("numpy.log1p(x)", "x", (-1.0,), math.inf),
    ("numpy.arctanh(x)", "x", (-2.0,), math.nan),
    ("numpy.arctanh(x)", "x", (1.0,), math.inf),
    ("numpy.arccosh(x)", "x", (-2.0,), math.nan),
    ("a ** b", "b", (1e300, 0.5), 1e150 * math.log(1e300)),
    ("numpy.sqrt(x)", "x", (0.0,), math.inf),
    ("numpy.log(x)", "x", (0.0,), math.inf),
]


@pytest.mark.parametrize(("text", "parameter", "values", "expected"), TRUE_VALUES)
def test_true_values_far_out(text, parameter, values, expected):
    name, _ = signature(text)
    numbers = [np.float64(v) for v in values]
    y = np.float64(primal(name)(*numbers))
    for scalar in (False, True):
        actual = partial(name, parameter, scalar)(*numbers, y)
        assert actual == pytest.approx(expected, rel=5e-14, abs=1e-307 if expected == 0.0 else 0.0, nan_ok=True)


@pytest.mark.parametrize(("name", "parameter"), TABLE_ROWS)
def test_nan_is_not_masked(name, parameter):
    """A partial that depends on its operands is nan where they are, unless it is a choice between 0 and 1."""
    rule = rules.find(name)
    reads = rule.uses(parameter)
    choices = ("maximum", "minimum", "max", "min", "fmax", "fmin", "clip", "where", "strong_zero")
    if not reads or name.split(".")[-1] in choices:
        return
    numbers = [np.float64("nan")] * len(rule.parameters)
    assert math.isnan(partial(name, parameter)(*numbers, np.float64("nan")))
    assert math.isnan(partial(name, parameter, scalar=True)(*numbers, np.float64("nan")))


@pytest.mark.parametrize(("name", "parameter"), TABLE_ROWS)
def test_infinite_partials_are_marked_singular(name, parameter):
    """At the edges of what the primal takes, a partial that is not finite belongs to a singular parameter."""
    rule = rules.find(name)
    if parameter in rule.singular:
        return
    edges = [0.0, 1.0, -1.0, 0.5, 1e-300, 1e300, -1e300]
    for value in edges:
        for other in edges:
            numbers = [np.float64(value), np.float64(other), np.float64(1.0)][:len(rule.parameters)]
            try:
                y = np.float64(primal(name)(*numbers))
            except (ValueError, OverflowError, ZeroDivisionError):
                continue
            if math.isfinite(y):
                slopes = [np.float64(partial(name, parameter, scalar)(*numbers, y)) for scalar in (False, True)]
                # a slope beyond the largest number is not the rule's doing
                assert not any(map(math.isnan, slopes)), numbers


# -- powers ---------------------------------------------------------------------------------------------------------
POWERS = [
    ("3", "3.0 * x ** 2"), ("2", "2.0 * x"), ("1", "1.0"), ("0", "0.0"), ("-1", "-1.0 * x ** (-2)"),
    ("2.0", "2.0 * x"), ("0.5", "0.5 / r"), ("-1.5", "-1.5 * r / x"), ("1.5", "1.5 * x ** 0.5"),
]


@pytest.mark.parametrize(("exponent", "expected"), POWERS)
def test_power_of_a_known_exponent(exponent, expected):
    c = tree.expression(exponent)
    node = rules.power_partial("a", tree.name("x"), c, tree.name("r"))
    assert tree.equal(node, tree.expression(expected))
    arguments = {"a": tree.name("x"), "b": c}
    rule = rules.find("a ** b")
    assert tree.equal(node, rule.partial("a", arguments, tree.name("r")))
    assert rule.uses("a", arguments) == {{"x": "a", "r": "y"}[n] for n in tree.names(node)}


@pytest.mark.parametrize("exponent", [3, 2, 1, 0, -1, -2, 0.5, -0.5, 1.5, -1.5, 2.0, 4.0, 7])
def test_power_values(exponent):
    c = tree.const(exponent)
    for base in (0.3, 1.0, 2.7):
        y = base ** exponent
        actual = partial("a ** b", "a", b=c)(base, exponent, y)
        assert actual == pytest.approx(exponent * base ** (exponent - 1), rel=1e-15)


@pytest.mark.parametrize("exponent", ["1e999", "-1e999", "1 / 1e-320", "-1 / 1e-320"])
def test_power_of_an_infinite_exponent(exponent):
    found = rules.power_partial("a", tree.name("x"), tree.expression(exponent), tree.name("r"))
    general = rules.power_partial("a", tree.name("x"), tree.name("b"), tree.name("r"))
    assert tree.equal(found, tree.substitute(general, {"b": tree.expression(exponent)}))


def test_singular_depends_on_the_arguments():
    divide, power = rules.find("a / b"), rules.find("a ** b")
    x, y = tree.name("x"), tree.name("y")
    assert divide.is_singular("a", {"a": x, "b": y})
    assert not divide.is_singular("a", {"a": x, "b": tree.const(9.0)})
    assert divide.is_singular("b", {"a": tree.const(1.0), "b": x})
    assert not power.is_singular("a", {"a": x, "b": tree.const(3)})
    assert not power.is_singular("a", {"a": x, "b": tree.const(1.5)})
    assert power.is_singular("a", {"a": x, "b": tree.const(0.5)})
    assert power.is_singular("a", {"a": x, "b": tree.const(-2)})
    assert power.is_singular("a", {"a": x, "b": y})
    assert not rules.find("numpy.sin").is_singular("x", {"x": x})
