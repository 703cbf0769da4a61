"""Nothing unwritten is read: work arrays, tapes, their fresh capacity and the run time's scratch hold nan until
they are written, and derivatives are what they are. `pytest --poison` runs every test so; a sample runs always."""
from __future__ import annotations

import math
from types import FunctionType

import numpy as np
import pytest

import s2sad
from s2sad.run import module_loader
from tests.harness.derivatives import UnreliableDifferences, check_derivatives
from tests.harness.engines import running
from tests.harness.poison import filled, poisoned
from tests.programs import random_kernel
from tests.harness.seeds import seeded

PROGRAMS = 6


def until_large(x):
    total, k = 0.0, 0
    while total < 90.0:
        total += math.exp(0.1 * x[k % x.size]) * (1.0 + 0.01 * total)
        k += 1
    return total * total


def waves(u, steps):
    work = np.empty_like(u)
    for _ in range(steps):
        for i in range(1, u.size - 1):
            work[i] = u[i] + 0.1 * u[i] * (u[i + 1] - u[i - 1])
        work[0], work[-1] = u[-1], u[0]
        u[:] = work * np.cos(work)


def shrinking(x, steps):
    total = 0.0
    for s in range(steps):
        part = np.empty(x.size - s)
        for i in range(part.size):
            part[i] = np.sin(x[i]) * x[i + s]
        total += np.sum(part * part) if s % 2 == 0 else part[0]
    return total


def sums(x):
    return np.sum(x * x) * np.sum(np.exp(x))


def in_order(x):
    return np.sum(np.sort(x)[1:] * x[:-1]) * np.max(x)


def solved(a, b):
    return np.sum(np.linalg.solve(a, b) ** 2)


X = np.linspace(0.3, 1.2, 7)
CASES = [(until_large, (X,), ("x",), ("return",)), (waves, (X, 3), ("u",), ("u",)),
         (shrinking, (X, 4), ("x",), ("return",)), (sums, (np.linspace(-1.0, 1.0, 300),), ("x",), ("return",)),
         (in_order, (X,), ("x",), ("return",)),
         (solved, (np.eye(3) + 0.1 * np.arange(9.0).reshape(3, 3), np.ones(3)), ("a", "b"), ("return",))]
COMPILED = (until_large, sums)


def new(function):
    """The function again, of which nothing has been derived."""
    return FunctionType(function.__code__, function.__globals__, function.__name__)


@pytest.mark.parametrize(("kernel", "arguments", "wrt", "of", "engine"), [
    (*case, engine) for case in CASES for engine in ("numpy", "loops", "numba")
    if engine != "numba" or case[0] in COMPILED])
def test_kernels(kernel, arguments, wrt, of, engine):
    with poisoned():
        check_derivatives(new(kernel), arguments, wrt, of, engine, coordinates=8)


@pytest.mark.parametrize("engine", ["numpy", "loops"])
@pytest.mark.parametrize("number", range(PROGRAMS))
def test_generated_programs(number, engine):
    program = random_kernel(seeded(7000 + number))
    with poisoned():
        try:
            check_derivatives(new(program.load()), program.arguments(), program.wrt, program.of, engine,
                              coordinates=3, directions=1, vanishing=1e-16)
        except UnreliableDifferences:
            pass


def test_stacks_that_are_kept_hold_nothing_of_the_call_before():
    f = s2sad.differentiate(new(waves), engine="numba")
    with poisoned():
        first, second = (s2sad.vjp(f, (X, steps), {"u": np.ones(7)}, wrt=("u",))["u"] for steps in (5, 2))
        with running("loops") as run_under:
            again = s2sad.differentiate(new(waves), engine=run_under)
            expected = s2sad.vjp(again, (X, 2), {"u": np.ones(7)}, wrt=("u",))["u"]
    np.testing.assert_allclose(second, expected, rtol=1e-12)
    assert np.all(np.isfinite(first))


def stepped(u, steps):
    for _ in range(steps):
        for i in range(u.size):
            u[i] = u[i] * u[i]


@pytest.mark.parametrize("engine", ["numpy", "loops"])
def test_an_adjoint_that_does_not_record_is_told_by_it(engine, monkeypatch):
    """The pushes are taken out of the text: what the reverse sweep restores was never written."""
    taken = []

    def without_pushes(self, identifier, path, text, *more, before=module_loader._Loader.__init__):
        lines = text.splitlines(keepends=True)
        left = [line for line in lines if "_stack[" not in line.partition("=")[0] or "for " in line]
        taken.append(len(lines) - len(left))
        before(self, identifier, path, "".join(left), *more)

    with running(engine) as run_under:      # the runtime's functions are known, as they are without poison
        s2sad.vjp(s2sad.differentiate(new(stepped), engine=run_under), (X, 2), {"u": np.ones(7)}, wrt=("u",))
    held = [np.ones(14) for _ in range(100)]
    del held                                # what memory holds that is had again
    monkeypatch.setattr(module_loader._Loader, "__init__", without_pushes)
    with poisoned(), running(engine) as run_under:
        found = s2sad.vjp(s2sad.differentiate(new(stepped), engine=run_under), (X, 2), {"u": np.ones(7)},
                          wrt=("u",))["u"]
    assert sum(taken) > 0 and np.all(np.isnan(found))


def partly(x):
    work = np.empty_like(x)
    work[1:] = x[1:] * x[1:]
    return np.sum(work * work)


@pytest.mark.parametrize("engine", ["numpy", "loops", "numba"])
def test_a_kernel_that_reads_what_it_did_not_write_is_told_by_it(engine):
    with poisoned(), running(engine) as run_under:
        value, gradient = s2sad.value_and_gradient(s2sad.differentiate(new(partly), engine=run_under))(X)
    assert math.isnan(value)
    np.testing.assert_allclose(gradient[1:], 4.0 * X[1:] ** 3, rtol=1e-14)


def squares(y, x):
    for i in range(x.size):
        y[i] = x[i] * x[i]


def whole(y, x):
    y[...] = np.exp(x)


def through_work(y, x):
    squares(y, x)
    for i in range(1, x.size):
        y[i] += y[i - 1]


@pytest.mark.parametrize("engine", ["numpy", "loops"])
@pytest.mark.parametrize("kernel", [squares, whole, through_work])
def test_shadows_of_what_is_overwritten_need_not_be_cleared(kernel, engine):
    """Forwards what the shadow of an output held before is not read, and backwards nothing is left in it."""
    with poisoned(), running(engine) as run_under:
        f = s2sad.differentiate(new(kernel), engine=run_under)
        clean, dirty = np.zeros(7), filled(np.empty(7))
        for y_dot in (clean, dirty):
            s2sad.autodiff(s2sad.Forward, f, s2sad.Duplicated(filled(np.empty(7)), y_dot), s2sad.Duplicated(
                X, np.ones(7)))
        np.testing.assert_array_equal(clean, dirty)
        y_bar, x_bar = np.ones(7), np.zeros(7)
        s2sad.autodiff(s2sad.Reverse, f, s2sad.Duplicated(filled(np.empty(7)), y_bar), s2sad.Duplicated(X, x_bar))
    assert np.all(np.isfinite(clean)) and np.all(np.isfinite(x_bar)) and not y_bar.any()
