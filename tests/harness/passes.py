"""Passes left out: `python -m tests.harness.passes programs goldens kernels --count 30` leaves out the passes that may
change rounding, and derives with and without the others that make derivatives shorter and faster: gradients are
compared bit for bit. Where they differ, or where passes are named, each is left out alone.

A pass that may change rounding says so itself: `CHANGES_ROUNDING = True` in its module.
"""
from __future__ import annotations

import argparse
import copy
import sys
import warnings
from collections.abc import Callable, Collection, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from types import FunctionType
from typing import Any
from unittest.mock import patch

import numpy as np

import s2sad
from benchmarks.kernels.cases import ARRAYS, LOOPS
from benchmarks.published import cases as published
from s2sad.dispatch import artifacts, executable
from s2sad import optimize, simplify
from s2sad.passes import Pass, each
from s2sad.run import compiled, module_loader
from s2sad.units import normal_forms
from tests.harness import goldens
from tests.harness.bulk import outputs
from tests.harness.engines import running
from tests.programs import Program, random_kernel

LISTS = ((normal_forms, "KERNELS"), (simplify, "PASSES"), (optimize, "PASSES"))
_NEEDED = ("dead_code", "split_temporaries", "share_temporaries", "remove_marks", "complex_division", "wide_numbers")
_LISTED = tuple(dict.fromkeys(step.function.__name__ for step in (
    *each(optimize.KERNELS), *each(simplify.PASSES), *each(optimize.PASSES)) if step.function.__name__ not in _NEEDED))
vectorize = sys.modules["s2sad.optimize.vectorize"]
reductions = sys.modules["s2sad.optimize.scalar_reductions"]

# what stands in the place of a step of `vectorize` that is left out
_STEPS: dict[str, Callable[..., Any]] = {
    "scalar_reductions": lambda loop, *_: reductions.ScalarReductions(loop),
    "tape_row_loads": lambda loop, stacks: ([], loop),
    "loop_peeling": lambda *_: None,
    "scalar_replacement": lambda *_: None,
    "loop_distribution": lambda *_: None,
}
PASSES = (*_LISTED, *_STEPS)


def changes_rounding(name: str) -> bool:
    """What the pass says of itself."""
    function = getattr(vectorize, name) if name in _STEPS else next(
        step.function for room, held in LISTS for step in each(getattr(room, held)) if step.function.__name__ == name)
    return getattr(sys.modules[function.__module__], "CHANGES_ROUNDING", False)


SAME = frozenset(name for name in PASSES if not changes_rounding(name))
# `vectorize` stays, for some of its parts may not; what it does beside them Python does not see
ROUNDING = frozenset(PASSES) - SAME - {"vectorize"}


@contextmanager
def recorded_loads(texts: list[str]) -> Iterator[None]:
    """Every text that is loaded inside is put on the list."""
    loaded = module_loader.load

    def load_and_tell(text: str, *arguments: Any, **options: Any) -> Any:
        texts.append(text)
        return loaded(text, *arguments, **options)
    with patch.object(compiled, "load", load_and_tell), patch.object(executable, "load", load_and_tell):
        yield


@contextmanager
def without_passes(names: Collection[str]) -> Iterator[None]:
    """Whatever is derived inside is derived without these passes."""
    with ExitStack() as changed:
        for room, held in LISTS:
            left = tuple(p for p in getattr(room, held) if not isinstance(p, Pass) or p.function.__name__ not in names)
            changed.enter_context(patch.object(room, held, left))
        for name in set(names) & set(_STEPS):
            changed.enter_context(patch.object(vectorize, name, _STEPS[name]))
        yield


@dataclass(frozen=True)
class Task:
    """A kernel of which nothing has been derived, made anew at each call, its arguments, and what is asked for."""
    kernel: Callable[[], Callable[..., Any]]
    arguments: Callable[[], tuple[Any, ...]]
    wrt: tuple[str, ...]
    of: tuple[str, ...]


def of_program(program: Program) -> Task:
    return Task(program.load, program.arguments, program.wrt, outputs(program))


def of_function(function: FunctionType, arguments: Callable[[], tuple[Any, ...]], wrt: tuple[str, ...],
                of: tuple[str, ...]) -> Task:
    def copied() -> FunctionType:
        return FunctionType(function.__code__, function.__globals__, function.__name__, function.__defaults__)
    return Task(copied, arguments, wrt, of)


def tasks(kind: str, numbers: range) -> Iterator[tuple[str, Task]]:
    """What is compared, by name: random programs with these numbers, the goldens, the benchmarks' kernels."""
    if kind == "programs":
        yield from ((f"program {n}", of_program(random_kernel(n))) for n in numbers)
    elif kind == "goldens":
        for name in goldens.CASES:
            found = goldens.given(name)
            if found.module.kernel is found.kernel:     # else it takes structures, which the names say taken apart
                yield f"golden {name}", of_function(found.kernel, lambda found=found: copy.deepcopy(found.arguments),
                                                    found.adjoint.wrt, found.adjoint.of)
    else:
        for case in (*LOOPS, *ARRAYS, *published.CASES.values()):
            yield f"kernel {case.name}", of_function(case.function, lambda case=case: case.arguments("small"), case.wrt,
                                                     case.of)


def derivatives(task: Task, engine: str, left_out: Collection[str]) -> tuple[dict[str, np.ndarray], str]:
    """The gradient of the outputs, derived without some passes, and the text."""
    texts: list[str] = []
    kernel, given = task.kernel(), task.arguments()
    with np.errstate(all="ignore"):
        returned = kernel(*task.arguments()) if "return" in task.of else None
    values = dict(zip(kernel.__code__.co_varnames, given))
    seeds = {n: _seed(returned if n == "return" else values[n]) for n in task.of}
    with recorded_loads(texts), without_passes(left_out), running(engine) as run_under, np.errstate(all="ignore"):
        found = s2sad.vjp(s2sad.differentiate(kernel, engine=run_under), given, seeds, wrt=task.wrt)
    return {n: np.asarray(v) for n, v in found.items()}, "\n".join(texts)


def _seed(value: Any) -> Any:
    if isinstance(value, tuple):
        return tuple(map(_seed, value))
    return 0.75 * np.ones_like(value) if isinstance(value, np.ndarray) else 0.75


def relative_difference(one: dict[str, np.ndarray], other: dict[str, np.ndarray]) -> float:
    """0 if they are the same bit for bit; else the largest difference over the largest element."""
    if all(np.array_equal(one[n], other[n], equal_nan=True) for n in one):
        return 0.0
    top = max(float(np.nanmax(np.abs(v), initial=0.0)) for v in one.values())
    return max(float(np.nanmax(np.abs(one[n] - other[n]), initial=0.0)) for n in one) / (top or 1.0)


def differing(task: Task, engine: str, passes: Collection[str]) -> Iterator[tuple[str, float, bool]]:
    """What changes a gradient that may not, or, for named passes, what each changes: its name, by how much, and
    whether the text is another one."""
    if not passes:
        same, _ = derivatives(task, engine, ROUNDING)
        bare, _ = derivatives(task, engine, ROUNDING | SAME)
        if not relative_difference(same, bare):
            return
        yield "all together", relative_difference(same, bare), True
    whole, text = derivatives(task, engine, ())
    for name in passes or SAME:
        other, left = derivatives(task, engine, (name,))
        if passes or relative_difference(whole, other):
            yield name, relative_difference(whole, other), left != text


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.harness.passes", description=__doc__)
    parser.add_argument("of", nargs="*", default=["programs"], choices=("programs", "goldens", "kernels"))
    parser.add_argument("--count", type=int, default=10)
    parser.add_argument("--start", type=int, default=0)
    parser.add_argument("--engine", choices=("numpy", "loops"), default="loops")
    parser.add_argument("--passes", default="", help="comma separated; all without it")
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    artifacts.ENABLED = False       # what was derived with all passes is not taken again
    passes = options.passes.split(",") if options.passes else ()
    asked = wrong = 0
    for kind in options.of:
        for name, task in tasks(kind, range(options.start, options.start + options.count)):
            asked += bool(task.of)
            try:
                for left, found, other in differing(task, options.engine, passes) if task.of else ():
                    rounding = left in PASSES and changes_rounding(left)
                    wrong += bool(found) and not rounding
                    print(f"{name}: without {left} {found:.1e}{'' if other else ', the same text'}", flush=True)
            except Exception as error:
                wrong += 1
                print(f"{name}: {type(error).__name__} {str(error)[:200]}", flush=True)
    print(f"{asked} compared, {wrong} wrong")
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main())
