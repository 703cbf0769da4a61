"""What runs the calls of a derivative that may take so much memory: a plan for each set of sizes, kept by these.

A plan follows from shapes and integers, if these say all; else floats and the content of arrays of integers are asked,
too, and belong to what the plan is kept by.
"""
from __future__ import annotations

import hashlib
from collections.abc import Callable, Collection, Hashable, Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from s2sad.diagnostics import S2sadError
from s2sad.dispatch.snapshot_plan import SnapshotPlan, snapshot_plan
from s2sad.program import Checkpoints, Generated
from s2sad.run.memory import Footprint, footprint_of

if TYPE_CHECKING:
    from s2sad.dispatch.executable import Executable

_KEPT = 1024


class LimitedMemory:
    """The plans for the derivative of a kernel, of which the arguments in `written` are changed; `variant` is what runs
    it where loops keep snapshots."""

    def __init__(self, limit: int, kernel: str, written: Collection[str],
                 variant: Callable[[Checkpoints], Executable]):
        self.limit, self.kernel, self.written, self.variant = limit, kernel, written, variant
        self._plans: dict[Hashable, SnapshotPlan | None] = {}     # None: more must be known
        self._prepared: set[Checkpoints] = set()

    def executable(self, arguments: list[Any] | tuple[Any, ...], values: Mapping[str, Any], copies: int) -> Executable:
        """What runs a call, compiled: nothing that others have recorded is kept beside what it takes."""
        plan = self.plan(values, copies)
        found = self.variant(plan.checkpoints)
        if plan.checkpoints not in self._prepared:
            found.prepare_call(arguments)
            self._prepared.add(plan.checkpoints)
        for other in self._prepared - {plan.checkpoints}:
            self.variant(other).forget_tape()
        if found.kept_bytes + plan.found.peak - plan.found.tape + copies > self.limit:
            found.forget_tape()
        return found

    def plan(self, values: Mapping[str, Any], copies: int) -> SnapshotPlan:
        """The plan for the values of the kernel's parameters, by name, of which the caller makes `copies`."""
        key = (copies, *_sizes(values))
        if key not in self._plans:
            self._keep(key, self._planned({n: v for n, v in values.items() if not _is_float(v)}, copies, values))
        plan = self._plans[key]
        if plan is None:
            full = (*key, *_contents(values, self.written))
            plan = self._plans.get(full)
            if plan is None:
                plan = self._made(values, copies, self.written)
                self._keep(full, plan)
        return plan

    def _planned(self, sizes: Mapping[str, Any], copies: int, values: Mapping[str, Any]) -> SnapshotPlan | None:
        """The plan that sizes and integers lead to; None if more decides."""
        try:
            plan = self._made(sizes, copies, [*values])
        except S2sadError:
            return None
        settled = all(found.is_complete and not found.is_bound for found in (plan.plain, plan.found))
        return plan if settled or len(sizes) == len(values) and not any(map(_is_array_of_integers, values.values())
                                                                        ) else None

    def _made(self, values: Mapping[str, Any], copies: int, written: Collection[str]) -> SnapshotPlan:
        def predict(generated: Generated) -> Footprint:
            return footprint_of(generated, values, written)
        return snapshot_plan(self.kernel, self.limit, copies, lambda c: self.variant(c).generated, predict)

    def _keep(self, key: Hashable, plan: SnapshotPlan | None) -> None:
        if len(self._plans) >= _KEPT:
            self._plans.clear()
        self._plans[key] = plan


def _sizes(values: Mapping[str, Any]) -> Iterator[Hashable]:
    for value in values.values():
        if isinstance(value, np.ndarray):
            yield value.shape
        elif not _is_float(value):
            yield value if isinstance(value, Hashable) else repr(value)


def _contents(values: Mapping[str, Any], written: Collection[str]) -> Iterator[Hashable]:
    for name, value in values.items():
        if _is_float(value):
            yield value
        elif _is_array_of_integers(value) and name not in written:
            yield hashlib.blake2b(value.tobytes(), digest_size=16).digest()


def _is_float(value: Any) -> bool:
    return isinstance(value, (float, complex, np.inexact))


def _is_array_of_integers(value: Any) -> bool:
    return isinstance(value, np.ndarray) and value.dtype.kind in "biu"
