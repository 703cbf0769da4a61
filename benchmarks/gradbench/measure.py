"""Each eval's primal and derivative as the tool computes them, beside C++ by hand: in turns, one thread, and by the
processor's time."""
from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from time import process_time
from typing import Any

import numpy as np

from benchmarks.gradbench import by_hand, inputs
from benchmarks.gradbench.protocol import functions
from s2sad.report.timing import Prepare, Times, sampled


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


def measured(quick: bool) -> dict[str, Any]:
    """Times and agreement of all cases, as JSON; without a compiler of C++ of s2sad alone."""
    return {"compiler": f"g++ {' '.join(by_hand.OPTIONS[:2])}" if by_hand.library() else None,
            "cases": [_measured(case, 0.1 if quick else 1.5) for case in CASES]}


def _measured(case: Case, budget: float) -> dict[str, Any]:
    found = functions(case.module)
    arguments = found[case.functions[1]].arguments(case.given())
    ours = [None if name is None else lambda name=name: found[name].call(*arguments) for name in case.functions]
    hand = by_hand.calls(case.module, arguments) if by_hand.library() else (None, None)
    runs: dict[str, Prepare] = {
        f"{who} {what}": lambda call=call: call for who, pair in (("C++", hand), ("s2sad", ours))
        for what, call in zip(("primal", "derivative"), pair) if call}
    taken = sampled(runs, budget, least=7, clock=process_time)
    return {"eval": case.module, "input": case.words, "apart": _agreement(ours, hand) if any(hand) else None,
            "times": {name: asdict(Times.of(values)) for name, values in taken.items()}}


def _agreement(ours: Any, hand: Any) -> float:
    """The largest difference, by GradBench's measure: over the sum of magnitudes where that is above 1."""
    worst = 0.0
    for own, by in zip(ours, hand):
        if own and by:
            for a, b in zip(_arrays(own()), _arrays(by())):
                worst = max(worst, float(np.max(np.abs(a - b) / np.maximum(np.abs(a) + np.abs(b), 1.0))))
    return worst


def _arrays(result: Any) -> Iterator[np.ndarray]:
    for part in result if isinstance(result, tuple) else (result,):
        yield np.array(part, dtype=np.float64).ravel()
