"""The engines that tests run kernels under: `numpy`, `numba`, and `loops`, the text for Numba run by Python.

What is wrong with a text shows under `loops` in a tenth of the time that compiling it takes; what Numba cannot compile,
or compiles to something else, shows under `numba` alone.
"""
from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from functools import cache
from typing import Any
from zlib import crc32

import pytest

from s2sad import S2sadError
from s2sad.run import compiled
from tests.harness.constructs import listed
from tests.harness.instrumentation import instrumented

EVERY = 10
_runtime = cache(compiled._runtime.__wrapped__)      # the runtime's functions as they are
compiling: list[bool] = []      # with pytest's option --compiled: Numba compiles every text


@contextmanager
def running(engine: str) -> Iterator[str]:
    """The name of the engine for s2sad, which leaves to Python inside what is written for Numba if it is `loops`."""
    if engine != "loops" or compiling:
        yield "numba" if engine == "loops" else engine
        return
    before = compiled._jit, compiled._key, compiled._runtime
    compiled._jit = lambda function, *_, **__: instrumented(function)
    compiled._key = lambda bounds: f"{before[1](bounds)}-loops"       # modules of their own
    compiled._runtime = _runtime                                      # what is compiled of the runtime stays for others
    try:
        yield "numba"
    finally:
        compiled._jit, compiled._key, compiled._runtime = before


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


def each(cases: Iterable[Any]) -> list[Any]:
    """Every case under NumPy and as the text for Numba, which is compiled for one in `EVERY`, as their names say."""
    made = []
    for k, case in enumerate(cases):
        given = case if isinstance(case, tuple) else (case,)
        name = str(getattr(given[0], "__name__", k))
        for engine in ("numpy", "loops" if crc32(name.encode()) % EVERY else "numba"):
            made.append(pytest.param(*given, engine, id=f"{name}-{engine}"))
    return made


def engines(name: str, case: Any) -> list[Any]:
    """A case under NumPy and as the text for Numba, which is compiled if tests/corpus/compiled.txt lists it."""
    made = [pytest.param(case, "numpy", id=f"{name}-numpy"),
            pytest.param(case, "loops", id=f"{name}-loops", marks=pytest.mark.emits(name))]
    return [*made, pytest.param(case, "numba", id=f"{name}-numba")] if name in listed() else made
