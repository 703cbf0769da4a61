"""Passes left out: `python -m tests.passes --count 30 --engine loops` derives random programs with and without each of
the passes that make derivatives shorter and faster, and compares bit for bit those that may not change rounding.

A pass says itself whether it may: `CHANGES_ROUNDING` in its module.
"""
from __future__ import annotations

import argparse
import sys
import warnings
from collections import Counter
from collections.abc import Callable, Collection, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from typing import Any
from unittest.mock import patch

import numpy as np

import s2sad
from s2sad import artifacts, generated, pipeline, simplify
from s2sad.run import compiled, load
import s2sad.simplify.faster
from s2sad.units import array_forms
from tests.bulk import outputs
from tests.engines import running
from tests.programs import Program, random_kernel

faster_module, totals_module = sys.modules["s2sad.simplify.faster"], sys.modules["s2sad.simplify.totals"]


def _as_it_is(function: Any, *_: Any, **__: Any) -> Any:
    return function


# where each pass is called, and what stands there if it is left out
PASSES: dict[str, tuple[Any, str, Callable[..., Any]]] = {
    **{name: (simplify, name, _as_it_is) for name in (
        "merge", "undone", "branches", "fold", "algebra", "select", "gains", "uncopied", "repeated")},
    "coalesce": (simplify, "coalesce", lambda function, *_: (function, {})),
    "handed": (array_forms, "handed", lambda function, *_: (function, {})),
    **{name: (pipeline, name, _as_it_is) for name in (
        "products", "turned", "kept", "exponentials", "unguarded", "powers", "extremes", "faster")},
    "joined": (faster_module, "joined", _as_it_is),
    "totals": (faster_module, "totals", lambda loop, *_: totals_module.Totals(loop)),
    "restore": (faster_module, "restored", lambda loop, stacks: ([], loop)),
    "peel": (faster_module, "peeled", lambda *_: None),
    "rotate": (faster_module, "rotated", lambda *_: None),
    "distribute": (faster_module, "distributed", lambda *_: None),
}
MODULES = {"restore": "restored"}


def changes_rounding(name: str) -> bool:
    """What the pass says of itself."""
    return sys.modules[f"s2sad.simplify.{MODULES.get(name, name)}"].CHANGES_ROUNDING


SAME = frozenset(name for name in PASSES if not changes_rounding(name))


@contextmanager
def told(texts: list[str]) -> Iterator[None]:
    """Every text that is loaded inside is put on the list."""
    loaded = load.load

    def load_and_tell(text: str, *arguments: Any, **options: Any) -> Any:
        texts.append(text)
        return loaded(text, *arguments, **options)
    with patch.object(compiled, "load", load_and_tell), patch.object(generated, "load", load_and_tell):
        yield


@contextmanager
def without(names: Collection[str]) -> Iterator[None]:
    """Whatever is derived inside is derived without these passes."""
    with ExitStack() as changed:
        for name in names:
            module, attribute, replacement = PASSES[name]
            changed.enter_context(patch.object(module, attribute, replacement))
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


def derivatives(task: Task, engine: str, left_out: Collection[str]) -> tuple[dict[str, np.ndarray], str]:
    """The gradient of the outputs, derived without some passes, and the text."""
    texts: list[str] = []
    kernel, given = task.kernel(), task.arguments()
    with np.errstate(all="ignore"):
        returned = kernel(*task.arguments()) if "return" in task.of else None
    values = dict(zip(kernel.__code__.co_varnames, given))
    seeds = {n: _seed(returned if n == "return" else values[n]) for n in task.of}
    with told(texts), without(left_out), running(engine) as run_under, np.errstate(all="ignore"):
        found = s2sad.vjp(s2sad.differentiate(kernel, engine=run_under), given, seeds, wrt=task.wrt)
    return {n: np.asarray(v) for n, v in found.items()}, "\n".join(texts)


def _seed(value: Any) -> Any:
    if isinstance(value, tuple):
        return tuple(map(_seed, value))
    return 0.75 * np.ones_like(value) if isinstance(value, np.ndarray) else 0.75


def apart(one: dict[str, np.ndarray], other: dict[str, np.ndarray]) -> float:
    """0 if they are the same bit for bit; else the largest difference over the largest element."""
    if all(np.array_equal(one[n], other[n], equal_nan=True) for n in one):
        return 0.0
    top = max(float(np.nanmax(np.abs(v), initial=0.0)) for v in one.values())
    return max(float(np.nanmax(np.abs(one[n] - other[n]), initial=0.0)) for n in one) / (top or 1.0)


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.passes", description=__doc__)
    parser.add_argument("--count", type=int, default=10)
    parser.add_argument("--start", type=int, default=0)
    parser.add_argument("--engine", choices=("numpy", "loops"), default="loops")
    parser.add_argument("--passes", default="", help="comma separated; all without it")
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    artifacts.ENABLED = False       # what was derived with all passes is not taken again
    worst: dict[str, tuple[float, int]] = {}
    changed: Counter[str] = Counter()
    for number in range(options.start, options.start + options.count):
        task = of_program(random_kernel(number))
        if not task.of:
            continue
        whole, text = derivatives(task, options.engine, ())
        for name in options.passes.split(",") if options.passes else PASSES:
            try:
                other, left = derivatives(task, options.engine, (name,))
            except Exception as error:
                print(f"{name}: program {number}: {type(error).__name__} {str(error)[:200]}", flush=True)
                continue
            found = apart(whole, other)
            changed[name] += left != text
            worst[name] = max(worst.get(name, (0.0, -1)), (found, number))
    for name, (found, number) in worst.items():
        print(f"{name:14s} {'may' if changes_rounding(name) else 'may not'} change rounding: {found:.1e}, "
              f"{changed[name]} texts differ" + (f" (program {number})" if found else ""))
    return int(any(found and not changes_rounding(name) for name, (found, _) in worst.items()))


if __name__ == "__main__":
    sys.exit(main())
