"""The chapter of published kernels: one line for each, the geometric means, and where s2sad loses."""
from __future__ import annotations

import importlib.util
import json
import signal
import subprocess
import sys
import tempfile
import threading
from collections.abc import Iterator, Sequence
from pathlib import Path
from statistics import geometric_mean
from time import perf_counter
from typing import Any

from benchmarks.peers.sections import Chapter, Section
from benchmarks.published.cases import CASES
from benchmarks.tables import NOISE, Table, noise, seconds
from s2sad.report.timing import Times

ROOT = Path(__file__).resolve().parent.parent.parent
QUICK = ("gesummv", "softmax", "crank_nicolson")
MINUTES, LONGEST = 10.0, 75.0       # of the chapter; seconds of one kernel
_AT_ONCE = 20.0                     # seconds that the last kernel and the document keep


# -- measuring ------------------------------------------------------------------------------------------------------

def measure(quick: bool, kernels: Sequence[str] = ()) -> dict[str, Any]:
    """What was found of each kernel, or of those that are named; one that takes too long or kills its process costs its
    line."""
    end = perf_counter() + 60.0 * MINUTES - _AT_ONCE
    waiting, found = list(kernels or (QUICK if quick else CASES)), {}
    while waiting and perf_counter() < end:
        for name, line in worked("0.2" if quick else "1.0", list(waiting), end):
            found[name] = line
            waiting.remove(name)
    late = {"failed": f"not measured: the {MINUTES:g} minutes of the chapter were over"}
    return {"jax": importlib.util.find_spec("jax") is not None, "kernels": {**found, **dict.fromkeys(waiting, late)}}


def worked(budget: str, names: list[str], end: float) -> Iterator[tuple[str, dict[str, Any]]]:
    """What one process finds of kernels, until one fails it."""
    command = [sys.executable, "-m", "benchmarks.published.worker", budget, *names]
    with tempfile.TemporaryFile("w+") as errors:
        process = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=errors, text=True)
        assert process.stdout is not None
        for name in names:
            allowed = max(1.0, min(LONGEST, end - perf_counter()))
            stop = threading.Timer(allowed, process.kill)
            stop.start()
            line = next((t for t in process.stdout if t.startswith("{")), "")
            stop.cancel()
            if not line:
                killed = process.wait() == -signal.SIGKILL
                errors.seek(0)
                yield name, {"failed": f"stopped after {allowed:.0f} s" if killed else _last(errors.read())}
                return
            found = json.loads(line)
            yield found.pop("name"), found
        process.wait()


def _last(text: str) -> str:
    return text.strip().rpartition("\n")[2][:200] or "its process ended"


# -- rendering ------------------------------------------------------------------------------------------------------

def render(found: dict[str, Any]) -> Chapter:
    """The chapter's tables."""
    kernels = found["kernels"]
    measured = {n: line for n, line in kernels.items() if "times" in line}
    table = Table("Gradients of published kernels, large size, float64", (
        "kernel", "Numba primal", "generated primal", "adjoint", "over Numba", "over generated", "vjp", "over Numba",
        "JAX gradient", "over its primal", "s2sad : JAX"))
    rows = {name: _Row(line["times"]) for name, line in measured.items()}
    table.rows = [(name, *row.texts()) for name, row in rows.items()]
    table.rows.append(("geometric mean", "", "", "", _mean(r.adjoint for r in rows.values()),
                       _mean(r.generated for r in rows.values()), "", _mean(r.vjp for r in rows.values()), "",
                       _mean(r.jax for r in rows.values()), _mean(r.against for r in rows.values())))
    table.notes = [
        "Numba primal: the kernel under `numba.njit`, - where Numba does not take it as it is written; generated "
        "primal: as s2sad compiles it. adjoint: the bare function; vjp: as a user calls it, arguments copied, "
        "gradients new. s2sad : JAX: the vjp over JAX's jitted gradient, above 1 where s2sad loses."]
    return Chapter([_summary(rows)], [table, _numpy(rows), _errors(measured), *_others(kernels, found["jax"])])


class _Row:
    """The ratios of one kernel, None where one of the two times is missing or does not repeat."""

    def __init__(self, times: dict[str, Any]):
        self.times = {name: Times(**t) for name, t in times.items()}
        self.adjoint, self.vjp = self._over("adjoint", "njit"), self._over("vjp", "njit")
        self.generated = self._over("adjoint", "generated")
        self.jax = self._over("jax gradient", "jax primal")
        self.against, self.numpy = self._over("vjp", "jax gradient"), self._over("vjp", "numpy")

    def _over(self, top: str, bottom: str) -> float | None:
        pair = [self.times[n] for n in (top, bottom) if n in self.times]
        return pair[0].median / pair[1].median if len(pair) == 2 and all(noise(t) <= NOISE for t in pair) else None

    def time(self, name: str) -> str:
        found = self.times.get(name)
        return "-" if found is None else "does not repeat" if noise(found) > NOISE else seconds(found.median)

    def texts(self) -> tuple[str, ...]:
        return (self.time("njit"), self.time("generated"), self.time("adjoint"), _ratio(self.adjoint),
                _ratio(self.generated), self.time("vjp"), _ratio(self.vjp), self.time("jax gradient"),
                _ratio(self.jax), _ratio(self.against))


def _ratio(value: float | None) -> str:
    return "-" if value is None else f"{value:.2f}"


def _mean(values: Any) -> str:
    known = [v for v in values if v is not None]
    return f"{geometric_mean(known):.2f}" if known else "-"


def _summary(rows: dict[str, _Row]) -> str:
    """The means, the worst, and every kernel at which JAX is faster."""
    bare = {n: r.generated for n, r in rows.items() if r.generated is not None}
    beside = {n: r.against for n, r in rows.items() if r.against is not None}
    if not bare:
        return "Of the published kernels no time repeats."
    worst = ", ".join(f"{n} {bare[n]:.1f}" for n in sorted(bare, key=lambda n: -bare[n])[:5])
    own = _mean(r.adjoint for r in rows.values())
    said = (f"Published kernels ({len(bare)} whose times repeat, of {len(CASES)}): in the geometric mean the bare "
            f"adjoint takes {_mean(bare.values())} times the primal that s2sad generates, {own} times the kernel's own "
            f"under Numba; the worst over the generated primal: {worst}.")
    if not beside:
        return said
    lost = [f"{n} {beside[n]:.1f}" for n in sorted(beside, key=lambda n: -beside[n]) if beside[n] > 1.0]
    return (f"{said} A vjp takes {_mean(beside.values())} times as long as JAX's gradient in the geometric "
            f"mean; JAX is faster at {len(lost)} of {len(beside)}{': ' + ', '.join(lost) if lost else ''}.")


def _numpy(rows: dict[str, _Row]) -> Table:
    """NumPy's own primal, where the kernel is written in whole arrays."""
    table = Table("The compiled gradient over NumPy's primal, for kernels that are written in whole arrays",
                  ("kernel", "NumPy primal", "vjp over it"))
    known = [(n, r) for n, r in rows.items() if "numpy" in r.times]
    table.rows = [(n, r.time("numpy"), _ratio(r.numpy)) for n, r in known]
    table.rows.append(("geometric mean", "", _mean(r.numpy for _, r in known)))
    return table


def _errors(measured: dict[str, Any]) -> Table:
    table = Table("Errors of the gradients, small size: the largest of an argument over its largest magnitude",
                  ("kernel", "s2sad", "JAX", "apart"))
    kinds = ("s2sad", "jax", "apart")
    for name, line in measured.items():
        table.rows.append((name, *(f"{line['errors'][k]:.1e}" if k in line["errors"] else "-" for k in kinds)))
    without = [f"{n} ({line['errors']['no reference']})" for n, line in measured.items()
               if "no reference" in line["errors"]]
    table.notes = ["s2sad, JAX: against derivatives at 113 bits; apart: of both gradients."]
    if without:
        table.notes.append(f"Not to be had at 113 bits: {', '.join(without)}.")
    return table


def _others(kernels: dict[str, Any], jax: bool) -> list[str]:
    """What was refused or failed, and why there is no version in JAX."""
    refused = [f"- {n}: {line['refused'].splitlines()[0]}" for n, line in kernels.items() if "refused" in line]
    failed = [f"- {n}: {line['failed']}" for n, line in kernels.items() if "failed" in line]
    reasons = [f"{n} ({CASES[n].no_jax})" for n in kernels if CASES[n].no_jax]
    said = [f"Refused by s2sad: {'none' if not refused else ''}" + "".join(f"\n{r}" for r in refused)]
    if failed:
        said.append("\n".join(["Without a line:", "", *failed]))
    if not jax:
        said.append("JAX is not installed and left out.")
    elif reasons:
        said.append(f"Without a version in JAX: {'; '.join(reasons)}.")
    return said


def tables(quick: bool, kernels: list[str]) -> list[Table]:
    """The chapter's tables, for `python -m benchmarks published`."""
    chapter = render(measure(quick, kernels))
    found = [part for part in chapter.body if isinstance(part, Table)]
    found[0].notes += [part for part in [*chapter.summary, *chapter.body] if isinstance(part, str)]
    return found


SECTION = Section("published", "Published kernels", measure, render, minutes=MINUTES)
