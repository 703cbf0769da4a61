"""Of an array of which the steps of a loop change a region alone, a snapshot holds this, where it is known before."""
from __future__ import annotations

import tracemalloc
from typing import Any

import numpy as np
import pytest

import s2sad
from tests.harness.engines import running
from tests.harness.seeds import generator

ENGINES = pytest.mark.parametrize("engine", ["numpy", "numba"])


def one_element(u, c, n, m):
    for k in range(n):
        u[0] = u[0] * (1.0 + c * u[1] + 0.01 * k)
    return np.sum(u * u)


def two_rows(u, c, n, m):
    v = np.outer(u, u)
    for _k in range(n):
        v[1] = v[1] + c * np.sin(v[2]) * v[0]
        v[2, 1:] = v[2, 1:] * (1.0 + c * v[1, :-1])
    return np.sum(v * v)


def in_loops(u, c, n, m):
    v = np.outer(u, u)
    for _k in range(n):
        for i in range(1, 3):
            for j in range(v.shape[1]):
                v[i, j] = v[i, j] * (1.0 + c * v[i - 1, j] * v[-1, j])
    return np.sum(v * v)


def up_to_a_number(u, c, n, m):
    for _k in range(n):
        for i in range(1, m):
            u[i] = u[i] * (1.0 + c * u[i - 1])
    return np.sum(u * u)


def until(u, c, n, m):
    t = 0.0
    while t < n:
        t += 1.0 + 0.1 * u[0] ** 2
        u[:2] = u[:2] + c * u[1:3] * t
    return np.sum(u * u)


def changed_behind(u, c, n, m):
    """What steps read outside of the region is not there any more when they are reversed."""
    for _k in range(n):
        u[0] = u[0] * (1.0 + c * u[3])
    s = u[0] * u[0]
    u[3] = s * u[1]
    u *= u
    return np.sum(u)


def in_another_loop(u, c, n, m):
    total = 0.0
    for _m in range(3):
        for _k in range(n):
            u[0] = u[0] * (1.0 + c * u[1]) + 0.1 * u[2]
        u[1:] = u[1:] * np.cos(u[0])
        total += u[0] * total + np.sum(u)
    return total


def twice(u, c, n, m):
    advance(u, c, n)
    u[1] = u[1] * u[0]
    advance(u, c * u[0], n)
    return np.sum(u * u)


def advance(u, c, n):
    for k in range(n):
        u[0] = u[0] + c * u[1] * u[0] * (k + 1)


def by_a_helper(u, c, n, m):
    for k in range(n):
        advance(u, c, k)
    return np.sum(u * u)


def read_by_a_helper(u, c, n, m):
    for _k in range(n):
        u[1:m] = u[1:m] * (1.0 + c * others(u))
    return np.sum(u * u)


def others(u):
    total = 0.0
    for i in range(u.size):
        total += u[i] * u[i]
    return total


def by_a_helper_of_a_helper(u, c, n, m):
    for k in range(n):
        for j in range(1, 3):
            relax(u, c * (k + 1), j, m)
        u[0] = u[0] * np.cos(u[5])
    return np.sum(u * u)


def relax(u, c, j, m):
    part_of(u, c, j, j + 1)
    for i in range(j):
        u[i] = u[i] + c * u[m] * u[i + 1]


def part_of(u, c, lo, hi):
    for _ in range(2):
        u[lo:hi] = u[lo:hi] * (1.0 + c * u[lo + 1:hi + 1])


def as_it_is_written(u, c, n, m):
    for _k in range(n):
        u[m - 6:m] = u[m - 6:m] * (1.0 + c * u[1])
    return np.sum(u * u)


def as_a_helper_has_it(u, c, n, m):
    for k in range(n):
        scale(u, c * k, m - 7, m)
    return np.sum(u * u)


def scale(u, c, lo, hi):
    u[lo:hi] = u[lo:hi] * (1.0 + c * u[1])


REGIONS: dict[Any, tuple[str, int]] = {         # the loop, and the elements of a state, of all loops of the name
    one_element: ("k", 1), two_rows: ("_k", 12), in_loops: ("_k", 12), up_to_a_number: ("_k", 3), until: ("", 2),
    changed_behind: ("_k", 1), in_another_loop: ("_k", 1), twice: ("advance.k", 2), by_a_helper: ("k", 1),
    read_by_a_helper: ("_k", 3), by_a_helper_of_a_helper: ("k", 3), as_it_is_written: ("_k", 0),
    as_a_helper_has_it: ("k", 1)}


def ends_of_the_array(u, c, n, m):
    for _k in range(n):
        u[0] = u[0] * (1.0 + c * u[1])
        u[-1] = u[-1] * (1.0 + c * u[-2])
    return np.sum(u * u)


def at_the_counter(u, c, n, m):
    for k in range(n):
        u[k % 3] = u[k % 3] * (1.0 + c * u[3])
    return np.sum(u * u)


def at_a_place_that_moves(u, c, n, m):
    j = 0
    for _k in range(n):
        u[j:j + 2] = u[j:j + 2] * (1.0 + c * u[4])
        j = 1 - j
    return np.sum(u * u)


def perhaps_from_the_end(u, c, n, m):
    for _k in range(n):
        u[m - 5] = u[m - 5] * (1.0 + c * u[1])
    return np.sum(u * u)


def at_places_that_differ(u, c, n, m):
    for k in range(n):
        u[k % 2:k % 2 + 2] = u[k % 2:k % 2 + 2] * (1.0 + c * u[4])
    return np.sum(u * u)


def two_as_written(u, c, n, m):
    for _k in range(n):
        u[m - 6:m] = u[m - 6:m] * (1.0 + c * u[1])
        u[m - 5:m] = u[m - 5:m] * (1.0 + c * u[0])
    return np.sum(u * u)


def of_a_part(u, c, n, m):
    for k in range(n):
        advance(u[m:], c, k)
    return np.sum(u * u)


def at_a_place_of_the_step(u, c, n, m):
    for k in range(n):
        scale(u, c, k % 4, k % 4 + 2)
    return np.sum(u * u)


def at_a_place_that_is_read(u, c, n, m):
    for _k in range(n):
        scale(u, c, int(10.0 * u[0]) % 3, 5)
    return np.sum(u * u)


def helper_that_replaces(u, c, n, m):
    for _k in range(n):
        replaced(u, c)
    return np.sum(u * u)


def replaced(u, c):
    u[0] = u[0] * c
    u[:] = u * (1.0 + c * u[0])


def all_but_a_rim(u, c, n, m):
    for _k in range(n):
        u[1:-1] = u[1:-1] + c * u[2:] * u[:-2]
    return np.sum(u * u)


WHOLE = {ends_of_the_array: "_k", at_the_counter: "k", at_a_place_that_moves: "_k", perhaps_from_the_end: "_k",
         all_but_a_rim: "_k", at_places_that_differ: "k", two_as_written: "_k", of_a_part: "k",
         at_a_place_of_the_step: "k", at_a_place_that_is_read: "_k", helper_that_replaces: "_k"}
LOOPS = {k: loop for k, (loop, _) in REGIONS.items()} | WHOLE


def _kept(kernel, engine: str, snapshots: Any, **options: Any):
    loop = LOOPS[kernel] or f"line {kernel.__code__.co_firstlineno + 2}"
    return s2sad.differentiate(kernel, engine=engine, wrt=("u", "c"), checkpoint={loop: snapshots}, **options)


@ENGINES
@pytest.mark.parametrize("kernel", LOOPS, ids=lambda k: k.__name__)
def test_gradients(kernel, engine):
    u = np.linspace(0.2, 0.7, 6)
    plain = s2sad.value_and_gradient(s2sad.differentiate(kernel, engine=engine, wrt=("u", "c")))
    for snapshots in (1, 4) if engine == "numpy" else (2,):
        gradient = s2sad.value_and_gradient(_kept(kernel, engine, snapshots))
        for steps in (0, 1, 2, 9):
            (value, found), (expected, bars) = gradient(u, 0.1, steps, 4), plain(u, 0.1, steps, 4)
            assert value == expected
            for argument, bar in bars.items():
                np.testing.assert_allclose(found[argument], bar, rtol=0.0 if engine == "numpy" else 1e-13)


@ENGINES
@pytest.mark.parametrize("kernel", LOOPS, ids=lambda k: k.__name__)
def test_the_bytes_of_snapshots(kernel, engine):
    """Four snapshots and the last state, of nine steps; numbers that are state are kept beside the arrays."""
    size = REGIONS[kernel][1] if kernel in REGIONS else 6
    numbers = {until: 1, at_a_place_that_moves: 1}.get(kernel, 0)
    found = _kept(kernel, engine, 4).adjoint.memory(np.linspace(0.2, 0.7, 6), 0.1, 9, 4)
    assert found.snapshots == 5 * 8 * (size + numbers)


@pytest.mark.parametrize("kernel", REGIONS, ids=lambda k: k.__name__)
def test_what_is_said_is_what_is_allocated(kernel):
    u = np.linspace(0.2, 0.7, 600)
    if kernel in (two_rows, in_loops):
        u = u[::10].copy()
    kept = _kept(kernel, "numpy", 40)
    args = u, np.zeros_like(u), 1e-4, 80, 300, 1.0
    kept.adjoint(*args)
    tracemalloc.start()
    kept.adjoint(*args)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert abs(kept.adjoint.memory(u, 1e-4, 80, 300).peak - peak) < 8192 + 0.05 * peak


@ENGINES
@pytest.mark.parametrize("kernel", [
    two_rows, until, changed_behind, in_another_loop, by_a_helper_of_a_helper, as_a_helper_has_it, as_it_is_written],
    ids=lambda k: k.__name__)
def test_files_and_both_halves(kernel, engine, tmp_path):
    u = np.linspace(0.2, 0.7, 6)
    expected = s2sad.gradient(_kept(kernel, engine, 3))(u, 0.1, 9, 4)
    on_disk = _kept(kernel, engine, s2sad.Snapshots(3, on_disk=str(tmp_path)))
    np.testing.assert_array_equal(s2sad.gradient(on_disk)(u, 0.1, 9, 4)["u"], expected["u"])
    halves = _kept(kernel, engine, 3)
    value, tape = halves.augmented(u.copy(), 0.1, 9, 4)
    with tape:
        for seed in (1.0, -2.0, 1.0):
            u_bar = np.zeros_like(u)
            halves.reverse(tape, u_bar, seed, keep=True)
            np.testing.assert_allclose(u_bar, seed * expected["u"], rtol=1e-13)
    assert value == kernel(u.copy(), 0.1, 9, 4) or engine == "numba"


# -- regions that might begin before the first place ----------------------------------------------------------------
def down_to_the_lesser(u, m, v):
    for _k in range(6):
        for i in range(11, min(5, m), -1):
            for _j in range(i):
                u[i] = u[i] * np.cos(u[i] * 0.1)


def down_to_the_greater(u, m, v):
    for _k in range(6):
        for i in range(11, max(5, m), -1):
            for _j in range(i):
                u[i] = u[i] * np.cos(u[i] * 0.1)


def from_a_number(u, m, v):
    for _k in range(6):
        for i in range(m, 8):
            for _j in range(i):
                u[i] = u[i] * np.cos(u[i] * 0.1)


def from_a_size(u, m, v):
    for _k in range(6):
        for i in range(v.size - 5, 10):
            for _j in range(i):
                u[i] = u[i] * np.cos(u[i] * 0.1)


def down_to_a_number(u, m, v):
    for _k in range(6):
        for i in range(8, m, -1):
            for j in range(i):
                u[i] = u[i] * np.cos(u[j] * 0.1)


def one_of_two_stores(u, m, v):
    for _k in range(6):
        for _j in range(m):
            u[m] = u[m] * np.cos(u[m] * 0.1)
        for _j in range(m - 5):
            u[m - 5:m - 3] = u[m - 5:m - 3] * np.cos(u[m] * 0.1)


def from_one_to_another(u, m, v):
    for _k in range(6):
        u[m:m + 4] = u[m:m + 4] * np.cos(u[m:m + 4] * u[3])
        u[m:4 + m] = u[m:m + 4] + 0.1


def up_to_one(u, m, v):
    for _k in range(6):
        cooled(u, m)


def cooled(u, hi):
    for _ in range(2):
        u[:hi] = u[:hi] * np.cos(u[:hi] * u[11])


@pytest.mark.parametrize("engine", ["numpy", "loops"])
@pytest.mark.parametrize("kernel", [
    from_one_to_another, up_to_one, down_to_the_lesser, down_to_the_greater, from_a_number, from_a_size,
    down_to_a_number, one_of_two_stores], ids=lambda k: k.__name__)
def test_places_before_the_first(kernel, engine):
    """A slice that begins below 0 begins at the end: such a region begins at 0, or is the slice that is written."""
    u, seed = 0.4 + generator(3).random(12), {"u": np.arange(12.0) + 1.0}
    with running(engine) as under:
        kept, recorded = (s2sad.differentiate(kernel, engine=under, wrt="u", **options) for options in (
            {"checkpoint": {"_k": 3}}, {}))
        for m in range(-3, 9):
            given = u, m, np.zeros(abs(m))
            found = s2sad.vjp(kept, given, seed)["u"]
            assert found.tolist() == s2sad.vjp(recorded, given, seed)["u"].tolist(), m
