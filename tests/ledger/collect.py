"""A plugin of pytest: what tests ask the compiler for goes to a store.

The package's own functions are replaced, from here, at the four places where a program is read, taken apart, asked for
what it writes, and derived. Meanwhile all run under NumPy at the level "plain", which is derived soonest, and what only
is to be compared with differences is not derived at all: tests that look at other texts fail, which is of no account.
"""
from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import replace
from functools import partial, wraps
from pathlib import Path
from types import FunctionType
from typing import Any

import pytest

import s2sad
from s2sad import S2sadError, pipeline, read
from s2sad.dispatch import compiler
from s2sad.dispatch import cache
from s2sad.program import Program, Request
from s2sad.live_objects.side_table import looked_up
from tests.harness import derivatives
from tests.ledger.identity import described, digest
from tests.ledger.registered import Registered, paths_of
from tests.ledger.store import ANYTHING, Asked, Kernel, Store, decorating, pickled, texts_of

ROOT = Path(__file__).resolve().parent.parent.parent
Origin = tuple[Any, str, tuple[Any, ...], Any]      # function, file, varying, forms: how a program came to be


class Collector:
    """Adds to a store what the compiler is asked for; `missed` says what could not be kept, by reason."""

    def __init__(self) -> None:
        self.store = Store()
        self.missed: dict[str, str] = {}
        self.registered = Registered([])
        self.is_asked_only = False

    def add(self, origin: Origin, types: Any, asked: Asked, program: Program | None = None) -> None:
        function, file, varying, forms = origin
        outside = file and Path(file).read_text()
        paths = set() if program is None else {g.path for g in compiler.registered_rules(program)}
        calls = self.registered.reaching(paths)
        identity = digest(described((function, outside, varying, forms, types, [c[:4] for c in calls])))
        kernel = self.store.kernels.get(identity)
        if kernel is None:
            if identity in self.missed:
                return
            try:
                asking = None if file else function, tuple(varying), forms, types
                _, functions = pickled((*asking, calls))
                calls = self.registered.reaching(paths | paths_of(functions))
                content, functions = pickled((*asking, calls, decorating(functions)))
            except Exception as error:      # whatever a test has put within reach of its kernel
                self.missed[identity] = f"{_name(function)}: {type(error).__name__}: {error}"
                return
            texts = texts_of(functions) | ({file: outside} if file else {})
            self.store.texts.update((digest(t), t) for t in texts.values())
            kernel = self.store.kernels[identity] = Kernel(
                identity, _name(function), content, {path: digest(t) for path, t in texts.items()}, file,
                bool(calls))
        kernel.asked.add(asked)
        kernel.places.add(_place(function))


def _innermost_function(function: FunctionType | None) -> Any:
    """A function, or what a function of left arguments was made of: a partial, or an object that is called."""
    kernel, names, called = function and looked_up(function, "given") or (function, {}, None)
    return function if kernel is function else partial(kernel, **names) if called is None else called


def _name(function: Any) -> str:
    return function if isinstance(function, str) else getattr(
        getattr(function, "func", function), "__name__", type(function).__name__)


def _place(function: Any) -> str:
    """The function's file and line in the tree, or the test that made it."""
    code = getattr(read.python_function(getattr(function, "func", function)), "__code__", None)
    path = Path(code.co_filename if code else "")
    if code and path.is_relative_to(ROOT):
        return f"{path.relative_to(ROOT)}:{code.co_firstlineno}"
    return os.environ.get("PYTEST_CURRENT_TEST", "").partition("[")[0].partition(" (")[0]


# -- the four places ------------------------------------------------------------------------------------------------

def _origin(program: Program) -> Origin | None:
    return vars(program).get("origin")


def _from(program: Program, origin: Origin | None) -> Program:
    vars(program)["origin"] = origin
    return program


def reading(collector: Collector, inner: Callable[..., Program]) -> Callable[..., Program]:
    @wraps(inner)
    def load(function: Any, varying: Any = ()) -> Program:
        origin = (_innermost_function(read.python_function(function)), "", tuple(varying), None)
        try:
            return _from(inner(function, varying), origin)
        except S2sadError:
            if origin[0] is not None:
                collector.add(origin, None, ANYTHING)
            raise
    return load


def reading_file(collector: Collector, inner: Callable[..., Program]) -> Callable[..., Program]:
    @wraps(inner)
    def load_file(path: Any, function: str) -> Program:
        origin = (function, os.path.abspath(path), (), None)
        try:
            program = inner(path, function)
        except S2sadError:
            return inner(path, function)    # messages of files are what tests of reading look at: no kernel
        return _from(program, origin if len(program.files) == 1 else None)
    return load_file


def taking_apart(collector: Collector, inner: Callable[..., Any]) -> Callable[..., Any]:
    @wraps(inner)
    def flat_program(program: Program, function: Any, forms: tuple[Any, ...], varying: Any, facts: Any) -> Any:
        known = _origin(program)
        origin = known and (*known[:3], (forms, tuple(facts.items())))
        try:
            flat = inner(program, function, forms, varying, facts)
        except S2sadError:
            if origin:
                collector.add(origin, None, ANYTHING, program)
            raise
        _from(flat.program, origin)
        return flat
    return flat_program


def summarizing(collector: Collector, inner: Callable[..., Any]) -> Callable[..., Any]:
    @wraps(inner)
    def summary(program: Program, types: tuple[Any, ...], forms: Any = None) -> Any:
        try:
            return inner(program, types, forms)
        except S2sadError:
            origin = _origin(program)
            if origin:
                collector.add(origin, types, ANYTHING, program)
            raise
    return summary


def deriving(collector: Collector, inner: Callable[..., Any]) -> Callable[..., Any]:
    @wraps(inner)
    def derive(program: Program, request: Request, *given: Any, **named: Any) -> Any:
        origin = _origin(program)
        if origin:
            collector.add(origin, request.types, (request.mode, request.wrt, request.of, request.with_primal),
                          program)
        elif not program.files and program.function is None:    # what the evaluator leaves is no function's own
            pass
        else:
            collector.missed[f"no origin {program.entry}"] = f"{program.entry}: not read by itself"
        if collector.is_asked_only:
            raise _Enough
        return inner(program, replace(request, level="plain"), *given, **named)
    return derive


def collecting(collector: Collector) -> ExitStack:
    """From now on, until it is closed, all that is asked is collected."""
    kept = collector.registered.recording()
    for module, name, wrapper in ((compiler, "program", reading), (read, "load_file", reading_file),
                                  (compiler, "flat_program", taking_apart),
                                  (pipeline, "summary", summarizing), (pipeline, "derive", deriving)):
        inner = getattr(module, name)
        setattr(module, name, wrapper(collector, inner))
        kept.callback(setattr, module, name, inner)
    return kept


class _Enough(BaseException):
    """A derivative was asked for, and is not needed."""


def record_requests(collector: Collector, function: Any, subject: derivatives.VectorFunction) -> derivatives.Measured:
    """What `check_derivatives` asks for, in place of what it measures."""
    differentiated, args = s2sad.differentiate(function, engine="numpy"), tuple(subject.given.values())
    tangents = derivatives._split(subject.given, subject.wrt, subject.x)
    collector.is_asked_only = True
    try:
        for ask in (lambda: s2sad.vjp(differentiated, args, subject.outputs, wrt=subject.wrt),
                    lambda: s2sad.jvp(differentiated, args, tangents, of=subject.of)):
            with suppress(_Enough):
                ask()
    finally:
        collector.is_asked_only = False
    return derivatives.Measured(0.0, 0.0, 0.0)


@contextmanager
def measuring_nothing(collector: Collector) -> Iterator[None]:
    """Derivatives are for NumPy alone, and not compared with differences: both take most of the time of tests."""
    before = derivatives._measured, cache.chosen
    derivatives._measured = lambda function, subject, *_: record_requests(collector, function, subject)
    cache.chosen = lambda engine: "numpy"
    try:
        yield
    finally:
        derivatives._measured, cache.chosen = before


# -- the plugin -----------------------------------------------------------------------------------------------------

def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--ledger-store", help="a folder for the store of each process")


def pytest_configure(config: pytest.Config) -> None:
    folder = config.getoption("--ledger-store")
    if folder is None:
        return
    collector, kept = Collector(), ExitStack()
    kept.enter_context(collecting(collector))
    kept.enter_context(measuring_nothing(collector))

    def write() -> None:
        kept.close()
        worker = os.environ.get("PYTEST_XDIST_WORKER", "main")
        collector.store.write(f"{folder}/{worker}.store")
        Path(f"{folder}/{worker}.missed").write_text("".join(f"{m}\n" for m in sorted(set(collector.missed.values()))))
    config.add_cleanup(write)
