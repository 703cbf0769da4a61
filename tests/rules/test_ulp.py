"""Partials against literals of 25 digits, which `python -m benchmarks precision` writes to tests/rules/partials.txt: no
rule errs by more than 4 units in the last place, times the condition of the partial where that is above 1."""
from __future__ import annotations

from decimal import Decimal, localcontext
from pathlib import Path

import numpy as np
import pytest

import s2sad
from tests.rules import test_rules

LIMIT = 4.0
ROWS = [line.split("; ") for line in (Path(__file__).parent / "partials.txt").read_text().splitlines()]


def ulps(found, expected):
    """The error in units in the last place of the expected value, exactly."""
    with localcontext() as context:
        context.prec = 400
        wanted = Decimal(expected)
        return float(abs(Decimal(float(found)) - wanted) / Decimal(float(np.spacing(abs(float(wanted))))))


def test_the_unit_in_the_last_place():
    assert ulps(1.0, "1.0") == 0.0
    assert ulps(1.0 + 2.0 ** -52, "1") == 1.0
    assert ulps(0.1, "0.1") == pytest.approx(0.4, abs=1e-9)


def moved(name, parameter, point):
    """How much more the partial moves than its arguments, relatively, by differences of its own text."""
    partial, primal = test_rules.partial(name, parameter), test_rules.primal(name)
    base, total = float(partial(*point, primal(*point))), 0.0
    for k, x in enumerate(point):
        other = [*point[:k], x * (1.0 + 1e-6), *point[k + 1:]]
        total += abs(float(partial(*other, primal(*other))) / base - 1.0) / 1e-6
    return total


@pytest.mark.parametrize("name", list(dict.fromkeys(row[0] for row in ROWS)))
@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_rule(name):
    for _, parameter, point, expected in (row for row in ROWS if row[0] == name):
        numbers = [np.float64(n) for n in point.split(", ")]
        y = np.float64(test_rules.primal(name)(*numbers))
        for scalar in (False, True):
            found = test_rules.partial(name, parameter, scalar)(*numbers, y)
            error = ulps(found, expected)
            assert error <= LIMIT or error <= LIMIT * moved(name, parameter, numbers), \
                f"{parameter} at {point}: {error:.1f} ulp"


def test_every_rule_that_a_file_names_is_there():
    assert len({row[0] for row in ROWS}) > 50


@pytest.mark.parametrize(("x", "expected"), [
    (1e-9, "333333.3333333334288084119"), (1e12, "3.333333333333331444040838e-9"),
    (0.7, "0.4228114294012384297875686"), (1e-200, "7.181448966773006621357702e+132")])
def test_a_root_by_a_power(x, expected):
    def root(x):
        return x ** (1.0 / 3.0)
    assert ulps(s2sad.gradient(root)(x), expected) <= LIMIT
