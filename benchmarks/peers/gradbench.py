"""The chapter on GradBench: its evals beside C++ by hand, and where s2sad loses."""
from __future__ import annotations

from statistics import geometric_mean
from typing import Any

from benchmarks.gradbench.measure import measured
from benchmarks.peers.results import LOSES
from benchmarks.peers.sections import Chapter, Section
from benchmarks.tables import NOISE, Table, noise, shown
from s2sad.report.timing import Times

COLUMNS = ("eval", "input", "C++ primal", "s2sad", "", "C++ derivative", "s2sad", "", "agree to")


def render(found: dict[str, Any]) -> Chapter:
    """The table, and above it the evals at which C++ by hand is faster."""
    table = Table("GradBench's evals: s2sad and C++ by hand", COLUMNS)
    ratios: dict[str, float] = {}
    for case in found["cases"]:
        times = {name: Times(**t) for name, t in case["times"].items()}
        cells: list[str] = []
        for what in ("primal", "derivative"):
            hand, ours = times.get(f"C++ {what}"), times.get(f"s2sad {what}")
            ratio = _over(ours, hand)
            cells += [shown(hand) if hand else "", shown(ours) if ours else "", f"{ratio:.1f}" if ratio else ""]
            if ratio and what == "derivative":
                ratios[f"{case['eval']} ({case['input']})"] = ratio
        table.rows.append((case["eval"], case["input"], *cells,
                           "" if case["apart"] is None else f"{case['apart']:.0e}"))
    compiler = found["compiler"] or "no compiler was at hand, so its columns are empty"
    table.notes = ["Behind s2sad's times stands how many times C++'s they are. agree to: the largest difference "
                   "between both, over the sum of their magnitudes where that is above 1; GradBench asks for 1e-4. "
                   f"C++: {compiler}."]
    return Chapter([_summary(ratios)] if ratios else [], [table])


def _over(ours: Times | None, hand: Times | None) -> float | None:
    """The ratio of two times that repeat."""
    return ours.median / hand.median if ours and hand and max(noise(ours), noise(hand)) <= NOISE else None


def _summary(ratios: dict[str, float]) -> str:
    lost = [f"{n} {ratios[n]:.1f}" for n in sorted(ratios, key=lambda n: -ratios[n]) if ratios[n] > LOSES]
    return (f"GradBench: a derivative takes {geometric_mean(ratios.values()):.1f} times that of C++ with derivatives "
            f"by hand in the geometric mean; C++ is faster at {len(lost)} of {len(ratios)}"
            f"{': ' + ', '.join(lost) if lost else ''}.")


def tables(quick: bool, kernels: list[str]) -> list[Table]:
    """The chapter's table, for `python -m benchmarks gradbench`."""
    return [part for part in render(measured(quick)).body if isinstance(part, Table)]


SECTION = Section("gradbench", "GradBench", measured, render, minutes=6.0)
