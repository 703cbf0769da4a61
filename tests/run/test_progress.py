"""What takes long says so, and what a kernel asks for in vain is warned of."""
from __future__ import annotations

import logging
import sys
import time
import warnings

import numpy as np
import pytest

import s2sad
from s2sad import S2sadWarning, diagnostics, differentiate, gradient
from s2sad.run import progress
from s2sad.run.progress import Working
from s2sad.run import compiled


@pytest.fixture(autouse=True)
def quick(monkeypatch):
    monkeypatch.delenv("S2SAD_VERBOSE", raising=False)
    monkeypatch.setattr(progress, "_PATIENCE", 0.02)


def work(seconds=0.2):
    with Working("compiling 'f'", of=3) as working:
        working.step("helper")
        working.step("f_adjoint")
        time.sleep(seconds)


def test_what_takes_long_says_so(capsys):
    work()
    first, last = capsys.readouterr().err.splitlines()
    assert first == "s2sad: compiling 'f' (2 of 3: f_adjoint) ..." and last.startswith("s2sad: compiling 'f': 0.")


def test_what_is_quick_says_nothing(capsys, monkeypatch):
    monkeypatch.setattr(progress, "_PATIENCE", 5.0)
    work(0.0)
    assert capsys.readouterr() == ("", "")
    monkeypatch.setenv("S2SAD_VERBOSE", "1")
    work(0.0)
    assert capsys.readouterr().err.startswith("s2sad: compiling 'f': 0.0 s")


def test_silence(capsys, monkeypatch):
    monkeypatch.setenv("S2SAD_VERBOSE", "0")
    work()
    assert capsys.readouterr() == ("", "")


def test_a_process_without_stderr(monkeypatch):
    monkeypatch.setattr(sys, "stderr", None)
    work()


def test_the_logger_is_told(caplog):
    with caplog.at_level(logging.DEBUG, "s2sad"):
        assert gradient(differentiate(lambda x: x * x, engine="numpy"))(3.0) == 6.0
        work(0.0)
    told = [r.getMessage() for r in caplog.records if r.name == "s2sad"]
    assert [t for t in told if t.startswith("deriving the adjoint of 'function': ")]
    assert "compiling 'f' (2 of 3: f_adjoint)" in told


def test_functions_are_counted_while_they_are_compiled(caplog):
    pytest.importorskip("numba")

    def helper(x):
        for i in range(x.size):
            x[i] = x[i] * x[i]

    def loss(x):
        helper(x)
        return np.sum(x)
    with caplog.at_level(logging.DEBUG, "s2sad"):
        gradient(differentiate(loss, engine="numba"))(np.ones(2))
    assert [r for r in caplog.records if r.name == "s2sad" and " of " in r.getMessage()]


def test_the_engine_that_runs(monkeypatch):
    assert differentiate(lambda x: x, engine="numpy").engine == "numpy"
    monkeypatch.setattr(compiled, "available", lambda: False)
    f = differentiate(lambda x: x * x)
    diagnostics.warn_once.cache_clear()
    with pytest.warns(S2sadWarning) as caught:
        assert f.engine == "numpy" and gradient(f)(3.0) == 6.0
    assert [str(w.message) for w in caught] == [
        'Numba is not installed, so engine="auto" runs derivatives in the interpreter, where loops over elements are '
        'some hundred times slower: pip install "s2sad[jit]", or say engine="numpy"']
    assert caught[0].filename == __file__
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert gradient(differentiate(lambda x: x * x * x))(2.0) == 12.0


def test_what_derivatives_leave_out_is_warned_of_once():
    numba = pytest.importorskip("numba")
    prange = numba.prange

    def loss(x):
        total = 0.0
        for i in prange(x.size):
            total += x[i] * x[i]
            print("total", total)
        return total
    with pytest.warns(S2sadWarning) as caught:
        gradient(differentiate(loss, engine="numpy"))(np.ones(2))
    first = loss.__code__.co_firstlineno
    assert [str(w.message) for w in caught] == [
        f"{__file__}:{first + 2}:18: warning[S201]: derivatives run this loop one iteration after the other\n"
        f"  {first + 2} |         for i in prange(x.size):\n"
        "      |                  ^^^^^^^^^^^^^^\n  help: range says the same",
        f"{__file__}:{first + 4}:13: warning[S201]: derivatives do not print this\n"
        f"  {first + 4} |             print(\"total\", total)\n"
        "      |             ^^^^^^^^^^^^^^^^^^^^^\n"
        "  help: call the kernel itself, or autodiff with the primal, to see it"]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        s2sad.vjp(differentiate(loss, engine="numpy"), (np.ones(2),), {"return": 1.0})
