"""Loops that keep snapshots in cases that are seldom, under each engine: left at once, nested deeper than snapshots go,
raised in late, run by threads, with state of another size and with derivatives that remember."""
from __future__ import annotations

import threading
from typing import Any

import numpy as np
import pytest

import s2sad

ENGINES = pytest.mark.parametrize("engine", ["numpy", "numba"])


def _line(kernel, behind: int) -> str:
    return f"line {kernel.__code__.co_firstlineno + behind}"


# -- loops ----------------------------------------------------------------------------------------------------------
def leaves_at_once(u, c, n):
    for k in range(n):
        u[:] = np.exp(c * u) + k
        if u[0] > 0.0:
            break
    return np.sum(u * u)


def leaves_before_anything(u, c, n):
    k = 0
    while True:
        if u[0] > 0.0 or k > n:
            break
        u[:] = np.sin(u) * c
        k += 1
    return np.sum(u * u) * (c + k)


def returns_at_once(u, c, n):
    for k in range(n):
        u[:] = np.exp(c * u) + k
        if u[0] > 0.0:
            return np.sum(u * u)
    return u[0]


def never_begins(u, c, n):
    while n < 0:
        u[:] = np.sin(u) * c
        n += 1
    return np.sum(u * u) * c


@ENGINES
@pytest.mark.parametrize(("kernel", "behind", "expected"), [
    (leaves_at_once, 1, lambda u: 0.4 * np.exp(0.4 * u)), (returns_at_once, 1, lambda u: 0.4 * np.exp(0.4 * u)),
    (leaves_before_anything, 2, lambda u: 0.4 * u), (never_begins, 1, lambda u: 0.4 * u)],
    ids=lambda p: getattr(p, "__name__", ""))
def test_a_loop_that_is_left_in_its_first_step(kernel, behind, expected, engine):
    u = np.linspace(0.1, 0.6, 6)
    for snapshots in (1, 5):
        kept = s2sad.differentiate(kernel, engine=engine, checkpoint={_line(kernel, behind): snapshots})
        np.testing.assert_allclose(s2sad.gradient(kept, wrt="u")(u, 0.2, 9), expected(u), rtol=1e-14)


def three_deep(u, c, n):
    for k in range(n):
        for m in range(k, n):
            t = u[0]
            while t < 0.5:
                t = t + 0.2 + c * u[1] * t
                u[2] = u[2] * np.cos(t)
            u[m % 6] = u[m % 6] * np.exp(-c * u[(m + 1) % 6]) + 0.01 * k * m
        u[0] = u[0] * u[1]
    return np.sum(u * u)


@ENGINES
def test_fewer_snapshots_than_loops_that_are_nested(engine):
    u, inner = np.linspace(0.1, 0.6, 6), _line(three_deep, 4)
    expected = s2sad.value_and_gradient(s2sad.differentiate(three_deep, engine=engine), wrt="u")
    for loops in (("k",), ("m",), (inner,), ("k", "m", inner)):
        kept = s2sad.differentiate(three_deep, engine=engine, checkpoint=dict.fromkeys(loops, 1))
        for steps in (0, 1, 2, 5):
            value, gradient = s2sad.value_and_gradient(kept, wrt="u")(u, 0.1, steps)
            assert value == expected(u, 0.1, steps)[0]
            np.testing.assert_allclose(gradient, expected(u, 0.1, steps)[1], rtol=0.0 if engine == "numpy" else 1e-13)


# -- calls ----------------------------------------------------------------------------------------------------------
def raises_late(u, c, n):
    for k in range(n):
        u[:] = u + c * np.sin(u)
        if k == 499_999:
            raise ValueError("too late")
    return np.sum(u)


def raises_where_it_grows(u, c, n):
    t = 0.0
    while t < n:
        u[:] = u + c * np.sin(u)
        t += 0.5
        if u[0] > 1.5:
            raise ValueError("too late")
    return np.sum(u)


@ENGINES
@pytest.mark.parametrize(("kernel", "behind", "c", "steps"), [
    (raises_late, 1, 1e-7, 1_000_000), (raises_where_it_grows, 2, 0.1, 100)],
    ids=lambda p: getattr(p, "__name__", ""))
def test_a_step_that_raises_late_leaves_arguments_as_they_were(kernel, behind, c, steps, engine):
    u = np.linspace(0.3, 0.5, 3)
    given = u.copy()
    kept = s2sad.differentiate(kernel, engine=engine, checkpoint={_line(kernel, behind): 20})
    assert "u_snapshots" in kept.adjoint_source(u, c, steps)
    for _again in range(2 if steps < 1000 else 1):
        with pytest.raises(ValueError, match="too late"):
            s2sad.gradient(kept, wrt="u")(given, c, steps)
        np.testing.assert_array_equal(given, u)
    few = s2sad.gradient(kept, wrt="u")(given, c, 3)
    np.testing.assert_array_equal(few, s2sad.gradient(s2sad.differentiate(kernel, engine=engine), wrt="u")(u, c, 3))


def counts(u, c, n):
    for k in range(n):
        u[:] = u + c * np.sin(u) * (k % 3)
    return np.sum(u * u)


def until(u, c, n):
    t = 0.0
    while t < 0.1 * n:
        t += 0.1
        u[:] = u + c * np.sin(u * t)
    return np.sum(u * u)


@ENGINES
@pytest.mark.parametrize(("kernel", "behind"), [(counts, 1), (until, 2)], ids=lambda p: getattr(p, "__name__", ""))
def test_two_threads_at_once(kernel, behind, engine):
    """Each with arrays of its own size and another number of steps."""
    gradient = s2sad.gradient(s2sad.differentiate(kernel, engine=engine, checkpoint={_line(kernel, behind): 3}),
                              wrt="u")
    given = [(np.linspace(0.1, 0.6, 40 + k), 0.01, 30 + 7 * k) for k in range(2)]
    expected = [gradient(*args) for args in given]
    found: list[list[Any]] = [[], []]

    def run(k: int) -> None:
        found[k] += [gradient(*given[k]) for _ in range(20)]
    threads = [threading.Thread(target=run, args=(k,)) for k in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for mine, alone in zip(found, expected):
        assert len(mine) == 20
        for gradient_of_call in mine:
            np.testing.assert_array_equal(gradient_of_call, alone)


# -- what is refused ------------------------------------------------------------------------------------------------
def _refused(kernel, engine: str, *args: Any) -> str:
    plain = s2sad.gradient(s2sad.differentiate(kernel, engine=engine), wrt="u")
    assert np.all(np.isfinite(plain(*args)))
    with pytest.raises(s2sad.S2sadError) as caught:
        s2sad.gradient(s2sad.differentiate(kernel, engine=engine, checkpoint={"_k": 3}), wrt="u")(*args)
    return "\n".join(line for line in str(caught.value).splitlines() if " | " not in line)


def growing(u, n):
    for _k in range(n):
        u = np.concatenate((u, 0.5 * u[:1]))
    return np.sum(u * u)


def shrinking(u, n):
    for _k in range(n):
        u = u[1:] * u[:-1]
    return np.sum(u * u)


@ENGINES
@pytest.mark.parametrize("kernel", [growing, shrinking], ids=lambda k: k.__name__)
def test_state_that_changes_its_size(kernel, engine):
    assert _refused(kernel, engine, np.linspace(0.5, 1.0, 9), 4).endswith(
        "error[S201]: 'u' is allocated anew in a loop that keeps snapshots, and is read behind the step\n"
        "  help: allocate it before the loop and write it in place, or leave the loop out of 'checkpoint'")


def own_forward(u):
    kept = u.copy()
    u *= u
    return kept


def own_reverse(kept, u, u_bar):
    u_bar *= 2.0 * kept


@s2sad.rule(forward=own_forward, reverse=own_reverse)
def own(u):
    u *= u


def of_its_own(u, n):
    for _k in range(n):
        own(u)
        u += 0.5
    return np.sum(u)


def calls_own(u):
    own(u)
    u += 0.5


def of_a_helper_of_its_own(u, n):
    for _k in range(n):
        calls_own(u)
    return np.sum(u)


@ENGINES
@pytest.mark.parametrize(("kernel", "called"), [(of_its_own, "own"), (of_a_helper_of_its_own, "calls_own")],
                         ids=lambda p: getattr(p, "__name__", ""))
def test_a_derivative_of_the_users_own(kernel, called, engine):
    """What it keeps may depend on how often it was called."""
    assert _refused(kernel, engine, np.full(3, 0.1), 3).endswith(
        f"error[S201]: '{called}' is called in a loop that keeps snapshots, whose steps run again\n"
        "  help: leave the loop out of 'checkpoint'")
