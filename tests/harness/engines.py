"""The engines that tests run kernels under: `numpy`, `numba`, and `loops`, the text for Numba run by Python.

What is wrong with a text shows under `loops` in a tenth of the time that compiling it takes; what Numba cannot compile,
or compiles to something else, shows under `numba` alone.
"""
from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from functools import cache
from typing import Any

import pytest

from s2sad import S2sadError
from s2sad.run import compiled
from s2sad.runtime import lanes
from tests.harness.constructs import listed
from tests.harness.instrumentation import instrumented

_runtime = cache(compiled._runtime.__wrapped__)      # the runtime's functions as they are
compiling: list[bool] = []      # with pytest's option --compiled: Numba compiles every text


@contextmanager
def running(engine: str) -> Iterator[str]:
    """The name of the engine for s2sad, which leaves to Python inside what is written for Numba if it is `loops`."""
    if engine != "loops" or compiling:
        yield "numba" if engine == "loops" else engine
        return
    before = compiled._jit, compiled._key, compiled._runtime, compiled.through_python
    compiled.through_python = lambda function: None if function is lanes else before[3](function)
    compiled._jit = lambda function, *_, **__: instrumented(function)
    compiled._key = lambda bounds: f"{before[1](bounds)}-loops"       # modules of their own
    compiled._runtime = _runtime                                      # what is compiled of the runtime stays for others
    try:
        yield "numba"
    finally:
        compiled._jit, compiled._key, compiled._runtime, compiled.through_python = before


def one_line(error: S2sadError) -> str:
    """What an error says in one line, with what to do."""
    (found,) = error.diagnostics
    return f"{found.message}: {found.help}" if found.help else found.message


def located(error: S2sadError) -> str:
    """What an error says and where: its code, the part of the text that is marked, and what to do."""
    texts = []
    for found in error.diagnostics:
        part = ""
        if found.span is not None:
            line = found.span.source.line(found.span.line)
            end = found.span.end_column if found.span.end_line == found.span.line else len(line)
            part = f" at `{line[found.span.column:end]}`"
        texts.append(": ".join(filter(None, (f"{found.code}{part}", found.message, found.note, found.help))))
    return "\n".join(texts)


def engines(name: str, *case: Any, called: str = "") -> list[Any]:
    """A case under NumPy and as the text for Numba, which is compiled if tests/corpus/compiled.txt lists its name; the
    tests are `called` so."""
    made = [pytest.param(*case, "numpy", id=f"{called or name}-numpy"),
            pytest.param(*case, "loops", id=f"{called or name}-loops", marks=pytest.mark.emits(name))]
    return [*made, pytest.param(*case, "numba", id=f"{called or name}-numba")] if name in listed() else made


def each(cases: Iterable[Any], asked: str = "") -> list[Any]:
    """The cases of a test module, kernels or tuples that begin with one, under the engines; what is `asked` of them is
    part of their names, where a module asks several things of one kernel."""
    made, seen = [], Counter()
    for case in cases:
        given = case if isinstance(case, tuple) else (case,)
        called = given[0].__name__
        seen[called] += 1
        called = called if seen[called] == 1 else f"{called}-{seen[called]}"
        topic = given[0].__module__.removeprefix("tests.").replace(".test_", ".")
        made += engines(".".join(filter(None, (topic, asked, called))), *given, called=called)
    return made
