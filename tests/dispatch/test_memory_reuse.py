"""What calls of derivatives keep for the next: never shared by two that run, bounded, and freed when asked."""
from __future__ import annotations

import gc
import threading
from concurrent.futures import ThreadPoolExecutor

import numba
import numpy as np
import pytest

import s2sad
from s2sad.dispatch.memory_reuse import CallCopies, InThreads, MemoryReuse, aligned_empty, clear_kept

FIRST = (np.empty(0),)


def growing(wanted, stack):
    """Gives a stack of this size back, the one that it is given if that has it."""
    return wanted, stack if stack.size == wanted else np.empty(wanted)


@pytest.fixture(autouse=True)
def _nothing_kept():
    clear_kept()
    yield
    clear_kept()


def test_a_call_takes_the_stacks_of_the_last_one():
    seen = []
    reuse = MemoryReuse(lambda n, stack: (seen.append(stack), *growing(n, stack)), FIRST, arena=False)
    assert reuse(5)[1] == 5
    reuse(5), reuse(6), reuse(6)
    assert seen[1] is seen[2] and seen[2] is not seen[3] and [s.size for s in seen] == [0, 5, 5, 6]
    assert reuse.stack_bytes == 48


def test_a_call_inside_of_another_has_stacks_of_its_own():
    seen = []

    def calling(depth, stack):
        seen.append(stack)
        if depth:
            reuse(depth - 1)
        return depth, np.empty(4)
    reuse = MemoryReuse(calling, FIRST, arena=False)
    reuse(0)
    reuse(2)
    assert seen[1].size == 4 and seen[2] is seen[3] is FIRST[0]


def test_what_raises_leaves_nothing():
    def raising(bad, stack):
        if bad:
            raise ValueError("bad")
        return True, np.empty(4)
    reuse = MemoryReuse(raising, FIRST, arena=False)
    reuse(False)
    with pytest.raises(ValueError, match="bad"):
        reuse(True)
    assert reuse.stack_bytes == 0 and clear_kept() == 0
    reuse(False)
    assert reuse.stack_bytes == 32


def test_threads_share_nothing():
    barrier = threading.Barrier(2)

    def waiting(n, stack):
        barrier.wait(timeout=20)
        return stack, np.empty(n)
    reuse = MemoryReuse(waiting, FIRST, arena=False)
    with ThreadPoolExecutor(2) as pool:
        list(pool.map(reuse, (4, 4)))
        both = [found[0] for found in pool.map(reuse, (4, 4))]
        assert both[0] is not both[1] and [b.size for b in both] == [4, 4]
    assert clear_kept() in (0, 32, 64)      # what threads that have ended kept is gone


def test_the_bound(monkeypatch):
    monkeypatch.setenv("S2SAD_TAPE_SIZE", "1K")
    first, second, large = (MemoryReuse(growing, FIRST, arena=False) for _ in range(3))
    first(60), second(60)
    assert (first.stack_bytes, second.stack_bytes) == (480, 480)
    first(60), large(30)
    assert (first.stack_bytes, second.stack_bytes, large.stack_bytes) == (480, 0, 240)
    large(1000)
    assert (first.stack_bytes, large.stack_bytes) == (0, 0)
    del first, second, large
    gc.collect()
    assert clear_kept() == 0


@pytest.mark.parametrize("shape", [(), (0,), (5,), (3, 0), (1000, 7)])
@pytest.mark.parametrize("dtype", ["float64", "float32", "complex128", "bool"])
def test_aligned_arrays_are_like_others(shape, dtype):
    arrays = [aligned_empty(shape, np.dtype(dtype)) for _ in range(4)]
    for k, made in enumerate(arrays):
        assert (made.shape, made.dtype, made.flags.c_contiguous, made.flags.writeable) == (shape, dtype, True, True)
        assert made.ctypes.data % 64 == 0 or made.size == 0
        made[...] = k % 2
    assert all((made == k % 2).all() for k, made in enumerate(arrays))


def test_the_arena_begins_where_a_line_of_the_cache_does():
    seen = []
    reuse = MemoryReuse(lambda n, arena: (seen.append(arena), n, n)[1:], FIRST, arena=True)
    for n in (1 << 14, 1 << 14, 10, (1 << 14) + 3, 5):
        reuse(n)
    assert [a.size for a in seen] == [0, 1 << 14, 1 << 14, 1 << 14, (1 << 14) + 3]
    assert seen[1] is seen[3] and all(a.ctypes.data % 64 == 0 for a in seen[1:])


# -- with compiled derivatives ----------------------------------------------------------------------------------------
def steps(u, n: int):
    for k in range(n):
        for i in range(u.size):
            u[i] = u[i] * u[i] * (1.0 + 0.01 * k)


def others(u, n: int):
    for _ in range(n):
        for i in range(u.size):
            u[i] = np.sin(u[i])


def adjoint_of(f, u, n):
    f.adjoint(u.copy(), bar := np.ones(u.size), n)
    return bar


def test_clear_frees_the_tapes_of_a_function_or_of_all():
    f, g = (s2sad.differentiate(h, wrt="u", engine="numba") for h in (steps, others))
    u = np.full(10, 0.9)
    expected = adjoint_of(f, u, 5)
    adjoint_of(g, u, 4)
    assert s2sad.clear(f) == 400 and s2sad.clear(steps) == 0 and s2sad.clear(s2sad.gradient(others)) == 320
    np.testing.assert_array_equal(adjoint_of(f, u, 5), expected)
    assert s2sad.clear() == 400 and s2sad.clear() == 0


def test_threads_have_the_same_gradients():
    f = s2sad.differentiate(steps, wrt="u", engine="numba")
    given = [np.linspace(0.5, 1.0, 500) * k for k in (0.9, 0.95, 1.0, 1.05)] * 4
    expected = [adjoint_of(f, u, 30) for u in given]
    stopped = threading.Event()

    def clearing():
        while not stopped.is_set():
            s2sad.clear(f)
    beside = threading.Thread(target=clearing)
    beside.start()
    with ThreadPoolExecutor(4) as pool:
        found = list(pool.map(lambda u: adjoint_of(f, u, 30), given))
    stopped.set()
    beside.join()
    for ours, theirs in zip(found, expected):
        np.testing.assert_array_equal(ours, theirs)


INSIDE: list[np.ndarray] = []


@s2sad.nondifferentiable
def looks(x):
    with numba.objmode():
        if not INSIDE:
            INSIDE.append(np.zeros(0))
            INSIDE.append(adjoint_of(s2sad.differentiate(calling_back, wrt="u", engine="numba"), np.full(3, 0.7), 4))
    return 1.0


def calling_back(u, n: int):
    for _ in range(n):
        for i in range(u.size):
            u[i] = u[i] * u[i] * 1.1
    u[0] *= looks(u[0])


def test_a_derivative_that_a_callback_calls_again():
    f = s2sad.differentiate(calling_back, wrt="u", engine="numba")
    u = np.full(3, 0.9)
    INSIDE[:] = [np.zeros(0)]
    expected, inner = adjoint_of(f, u, 4), adjoint_of(f, np.full(3, 0.7), 4)
    INSIDE.clear()
    found = adjoint_of(f, u, 4)
    assert len(INSIDE) == 2
    np.testing.assert_array_equal(found, expected)
    np.testing.assert_array_equal(INSIDE[1], inner)


# -- copies of arguments and seeds ----------------------------------------------------------------------------------

def stepped(v, u, c):
    v[:] = c * u
    u[:] = u * v


def part_of_itself(u, c):
    u[0] = c * u[1]
    return u[1:]


LARGE = np.linspace(0.1, 2.0, 1 << 14)


def test_copies_take_the_memory_of_those_of_the_last_call():
    threads = InThreads()
    first, second, third = (CallCopies(threads) for _ in range(3))
    kept, small = first.of("u", LARGE), first.of("v", LARGE[:4])
    first.end()
    again = second.of("u", 2.0 * LARGE[::-1])
    assert kept.ctypes.data % 64 == 0
    assert again is kept and np.array_equal(kept, 2.0 * LARGE[::-1]) and second.of("v", LARGE[:4]) is not small
    assert third.of("u", LARGE) is not kept             # it began before the second one has ended
    second.end()
    assert CallCopies(threads).of("u", LARGE.astype(np.float32)).dtype == np.float32


@pytest.mark.parametrize("engine", ["numpy", "numba"])
def test_results_have_memory_of_their_own(engine):
    f, c = s2sad.differentiate(stepped, engine=engine), 1.5
    given, seeds = (np.zeros_like(LARGE), LARGE.copy(), c), {"v": np.ones_like(LARGE), "u": np.ones_like(LARGE)}
    found = [s2sad.vjp(f, given, seeds, wrt=wrt) for wrt in (("u", "c"), ("u", "c"), ("v", "u"), ("c",))]
    expected = c + 2.0 * c * LARGE
    for one in found[:3]:
        np.testing.assert_allclose(one["u"], expected, rtol=1e-14)
    assert not any(np.shares_memory(a["u"], b["u"]) for a in found[:3] for b in found[:3] if a is not b)
    assert np.array_equal(given[1], LARGE) and not given[0].any() and (seeds["v"] == 1.0).all()
    tangents = [s2sad.jvp(f, given, {"u": direction}) for direction in (seeds["u"], 2.0 * seeds["u"])]
    np.testing.assert_allclose(tangents[0]["u"], 2.0 * c * LARGE, rtol=1e-14)
    np.testing.assert_allclose(tangents[1]["u"], 4.0 * c * LARGE, rtol=1e-14)


@pytest.mark.parametrize("engine", ["numpy", "numba"])
def test_a_result_that_is_a_part_of_a_tangent_stays(engine):
    f = s2sad.differentiate(part_of_itself, engine=engine)
    first = s2sad.jvp(f, (LARGE, 2.0), {"u": np.ones_like(LARGE)}, of="return")["return"]
    held = first.copy()
    s2sad.jvp(f, (LARGE, 2.0), {"u": np.zeros_like(LARGE)}, of="return")
    assert np.array_equal(first, held) and held.all()


def test_what_copies_take_is_freed_with_the_tapes_of_a_function():
    f = s2sad.differentiate(stepped, engine="numpy")
    s2sad.vjp(f, (np.zeros_like(LARGE), LARGE, 1.5), {"v": np.ones_like(LARGE)}, wrt="c")
    assert s2sad.clear(f) == LARGE.nbytes and s2sad.clear(f) == 0       # the seed: no argument is written


def squared_twice(u, c):
    for _ in range(2):
        for i in range(u.size):
            u[i] = c * u[i] * u[i]


def squared_by_a_helper(u, c):
    squared_twice(u[1:], c)
    squared_twice(u, c)


@pytest.mark.parametrize("kernel", [squared_twice, squared_by_a_helper])
@pytest.mark.parametrize("engine", ["numpy", "numba"])
def test_what_a_derivative_writes_is_copied(engine, kernel):
    f, given, seed = s2sad.differentiate(kernel, engine=engine), LARGE.copy(), {"u": np.ones_like(LARGE)}
    first, second = (s2sad.vjp(f, (given, 0.9), seed) for _ in range(2))
    assert np.array_equal(given, LARGE) and np.array_equal(first["u"], second["u"]) and first["c"] == second["c"]
    s2sad.jvp(f, (given, 0.9), seed)
    assert np.array_equal(given, LARGE) and (seed["u"] == 1.0).all()
