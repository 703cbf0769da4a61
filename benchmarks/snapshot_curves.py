"""The chapter of long loops: the time of a gradient against the memory of its snapshots, one curve for each kernel.

Each number of snapshots is a text of its own, which is compiled: that is most of what the chapter takes.
"""
from __future__ import annotations

import os
import statistics
from collections.abc import Callable
from functools import partial
from importlib.util import find_spec
from time import process_time
from typing import Any

import numpy as np

import s2sad
from benchmarks.peers.sections import Chapter, Picture, Section
from benchmarks.snapshots import KERNELS, given, gradient, measured_rows, table as table_of_long_loops
from benchmarks.tables import Table, seconds

STEPS, COUNTS, ROUNDS = 1000, (2, 5, 20, 100), 7
QUICK_STEPS, QUICK_COUNTS, QUICK_ROUNDS = 60, (2, 60), 3
PEERS = {"jax": "JAX's jax.checkpoint over chunks of a scan", "equinox": "Equinox's checkpointed loop"}
LOOPS = {"jax": "in_chunks", "equinox": "checkpointed"}      # of `peers.with_jax`
MINUTES = 20.0


def measure(quick: bool) -> dict[str, Any]:
    """Of each kernel the time and the tape of a gradient that records, and of those that keep snapshots."""
    steps, counts, rounds = (QUICK_STEPS, QUICK_COUNTS, QUICK_ROUNDS) if quick else (STEPS, (*COUNTS, STEPS), ROUNDS)
    kernels: dict[str, Any] = {}
    for name, (kernel, loop, wrt) in KERNELS.items():
        arguments = given(name, steps)
        made = partial(s2sad.differentiate, kernel, engine="numba", wrt=wrt)
        recorded = made()
        curve = [_point(made(checkpoint={loop: count}), wrt, arguments, rounds, count) for count in counts]
        kernels[name] = {"recorded": _point(recorded, wrt, arguments, rounds, 0), "curve": curve,
                         "primal": _median(partial(_primal, recorded, arguments), rounds),
                         "peers": _peers(name, gradient(wrt)(recorded, arguments)[wrt], arguments, counts, rounds)}
    return {"unreached": [] if quick else ["long"], "steps": steps, "kernels": kernels, "load": os.getloadavg()[0],
            "cores": os.cpu_count(), "peers": {name: find_spec(name) is not None for name in PEERS}}


def resume(found: dict[str, Any]) -> dict[str, Any]:
    """What was measured, with the loops of a million steps, which take ten minutes."""
    return {**found, "unreached": [], "long": measured_rows()}


def _peers(name: str, expected: Any, arguments: tuple[Any, ...], counts: tuple[int, ...], rounds: int
           ) -> dict[str, list[dict[str, float]]]:
    """The same points of the loops of other tools, whose gradients must be equal."""
    if not find_spec("jax") or name == "integrate_until":       # its number of steps is not known
        return {}
    from benchmarks.peers import with_jax
    found: dict[str, list[dict[str, float]]] = {}
    for tool in filter(find_spec, PEERS):
        points = found[tool] = []
        for count in counts:
            run, taken = with_jax.stepped_gradient(name, arguments, getattr(with_jax, LOOPS[tool])(count))
            np.testing.assert_allclose(np.asarray(run()), expected, rtol=1e-6, atol=1e-9 * np.abs(expected).max())
            points.append({"snapshots": count, "bytes": taken, "time": _median(run, rounds)})
    return found


def _primal(f: Any, arguments: tuple[Any, ...]) -> Any:
    return f.primal(arguments[0].copy(), *arguments[1:])


def _point(f: Any, wrt: str, arguments: tuple[Any, ...], rounds: int, snapshots: int) -> dict[str, float | None]:
    """The snapshots or the tape of a gradient, None where it is known only at run time, and its time."""
    memory = f.adjoint.memory(*arguments)
    taken = _median(lambda: gradient(wrt)(f, arguments), rounds)
    return {"snapshots": snapshots, "bytes": _bytes(memory), "runs": _runs(memory, snapshots), "time": taken}


def _runs(memory: Any, snapshots: int) -> int | None:
    """How often steps run, one after the other and in their adjoints; None where that shows only at run time."""
    return next((loop.runs or None for loop in memory.loops), None) if snapshots else None


def _bytes(memory: Any) -> int | None:
    return (memory.snapshots or memory.tape) if memory.is_complete else None


def _median(run: Callable[[], Any], rounds: int) -> float:
    """The processor's time of a call, which has been compiled by one before."""
    run()
    times = []
    for _ in range(rounds):
        start = process_time()
        run()
        times.append(process_time() - start)
    return statistics.median(times)


def render(found: dict[str, Any]) -> Chapter:
    steps = found["steps"]
    table = Table(f"Gradients of loops of {steps:,} steps", (
        "kernel", "snapshots", "runs of a step", "kept, MB", "time", "over recording", "over the primal"))
    for name, of in found["kernels"].items():
        recorded = of["recorded"]
        for point in (*of["curve"], recorded):
            count = int(point["snapshots"])
            runs = point.get("runs")
            table.rows.append((name, str(count) if count else "all is recorded",
                               f"{runs / steps:.2f}" if runs else "" if count else "1.00",
                               f"{point['bytes'] / 1e6:.2f}" if point["bytes"] else "grows", seconds(point["time"]),
                               f"{point['time'] / recorded['time']:.2f}", f"{point['time'] / of['primal']:.2f}"))
    others = Table("The same gradients by loops of JAX, whose memory is what its compiler says", (
        "kernel", "loop", "snapshots", "memory, MB", "time", "over s2sad's with as many"))
    for name, of in found["kernels"].items():
        for tool, points in of.get("peers", {}).items():
            for point, own in zip(points, of["curve"]):
                others.rows.append((name, PEERS[tool], str(point["snapshots"]), f"{point['bytes'] / 1e6:.2f}",
                                    seconds(point["time"]), f"{point['time'] / own['time']:.2f}"))
    absent = [PEERS[name] for name, there in found["peers"].items() if not there]
    table.notes = [f"The load of the machine was {found['load']:.1f} on {found['cores']} cores when this was measured.",
                   *([f"Not installed, and not compared: {', '.join(absent)}."] if absent else [])]
    return Chapter(body=[
        "Runs of a step: with those in its own adjoint, which are none where that needs the state alone.",
        Picture("snapshots", "time of a gradient against what it keeps, a curve for each kernel",
                partial(_draw, found)),
        table, *([others] if others.rows else []),
        *([table_of_long_loops(found["long"])] if "long" in found else [])])


def _draw(found: dict[str, Any], figure: Any) -> None:
    axes = figure.subplots()
    for name, of in found["kernels"].items():
        points, recorded = of["curve"], of["recorded"]
        [line] = axes.plot([p["bytes"] / 1e6 for p in points], [p["time"] / of["primal"] for p in points], "o-",
                           label=name)
        if recorded["bytes"]:
            axes.plot(recorded["bytes"] / 1e6, recorded["time"] / of["primal"], "s", color=line.get_color(),
                      mfc="white")
    axes.set_xscale("log")
    axes.set_xlabel("snapshots, MB (squares: all is recorded)")
    axes.set_ylabel("gradient over primal")
    axes.set_ylim(bottom=0.0)
    axes.legend()


SECTION = Section("snapshots", "Long loops", measure, render, MINUTES, resume)
