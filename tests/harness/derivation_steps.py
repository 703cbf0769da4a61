"""What each pass makes of a kernel, under both engines and in both modes."""
from __future__ import annotations

import contextlib
import os
import re
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from itertools import product
from pathlib import Path
from typing import Any

from s2sad import pipeline, read
from s2sad.diagnostics import Report, S2sadError
from s2sad.infer.assumed_types import assumed_types
from s2sad.interface.selection import selected_of, selected_wrt
from s2sad.program import Request
from s2sad.tree import FunctionDef

HEADER = "import itertools\nimport math\nimport numpy as np\nimport scipy\nimport scipy.linalg\n\n\n"


@dataclass(frozen=True)
class Step:
    """What a pass made of a function."""
    title: str
    before: FunctionDef | None
    after: FunctionDef


@dataclass(frozen=True)
class Run:
    """The steps of a derivation; what refused it, and with which message, if anything did."""
    steps: tuple[Step, ...]
    by: Callable[..., Any] | None = None
    message: str = ""


@cache
def runs(kernel: str) -> tuple[Run, ...]:
    """The kernel derived under both engines and in both modes."""
    return tuple(_run(kernel, engine, mode) for engine, mode in product(("numpy", "numba"), ("adjoint", "tangent")))


def _run(kernel: str, engine: str, mode: str) -> Run:
    steps: list[Step] = []
    last: dict[str, FunctionDef] = {}

    def watch(title: str, tree: FunctionDef) -> None:
        kernel = re.sub(r"_(adjoint|tangent)(_\d+)?$", "", tree.name)
        steps.append(Step(title, last.get(tree.name, last.get(kernel)), tree))
        last[tree.name] = tree
    try:
        with _file(kernel) as (path, name):
            program = read.load_file(path, name)
            last.update((n, k.tree) for n, k in program.kernels.items())
            pipeline.derive(program, _request(program, engine, mode), watch)
    except S2sadError as error:
        return Run(tuple(steps), _refusing(error), str(error))
    return Run(tuple(steps))


@contextlib.contextmanager
def _file(kernel: str) -> Iterator[tuple[str, str]]:
    there = os.getcwd()
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        try:
            Path("kernel.py").write_text(HEADER + kernel + "\n", encoding="utf-8")
            yield "kernel.py", re.findall(r"^def (\w+)", kernel, re.M)[-1]
        finally:
            os.chdir(there)


def _request(program: Any, engine: str, mode: str) -> Request:
    kernel = program.kernels[program.entry]
    report = Report(kernel.source)
    found = assumed_types(program.entry, {n: k.tree for n, k in program.kernels.items()}, kernel.parameters,
                          kernel.annotations, kernel.defaults, {}, report)
    report.finish()
    types = tuple(found[p].type for p in kernel.parameters)
    wrt = selected_wrt(program.entry, kernel.parameters, types, None)
    of = selected_of(program.entry, kernel.parameters, types, pipeline.summary(program, types), None)
    return Request(mode, types, wrt, of, engine, "fast")


def _refusing(error: S2sadError) -> Callable[..., Any] | None:
    """The pass after which the error was raised."""
    found, place = None, error.__traceback__
    while place is not None:
        if place.tb_frame.f_code.co_name == "_one":
            found = place.tb_frame.f_locals["step"].function
        place = place.tb_next
    return found
