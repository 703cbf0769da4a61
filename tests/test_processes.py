"""What s2sad has seen and what it gives goes to other processes: pickled, forked, spawned."""
from __future__ import annotations

import copy
import functools
import gc
import os
import pickle
import signal
import threading
import weakref

import pytest

import s2sad
from s2sad.compiler_lock import COMPILER_LOCK
from s2sad.variants import derivatives_of


def square(x):
    return x * x


def test_a_function_is_pickled_and_copied_as_it_was():
    s2sad.gradient(square)(3.0)
    assert pickle.loads(pickle.dumps(square)) is square
    assert pickle.loads(pickle.dumps(vars(square))) == {"__s2sad__": {}}
    assert copy.deepcopy(square) is square


def test_what_was_derived_of_a_function_is_not_its_copy_s():
    def double(x):
        return 2.0 * x

    assert s2sad.gradient(double)(1.0) == 2.0

    def triple(x):
        return 3.0 * x

    functools.update_wrapper(triple, double)
    del triple.__wrapped__
    assert s2sad.gradient(triple)(1.0) == 3.0


def test_a_dead_function_frees_what_was_derived_of_it():
    def power(x, n):
        return 1.0 if n == 0 else x * x

    assert s2sad.gradient(power, "x")(3.0, 2) == 6.0
    refers = weakref.ref(power), weakref.ref(derivatives_of(power))
    del power
    gc.collect()
    assert [r() for r in refers] == [None, None]


@pytest.mark.skipif(not hasattr(os, "fork"), reason="processes are not forked here")
def test_a_process_forked_while_a_derivative_is_made_makes_its_own():
    begun, go_on = threading.Event(), threading.Event()

    def hold():
        with COMPILER_LOCK:
            begun.set()
            go_on.wait(10)

    thread = threading.Thread(target=hold)
    thread.start()
    begun.wait(10)
    threading.Timer(0.2, go_on.set).start()
    child = os.fork()
    if child == 0:
        signal.alarm(60)                # a child that waits for ever fails
        found = s2sad.gradient(s2sad.differentiate(square, engine="numpy"))(3.0)
        os._exit(0 if found == 6.0 else 1)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
    thread.join()
    assert COMPILER_LOCK.acquire(blocking=False)
    COMPILER_LOCK.release()
