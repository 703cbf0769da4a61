"""What is measured of a kernel: gradients checked, times in turns, memory, growth, first gradients, lines changed."""
from __future__ import annotations

import os
import tempfile
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np

from benchmarks.peers.problems import EXACT, SIZES, Problem, error
from benchmarks.peers.process import Process
from benchmarks.peers.results import Kernel, slope
from benchmarks.peers.tools import OURS, PRIMALS, Tool
from benchmarks.tables import NOISE, noise
from s2sad.report.timing import Times

PREPARE, CALL = 40.0, 0.5       # seconds in which a tool has to compile and give the first gradient; of one gradient
UNSTEADY = 4                    # times as many samples at most are taken where they are far apart
WRONG = {"s2sad, Numba, float32": 1e-2}
ALLOWED = 1e-7                  # the error with which a tool's version of a kernel still counts as the same kernel
FIRST = ("brusselator", "attention")
CORES = min(2, os.cpu_count() or 1)
Found = dict[str, Any]


class Comparison:
    """The processes of all variants, and how long a sample and all samples of one variant may take."""

    def __init__(self, tools: list[Tool], folder: Path, sample: float, rounds: int, budget: float) -> None:
        self.folder, self.sample, self.rounds, self.budget = folder, sample, rounds, budget
        self.processes = {variant: Process(tool.adapter) for tool in tools for variant in tool.variants}

    def kernel(self, name: str, sizes: tuple[int, ...]) -> Found:
        """Everything that is found of a kernel, by size, and the steps of differences at the size that is exact."""
        found: Found = {"sizes": {}, "curves": {}}
        over: set[str] = set()
        for place, size in enumerate(sizes):
            expected = Problem.of(name, size).reference() if size == SIZES[name][EXACT] else None
            at = self.size(name, size, over, expected)
            if expected is not None:
                found["curves"] = self.curves(expected)
            found["sizes"][str(size)] = at
            for variant, line in at["variants"].items():
                if place + 1 < len(sizes) and (why := too_long(Kernel(name, found), variant, sizes[place + 1])):
                    line["later"] = why
                if "left" in line or "later" in line:
                    over.add(variant)
        return found

    def size(self, name: str, size: int, over: set[str], expected: list[Any] | None) -> Found:
        """Gradients, errors, times and memory of all variants that are not over yet."""
        problem = Problem.of(name, size)
        trying = [variant for variant in self.processes if variant not in over]
        with ThreadPoolExecutor(CORES) as several:      # what is not timed may run side by side
            lines = dict(zip(trying, several.map(lambda v: self._prepared(v, name, size), trying)))
        self._checked(lines, expected)
        ready = [v for v, line in lines.items() if "left" not in line]
        self._timed(ready, lines)
        for variant in ready:
            if "left" not in lines[variant]:
                lines[variant]["memory"] = self.processes[variant].ask({"do": "memory"}, PREPARE).get("bytes")
        return {"inputs": problem.inputs, "exact": expected is not None, "variants": lines}

    def curves(self, expected: list[Any]) -> Found:
        """The errors of differences at each step, for what was prepared last."""
        found: Found = {}
        for variant in ("forward differences", "central differences"):
            files = [str(self.folder / f"{variant}-{k}.npz") for k in range(10)]
            answer = self.processes[variant].ask({"do": "curve", "files": files}, 3 * PREPARE)
            if "steps" in answer:
                found[variant] = [[step, error(_arrays(file), expected)] for step, file in zip(answer["steps"], files)]
        return found

    def stop(self) -> None:
        """Ends all processes."""
        for process in self.processes.values():
            process.stop()

    def _prepared(self, variant: str, name: str, size: int) -> Found:
        request = {"do": "prepare", "variant": variant, "kernel": name, "size": size, "file": self._file(variant)}
        answer = self.processes[variant].ask(request, PREPARE, every_core=True)
        left = answer.get("unsupported") or answer.get("failed")
        return {"left": left} if left else {"seconds": answer["seconds"], "lines": answer["lines"]}

    def _checked(self, lines: dict[str, Found], expected: list[Any] | None) -> None:
        """Errors against the reference, or how far a gradient is from s2sad's; a wrong one is left out, and said."""
        ours = next((v for v in OURS if "seconds" in lines.get(v, {})), None)
        against = expected if expected is not None else _arrays(self._file(ours)) if ours else None
        for variant, line in lines.items():
            if "left" in line or variant in PRIMALS or against is None:
                continue
            off = error(_arrays(self._file(variant)), against)
            if expected is not None:
                line["error"] = off
            if not off <= WRONG.get(variant, ALLOWED) and not variant.endswith("differences"):
                line["left"] = f"its gradient is wrong by {off:.1e}"

    def _timed(self, variants: list[str], lines: dict[str, Found]) -> None:
        """Samples of all in turns; one whose calls are long has fewer, one that is too long none."""
        samples: dict[str, list[float]] = {variant: [] for variant in variants}
        spent = dict.fromkeys(variants, 0.0)
        for _ in range(UNSTEADY * self.rounds):
            for variant in variants:
                if "left" in lines[variant] or self._enough(samples[variant], spent[variant]):
                    continue
                start = perf_counter()
                answer = self.processes[variant].ask({"do": "time", "seconds": self.sample}, 6 * CALL)
                spent[variant] += perf_counter() - start
                if "times" not in answer or min(answer["times"]) > CALL:
                    lines[variant]["left"] = f"a gradient takes over {CALL:g} s"
                else:
                    samples[variant].append(float(np.median(answer["times"])))
        for variant in variants:
            if "left" not in lines[variant]:
                lines[variant]["times"] = asdict(Times.of(samples[variant]))

    def _enough(self, samples: list[float], spent: float) -> bool:
        """Whether a variant has its samples: all count, and those that are far apart are asked for more."""
        if len(samples) < 3:
            return False
        share = 1.0 if noise(Times.of(samples)) <= 0.5 * NOISE else UNSTEADY
        return len(samples) >= share * self.rounds or spent > share * self.budget

    def _file(self, variant: str) -> str:
        return str(self.folder / f"{variant}.npz")


def too_long(kernel: Kernel, variant: str, size: int) -> str | None:
    """Why a variant is not tried at the next size: a gradient grows as the size and the number of inputs, what comes
    before the first as it did from the last size to this one."""
    last = kernel.sizes[-1]
    times = kernel.times(variant, last)
    if times is not None:
        inputs = kernel.stored["sizes"][str(last)]["inputs"]
        expected = times.median * max(size / last, Problem.of(kernel.name, size).inputs / inputs)
        if expected > 2.0 * CALL:
            return f"a gradient at n = {size} would take about {expected:.0f} s"
    prepared = [(n, s) for n in kernel.sizes[-2:] if (s := kernel.line(variant, n).get("seconds"))]
    if len(prepared) == 2:
        expected = prepared[1][1] * (size / last) ** slope(*zip(*prepared))
        if expected > 2.0 * PREPARE:
            return f"the first gradient at n = {size} would take about {expected:.0f} s"
    return None


def first_gradients(tools: list[Tool], kernels: tuple[str, ...]) -> Found:
    """The processor's seconds from the start of a process to its first gradient, with empty caches."""
    found: Found = {}
    for tool in tools:
        for variant in tool.variants:
            if variant in PRIMALS or variant in ("s2sad, Numba, float32", "central differences"):
                continue
            found[variant] = {kernel: _first(tool.adapter, variant, kernel) for kernel in kernels}
    return found


def _first(adapter: str, variant: str, kernel: str) -> float | None:
    with tempfile.TemporaryDirectory() as folder:
        process = Process(adapter, {"S2SAD_CACHE_DIR": folder})
        answer = process.ask({"do": "prepare", "variant": variant, "kernel": kernel, "size": SIZES[kernel][EXACT],
                              "file": f"{folder}/gradient.npz"}, 2 * PREPARE)
        process.stop()
    return answer.get("since")


def _arrays(file: str) -> list[Any]:
    with np.load(file) as stored:
        return [stored[name] for name in stored.files]
