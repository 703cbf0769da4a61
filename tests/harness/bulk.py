"""Many generated kernels through the compiler: `python -m tests.harness.bulk --count 20000 --engine numpy --jobs 2`.

The engine `loops` is the text that is written for Numba, run by Python: it finds what is wrong with a text in a tenth
of the time that compiling it takes.

Every failure is printed with its number and its text, made smaller by leaving out statements for as long as it
fails in the same way. The exit status is 1 if anything failed.
"""
from __future__ import annotations

import argparse
import ast
import multiprocessing
import signal
import sys
import time
import traceback
import warnings
from collections import Counter
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import s2sad
from tests.harness.derivatives import UnreliableDifferences, check_derivatives, check_value
from tests.harness.garbage import collect_rarely
from tests.harness.poison import poisoned
from tests.programs import Program, lists_of_the_run, names_of_arrays, random_kernel

_MODE = ExitStack()
GENERATORS = {"kernels": random_kernel, "names": names_of_arrays.random_program,
              "lists": lists_of_the_run.random_program}
Task = tuple[str, int, str, frozenset[str]]
SKIPPED = ("invalid", "unreliable")


@dataclass(frozen=True)
class Outcome:
    """What became of one program: `kind` is ok, wrong, refused, crash, or one of SKIPPED."""
    seed: int
    kind: str
    where: str = ""
    text: str = ""
    source: str = ""

    @property
    def failed(self) -> bool:
        return self.kind not in ("ok", *SKIPPED)


@contextmanager
def limit(seconds: float) -> Iterator[None]:
    """Raises TimeoutError after so much work: a program from which statements were left out need not end."""
    def stop(*_: object) -> None:
        raise TimeoutError(f"not done after {seconds} s")
    before = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)


def outputs(program: Program) -> tuple[str, ...]:
    """The outputs of a program: of the arrays that it may write those that it does write for its arguments."""
    given, left = program.arguments(), program.arguments()
    program.load()(*left)
    names = [name for name, _ in program.parameters]
    return tuple(o for o in program.of if o == "return" or not np.array_equal(
        given[names.index(o)], left[names.index(o)], equal_nan=True))


def outcome(program: Program, engine: str, seed: int = 0) -> Outcome:
    """Loads, runs and checks one program."""
    try:
        function = program.load()
        arguments = program.arguments()
        with np.errstate(all="ignore"), limit(1.0):
            function(*program.arguments())
        if not outputs(program):
            return Outcome(seed, "invalid", "nothing to differentiate", "it changes none of its outputs",
                           program.source)
    except Exception as error:
        return Outcome(seed, "invalid", type(error).__name__, str(error), program.source)
    try:
        with np.errstate(all="ignore"), limit(120.0):
            check_derivatives(function, arguments, program.wrt, outputs(program), engine, coordinates=6, directions=1,
                              vanishing=1e-16)
            check_value(function, arguments, program.wrt, engine)
    except UnreliableDifferences as error:
        return Outcome(seed, "unreliable", "", str(error), program.source)
    except AssertionError as error:
        return Outcome(seed, "wrong", _first_words(error), str(error), program.source)
    except s2sad.S2sadError as error:
        codes = ",".join(sorted({d.code for d in error.diagnostics}))
        return Outcome(seed, "refused", codes + " " + error.diagnostics[0].message[:60], str(error), program.source)
    except Exception as error:
        return Outcome(seed, "crash", _place(error), traceback.format_exc(limit=-6), program.source)
    return Outcome(seed, "ok")


def _first_words(error: AssertionError) -> str:
    return " ".join(str(error).strip().split()[:2]).rstrip(":")


def _place(error: Exception) -> str:
    """The kind of the error and the function of s2sad (or of the generated file) that raised it."""
    frames = traceback.extract_tb(error.__traceback__)
    names = [f.name for f in frames if "s2sad" in f.filename]
    return f"{type(error).__name__} in {names[-1] if names else frames[-1].name}"


# -- shrinking ------------------------------------------------------------------------------------------------------
def _bodies(module: ast.Module) -> list[list[ast.stmt]]:
    return [body for node in ast.walk(module) for body in (getattr(node, "body", None), getattr(node, "orelse", None))
            if isinstance(body, list) and body]


def smaller_texts(source: str) -> Iterator[str]:
    """The source with one statement left out, or a compound one replaced by its body, the largest first."""
    module = ast.parse(source)
    places = [(b, k) for b, body in enumerate(_bodies(module)) for k in range(len(body))]
    edits = [(b, k, inline) for inline in (False, True) for b, k in places]
    for b, k, inline in edits:
        copy = ast.parse(source)
        body = _bodies(copy)[b]
        statement = body[k]
        inner = getattr(statement, "body", None)
        if inline and (not inner or isinstance(statement, ast.FunctionDef)):
            continue
        body[k:k + 1] = inner if inline else []
        text = _unparsed(copy, body)
        if text is not None:
            yield text
    yield from _smaller_expressions(source)


def _unparsed(module: ast.Module, body: list[ast.stmt]) -> str | None:
    if not body and not any(getattr(n, "orelse", None) is body for n in ast.walk(module)):
        body.append(ast.Pass())
    try:
        text = ast.unparse(module)
        ast.parse(text)
    except (SyntaxError, ValueError):
        return None
    return text + "\n"


class _Operand(ast.NodeTransformer):
    """Puts an operand in the place of the operation with this number."""

    def __init__(self, number: int, part: int):
        self.left, self.part = number, part

    def visit(self, node: ast.AST) -> ast.AST:
        if isinstance(node, (ast.BinOp, ast.Call, ast.IfExp)):
            self.left -= 1
            if self.left == -1:
                parts = (node.args[:2] if isinstance(node, ast.Call) else [node.left, node.right]
                         if isinstance(node, ast.BinOp) else [node.body, node.orelse])
                return parts[self.part] if self.part < len(parts) else node
        return self.generic_visit(node)


def _smaller_expressions(source: str) -> Iterator[str]:
    """The source with one operation replaced by one of its operands."""
    count = sum(isinstance(n, (ast.BinOp, ast.Call, ast.IfExp)) for n in ast.walk(ast.parse(source)))
    for k in range(count):
        for part in range(2):
            text = ast.unparse(_Operand(k, part).visit(ast.parse(source))) + "\n"
            if text != source:
                yield text


def shrink(program: Program, engine: str, failure: Outcome, seconds: float = 60.0) -> Program:
    """The program, smaller, failing in the same way."""
    deadline, shrunk = time.monotonic() + seconds, True
    program = program.with_source(ast.unparse(ast.parse(program.source)) + "\n")
    while shrunk and time.monotonic() < deadline:
        shrunk = False
        for text in smaller_texts(program.source):
            found = outcome(program.with_source(text), engine)
            if (found.kind, found.where) == (failure.kind, failure.where) and len(text) < len(program.source):
                program, shrunk = program.with_source(text), True
                break
            if time.monotonic() > deadline:
                break
    return program


# -- the run --------------------------------------------------------------------------------------------------------
def _program(kind: str, seed: int, without: frozenset[str]) -> Program:
    return GENERATORS[kind](seed, without) if kind == "kernels" else GENERATORS[kind](seed)


def _work(task: Task) -> Outcome:
    kind, seed, engine, without = task
    return outcome(_program(kind, seed, without), engine, seed)


def _begin(poison: bool) -> None:
    collect_rarely()
    if poison:
        _MODE.enter_context(poisoned())


def _outcomes(tasks: list[Task], jobs: int, poison: bool) -> Iterator[Outcome]:
    if jobs == 1:
        _begin(poison)
        yield from map(_work, tasks)
        return
    with multiprocessing.get_context("spawn").Pool(jobs, _begin, (poison,), maxtasksperchild=2000) as pool:
        yield from pool.imap_unordered(_work, tasks, chunksize=8)


def _report(found: Outcome, program: Program, engine: str, seconds: float) -> str:
    small = shrink(program, engine, found, seconds) if seconds else program
    final = outcome(small, engine, found.seed)
    return (f"==== seed {found.seed}: {found.kind} ({found.where})\nwrt={program.wrt} of={program.of} n={program.n} "
            f"seed={program.seed} dtype={program.dtype} parameters={program.parameters}\n{small.source}\n"
            f"{final.text or found.text}\n")


def run(arguments: argparse.Namespace) -> int:
    """Runs the programs and prints; gives the number of failures."""
    without = frozenset(w for w in arguments.without.split(",") if w)
    seeds = range(arguments.start, arguments.start + arguments.count)
    tasks = [(arguments.programs, s, arguments.engine, without) for s in seeds]
    kinds: Counter[str] = Counter()
    places: Counter[tuple[str, str]] = Counter()
    began = time.monotonic()
    for done, found in enumerate(_outcomes(tasks, arguments.jobs, arguments.poison), 1):
        kinds[found.kind] += 1
        if found.failed:
            places[found.kind, found.where] += 1
            if places[found.kind, found.where] <= arguments.each:
                program = _program(arguments.programs, found.seed, without)
                text = _report(found, program, arguments.engine, arguments.shrink)
                print(text, flush=True)
                if arguments.output:
                    with Path(arguments.output).open("a") as file:
                        file.write(text)
        if done % 500 == 0:
            print(f"-- {done} of {len(tasks)}, {time.monotonic() - began:.0f} s, {dict(kinds)}", flush=True)
    for (kind, where), count in places.most_common():
        print(f"{count:6d} {kind}: {where}")
    failed = sum(places.values())
    print(f"{kinds['ok']} passed, {failed} failed, {len(tasks) - kinds['ok'] - failed} skipped")
    return failed


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.harness.bulk", description=__doc__)
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--start", type=int, default=0, help="the first program's number")
    parser.add_argument("--programs", choices=tuple(GENERATORS), default="kernels",
                        help="kernels, names that leave their arrays, lists whose length only the run knows")
    parser.add_argument("--engine", choices=("numpy", "numba", "loops"), default="numpy")
    parser.add_argument("--poison", action="store_true", help="nan in whatever is allocated and not yet written")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--each", type=int, default=1, help="how many failures of one kind and place to print")
    parser.add_argument("--shrink", type=float, default=30.0, help="seconds to shrink each (0: as it is)")
    parser.add_argument("--without", default="", help="features to leave out, comma separated")
    parser.add_argument("--output", default="", help="a file to append failures to")
    warnings.simplefilter("ignore")
    return 1 if run(parser.parse_args()) else 0


if __name__ == "__main__":
    sys.exit(main())
