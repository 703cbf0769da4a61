"""GradBench's protocol from the side of a tool: one JSON object a line is read, and one is written."""
from __future__ import annotations

import importlib
import json
import sys
import traceback
from collections.abc import Callable
from contextlib import redirect_stdout
from dataclasses import dataclass, field
from pkgutil import iter_modules
from time import perf_counter_ns
from typing import Any, TextIO

import s2sad
from benchmarks.gradbench import evals
from benchmarks.gradbench.function import Function

Answer = dict[str, Any]
MODULES = tuple(sorted(found.name for found in iter_modules(evals.__path__)))


class Refused(Exception):
    """What a message asks for cannot be done; the text says why."""


def serve(lines: TextIO, answers: TextIO) -> None:
    """Answers each line until there is no more. Whatever else is printed meanwhile goes to stderr."""
    tool = Tool()
    for line in lines:
        if line.strip():
            with redirect_stdout(sys.stderr):
                answer = tool.answer(line)
            print(json.dumps(answer, allow_nan=False), file=answers, flush=True)


@dataclass
class Tool:
    """What is remembered between messages: which functions have been run with which types of arguments."""
    prepared: set[Any] = field(default_factory=set)

    def answer(self, line: str) -> Answer:
        """The response to one line; a message that is none, or asks for what is not there, is refused with a reason."""
        try:
            message = json.loads(line)
        except ValueError as error:
            return {"id": None, "success": False, "error": f"not JSON: {error}"}
        if not isinstance(message, dict):
            return {"id": None, "success": False, "error": "a message is an object with an id and a kind"}
        answers: dict[Any, Callable[[Answer], Answer]] = {
            "start": lambda message: {"tool": "s2sad", "config": {"version": s2sad.__version__}},
            "define": self.define, "evaluate": self.evaluate}
        kind = message.get("kind")
        try:
            found = answers[kind](message) if isinstance(kind, str) and kind in answers else {}
        except Refused as refusal:
            found = {"success": False, "error": str(refusal)}
        except Exception as error:   # a user's input may raise whatever NumPy raises; the next message is answered
            traceback.print_exc()
            found = {"success": False, "error": "".join(traceback.format_exception_only(error)).strip()}
        return {"id": message.get("id"), **found}

    def define(self, message: Answer) -> Answer:
        """Whether there is a module of the name; what it takes to load it."""
        start = perf_counter_ns()
        functions(message.get("module"))
        return {"success": True, "timings": [_timing("define", perf_counter_ns() - start)]}

    def evaluate(self, message: Answer) -> Answer:
        """The output of a function with one timing for each run. The first run with arguments of new types compiles;
        it is a timing of its own, "prepare"."""
        function = _function(message)
        given = message.get("input")
        arguments = function.arguments(given)
        timings = []
        key = (message.get("module"), message.get("function"), *map(_type, arguments))
        if key not in self.prepared:
            timings.append(_timing("prepare", _timed(function, arguments)[1]))
            self.prepared.add(key)
        least, seconds = runs(given)
        total, done, result = 0, 0, None
        while done < least or total < seconds * 1e9:
            result, taken = _timed(function, arguments)
            timings.append(_timing("evaluate", taken))
            total, done = total + taken, done + 1
        output = function.output(result, given)
        try:
            json.dumps(output, allow_nan=False)
        except ValueError:
            raise Refused("the result is not finite, which JSON has no number for") from None
        return {"success": True, "output": output, "timings": timings}


def functions(module: Any) -> dict[str, Function]:
    """The functions of an eval by name. Raises Refused for an unknown one."""
    if module not in MODULES:
        raise Refused(f"no module {module!r}; there are {', '.join(MODULES)}")
    return importlib.import_module(f"{evals.__name__}.{module}").FUNCTIONS


def runs(given: Any) -> tuple[int, float]:
    """How often a function runs at least, and for how many seconds; once where the input does not say.

    >>> runs(3.0), runs({"min_runs": 2, "min_seconds": 0.5})
    ((1, 0.0), (2, 0.5))
    """
    if not isinstance(given, dict):
        return 1, 0.0
    least, seconds = given.get("min_runs", given.get("runs", 1)), given.get("min_seconds", 0.0)
    if not isinstance(least, int) or not isinstance(seconds, (int, float)):
        raise Refused(f"min_runs and min_seconds are numbers, not {least!r} and {seconds!r}")
    return max(least, 1), float(seconds)


def _function(message: Answer) -> Function:
    found, name = functions(message.get("module")), message.get("function")
    if not isinstance(name, str) or name not in found:
        raise Refused(f"no function {name!r} in {message['module']}; there are {', '.join(found)}")
    return found[name]


def _timed(function: Function, arguments: tuple[Any, ...]) -> tuple[Any, int]:
    start = perf_counter_ns()
    result = function.call(*arguments)
    return result, perf_counter_ns() - start


def _timing(name: str, nanoseconds: int) -> Answer:
    return {"name": name, "nanoseconds": nanoseconds}


def _type(value: Any) -> Any:
    """What a derivative is compiled for: of an array its dtype and which axes have length 1."""
    shape = getattr(value, "shape", None)
    return type(value) if shape is None else (str(value.dtype), tuple(size == 1 for size in shape))
