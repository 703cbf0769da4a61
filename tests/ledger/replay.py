"""A store asked of the package on the path: one row for each request, the same at each run."""
from __future__ import annotations

import gc
import multiprocessing
import os
import shutil
import tempfile
import time
import warnings
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

from s2sad import S2sadError, pipeline, read
from s2sad.dispatch import compiler
from s2sad.blocks import with_blocks
from s2sad.dispatch.compiler import entry_kernel, flat_program
from s2sad.emit.module import module_text
from s2sad.program import Program, Request
from s2sad.interface.selection import selected_of
from s2sad.tree import AST, FunctionDef, Pass, copy, forgotten
from tests.harness.garbage import collect_rarely
from tests.ledger.identity import digest
from tests.ledger.registered import register
from tests.ledger.store import ANYTHING, Asked, Kernel, Store, unpickled

ENGINES, LEVELS = ("numpy", "numba"), ("plain", "fast")
COLUMNS = tuple(f"{engine} {text}" for engine in ENGINES for text in ("structured", *LEVELS))


@dataclass(frozen=True)
class Row:
    """What one request became: `cells` by `COLUMNS`, each a hash or the codes of a refusal."""
    identity: str
    name: str
    asked: str
    cells: tuple[str, ...]
    places: str

    def __str__(self) -> str:
        return "\t".join((self.identity, self.name, self.asked, *self.cells, self.places))

    @classmethod
    def of(cls, line: str) -> Row:
        identity, name, asked, *cells, places = line.rstrip("\n").split("\t")
        return cls(identity, name, asked, tuple(cells), places)


class _Structured:
    """The structured text of a kernel for one engine, as the passes show it."""

    def __init__(self) -> None:
        self.functions: dict[str, FunctionDef] = {}

    def watch(self, stage: str, function: FunctionDef) -> None:
        if stage == "inline":
            shown = copy(function)
            shown.body = _readable(shown.body)
            self.functions.setdefault(function.name, shown)

    def text(self, program: Program) -> str:
        return digest(module_text(list(self.functions.values()), header=["Structured."], constants=program.constants,
                                  standalone=False)) if self.functions else "-"


def _readable(block: list[AST]) -> list[AST]:
    """The block without what one pass leaves for the next."""
    return [with_blocks(s, _readable) for s in block if not forgotten(s)] or [Pass()]


class Replay:
    """One kernel and what was asked of it; `seconds` of the processor went into the compiler."""

    def __init__(self, kernel: Kernel, texts: dict[str, str]):
        self.kernel = kernel
        self.seconds = 0.0
        self.function, self.varying, self.forms, self.types, calls = unpickled(kernel, texts)
        register(calls)
        self.text = texts[kernel.texts[kernel.file]] if kernel.file else ""

    def rows(self) -> list[Row]:
        asked = sorted(self.kernel.asked - {ANYTHING}) or [ANYTHING]
        found: dict[Asked, list[str]] = {a: [] for a in asked}
        for engine in ENGINES:
            for a, cells in self.under(engine, asked).items():
                found[a] += cells
        places = ", ".join(sorted(self.kernel.places))
        return [Row(self.kernel.identity, self.kernel.name, _spelled(a), tuple(c), places) for a, c in found.items()]

    def under(self, engine: str, asked: list[Asked]) -> dict[Asked, list[str]]:
        """The cells of each request under one engine: it is read once, and its normal form is made once."""
        try:
            program = self.timed(self.program)
        except Exception as error:
            return {a: [_code(error)] * 3 for a in asked}
        seen, forms = _Structured(), {}
        if asked == [ANYTHING]:
            try:
                asked_for = {ANYTHING: self.default(program, forms)}
            except Exception as error:
                return {ANYTHING: [_code(error)] * 3}
        else:
            asked_for = {a: Request(a[0], self.types, a[1], a[2], with_primal=a[3]) for a in asked}
        cells = {a: [self.cell(program, replace(r, engine=engine, level=level), seen, forms) for level in LEVELS]
                 for a, r in asked_for.items()}
        structured = seen.text(program)
        return {a: [structured, *c] for a, c in cells.items()}

    def cell(self, program: Program, request: Request, seen: _Structured, forms: Any) -> str:
        try:
            return digest(self.timed(partial(pipeline.derive, program, request, seen.watch, forms)).text)
        except Exception as error:
            return _code(error)

    def timed(self, work: Any) -> Any:
        before = time.process_time()
        try:
            return work()
        finally:
            self.seconds += time.process_time() - before

    def program(self) -> Program:
        if self.kernel.file:
            folder = tempfile.mkdtemp()
            path = Path(folder) / Path(self.kernel.file).name
            path.write_text(self.text)
            try:
                return read.load_file(path, self.kernel.name)
            finally:
                shutil.rmtree(folder)
        program = compiler.program(self.function, self.varying)
        if self.forms is None:
            return program
        function = read.python_function(self.function)
        forms, facts = self.forms
        return flat_program(program, function, forms, self.varying, dict(facts)).program

    def default(self, program: Program, forms: Any) -> Request:
        """The adjoint of all that may be derived; raises what the kernel is refused with."""
        if self.types is None:
            raise S2sadError()
        summary = self.timed(partial(pipeline.summary, program, self.types, forms))
        kernel = entry_kernel(program)
        wrt = tuple(p for p, t in zip(kernel.parameters, self.types) if t.is_inexact)
        of = selected_of(program.entry, kernel.parameters, self.types, summary, None)
        return Request("adjoint", self.types, wrt, of)


def _spelled(asked: Asked) -> str:
    mode, wrt, of, with_primal = asked
    return f"{mode}({', '.join(wrt)} -> {', '.join(of)}){' with primal' if with_primal else ''}" if mode else "anything"


def _code(error: Exception) -> str:
    """The codes of a refusal; what should never be raised with a mark in front."""
    if isinstance(error, S2sadError):
        return "+".join(sorted({d.code for d in error.diagnostics})) or "read"
    return f"!{type(error).__name__}"


# -- all of them ----------------------------------------------------------------------------------------------------

_STORE: list[Store] = []


def _replay_kernel(identity: str) -> tuple[str, list[Row], float]:
    kernel = _STORE[0].kernels[identity]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            made = Replay(kernel, _STORE[0].texts)
        except Exception as error:      # a store that this tree cannot read shows as lost
            return identity, [Row(identity, kernel.name, "unpickled", (f"!{type(error).__name__}: {error}",) * 6,
                                  ", ".join(sorted(kernel.places)))], 0.0
        return identity, made.rows(), made.seconds


def replay_all(store: Store, sample: int = 1, jobs: int | None = None) -> Iterator[tuple[str, list[Row], float]]:
    """The rows of every `sample`-th kernel with the seconds of each: those with derivatives of the user's come last,
    each in a process that knows no others."""
    _STORE[:] = [store]
    gc.collect()
    collect_rarely()
    wanted = sorted(store.kernels)[::sample]
    for registers, chunk, tasks in ((False, 4, 100), (True, 1, 1)):
        with multiprocessing.get_context("fork").Pool(jobs or os.cpu_count(), maxtasksperchild=tasks) as pool:
            yield from pool.imap(_replay_kernel, [i for i in wanted if store.kernels[i].registers is registers], chunk)
