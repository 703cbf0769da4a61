"""Times of several runs, taken in turns, so that what disturbs the machine disturbs all alike."""
from __future__ import annotations

import gc
import statistics
from collections.abc import Callable, Mapping
from time import perf_counter
from typing import Any

Prepare = Callable[[], Callable[[], Any]]


def interleaved(candidates: Mapping[str, Prepare], budget: float, most: int = 1000) -> dict[str, float]:
    """The median time of each candidate, in seconds.

    A candidate prepares, untimed, what it needs (fresh copies of arrays that are overwritten) and gives the call that
    is timed. One round runs each once; there are at least 5 rounds and at most `most`, else as many as fit `budget`
    seconds. The first round warms up and is not counted.
    """
    times: dict[str, list[float]] = {name: [] for name in candidates}
    gc.collect()
    gc.disable()
    try:
        start, done = perf_counter(), -1
        while done < 5 or (done < most and perf_counter() - start < budget):
            for name, prepare in candidates.items():
                call = prepare()
                before = perf_counter()
                call()
                elapsed = perf_counter() - before
                if done >= 0:
                    times[name].append(elapsed)
            done += 1
    finally:
        gc.enable()
    return {name: statistics.median(taken) for name, taken in times.items()}


def repeated(call: Callable[[], Any], times: int) -> Callable[[], None]:
    """A call that runs another many times, for what is too short to be timed alone."""
    def loop() -> None:
        for _ in range(times):
            call()
    return loop
