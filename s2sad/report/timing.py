"""Times of several runs, taken in turns, so that what disturbs the machine disturbs all alike."""
from __future__ import annotations

import gc
import os
import statistics
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from time import perf_counter
from typing import Any

Prepare = Callable[[], Callable[[], Any]]


@dataclass(frozen=True)
class Times:
    """Quartiles of the time that a run takes, in seconds, over so many rounds."""
    median: float
    lower: float
    upper: float
    rounds: int

    @classmethod
    def of(cls, taken: list[float]) -> Times:
        """The quartiles of a sample of at least one.

        >>> Times.of([3.0, 1.0, 2.0, 5.0, 4.0])
        Times(median=3.0, lower=2.0, upper=4.0, rounds=5)
        """
        lower, median, upper = (statistics.quantiles(taken, n=4, method="inclusive") if len(taken) > 1
                                else taken * 3)
        return cls(median, lower, upper, len(taken))

    def __str__(self) -> str:
        return seconds(self.median)


def sampled(candidates: Mapping[str, Prepare], budget: float, most: int = 1000, least: int = 5,
            clock: Callable[[], float] = perf_counter) -> dict[str, list[float]]:
    """The times of each candidate, in seconds, round by round.

    A candidate prepares, untimed, what it needs (fresh copies of arrays that are overwritten) and gives the call that
    is timed. One round runs each once; there are at least `least` rounds and at most `most`, else as many as fit
    `budget` seconds of the clock. The first round warms up and is not counted.
    """
    times: dict[str, list[float]] = {name: [] for name in candidates}
    collecting = gc.isenabled()
    gc.disable()
    try:
        start, done = clock(), -1
        while done < least or (done < most and clock() - start < budget):
            for name, prepare in candidates.items():
                call = prepare()
                before = clock()
                call()
                elapsed = clock() - before
                if done >= 0:
                    times[name].append(elapsed)
            done += 1
    finally:
        if collecting:
            gc.enable()
    return times


def interleaved(candidates: Mapping[str, Prepare], budget: float, most: int = 1000) -> dict[str, float]:
    """The median time of each candidate, in seconds; see `sampled`."""
    return {name: statistics.median(taken) for name, taken in sampled(candidates, budget, most).items()}


def repeated(call: Callable[[], Any], times: int) -> Callable[[], None]:
    """A call that runs another many times, for what is too short to be timed alone."""
    def loop() -> None:
        for _ in range(times):
            call()
    return loop


@contextmanager
def on_one_core() -> Iterator[str]:
    """Keeps the process on one core where the system can, hidden threads of libraries included, so that these neither
    help nor disturb; the remark for the report."""
    if not hasattr(os, "sched_setaffinity"):
        yield ""
        return
    before = os.sched_getaffinity(0)
    core = max(before)
    _pin({core})
    try:
        yield f" (core {core})"
    finally:
        _pin(before)


def _pin(cores: set[int]) -> None:
    """Has every thread of this process run on these cores."""
    with suppress(OSError):     # no /proc, or a thread that has ended
        os.sched_setaffinity(0, cores)
        for thread in os.listdir("/proc/self/task"):
            with suppress(OSError):
                os.sched_setaffinity(int(thread), cores)


def seconds(value: float) -> str:
    """A time with a unit that suits it.

    >>> seconds(2.5e-6), seconds(0.0031), seconds(12.0)
    ('2.50 us', '3.10 ms', '12.00 s')
    """
    for unit, scale in (("us", 1e-6), ("ms", 1e-3)):
        if value < 1000.0 * scale:
            return f"{value / scale:.2f} {unit}"
    return f"{value:.2f} s"
