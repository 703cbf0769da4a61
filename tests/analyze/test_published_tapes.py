"""What is on the tapes of two kernels that are well known: nothing twice, and no work array."""
from __future__ import annotations

import ast
import re
from typing import Any

import numpy as np
import pytest

import s2sad
from benchmarks.kernels import shallow_water
from benchmarks.peers.problems import Problem

ENGINES = pytest.mark.parametrize("engine", ["numpy", "numba"])


@ENGINES
def test_a_long_short_term_memory_records_each_state_once(engine):
    """ADBench's: of each step and layer its hidden state and its cell, each on one stack; what it holds counts."""
    case, size = Problem.of("lstm", 64).case, 64
    function = s2sad.differentiate(case.function, wrt=case.wrt, of=case.of, engine=engine)
    arguments = case.arguments(size)
    text = function.adjoint_source(*arguments)
    [forward] = re.findall(r"def objective_adjoint\(.*?# forward sweep(.*?)# reverse sweep", text, re.DOTALL)
    pushed = re.findall(r"(state\w*_stack\w*)\[state\w*_top\w*(?:, i_2)?\] = state_1\[(.*?)(?:, i_2)?\]\n", forward)
    assert [row for _, row in pushed] == ["k", "k + 1"]
    assert len({stack for stack, _ in pushed}) == 2
    _main, _extra, state, sequence = arguments
    pushes = (len(sequence) - 1) * len(state) // 2
    each = state[0].nbytes * pushes
    found = {stack.name: stack.bytes for f in s2sad.explain(function, *arguments).functions for stack in f.recorded}
    assert {name: count for name, count in found.items() if name.startswith("state")} == {
        stack: each for stack, _ in pushed}


def _of_shallow_water(engine: str, kernel: Any = shallow_water.misfit) -> tuple[Any, tuple[Any, ...]]:
    h = 1.0 + np.random.default_rng(3).random((6, 5))
    function = s2sad.differentiate(kernel, wrt="h0", engine=engine)
    return function, (h, shallow_water.Params(), np.ones_like(h), 7)


@ENGINES
def test_shallow_water_records_no_work_array(engine):
    """Helpers of a helper fill `un`, `vn` and `hn`: only the state of each step is recorded, and the model runs once
    forwards, and once more in the adjoint of each step."""
    function, arguments = _of_shallow_water(engine)
    text = function.adjoint_source(*arguments)
    recorded = [(stack.name, stack.bytes) for f in s2sad.explain(function, *arguments).functions
                for stack in f.recorded]
    each = 7 * arguments[0].nbytes
    assert recorded == [("u_stack", each), ("v_stack", each), ("h_stack", each)]
    assert function.adjoint.memory(*arguments).tape == 3 * each
    bodies = [f for f in ast.parse(text).body if isinstance(f, ast.FunctionDef)]
    calls = {f.name: [n.func.id for n in ast.walk(f) if isinstance(n, ast.Call) and isinstance(n.func, ast.Name)
                      and n.func.id in ("step", "momentum", "continuity")] for f in bodies}
    assert {name: found for name, found in calls.items() if found} == {
        "step": ["momentum", "continuity"], "run_augmented": ["step"], "step_adjoint": ["momentum"]}


def reads_what_the_last_step_left(u, v, h, un, vn, hn, p: shallow_water.Params):
    """As `step`, with a drag by the velocity that the step before last had found."""
    for i in range(u.shape[0]):
        for j in range(u.shape[1]):
            u[i, j] -= 0.1 * p.dt * un[i, j] * un[i, j] * u[i, j]
    shallow_water.step(u, v, h, un, vn, hn, p)


def with_memory(h0, p: shallow_water.Params, observed, steps):
    h = h0.copy()
    u, v = 0.1 * h0, np.zeros_like(h)
    un, vn, hn = 0.2 * h0, np.empty_like(v), np.empty_like(h)
    for _ in range(steps):
        reads_what_the_last_step_left(u, v, h, un, vn, hn, p)
    total = 0.0
    for i in range(h.shape[0]):
        for j in range(h.shape[1]):
            total += (h[i, j] - observed[i, j]) ** 2
    return total / h.size


@ENGINES
def test_a_work_array_that_is_read_before_it_is_filled_is_recorded(engine):
    function, arguments = _of_shallow_water(engine, with_memory)
    assert "un_stack" in function.adjoint_source(*arguments)
    direction, h = np.cos(np.arange(30.0)).reshape(6, 5), 1e-6
    ahead, behind = (with_memory(arguments[0] + e * direction, *arguments[1:]) for e in (h, -h))
    found = np.sum(s2sad.gradient(function, wrt="h0")(*arguments) * direction)
    np.testing.assert_allclose(found, (ahead - behind) / (2 * h), rtol=1e-7)
