"""What a derivative takes for given arguments, in numbers and in words."""
from __future__ import annotations

from dataclasses import dataclass

from s2sad.program import Generated, RecordedArray, SnapshotLoop
from s2sad.run.memory.byte_counts import byte_text
from s2sad.run.memory.footprint import Footprint
from s2sad.run.memory.step_counts import runs_of_schedule, runs_of_steps, runs_of_thinned


@dataclass(frozen=True)
class LoopRuns:
    """A loop that keeps snapshots: what a user calls it, how many it keeps, its number of steps and how many runs of a
    step there are in all, those in the adjoints of steps among them if these run a part of it; None where only the run
    tells."""
    loop: str
    snapshots: int
    steps: int | None
    runs: int | None
    in_adjoint: bool = True

    @property
    def extra(self) -> int | None:
        """The runs that a loop that records does not need."""
        return None if self.runs is None or self.steps is None else self.runs - self.steps

    def __str__(self) -> str:
        head = f"{shown(self.loop)} keeps {self.snapshots:,} snapshots"
        if self.runs is None or self.steps is None:
            return f"{head}; how many steps there are is known only at run time"
        each = f", {self.runs / self.steps:.2f} a step" if self.steps else ""
        own = "" if self.in_adjoint else "; their adjoints run none, for they need the states alone"
        return f"{head} of {self.steps:,} steps, which run {self.runs:,} times in all{each}{own}"


@dataclass(frozen=True)
class GrowingTape:
    """A loop that records, and whose number of steps is known only at run time: the bytes of one step."""
    loop: str
    bytes: int

    def __str__(self) -> str:
        return (f"{shown(self.loop)} records {byte_text(self.bytes)} a step; how many steps there are is known only at "
                "run time")


@dataclass(frozen=True)
class Memory:
    """The bytes that a derivative takes beside its arguments, found before it runs.

    `peak` is the most that it holds at one time: of a `tape`, of `snapshots` and of other arrays (`work`), each of
    these at most so much at one time, and of `copies` of arguments and shadows, which a gradient makes; `disk` are the
    bytes of snapshots in files, which lie in no memory of their own. It is a bound
    if `is_bound`: data decide how much of it is used. `growing` has the loops that record and whose number of steps is
    not known, which the numbers do not hold; `is_complete` says that there are none, and no array of such a size.
    `loops` are those that keep snapshots.
    """
    peak: int
    tape: int
    snapshots: int
    work: int
    copies: int
    disk: int
    is_bound: bool
    is_complete: bool
    growing: tuple[GrowingTape, ...]
    loops: tuple[LoopRuns, ...]

    def __str__(self) -> str:
        more = "" if self.is_complete else ", and what is known only at run time"
        lines = [f"{'at most ' if self.is_bound else ''}{byte_text(self.peak)} beside the arguments{more}"]
        parts = (("tape", self.tape), ("snapshots", self.snapshots), ("other arrays", self.work),
                 ("copies of arguments and shadows", self.copies), ("snapshots on disk", self.disk))
        lines += [f"  {what}: {byte_text(count)}" for what, count in parts if count]
        return "\n".join([*lines, *(f"  {said}" for said in (*self.growing, *self.loops))])


def memory_of(generated: Generated, found: Footprint, copies: int = 0) -> Memory:
    """The memory of a call of a generated function, whose caller makes `copies` for it."""
    return Memory(found.peak + copies, found.tape, found.snapshots, found.work, copies, found.disk, found.is_bound,
                  found.is_complete, growing_tapes(found), loop_runs(generated, found))


def growing_tapes(found: Footprint) -> tuple[GrowingTape, ...]:
    """The loops with an unknown number of steps that record, in the order of the text."""
    arrays: dict[tuple[str, str], RecordedArray] = {}
    for array in found.arrays:
        arrays.setdefault((array.derivative, array.name), array)
    steps: dict[str, int] = {}
    for (derivative, name), array in arrays.items():
        stack = found.stack(derivative, name)
        if stack is not None and stack.unknown:
            steps[array.loop] = steps.get(array.loop, 0) + stack.each
    return tuple(GrowingTape(loop, count) for loop, count in steps.items())


def loop_runs(generated: Generated, found: Footprint) -> tuple[LoopRuns, ...]:
    """The loops that keep snapshots and are run, each once."""
    loops: dict[LoopRuns, None] = {}
    for loop in generated.facts.get("loops", ()):
        if loop.function in found.steps:
            loops.setdefault(_runs(loop, found.steps[loop.function]))
    return tuple(loops)


def _runs(loop: SnapshotLoop, steps: int | None) -> LoopRuns:
    schedule = loop.snapshots.schedule
    if schedule is not None:
        known, count, runs = schedule.steps, schedule.rows, runs_of_schedule(schedule)
    else:
        known, count = steps, loop.snapshots.count
        runs = 0 if known is None else (runs_of_steps if loop.is_counted else runs_of_thinned)(known, count)
    if known is None:
        return LoopRuns(loop.loop, count, None, None)
    return LoopRuns(loop.loop, count, known, runs if loop.runs_in_adjoint else runs - known, loop.runs_in_adjoint)


def shown(loop: str) -> str:
    """A loop, as a sentence begins with it."""
    return f"the loop of {loop}" if loop.startswith("line ") else f"the loop over {loop}" if loop else "a loop"
