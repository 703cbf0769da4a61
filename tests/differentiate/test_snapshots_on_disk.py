"""Snapshots in files: the same gradients, nothing left in the folder however a call ends, and early errors."""
from __future__ import annotations

import os
import shutil
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import s2sad
from s2sad import Snapshots, timesteps
from tests.differentiate import time_loops
from tests.differentiate.time_loops import LOOPS

ENGINES = pytest.mark.parametrize("engine", ["numpy", "numba"])


def steps_of(u, c, n):
    energy, t = 0.0, 0.0
    for k in range(n):
        u[:] = u + c * np.sin(u + k * t)
        energy += np.sum(u)
        t = t + 0.1
    return energy


def raising(u, c, n):
    for k in range(n):
        u[:] = u + c * np.sin(u)
        if k == 7:
            raise ValueError("too late")
    return np.sum(u * u)


def _gradient(kernel, engine: str, snapshots: Any, loop: str = "k") -> Any:
    return s2sad.gradient(s2sad.differentiate(kernel, engine=engine, checkpoint={loop: snapshots}), wrt="u")


def _bytes_mapped(folder: Path) -> int:
    """The bytes that the files of a folder take that this process has open."""
    files = [f for f in Path("/proc/self/fd").iterdir() if f.is_symlink() and str(folder) in os.readlink(f)]
    return sum(f.stat().st_size for f in files)


def _mapped(folder: Path) -> int:
    """How many files of a folder this process has mapped."""
    return sum(str(folder) in line for line in Path("/proc/self/maps").read_text(encoding="utf-8").splitlines())


@ENGINES
@pytest.mark.parametrize("kernel", [time_loops.work_array, time_loops.swapped, time_loops.until_a_time,
                                    time_loops.flags_and_integers, time_loops.complex_numbers,
                                    time_loops.of_a_helper], ids=lambda k: k.__name__)
def test_gradients_are_those_of_snapshots_in_memory(kernel, engine, tmp_path):
    u = np.linspace(0.1, 0.6, 6)
    for steps in (0, 1, 20):
        memory, disk = (_gradient(kernel, engine, s, LOOPS[kernel][0])(u, 0.11, steps)
                        for s in (3, Snapshots(3, on_disk=str(tmp_path))))
        np.testing.assert_array_equal(memory, disk)
    assert not os.listdir(tmp_path) and not _mapped(tmp_path)


@ENGINES
def test_nothing_is_left_where_a_step_raises(engine, tmp_path):
    u, gradient = np.ones(3), _gradient(raising, engine, Snapshots(2, on_disk=str(tmp_path)))
    wanted = gradient(u, 0.5, 5)
    for _ in range(3):
        with pytest.raises(ValueError, match="too late"):
            gradient(u, 0.5, 10)
    assert not os.listdir(tmp_path) and not _bytes_mapped(tmp_path)
    np.testing.assert_array_equal(u, 1.0)
    kept = _mapped(tmp_path)        # compiled code that raises lets go of nothing: the next call uses it again
    assert not kept if engine == "numpy" else kept == 1
    np.testing.assert_array_equal(gradient(u, 0.5, 5), wanted)
    assert _mapped(tmp_path) == kept and not _bytes_mapped(tmp_path)


def test_files_that_code_has_raised_over_are_used_again(tmp_path):
    gradient = _gradient(raising, "numba", Snapshots(2, on_disk=str(tmp_path)))
    for n, rounds in ((10, 30), (20, 30)):
        for _ in range(rounds):
            with pytest.raises(ValueError, match="too late"):
                gradient(np.ones(3), 0.5, n)
    assert _mapped(tmp_path) == 1
    with ThreadPoolExecutor(2) as pool:
        found = list(pool.map(lambda _: gradient(np.ones(3), 0.5, 5), range(8)))
    assert all(np.array_equal(f, found[0]) for f in found) and not _bytes_mapped(tmp_path)


def test_nothing_is_left_where_it_is_interrupted(tmp_path, monkeypatch):
    calls, sine = [], np.sin

    def interrupted(x):
        calls.append(x)
        assert len(calls) != 4 or _mapped(tmp_path) == 1
        if len(calls) == 4:
            raise KeyboardInterrupt
        return sine(x)
    gradient = _gradient(steps_of, "numpy", Snapshots(2, on_disk=str(tmp_path)))
    gradient(np.ones(3), 0.1, 9)
    monkeypatch.setattr(np, "sin", interrupted)
    with pytest.raises(KeyboardInterrupt):
        gradient(np.ones(3), 0.1, 9)
    assert not os.listdir(tmp_path) and not _mapped(tmp_path)


def test_two_threads_in_one_folder(tmp_path):
    found: list[Any] = [None, None]
    gradient = _gradient(steps_of, "numba", Snapshots(3, on_disk=str(tmp_path)))
    expected = [gradient(np.full(4, 0.1 + k), 0.1, 300) for k in range(2)]

    def run(k: int) -> None:
        found[k] = gradient(np.full(4, 0.1 + k), 0.1, 300)
    threads = [threading.Thread(target=run, args=(k,)) for k in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    np.testing.assert_array_equal(found, expected)


@ENGINES
def test_a_folder_that_is_not_there(engine, tmp_path):
    u, u_bar, folder = np.ones(3), np.zeros(3), str(tmp_path / "gone")
    kept = s2sad.differentiate(steps_of, engine=engine, checkpoint={"k": Snapshots(2, on_disk=folder)})
    with pytest.raises(s2sad.S2sadError) as caught:
        kept.adjoint(u, u_bar, 0.1, 9, 1.0)
    assert str(caught.value) == (
        "error[S407]: snapshots of 'steps_of' cannot be written: No such file or directory\n"
        f"  note: the folder is {folder}\n  help: give a folder with room for them, or keep fewer")
    np.testing.assert_array_equal(u, 1.0)
    os.mkdir(folder)
    kept.adjoint(u, u_bar, 0.1, 9, 1.0)
    assert np.all(u_bar > 0.0)


@ENGINES
def test_a_disk_that_is_full(engine, tmp_path, monkeypatch):
    u, kept = np.ones(1000), s2sad.differentiate(
        steps_of, engine=engine, checkpoint={"k": Snapshots(9, on_disk=str(tmp_path))})
    monkeypatch.setattr(shutil, "disk_usage", lambda folder: SimpleNamespace(free=79_999))
    with pytest.raises(s2sad.S2sadError, match="S407.*80,000 bytes are needed, 79,999 are free"):
        kept.adjoint(u, np.zeros(1000), 0.1, 100, 1.0)
    np.testing.assert_array_equal(u, 1.0)
    assert not os.listdir(tmp_path)
    kept.adjoint(u, np.zeros(1000), 0.1, 9, 1.0)     # fewer steps than snapshots


def second_of_two(u, c, n):
    for i in range(u.size):
        u[i] = c * u[i]
    for k in range(n):
        for i in range(u.size):
            u[i] = u[i] * u[i] + 0 * k


@ENGINES
def test_a_disk_that_is_full_is_seen_before_what_comes_in_front_of_the_loop(engine, tmp_path, monkeypatch):
    u, kept = np.ones(1000), s2sad.differentiate(
        second_of_two, engine=engine, wrt="u", checkpoint={"k": Snapshots(9, on_disk=str(tmp_path))})
    monkeypatch.setattr(shutil, "disk_usage", lambda folder: SimpleNamespace(free=79_999))
    with pytest.raises(s2sad.S2sadError) as caught:
        kept.adjoint(u, np.zeros(1000), 0.5, 100)
    assert str(caught.value) == (
        "error[S407]: snapshots of 'second_of_two' cannot be written: 80,000 bytes are needed, 79,999 are free\n"
        f"  note: the folder is {tmp_path}\n  help: give a folder with room for them, or keep fewer")
    np.testing.assert_array_equal(u, 1.0)
    monkeypatch.undo()
    kept.adjoint(u, u_bar := np.ones(1000), 0.5, 3)
    np.testing.assert_allclose(u_bar, 8 * 0.5 ** 7 * 0.5)


def marked(u, c, n):
    for k in timesteps(range(n), snapshots=Snapshots(3, on_disk=".")):
        u[:] = u + c * np.sin(u * k)
    return np.sum(u)


def test_a_loop_of_which_the_text_says_it(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = s2sad.differentiate(marked, engine="numpy").adjoint_source(np.ones(3), 0.1, 9)
    assert 'u_snapshots = on_disk(u, min(4, trips), ".")' in text
    assert s2sad.check(marked, np.ones(3), 0.1, 9, engine="numpy")


def test_a_folder_is_a_path(tmp_path):
    by_path = _gradient(steps_of, "numpy", Snapshots(2, on_disk=tmp_path))
    np.testing.assert_array_equal(by_path(np.ones(3), 0.1, 9), _gradient(steps_of, "numpy", 2)(np.ones(3), 0.1, 9))
    with pytest.raises(s2sad.S2sadError, match="which names no folder"):
        _gradient(steps_of, "numpy", Snapshots(2, on_disk=3))  # pyright: ignore[reportArgumentType]
