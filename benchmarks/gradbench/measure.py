"""Each eval's primal and derivative as the tool computes them, beside C++ by hand: in turns, one thread, and by the
processor's time, which does not count what else the machine does meanwhile.

`python -m benchmarks.gradbench --measure` prints the table, `--to docs/gradbench.md` puts it into that document.
"""
from __future__ import annotations

import gc
import platform
import re
import textwrap
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np

from benchmarks.gradbench import by_hand, inputs
from benchmarks.gradbench.protocol import functions
from benchmarks.peers.machine import processor
from benchmarks.tables import Table
from s2sad.report.timing import Times, seconds

COLUMNS = ("eval", "input", "C++ primal", "s2sad", "", "C++ derivative", "s2sad", "", "agree to")
MARKS = "<!-- measured -->", "<!-- end of what was measured -->"


@dataclass(frozen=True)
class Case:
    """An eval's input with a few words, the names of its functions, and a smaller input to see that it works."""
    module: str
    words: str
    given: Callable[[], Any]
    functions: tuple[str | None, str] = ("primal", "gradient")


CASES = (
    Case("llsq", "n = 4096, m = 128", lambda: inputs.llsq(4096)),
    Case("lse", "n = 160000", lambda: inputs.lse(160000)),
    Case("ode", "n = 10000, s = 100", lambda: inputs.ode(10000, 100)),
    Case("det", "ell = 9", lambda: inputs.det(9)),
    Case("gmm", "d = 10, k = 25, n = 1000", lambda: inputs.gmm(10, 25), ("objective", "jacobian")),
    Case("gmm", "d = 64, k = 25, n = 1000", lambda: inputs.gmm(64, 25), ("objective", "jacobian")),
    Case("lstm", "2 layers, c = 1024", lambda: inputs.lstm(2, 1024), ("objective", "jacobian")),
    Case("ba", "49 cameras, 7776 points, 31843 observations", lambda: inputs.ba(49, 7776, 31843),
         ("objective", "jacobian")),
    Case("ht", "544 vertices, 100 points", lambda: inputs.ht(544, 100, False), ("objective", "jacobian")),
    Case("ht", "544 vertices, 100 points in triangles", lambda: inputs.ht(544, 100, True), ("objective", "jacobian")),
    Case("kmeans", "k = 100, n = 10000, d = 16", lambda: inputs.kmeans(100, 10000, 16), ("cost", "dir")),
    *(Case("particle", f"{mode}, w = 0", lambda: {"w": 0.0}, (None, mode)) for mode in ("rr", "ff")),
    *(Case("saddle", f"{mode}, from (1, 1)", lambda: {"start": [1.0, 1.0]}, (None, mode)) for mode in ("rr", "ff")),
)


def tables(quick: bool, kernels: list[str]) -> list[Table]:
    """One table of all cases; without a compiler of C++ its columns are left out."""
    table = Table("GradBench's evals: s2sad and C++ by hand", COLUMNS)
    for case in CASES:
        table.rows.append(_row(case, 0.1 if quick else 1.5))
    table.notes.append("times are medians of the processor's, after ± half the interquartile range in percent; behind "
                       "s2sad's stands how many times C++'s they are")
    compiler = f"g++ {' '.join(by_hand.OPTIONS[:2])}" if by_hand.library() else "none at hand, so its columns are empty"
    table.notes.append(f"{processor()}, Python {platform.python_version()}, one thread; C++: {compiler}")
    return [table]


def _row(case: Case, budget: float) -> tuple[str, ...]:
    found = functions(case.module)
    arguments = found[case.functions[1]].arguments(case.given())
    ours = [None if name is None else lambda name=name: found[name].call(*arguments) for name in case.functions]
    hand = by_hand.calls(case.module, arguments) if by_hand.library() else (None, None)
    agreement = _agreement(ours, hand) if any(hand) else ""
    runs = {f"{who} {k}": call for who, pair in (("hand", hand), ("ours", ours)) for k, call in enumerate(pair) if call}
    times = {name: Times.of(values) for name, values in _sampled(runs, budget).items()}
    cells: list[str] = []
    for k in range(2):
        by, own = times.get(f"hand {k}"), times.get(f"ours {k}")
        cells += [_said(by), _said(own), f"{own.median / by.median:.1f}" if by and own else ""]
    return case.module, case.words, *cells, agreement


def _sampled(runs: Mapping[str, Callable[[], Any]], budget: float) -> dict[str, list[float]]:
    """Seconds of the processor for each run, round by round: at least 7 rounds, as many as fit the budget; the first
    one warms up and is not counted."""
    times: dict[str, list[float]] = {name: [] for name in runs}
    gc.collect()
    gc.disable()
    start, done = process_time(), -1
    while done < 7 or (done < 1000 and process_time() - start < budget):
        for name, call in runs.items():
            before = process_time()
            call()
            if done >= 0:
                times[name].append(process_time() - before)
        done += 1
    gc.enable()
    return times


def _agreement(ours: Any, hand: Any) -> str:
    """The largest difference, by GradBench's measure: over the sum of magnitudes where that is above 1."""
    worst = 0.0
    for own, by in zip(ours, hand):
        if own and by:
            for a, b in zip(_arrays(own()), _arrays(by())):
                worst = max(worst, float(np.max(np.abs(a - b) / np.maximum(np.abs(a) + np.abs(b), 1.0))))
    return f"{worst:.0e}"


def _arrays(result: Any) -> Iterator[np.ndarray]:
    for part in result if isinstance(result, tuple) else (result,):
        yield np.array(part, dtype=np.float64).ravel()


def _said(times: Times | None) -> str:
    if times is None:
        return ""
    return f"{seconds(times.median)} ± {50.0 * (times.upper - times.lower) / times.median:.0f} %"


def write(table: Table, path: Path) -> None:
    """Puts the table between the marks of a document."""
    lines = ["| " + " | ".join(row) + " |" for row in (table.columns, ["---"] * 2 + ["---:"] * 7, *table.rows)]
    notes = textwrap.wrap(" ".join(f"{note[0].upper()}{note[1:]}." for note in table.notes), 119)
    text = "\n".join([MARKS[0], "", *lines, "", *notes, "", MARKS[1]])
    path.write_text(re.sub(f"{MARKS[0]}.*?{MARKS[1]}", lambda _: text, path.read_text(), flags=re.S))
