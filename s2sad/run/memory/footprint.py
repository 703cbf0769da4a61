"""The memory that a generated function takes for given arguments, found before it runs."""
from __future__ import annotations

import ast
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from s2sad.program import Generated, Parameter, RecordedArray
from s2sad.run.memory.abstract_arrays import Array
from s2sad.run.memory.growing_stacks import Stack
from s2sad.run.memory.interval_arithmetic import UNKNOWN, is_number
from s2sad.run.memory.memory_interpreter import MemoryInterpreter


@dataclass(frozen=True)
class Footprint:
    """Bytes that a call holds beside its arguments: the most at one time (`peak`), and of a tape alone, of snapshots,
    of both of these (`recorded`), and of everything else (`work`); `disk` are those of snapshots in files, which are
    recorded, too, and in no memory. `is_bound` says that they are the most that data make of it, `is_complete` that all
    are known before the run; `stacks` has each recorded array by function and name, `steps` the number of steps of
    loops that keep snapshots, by function (None if that is not known)."""
    peak: int
    tape: int
    snapshots: int
    recorded: int
    work: int
    disk: int
    is_bound: bool
    is_complete: bool
    stacks: Mapping[tuple[str, str], Stack]
    steps: Mapping[str, int | None]
    arrays: tuple[RecordedArray, ...]

    def stack(self, derivative: str, name: str) -> Stack | None:
        """What is known of an array that a derivative records; None of a number."""
        there = [a for a in self.arrays if (a.derivative, a.name) == (derivative, name)]
        found = [s for a in there if (s := self.stacks.get((a.function, name))) is not None]
        return max(found, key=lambda s: s.bytes, default=None)


def footprint_of(generated: Generated, values: Mapping[str, Any], written: Collection[str] = ()) -> Footprint:
    """The memory of a call of a generated function for the values of its kernel's parameters, by name, of both where
    the two sweeps are functions; nothing is run.
    What lies in arrays of integers counts unless they are `written`."""
    functions, constants = parsed(generated.text)
    facts = generated.facts
    arrays = tuple(facts.get("recorded", ()))
    kept = [np.empty((0,) * rank, dtype) for _, dtype, rank in facts.get("stacks", ())]
    kept += [np.empty(0)] if facts.get("arena") else []
    run = MemoryInterpreter(functions, constants, {(r.function, r.name): r.kind for r in arrays},
                            facts.get("loops", ()))
    given = [*(given_argument(p, values, written) for p in generated.parameters), *(_abstract(s, True) for s in kept)]
    if "forward" in facts:
        returned = run.call(facts["forward"], [given_argument(p, values, written) for p in facts["taken"]])
        given.insert(0, _as_tape(returned))     # while `returned` is held
    run.call(facts.get("taped") or generated.entry, given)
    meter = run.meter
    steps = {f: int(n) if is_number(n) else None for f, n in run.steps.items()}
    peaks = meter.peaks
    return Footprint(meter.peak, peaks["tape"], peaks["snapshots"], peaks["recorded"], peaks["work"], peaks["disk"],
                     meter.bounded or bool(meter.loops), not meter.unknown, run.stacks.found, steps, arrays)


def _as_tape(returned: Any) -> Any:
    """The tape of what the first of two sweeps returns behind its results."""
    if not isinstance(returned, tuple):
        return UNKNOWN
    waiting = [returned[1]]
    while waiting:
        entry = waiting.pop()
        waiting += entry if isinstance(entry, tuple) else ()
        if isinstance(entry, Array) and entry.buffer is not None and entry.buffer.kind == "work":
            entry.buffer.tag("tape")
    return returned[1]


def given_argument(parameter: Parameter, values: Mapping[str, Any], written: Collection[str]) -> Any:
    """What is known of an argument: a shadow has the shape of its array."""
    if parameter.role == "seed":
        return UNKNOWN
    return _abstract(values.get(parameter.primal or parameter.name), parameter.role == "shadow" or
                     parameter.primal in written)


def _abstract(value: Any, changed: bool) -> Any:
    if isinstance(value, np.ndarray):
        known = value.dtype.kind in "biu" and not changed
        return Array(tuple(map(int, value.shape)), value.dtype, content=value if known else None)
    if isinstance(value, np.generic):
        return value.item()
    if is_number(value) or isinstance(value, (str, tuple)):
        return value
    return Array(tuple(value.shape), np.dtype(value.dtype)) if hasattr(value, "shape") else UNKNOWN


@lru_cache(maxsize=64)
def parsed(text: str) -> tuple[dict[str, ast.FunctionDef], dict[str, Any]]:
    """The functions and the constants of a text."""
    body = ast.parse(text).body
    constants: dict[str, Any] = {}
    for statement in body:
        if isinstance(statement, ast.Assign) and isinstance(statement.targets[0], ast.Name):
            try:
                constants[statement.targets[0].id] = ast.literal_eval(statement.value)
            except ValueError:
                continue
    return {s.name: s for s in body if isinstance(s, ast.FunctionDef)}, constants
