"""How many directions a call takes, as a clock of the test's has it."""
from __future__ import annotations

from functools import partial

import numpy as np
import pytest

import s2sad
from s2sad.jacobians import batch_widths
from s2sad.jacobians.batch_widths import MeasuredWidths
from s2sad.jacobians.jacobian_map import JacobianMap
from tests.harness.engines import running
from tests.jacobians import kernels

X = np.linspace(0.3, 1.7, 40)


class Clock:
    """Time passes by what calls are said to take, by the width of each and whether it is of adjoints."""

    def __init__(self, monkeypatch, taken):
        self.now, self.taken, self.widths = 0.0, taken, []
        monkeypatch.setattr(batch_widths, "clock", lambda: self.now)
        products = JacobianMap.products

        def timed(of, directions, width, transposed=False):
            self.widths.append(width)
            self.now += self.taken(width, transposed)
            return products(of, directions, width, transposed)
        monkeypatch.setattr(JacobianMap, "products", timed)

    def asked(self, ask):
        """The widths that a call takes."""
        self.widths.clear()
        ask()
        return self.widths[:]


def fastest(best):
    return lambda width, transposed: 1.0 if width == best else 2.0


@pytest.mark.parametrize("best", [8, 12, 16])
def test_a_dense_matrix_takes_what_was_fastest(best, monkeypatch):
    with running("loops") as run_under:
        J = s2sad.jacobian(s2sad.differentiate(kernels.in_place, engine=run_under), "u", "u", mode="forward")
        clock, wanted = Clock(monkeypatch, fastest(best)), J(X, 0.3)
        usual = [clock.asked(lambda: np.testing.assert_allclose(J(X, 0.3), wanted, rtol=1e-14)) for _ in range(2)]
        assert usual == [[16], [16]]        # until they have taken as long as the first
        assert clock.asked(lambda: J(X, 0.3)) == [*4 * [16], *4 * [12], *4 * [8], best]
        assert clock.asked(lambda: np.testing.assert_allclose(J(X, 0.3), wanted, rtol=1e-14)) == [best]
        assert clock.asked(lambda: J(X[:30].copy(), 0.3)) == [16]       # other shapes are others


@pytest.mark.parametrize("engine", ["numpy", "loops"])
def test_a_plan_is_measured_when_it_is_made(engine, monkeypatch, tmp_path):
    with running(engine) as run_under:
        f = s2sad.differentiate(kernels.brusselator, engine=run_under)
        args = np.zeros((5, 5, 2)), np.ones((5, 5, 2)), np.array([3.4, 1.0, 10.0])
        clock, J = Clock(monkeypatch, fastest(8)), s2sad.jacobian(f, "u", "du", sparse=True, mode="forward")
        wanted = s2sad.jacobian(f, "u", "du")(*args).reshape(50, 50)
        plan = J.plan(*args)
        assert plan.widths == ((8, 0) if engine == "loops" else (0, 0))
        plan.save(tmp_path / "plan.npz")
        again = s2sad.jacobian(f, "u", "du", sparse=s2sad.Plan.load(tmp_path / "plan.npz"))
        for made in (J, again):
            np.testing.assert_allclose(made(*args).toarray(), wanted, rtol=1e-14)
            assert clock.asked(partial(made, *args)) == ([8] if engine == "loops" else [plan.colors + 1])
        assert clock.asked(lambda: s2sad.jacobian(f, "u", "du", sparse=plan, batch=3)(*args)) == [3]
        assert s2sad.jacobian(f, "u", "du", sparse=True, batch=3).plan(*args).widths == (0, 0)


def sums(du, u):
    """Rows that are full, and a band."""
    for i in range(u.size):
        du[i] = 0.0
        for j in range(u.size if i < 5 else i, max(i - 8, 0) if i >= 5 else 0, -1):
            du[i] += u[j - 1] ** 2 * (i + 1.0)


def test_tangents_and_adjoints_have_widths_of_their_own(monkeypatch):
    with running("loops") as run_under:
        clock = Clock(monkeypatch, lambda width, transposed: 1.0 if width == (4 if transposed else 12) else 2.0)
        f = s2sad.differentiate(sums, engine=run_under)
        J = s2sad.jacobian(f, "u", "du", sparse=True)
        plan = J.plan(np.zeros(40), X)
        assert (plan.counts, plan.widths) == ((8, 5), (12, 4))
        assert clock.asked(lambda: J(np.zeros(40), X)) == [12, 4]
        np.testing.assert_allclose(J(np.zeros(40), X).toarray(), s2sad.jacobian(f, "u", "du")(np.zeros(40), X),
                                   rtol=1e-14)


def test_one_direction_needs_no_choice(monkeypatch):
    with running("loops") as run_under:
        J = s2sad.jacobian(s2sad.differentiate(kernels.to_a_number, engine=run_under), mode="reverse")
        clock = Clock(monkeypatch, fastest(8))
        assert [clock.asked(lambda: J(X)) for _ in range(4)] == 4 * [[1]]
        assert s2sad.hessian(s2sad.differentiate(kernels.energy, engine=run_under), "x", sparse=True).plan(
            X, 0.5).widths == (0, 0)


def test_time_that_stands_still_decides_nothing(monkeypatch):
    monkeypatch.setattr(batch_widths, "clock", lambda: 0.0)
    measured, asked = MeasuredWidths(), []
    for _ in range(5):
        measured.make(asked.append, lambda: {False: (16, 8)})
    assert asked == 5 * [(0, 0)] and measured.found is None
    assert measured.measure(asked.append, lambda: {False: (16, 8), True: (4,)}) == (16, 0)
