"""Loops over arrays, lists that grow, enumerate and zip keep snapshots, by the names that they bind for each step."""
from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import s2sad
from s2sad import timesteps


def over_an_array(u, c, times):
    for t in times:
        u[:] = u + c * np.sin(u * t)
    return np.sum(u * u)


def over_rows(u, c, times):
    forces = np.outer(times, u)
    for force in forces:
        u[1:] = u[1:] + c * force[1:] * u[:-1]
    return np.sum(u * u)


def over_a_list(u, c, times):
    forces = []
    for k in range(times.size):
        forces.append(np.cos(u * times[k]))
    for force in forces:
        u[:] = u * (1.0 + c * force)
    return np.sum(u * u)


def counted(u, c, times):
    for i, t in enumerate(times, 1):
        u[:] = u + c * np.sin(u * t) / i
    return np.sum(u * u)


def in_pairs(u, c, times):
    for start, end in zip(times[:-1], times[1:]):
        u[:] = u + (end - start) * c * np.cos(u * end)
    return np.sum(u * u)


def counted_pairs(u, c, times):
    for i, (t, s) in enumerate(zip(times, reversed(times))):
        u[:] = u + c * np.sin(u * t + s) / (i + 1.0)
    return np.sum(u * u)


def backwards(u, c, times):
    for t in reversed(times):
        u[:] = u + c * np.sin(u * t)
    return np.sum(u * u)


def left(u, c, times):
    for t in times:
        u[:] = u + c * np.cos(u * t)
        if u[0] > 0.3:
            break
    return np.sum(u * u)


def marked_and_counted(u, c, times):
    for i, t in enumerate(timesteps(times, snapshots=3)):
        u[:] = u + c * np.sin(u * t) / (i + 1.0)
    return np.sum(u * u)


def marked_in_pairs(u, c, times):
    for k, t in zip(s2sad.timesteps(range(times.size), snapshots=3), times):
        u[:] = u + c * np.sin(u * t) / (k + 1.0)
    return np.sum(u * u)


NAMES: dict[Any, tuple[str, ...]] = {
    over_an_array: ("t", "line"), over_rows: ("force",), over_a_list: ("force",), counted: ("i", "t"),
    in_pairs: ("start", "end"), counted_pairs: ("i", "t", "s", "line"), backwards: ("t",), left: ("t",),
    marked_and_counted: (), marked_in_pairs: ()}


def _checkpoint(kernel, name: str) -> dict[str, int]:
    line = kernel.__code__.co_firstlineno + 1
    return {f"line {line}" if name == "line" else name: 3}


@pytest.mark.parametrize("kernel", NAMES, ids=lambda k: k.__name__)
@pytest.mark.parametrize("engine", ["numpy", "numba"])
def test_gradients_are_those_of_loops_that_record(engine, kernel):
    """The same bits under NumPy; loops in vectors sum in another order."""
    times, u = np.linspace(0.0, 1.0, 20), np.linspace(0.1, 0.6, 6)
    unmarked = kernel if NAMES[kernel] else {marked_and_counted: unmarked_and_counted,
                                             marked_in_pairs: unmarked_in_pairs}[kernel]
    expected = s2sad.gradient(s2sad.differentiate(unmarked, engine=engine), wrt=("u", "c", "times"))
    for name in NAMES[kernel][:1] or ("",):
        kept = s2sad.differentiate(kernel, engine=engine, checkpoint=_checkpoint(kernel, name) if name else None)
        [loop] = kept.adjoint.memory(u, 0.11, times).loops
        assert loop.snapshots == 3
        found = s2sad.gradient(kept, wrt=("u", "c", "times"))
        for steps in (2, 3, 20) if engine == "numpy" else (2, 20):
            mine, plain = found(u, 0.11, times[:steps]), expected(u, 0.11, times[:steps])
            for argument, bar in plain.items():
                near = 0.0 if engine == "numpy" else 1e-13
                np.testing.assert_allclose(mine[argument], bar, rtol=near, atol=near * np.max(np.abs(bar)))


def unmarked_and_counted(u, c, times):
    for i, t in enumerate(times):
        u[:] = u + c * np.sin(u * t) / (i + 1.0)
    return np.sum(u * u)


def unmarked_in_pairs(u, c, times):
    for k, t in zip(range(times.size), times):
        u[:] = u + c * np.sin(u * t) / (k + 1.0)
    return np.sum(u * u)


@pytest.mark.parametrize(("kernel", "name"), [(k, n) for k, names in NAMES.items() for n in names],
                         ids=lambda k: getattr(k, "__name__", k))
def test_a_loop_goes_by_each_name_that_it_binds(kernel, name):
    kept = s2sad.differentiate(kernel, engine="numpy", checkpoint=_checkpoint(kernel, name))
    [loop] = kept.adjoint.memory(np.ones(6), 0.1, np.ones(20)).loops
    assert (loop.loop, loop.snapshots) == (NAMES[kernel][0], 3)


def _refused(kernel, checkpoint: Any, times: Any) -> str:
    with pytest.raises(s2sad.S2sadError) as caught:
        s2sad.gradient(kernel, wrt="u", checkpoint=checkpoint)(np.ones(6), 0.1, times)
    return "\n".join(line for line in str(caught.value).splitlines() if " | " not in line)


def test_a_loop_over_a_list_that_is_written_out():
    """A list that is given has as many names as elements."""
    line = over_an_array.__code__.co_firstlineno + 1
    assert _refused(over_an_array, {"t": 3}, [0.1, 0.2, 0.3]) == (
        f"{__file__}:{line}:5: error[S408]: this loop is written out before the run, and keeps no snapshots\n"
        "  help: leave it out of 'checkpoint'")


def test_names_that_no_loop_binds():
    assert _refused(counted_pairs, {"k": 3}, np.ones(3)) == (
        "error[S408]: checkpoint names 'k', which is no loop of 'counted_pairs'\n"
        '  help: its loops are "i"')
