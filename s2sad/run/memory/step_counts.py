"""How often the steps of a loop run that keeps snapshots."""
from __future__ import annotations

from functools import lru_cache
from math import comb

from s2sad.program import NOTHING, Schedule
from s2sad.runtime import crowded, runs_again


def runs_of_steps(steps: int, snapshots: int) -> int:
    """The runs of all steps of a loop together, those in the adjoints of steps among them, where their number is known
    before the first: t n - C(s + t, s + 1) + n (Griewank and Walther, ACM TOMS 26, 2000), and one for what is behind
    the loop. A loop that records runs each step once.

    >>> runs_of_steps(1000, 20), runs_of_steps(1, 20), runs_of_steps(0, 20)
    (3748, 2, 0)
    """
    if steps == 0:
        return 0
    repeats = 0
    while comb(snapshots + repeats, snapshots) < steps:
        repeats += 1
    return repeats * steps - comb(snapshots + repeats, snapshots + 1) + 1 + steps


@lru_cache(256)
def runs_of_thinned(steps: int, snapshots: int) -> int:
    """The same where the number shows in the end: every second, fourth, ... state is kept until then, in the place of
    that before the last step, too.

    >>> runs_of_thinned(1000, 20), runs_of_thinned(1, 20), runs_of_thinned(0, 20)
    (3820, 2, 0)
    """
    gap = step = 1
    while step < steps:
        while step % gap == 0 and crowded(step, gap, snapshots + 1):
            gap *= 2
        step += gap - step % gap
    return 2 * steps + runs_again(steps, gap, snapshots + 1)


def runs_of_schedule(schedule: Schedule) -> int:
    """The same where a schedule says from which state each step is reached that is reversed."""
    groups: list[list[tuple[int, int]]] = [[]]
    for entry in schedule.entries:
        if entry == NOTHING:
            groups.append([])
        else:
            groups[-1].append(entry)
    reached = range(schedule.steps - 1, -1, -1)
    again = sum(step - group[0][0] for step, group in zip(reached, groups[1:]) if group)
    return 2 * schedule.steps + again
