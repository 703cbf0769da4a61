"""The states that are kept of a loop, and how often its steps run: as derivatives use them."""
from __future__ import annotations

from collections.abc import Iterable
from math import comb

import numpy as np
import pytest

from s2sad.run.memory.step_counts import runs_of_steps, runs_of_thinned
from s2sad.runtime import crowded, revolve, thin


def _optimum(steps: int, places: int) -> int:
    """The least number of runs of steps, those that are taped included (Griewank and Walther 2000, and the steps)."""
    repeats = 0
    while comb(places + repeats, places) < steps:
        repeats += 1
    return repeats * steps - comb(places + repeats, places + 1) + steps


def revolved(steps: int, places: int) -> tuple[int, list[int]]:
    """The runs of a loop of which the length is known, and the steps in the order in which they are reversed."""
    held: list[int] = []
    runs = following = 0
    for step in range(steps):
        if step in (following, steps - 1):
            held.append(step)
            following = revolve(step, steps, places - len(held))
        runs += 1
    again, order = _reversed(steps, places, held)
    return runs + again, order


def _reversed(steps: int, places: int, held: list[int]) -> tuple[int, list[int]]:
    """The runs of the reverse sweep, from the states that the forward sweep holds in the end."""
    runs, order = 0, []
    for step in range(steps - 1, -1, -1):
        following = revolve(held[-1], step + 1, places - len(held))
        here = held[-1]
        for again in range(held[-1], step):
            if again == following:
                held.append(again)
                assert len(held) <= max(places, 1)
                following = revolve(again, step + 1, places - len(held))
            runs, here = runs + 1, again + 1
        assert here == step
        runs += 1
        order.append(step)
        if held[-1] == step:
            held.pop()
    assert not held
    return runs, order


@pytest.mark.parametrize("places", range(1, 13))
def test_revolve_runs_steps_as_few_times_as_can_be(places):
    """All are run once forwards, the last one too, for what stands behind the loop: one more than the optimum."""
    for steps in range(1, 301):
        runs, order = revolved(steps, places)
        assert runs == runs_of_steps(steps, places) == _optimum(steps, places) + 1, steps
        assert order == list(range(steps))[::-1]


def test_published_ratios():
    """Of a thousand steps (Griewank and Walther 2000), beside what is printed: the counts are the optimum, which for 10
    states is 4.636, not 4.62; 3.747 and 3.097 are printed without their last digit."""
    published = {5: (7284, 7.28), 10: (4636, 4.62), 20: (3747, 3.74), 40: (3097, 3.09), 60: (2938, 2.94)}
    for places, (runs, ratio) in published.items():
        assert revolved(1000, places)[0] - 1 == _optimum(1000, places) == runs
        assert abs(runs - 1000 * ratio) < (10 if places != 10 else 17)


def test_a_million_steps_are_counted_without_overflow():
    compiled = pytest.importorskip("numba").njit(revolve)
    for places in (1, 2, 100, 10**6):
        assert compiled(0, 10**6, places) == revolve(0, 10**6, places)
    assert compiled(5, 10**12, 3) == revolve(5, 10**12, 3)


def _thinned(steps: int, places: int) -> list[int]:
    held, count, gap = np.empty(places, int), 0, 1
    for step in range(steps):
        while step % gap == 0 and crowded(step, gap, places):
            count, gap = thin(held, count), 2 * gap
        if step % gap == 0:
            held[count] = step
            count += 1
    assert count <= places
    return held[:count].tolist()


@pytest.mark.parametrize("places", [1, 2, 3, 8, 20, 50])
def test_thinning_reverses_all_in_the_runs_that_are_counted(places):
    for steps in range(1, 400, 7):
        held = _thinned(steps, places + 1)
        runs, order = _reversed(steps, places + 1, held)
        assert order == list(range(steps))[::-1]
        assert steps + runs == runs_of_thinned(steps, places)


def _ratios(snapshots: int, lengths: Iterable[int]) -> list[float]:
    """Of the runs where the length shows in the end to those where it is known, with as many states in memory."""
    return [runs_of_thinned(steps, snapshots) / runs_of_steps(steps, snapshots) for steps in lengths]


def test_thinning_costs_little_more_than_knowing_the_length():
    """The place of the state before the last step, of which nobody knows that it is, holds one more of the others."""
    ratios = [_ratios(snapshots, range(1, 301)) for snapshots in range(1, 13)]
    assert np.max(ratios) <= 1.21
    assert max(map(np.mean, ratios)) <= 1.03 and np.mean(ratios) <= 0.9


@pytest.mark.parametrize("snapshots", [1, 2, 4, 8, 20, 50, 300])
def test_thinning_of_a_hundred_thousand_steps(snapshots):
    ratios = _ratios(snapshots, sorted({int(10 ** (k / 40)) for k in range(201)}))
    assert max(ratios) <= 1.24 and np.mean(ratios) <= 1.03
