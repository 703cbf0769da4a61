"""The tool for GradBench: its protocol, line by line."""
from __future__ import annotations

import io
import json
import subprocess
import sys
from typing import Any

import pytest

from benchmarks.gradbench import function, protocol
from tests.harness.documents import ROOT

EVALS = ("ba", "det", "gmm", "hello", "ht", "kmeans", "llsq", "lse", "lstm", "ode", "particle", "saddle")


@pytest.fixture(autouse=True, scope="module")
def by_numpy():
    """What is checked here does not depend on the engine; nothing is compiled."""
    function.ENGINE = "numpy"


def served(*lines: str) -> list[Any]:
    answers = io.StringIO()
    protocol.serve(io.StringIO("".join(f"{line}\n" for line in lines)), answers)
    return [json.loads(line) for line in answers.getvalue().splitlines()]


def untimed(answer: Any) -> Any:
    """The answer with the names of its timings alone."""
    return answer | {"timings": [t["name"] for t in answer["timings"]]} if "timings" in answer else answer


def test_session():
    answers = served(
        '{"id": 0, "kind": "start", "eval": "hello"}',
        '{"id": 1, "kind": "define", "module": "hello"}',
        '{"id": 2, "kind": "evaluate", "module": "hello", "function": "square", "input": 3.0, "description": "3"}',
        '{"id": 3, "kind": "analysis", "of": 2, "valid": true}',
        "",
        '{"id": 4, "kind": "evaluate", "module": "hello", "function": "double", "input": 9}',
        '{"id": 5, "kind": "end"}')
    assert [untimed(a) for a in answers] == [
        {"id": 0, "tool": "s2sad", "config": {"version": "0.1.0"}},
        {"id": 1, "success": True, "timings": ["define"]},
        {"id": 2, "success": True, "output": 9.0, "timings": ["prepare", "evaluate"]},
        {"id": 3},
        {"id": 4, "success": True, "output": 18.0, "timings": ["prepare", "evaluate"]},
        {"id": 5}]


@pytest.mark.parametrize(("line", "answer"), [
    ("square", {"id": None, "success": False, "error": "not JSON: Expecting value: line 1 column 1 (char 0)"}),
    ("[1]", {"id": None, "success": False, "error": "a message is an object with an id and a kind"}),
    ('{"id": 1}', {"id": 1}),
    ('{"id": 1, "kind": ["define"]}', {"id": 1}),
    ('{"kind": "start"}', {"id": None, "tool": "s2sad", "config": {"version": "0.1.0"}}),
    ('{"id": 1, "kind": "define", "module": "fft"}',
     {"id": 1, "success": False, "error": f"no module 'fft'; there are {', '.join(EVALS)}"}),
    ('{"id": 1, "kind": "define"}',
     {"id": 1, "success": False, "error": f"no module None; there are {', '.join(EVALS)}"}),
    ('{"id": 1, "kind": "evaluate", "module": "hello", "function": "cube", "input": 1}',
     {"id": 1, "success": False, "error": "no function 'cube' in hello; there are square, double"}),
    ('{"id": 1, "kind": "evaluate", "module": "hello", "function": ["square"], "input": 1}',
     {"id": 1, "success": False, "error": "no function ['square'] in hello; there are square, double"}),
    ('{"id": 1, "kind": "evaluate", "module": "lse", "function": "primal", "input": {"n": 3}}',
     {"id": 1, "success": False, "error": "KeyError: 'x'"}),
    ('{"id": 1, "kind": "evaluate", "module": "hello", "function": "square", "input": 1e200}',
     {"id": 1, "success": False, "error": "the result is not finite, which JSON has no number for"}),
    ('{"id": 1, "kind": "evaluate", "module": "lse", "function": "primal", "input": {"x": [1], "min_runs": "2"}}',
     {"id": 1, "success": False, "error": "min_runs and min_seconds are numbers, not '2' and 0.0"})])
def test_refused(line, answer):
    after = '{"id": 2, "kind": "analysis", "of": 1, "valid": false}'
    assert served(line, after) == [answer, {"id": 2}]


@pytest.mark.parametrize(("options", "least"), [
    ({"min_runs": 3, "min_seconds": 0}, 3), ({"runs": 4}, 4), ({}, 1), ({"min_runs": 1, "min_seconds": 0.02}, 2)])
def test_runs(options, least):
    message = {"id": 1, "kind": "evaluate", "module": "lse", "function": "primal", "input": {"x": [0.0], **options}}
    tool = protocol.Tool()
    first, second = (tool.answer(json.dumps(message)) for _ in range(2))
    assert [t["name"] for t in first["timings"]][:2] == ["prepare", "evaluate"]
    assert {t["name"] for t in second["timings"]} == {"evaluate"}
    taken = [t["nanoseconds"] for t in second["timings"]]
    assert len(taken) == least if "min_seconds" not in options or not options["min_seconds"] else len(taken) >= least
    assert sum(taken) >= options.get("min_seconds", 0) * 1e9


def test_command_keeps_stdout_for_the_protocol():
    """As GradBench runs it: one line in, one line out, ended by the end of the input."""
    lines = ['{"id": 0, "kind": "start"}', "no message",
             '{"id": 1, "kind": "evaluate", "module": "hello", "function": "double", "input": 2.5}']
    done = subprocess.run([sys.executable, "-m", "benchmarks.gradbench", "--engine", "numpy"], input="\n".join(lines),
                          text=True, capture_output=True, check=True, cwd=ROOT)
    answers = [json.loads(line) for line in done.stdout.splitlines()]
    assert [a["id"] for a in answers] == [0, None, 1]
    assert answers[2]["output"] == 5.0


def test_every_eval_is_there():
    assert protocol.MODULES == EVALS
