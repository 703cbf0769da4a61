"""Tapes that cannot be had are refused, before anything is written."""
from __future__ import annotations

import subprocess
import sys
import textwrap
import time

import numpy as np
import pytest

import s2sad
from s2sad import S2sadError, differentiate, gradient
from s2sad.dispatch import memory_check
from s2sad.run.memory import machine_memory
from tests.interface import memory_kernels as kernels

ENGINES = pytest.mark.parametrize("engine", ["numpy", "numba"])
U = np.linspace(0.1, 1.0, 300)
REFUSED = """\
error[S410]: the adjoint of 'swaps' takes 480,000 MB, and this process may have 1,000 MB
  120 |     for _ in range(n):
      |     ^^^^^^^^^^^^^^^^^^ the loop over _ records 480,000 MB
  help: checkpoint={"_": 50} keeps snapshots in place of the tape"""


@pytest.fixture
def small(monkeypatch):
    monkeypatch.setattr(memory_check, "most_memory", lambda: 1e9)


def without_path(error):
    head, _, rest = str(error).partition("error[")
    return f"error[{rest}"


@ENGINES
def test_nothing_runs_and_nothing_is_written(engine, small):
    u, u_bar = U.copy(), np.ones_like(U)
    f = differentiate(kernels.two_levels, engine=engine, wrt="u")
    calls = {
        "adjoint": lambda: f.adjoint(u, u_bar, 10 ** 6, 10 ** 6, 1.0),
        "gradient": lambda: gradient(f)(u, 10 ** 6, 10 ** 6),
        "vjp": lambda: s2sad.vjp(f, (u, 10 ** 6, 10 ** 6), {"return": 1.0}),
        "autodiff": lambda: s2sad.autodiff(s2sad.Reverse, f, s2sad.Duplicated(u, u_bar), 10 ** 6, 10 ** 6)}
    for call in calls.values():
        start = time.perf_counter()
        with pytest.raises(S2sadError) as caught:
            call()
        assert without_path(caught.value).startswith("error[S410]: the adjoint of 'two_levels' takes ")
        assert time.perf_counter() - start < 60.0
    np.testing.assert_array_equal(u, U)
    np.testing.assert_array_equal(u_bar, 1.0)


def test_says_the_bytes_the_loop_and_the_line_to_add(small):
    with pytest.raises(S2sadError) as caught:
        gradient(differentiate(kernels.swaps, engine="numpy", wrt="u"))(U, U.copy(), 2 * 10 ** 8)
    line = kernels.swaps.__code__.co_firstlineno + 1
    assert without_path(caught.value) == REFUSED.replace("120 |", f"{line} |")


@ENGINES
def test_later_calls_are_asked_too(engine, small):
    f = differentiate(kernels.two_levels, engine=engine, wrt="u")
    for steps in (1, 2, 3, 5):
        gradient(f)(U, steps, 2)
        f.adjoint(U.copy(), np.zeros_like(U), steps, 2, 1.0)
    with pytest.raises(S2sadError, match="S410"):
        gradient(f)(U, 10 ** 9, 2)
    with pytest.raises(S2sadError, match="S410"):
        f.adjoint(U.copy(), np.zeros_like(U), 10 ** 9, 2, 1.0)
    gradient(f)(U, 7, 2)


def test_what_the_help_says_helps(small):
    f = differentiate(kernels.two_levels, engine="numpy", wrt="u", checkpoint={"k": 50})
    assert f.adjoint.memory(U, 10 ** 6, 1).peak < 10 ** 6
    with pytest.raises(S2sadError, match=r'checkpoint=\{"product.j": 50\}'):
        gradient(differentiate(kernels.of_helper, engine="numpy", wrt="u"))(U, 10 ** 10)


def test_a_bound_refuses_nothing(monkeypatch):
    monkeypatch.setattr(memory_check, "most_memory", lambda: 100.0)
    assert gradient(differentiate(kernels.large_ones, engine="numpy", wrt="u"))(np.zeros(50), 50) is not None


def test_snapshots_that_are_too_many(monkeypatch):
    monkeypatch.setattr(memory_check, "most_memory", lambda: 100_000.0)
    f = differentiate(kernels.two_levels, engine="numpy", wrt="u", checkpoint={"k": 90})
    with pytest.raises(S2sadError) as caught:
        gradient(f)(U, 100, 1)
    assert str(caught.value).splitlines()[-1] == "  help: keep fewer snapshots, or some on disk"
    assert "the loop over k records 0.22 MB" in str(caught.value)


SCRIPT = """
    import resource, sys
    import numpy as np
    import s2sad
    from tests.interface import memory_kernels as kernels
    u = np.full(100_000, 0.5)
    f = s2sad.differentiate(kernels.slower, engine=sys.argv[1], wrt="u")
    s2sad.gradient(f)(u, 1.0, 2.0)
    there = int(open("/proc/self/statm").read().split()[0]) * 4096
    resource.setrlimit(resource.RLIMIT_AS, (there + 300_000_000, resource.RLIM_INFINITY))
    try:
        s2sad.gradient(f)(u, 1.0, 1000.0)
    except s2sad.S2sadError as error:
        print(error)
    assert (u == 0.5).all()
"""


@ENGINES
@pytest.mark.skipif(not machine_memory.PROC.exists(), reason="needs Linux's /proc")
def test_memory_that_is_gone_in_the_run_says_the_same(engine):
    done = subprocess.run([sys.executable, "-c", textwrap.dedent(SCRIPT), engine], check=True, stdout=subprocess.PIPE,
                          text=True)
    lines = done.stdout.splitlines()
    assert "takes" in lines[0] and lines[0].endswith(", and what is known only at run time, which could not be had")
    line = kernels.slower.__code__.co_firstlineno + 3
    assert lines[-1] == f'  help: checkpoint={{"line {line}": 50}} keeps snapshots in place of the tape'


@ENGINES
def test_a_number_of_steps_that_floats_decide_is_foreseen(engine, small):
    f = differentiate(kernels.until, engine=engine, wrt="u")
    gradient(f)(U, 1.0, 2.0)
    for end in (1e6, 3e6):
        with pytest.raises(S2sadError, match="S410"):
            gradient(f)(U, 1.0, end)


def test_what_the_kernel_itself_cannot_have_is_its_own_error():
    def hungry(u):
        w = np.zeros(10 ** 15)
        w[0] = u[0] * u[0]
        return w[0]
    with pytest.raises(MemoryError):
        gradient(differentiate(hungry, engine="numpy"))(U)


# -- what the system says ---------------------------------------------------------------------------------------------

@pytest.mark.parametrize(("groups", "files", "expected"), [
    ("0::/", {}, 3 * 1024.0), ("0::/a/b", {"a/memory.max": "2048"}, 2048.0),
    ("0::/a/b", {"a/memory.max": "max", "a/b/memory.max": "1000"}, 1000.0),
    ("4:memory:/x", {"memory/x/memory.limit_in_bytes": "500"}, 500.0),
    ("3:cpu:/x", {"memory/x/memory.limit_in_bytes": "500"}, 3 * 1024.0)])
def test_the_least_limit(groups, files, expected, tmp_path, monkeypatch):
    (tmp_path / "proc" / "self").mkdir(parents=True)
    (tmp_path / "proc" / "meminfo").write_text("MemTotal: 2 kB\nMemFree: 1 kB\nSwapTotal: 1 kB\n")
    (tmp_path / "proc" / "self" / "cgroup").write_text(groups + "\n")
    for name, content in files.items():
        place = tmp_path / "groups" / name
        place.parent.mkdir(parents=True, exist_ok=True)
        place.write_text(content + "\n")
    monkeypatch.setattr(machine_memory, "PROC", tmp_path / "proc")
    monkeypatch.setattr(machine_memory, "GROUPS", tmp_path / "groups")
    assert machine_memory.most_memory() == expected


def test_where_nobody_says(tmp_path, monkeypatch):
    monkeypatch.setattr(machine_memory, "PROC", tmp_path)
    monkeypatch.setattr(machine_memory, "_own_limits", lambda: iter(()))
    assert machine_memory.most_memory() == float("inf")
