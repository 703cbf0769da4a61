"""The loops of a derivative that keep snapshots so that a call takes no more memory than a limit, and how many each.

All is recorded, if that fits. Else the loop whose tape is the largest keeps one snapshot, and the next one, until it
fits; then these loops keep as many as there is room for. Counts are those of a coarse grid, so that few derivatives are
made for many sizes.
"""
from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property

from s2sad.diagnostics import Diagnostic, S2sadError
from s2sad.program import Checkpoints, Generated, RecordedArray, Snapshots
from s2sad.run.memory import Footprint, byte_text, growing_tapes
from s2sad.run.memory.call_memory import shown
from s2sad.run.memory.step_counts import runs_of_steps

Derive = Callable[[Checkpoints], Generated]
Predict = Callable[[Generated], Footprint]

_MANY = 1_000_000       # steps of a loop whose number of steps is not known
_DEAR = 6.0             # runs of a step from which more loops are tried
_TRIES = 5              # numbers of snapshots until one fits
_LINEAR = 8             # bytes beside a snapshot: the number of its step
GRID = tuple(sorted({count for k in range(31) for count in (1 << k, 3 << k >> 1)}))
"""1, 2, 3, 4, 6, 8, 12, ...: a third of the room that there is stays empty at most."""


@dataclass(frozen=True)
class SnapshotPlan:
    """What is chosen for a call: `checkpoints`, of the function that is `generated` with them, whose memory is `found`;
    `copies` are the bytes that its caller makes, `plain` is what it would take to record all."""
    limit: int
    copies: int
    checkpoints: Checkpoints
    generated: Generated
    found: Footprint
    plain: Footprint

    def __str__(self) -> str:
        head = f"takes {byte_text(self.found.peak + self.copies)} of the {byte_text(self.limit)} that checkpoint "
        if not self.checkpoints:
            return f"{head}allows: all is recorded"
        largest = _recording_most(self.plain)
        most = f", most of it for {_loops_in_words(largest[:1])}" if largest else ""
        more = "" if self.plain.is_complete else ", and what is known only at run time"
        return (f"{head}allows; without snapshots it would take {byte_text(self.plain.peak + self.copies)}{more}{most}")


def snapshot_plan(kernel: str, limit: int, copies: int, derive: Derive, predict: Predict) -> SnapshotPlan:
    """The plan for a call whose caller makes `copies`; raises S2sadError (S410) where nothing fits."""
    return _Planner(kernel, limit, copies, derive, predict).plan()


@dataclass(frozen=True)
class _Option:
    """One choice of loops, each with its number of snapshots."""
    counts: Mapping[str, int]
    generated: Generated
    found: Footprint

    @property
    def checkpoints(self) -> Checkpoints:
        return _checkpoints(self.counts)

    @cached_property
    def largest(self) -> tuple[str, ...]:
        """The loops that record and have no number yet, those that record most first."""
        return tuple(loop for loop in _recording_most(self.found) if loop not in self.counts)

    @property
    def size(self) -> tuple[int, int]:
        """How large it is: what is not known before the run, and the bytes that are."""
        unknown = sum(s.unknown for s in self.found.stacks.values())
        return (0 if self.found.is_complete else max(1, unknown)), self.found.peak

    def bytes_of_snapshot(self, loop: str) -> int:
        """What one more snapshot of a loop takes, of which this has one beside the last state."""
        kept = {(a.derivative, a.name) for a in self.found.arrays if a.loop == loop and a.kind == "snapshots"}
        stacks = [s for pair in kept if (s := self.found.stack(*pair)) is not None]
        return max(1, sum(s.bytes for s in stacks) // 2 + _LINEAR)

    def steps(self, loop: str) -> int:
        """The number of steps of a loop that keeps snapshots."""
        known = [self.found.steps.get(s.function) for s in self.generated.facts.get("loops", ()) if s.loop == loop]
        return max([_MANY if n is None else n for n in known], default=_MANY)

    def runs(self, loop: str, count: int) -> float:
        """The runs of a step, on the average."""
        steps = self.steps(loop)
        return runs_of_steps(steps, count) / steps if steps else 1.0

    @property
    def cost(self) -> float:
        """The same of all loops, as if each were in the next."""
        return math.prod(self.runs(loop, count) for loop, count in self.counts.items())


class _Planner:
    def __init__(self, kernel: str, limit: int, copies: int, derive: Derive, predict: Predict):
        self.kernel, self.limit, self.copies, self.derive, self.predict = kernel, limit, copies, derive, predict
        self.made: dict[Checkpoints, _Option | None] = {}
        self.refusals: dict[str, S2sadError] = {}

    def plan(self) -> SnapshotPlan:
        plain = self.option({})
        assert plain is not None
        best = plain if self.fits(plain) else self.with_snapshots(plain)
        return SnapshotPlan(self.limit, self.copies, best.checkpoints, best.generated, best.found, plain.found)

    def fits(self, option: _Option) -> bool:
        return option.found.is_complete and option.found.peak + self.copies <= self.limit

    def option(self, counts: Mapping[str, int]) -> _Option | None:
        """What comes of these numbers; None where one of the loops cannot keep snapshots."""
        key = _checkpoints(counts)
        if key not in self.made:
            try:
                self.made[key] = self.derived(counts, key)
            except S2sadError as refused:
                if not counts:
                    raise
                self.refusals.setdefault([*counts][-1], refused)
                self.made[key] = None
        return self.made[key]

    def derived(self, counts: Mapping[str, int], checkpoints: Checkpoints) -> _Option:
        generated = self.derive(checkpoints)
        try:
            return _Option(dict(counts), generated, self.predict(generated))
        except Exception as error:
            raise S2sadError(Diagnostic("S410", f"what the adjoint of '{self.kernel}' takes cannot be foreseen, and "
                                        f"checkpoint allows {byte_text(self.limit)}", help="name the loops that "
                                        'keep snapshots, and how many: checkpoint={"k": 20}')) from error

    def with_snapshots(self, plain: _Option) -> _Option:
        """The plan of the fewest runs that was found."""
        best = self.filled(self.without_idle_loops(self.narrowed(plain)))
        while best.cost > _DEAR:
            more = self.next_loop(best, frozenset())
            found = None if more is None else self.filled(more)
            if found is None or found.cost >= best.cost:
                break
            best = found
        return best

    def narrowed(self, option: _Option) -> _Option:
        """One snapshot for as many loops as it takes until it fits."""
        while not self.fits(option):
            more = self.next_loop(option, frozenset())
            if more is None:
                raise self.refused(option)
            option = more
        return option

    def next_loop(self, option: _Option, tried: frozenset[str]) -> _Option | None:
        """The option in which one more loop keeps a snapshot and which takes less: that which records most, else the
        next one, or one that is in it."""
        for loop in (n for n in option.largest if n not in tried):
            more = self.option({**_ones(option.counts), loop: 1})
            if more is None:
                continue
            least = self.option(_ones(option.counts))
            assert least is not None
            if more.size < least.size:
                return more
            inner = next((m for m in more.largest if m not in option.largest), None)
            found = None if inner is None else self.option({**_ones(option.counts), inner: 1})
            if found is not None and found.size < least.size:
                return found
        return None

    def without_idle_loops(self, option: _Option) -> _Option:
        """The option without the loops that it fits without."""
        for loop in [*option.counts][:-1]:
            fewer = self.option({n: c for n, c in option.counts.items() if n != loop})
            if fewer is not None and self.fits(fewer):
                option = fewer
        return option

    def filled(self, least: _Option) -> _Option:
        """As many snapshots as there is room for beside those of the least option, which fits. What several calls of a
        loop's function keep at one time shows in what comes out: then fewer are tried."""
        factor = 1.0
        for _ in range(_TRIES):
            counts, more = self.counts_within(least, factor)
            found = self.option(counts) if more else least
            if found is not None and self.fits(found):
                return found
            if found is None:
                break
            factor *= max(1.1, (found.found.peak - least.found.peak) / more)
        return least

    def counts_within(self, least: _Option, factor: float) -> tuple[dict[str, int], float]:
        """The numbers that save most runs, where a snapshot takes so many times its bytes; and the bytes they take."""
        counts, start = dict(least.counts), self.limit - self.copies - least.found.peak
        left = float(start)
        while True:
            costs = {n: factor * least.bytes_of_snapshot(n) * (_above(c) - c) for n, c in counts.items()}
            gains = {n: least.runs(n, c) - least.runs(n, _above(c)) for n, c in counts.items()}
            worth = {n: gains[n] / costs[n] for n in counts if gains[n] > 0.0 and costs[n] <= left}
            if not worth:
                return counts, (start - left) / factor
            loop = max(worth, key=lambda n: worth[n])
            left -= costs[loop]
            counts[loop] = _above(counts[loop])

    def refused(self, least: _Option) -> S2sadError:
        """The error, with what was found that takes least."""
        note = [f"with one snapshot of {_loops_in_words(least.counts)}"] if least.counts else []
        note += [str(grows) for grows in growing_tapes(least.found)]
        note += [f"{shown(loop)} keeps none: {error.diagnostics[0].message}" for loop, error in self.refusals.items()]
        allowed = f"checkpoint allows {byte_text(self.limit)}"
        if not least.found.is_complete:
            return S2sadError(Diagnostic("S410", f"what the adjoint of '{self.kernel}' takes is known only at run "
                                         f"time, and {allowed}", note="; ".join(note), help="name the loops that keep "
                                         'snapshots, and how many: checkpoint={"k": 20}'))
        taken = least.found.peak + self.copies
        if self.copies:
            note.append(f"{byte_text(self.copies)} of it are copies of arguments and shadows")
        return S2sadError(Diagnostic("S410", f"the adjoint of '{self.kernel}' takes {byte_text(taken)} at least, and "
                                     f"{allowed}", note="; ".join(note), help=f"say checkpoint={taken} or more"))


def _checkpoints(counts: Mapping[str, int]) -> Checkpoints:
    return tuple((loop, Snapshots(count)) for loop, count in sorted(counts.items()))


def _ones(counts: Iterable[str]) -> dict[str, int]:
    return dict.fromkeys(counts, 1)


def _above(count: int) -> int:
    """The next number of the grid."""
    place = GRID.index(count) + 1
    return GRID[place] if place < len(GRID) else count


def _recording_most(found: Footprint) -> list[str]:
    """The loops that record, those first whose end is not known, then by their bytes."""
    sizes: dict[str, tuple[bool, int]] = {}
    arrays: dict[tuple[str, str], RecordedArray] = {(a.derivative, a.name): a for a in found.arrays if a.loop}
    for pair, array in arrays.items():
        stack = found.stack(*pair)
        if stack is not None:
            unknown, taken = sizes.get(array.loop, (False, 0))
            grows = stack.unknown or not stack.bytes and not found.is_complete
            sizes[array.loop] = unknown or grows, taken + stack.bytes
    return sorted(sizes, key=lambda loop: sizes[loop], reverse=True)


def _loops_in_words(loops: Iterable[str]) -> str:
    return " and ".join(map(shown, loops))
