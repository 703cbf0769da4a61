"""Work arrays in an arena: which they are, and that calls of several sizes and threads find no stale value."""
from __future__ import annotations

import threading
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import s2sad
from s2sad import differentiate, gradient
from s2sad.dispatch.memory_reuse import MemoryReuse, clear_kept


def layers(x, w):
    h = np.tanh(x @ w)
    s = h @ w.T
    return np.sum(s * s * h[:, :1])


def returning(x, w):
    h = np.exp(x)
    return h * w, np.sum(h)


def same_array(x, w):
    h = x * w
    r = h
    r[0] = x[1] * x[1]
    return r


@s2sad.nondifferentiable
def noted(h):
    return h.size > 2


def noting(x, w):
    h = np.exp(x)
    return noted(h) * np.sum(h * w)


def text(kernel, *arguments) -> str:
    return differentiate(kernel, engine="numba").adjoint_source(*arguments, level="fast")


def numbers(*shape):
    return np.random.default_rng(3).random(shape)


@pytest.fixture(autouse=True)
def _nothing_kept():
    clear_kept()
    yield
    clear_kept()


def test_which_arrays_lie_in_it():
    found = text(layers, numbers(4, 3), numbers(3, 3))
    assert "h, top = allocate(arena" in found and "np.empty" not in found.partition("def layers_adjoint(")[0]
    assert "np.dot(x, w, out=" in found and " @ " not in found.partition("Adjoint of layers:")[2].partition("def ")[0]


def test_sizes_in_turn():
    compiled, plain = gradient(differentiate(layers, engine="numba")), gradient(differentiate(layers, engine="numpy"))
    for rows in (300, 7, 300, 400, 1, 0, 300):
        x, w = numbers(rows, 90), numbers(90, 90)
        for _ in range(2):
            found, wanted = compiled(x, w), plain(x, w)
            for n in ("x", "w"):
                np.testing.assert_allclose(found[n], wanted[n], rtol=1e-11, atol=1e-11)


def test_what_is_returned_is_the_callers():
    x, w = numbers(40_000), numbers(40_000)
    for kernel, seed in ((returning, (np.ones_like(x), 1.0)), (same_array, np.ones_like(x))):
        f = differentiate(kernel, engine="numba")
        first = s2sad.vjp(f, (x, w), {"return": seed})
        kept = {n: g.copy() for n, g in first.items()}
        s2sad.vjp(f, (2.0 * x, w), {"return": seed}), s2sad.vjp(f, (3.0 * x, w), {"return": seed})
        assert all(np.array_equal(first[n], kept[n]) for n in kept)


def test_primal_results_beside_gradients_are_the_callers():
    f = s2sad.value_and_gradient(differentiate(layers, engine="numba"))
    x, w = numbers(200, 90), 0.01 * numbers(90, 90)
    value, found = f(x, w)
    kept = {n: g.copy() for n, g in found.items()}
    assert f(x + 1.0, w)[0] != value
    f(x - 1.0, w)
    assert all(np.array_equal(found[n], kept[n]) for n in kept)


def test_threads_and_what_is_freed():
    f = differentiate(layers, engine="numba")
    g, barrier = gradient(f), threading.Barrier(2)
    x, w = numbers(300, 90), numbers(90, 90)
    wanted = g(x, w)

    def call(_):
        barrier.wait(timeout=20)
        return g(x, w)
    with ThreadPoolExecutor(2) as pool:
        for found in pool.map(call, range(8)):
            assert all(np.array_equal(found[n], wanted[n]) for n in wanted)
    g(x, w)
    assert s2sad.clear(f) >= 300 * 90 * 8 and s2sad.clear(f) == 0


def test_an_arena_grows_and_small_ones_are_not_kept():
    seen = []

    def taking(wanted, arena):
        seen.append(arena.size)
        return wanted, wanted
    reuse = MemoryReuse(taking, (np.empty(0),), arena=True)
    for n in (100, 100, 20_000, 100, 30_000, 100):
        assert reuse(n) == (n,)
    assert seen == [0, 0, 0, 20_000, 20_000, 30_000] and reuse.stack_bytes == 0 and clear_kept() == 240_000


def test_an_arena_over_the_bound_is_not_kept(monkeypatch):
    monkeypatch.setenv("S2SAD_TAPE_SIZE", "200K")
    seen = []
    reuse = MemoryReuse(lambda n, arena: (seen.append(arena.size), n)[1:], (np.empty(0),), arena=True)
    reuse(1_000_000), reuse(10_000), reuse(10_000)
    assert seen == [0, 0, 10_000]


def test_functions_of_the_users_get_memory_of_their_own():
    assert "arena" not in text(noting, numbers(4), numbers(4))
