"""Ctrl-C is heard in compiled code, and where it would be passed over."""
from __future__ import annotations

import signal
import subprocess
import sys

import pytest

from s2sad.run.interrupts import interruptible


@pytest.fixture(autouse=True)
def heard():
    """A shell's background jobs, and what they start, ignore Ctrl-C."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def test_an_interrupt_is_heard_where_it_is_passed_over():
    with pytest.raises(KeyboardInterrupt):
        with interruptible():
            try:
                signal.raise_signal(signal.SIGINT)
            except KeyboardInterrupt:
                pass        # as a callback does


def test_an_interrupt_is_heard_where_it_becomes_another_error():
    with pytest.raises(KeyboardInterrupt):
        with interruptible():
            try:
                signal.raise_signal(signal.SIGINT)
            except KeyboardInterrupt:
                raise RuntimeError("cannot be compiled") from None
    with pytest.raises(RuntimeError), interruptible():
        raise RuntimeError("cannot be compiled")
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


PROGRAM = """
import numpy as np, s2sad
from tests.run.test_interrupts import rounds
f = s2sad.differentiate(rounds, engine="numba")
u, u_bar = np.ones(100), np.zeros(100)
s2sad.gradient(f, "u")(u, 1), f.adjoint(u, u_bar, 1, 1.0)
try:
    print("ready", flush=True)
    while True:
        {call}
except BaseException as error:
    print(type(error).__name__, flush=True)
"""


def rounds(u, n):
    s = 0.0
    for _ in range(n):
        for i in range(u.size):
            s += u[i] ** 2 * 1e-9
        u[0] = 0.5 * s
    return s


@pytest.mark.parametrize("call", ['s2sad.gradient(f, "u")(u, 300000)', "f.adjoint(u, u_bar, 300000, 1.0)",
                                  "f.primal(u, 3000000)"])
def test_ctrl_c_in_compiled_code(call):
    with subprocess.Popen([sys.executable, "-c", PROGRAM.format(call=call)], stdout=subprocess.PIPE, text=True
                          ) as process:
        try:
            assert process.stdout is not None
            assert process.stdout.readline() == "ready\n"
            process.send_signal(signal.SIGINT)
            assert process.communicate(timeout=60)[0] == "KeyboardInterrupt\n"
        finally:
            process.kill()      # it runs for ever if it has not heard
