"""The chapter on other tools: run time against error, growth, first gradients, and the lines that have to change."""
from __future__ import annotations

import sys
import tempfile
from pathlib import Path
from time import perf_counter
from typing import Any

from benchmarks.peers.measuring import FIRST, Comparison, first_gradients
from benchmarks.peers.problems import EXACT, SIZES
from benchmarks.peers.rendering import render
from benchmarks.peers.sections import Section
from benchmarks.peers.tools import TOOLS, Tool, missing

MINUTES = 24.0
LONGEST = 3.0       # minutes that a kernel may take: none is begun later


def measure(quick: bool) -> dict[str, Any]:
    """All kernels at all sizes; those for which no time is left are named."""
    start = perf_counter()
    found: dict[str, Any] = {"missing": missing(), "kernels": {},
                             "unreached": ["brusselator", "attention"] if quick else list(SIZES)}
    found["first"] = first_gradients(_tools(), FIRST[:0] if quick else FIRST)
    return _measured(found, quick, start)


def resume(found: dict[str, Any]) -> dict[str, Any]:
    """What was found before with the kernels for which no time had been left."""
    return _measured(found, False, perf_counter())


def _tools() -> list[Tool]:
    return [tool for tool in TOOLS if tool.installed]


def _measured(found: dict[str, Any], quick: bool, start: float) -> dict[str, Any]:
    waiting, found["unreached"] = found["unreached"], []
    with tempfile.TemporaryDirectory() as folder:
        comparison = Comparison(_tools(), Path(folder), *((0.01, 3, 0.2) if quick else (0.02, 7, 0.4)))
        try:
            for name in waiting:
                if perf_counter() - start > 60.0 * (MINUTES - LONGEST):
                    found["unreached"].append(name)
                    continue
                found["kernels"][name] = _kernel(comparison, name, quick)
                print(f"peers: {name} after {perf_counter() - start:.0f} s", file=sys.stderr, flush=True)
        finally:
            comparison.stop()
    return found


def _kernel(comparison: Comparison, name: str, quick: bool) -> dict[str, Any]:
    """What is found of a kernel; what goes wrong costs this kernel only."""
    try:
        return comparison.kernel(name, SIZES[name][EXACT:EXACT + 1] if quick else SIZES[name])
    except Exception as problem:
        return {"failed": f"{type(problem).__name__}: {problem}"}


SECTION = Section("peers", "Against other tools", measure, render, minutes=MINUTES, resume=resume)
