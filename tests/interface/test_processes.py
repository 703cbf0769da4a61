"""What s2sad has seen and what it gives goes to other processes: pickled, forked, spawned."""
from __future__ import annotations

import copy
import functools
import gc
import multiprocessing
import os
import pickle
import signal
import subprocess
import sys
import threading
import weakref

import numpy as np
import pytest

import s2sad
from s2sad.dispatch.cache import derivatives_of
from s2sad.program import Recording
from s2sad.run.compiler_lock import COMPILER_LOCK
from tests.harness.documents import environment


def square(x):
    return x * x


def norm(u, k):
    return k * np.sum(u * u)


@s2sad.differentiate(wrt="u", engine="numpy")
def energy(u, k):
    return k * np.sum(u * u)


@s2sad.value_and_gradient
def cube(x):
    return x ** 3


class Spring:
    def __init__(self, k):
        self.k = k

    @s2sad.differentiate(engine="numpy")
    def pull(self, x):
        return self.k * x * x

    def push(self, x):
        return self.k * x


MADE = {
    "a gradient": (s2sad.gradient(norm, "u"), (np.ones(2), 0.5), [1.0, 1.0]),
    "a gradient of a decorated function": (s2sad.gradient(energy), (np.ones(2), 0.5), [1.0, 1.0]),
    "a value and a gradient": (s2sad.value_and_gradient(square), (3.0,), (9.0, 6.0)),
    "a differentiated function": (s2sad.differentiate(square), (3.0,), 9.0),
    "a decorated function": (energy, (np.ones(2), 0.5), 1.0),
    "a driver as a decorator": (cube, (2.0,), (8.0, 12.0)),
    "a decorated method": (Spring.pull, (Spring(2.0), 3.0), 18.0),
    "a gradient of a method": (s2sad.gradient(Spring(2.0).push), (3.0,), 2.0),
    "a gradient of a partial": (s2sad.gradient(functools.partial(norm, k=0.5)), (np.ones(2),), [1.0, 1.0]),
}


@pytest.mark.parametrize("title", MADE)
@pytest.mark.parametrize("protocol", range(2, pickle.HIGHEST_PROTOCOL + 1))
def test_pickled(title, protocol):
    made, args, gives = MADE[title]
    made(*args)
    found = pickle.loads(pickle.dumps(made, protocol))
    np.testing.assert_allclose(found(*args), gives)
    assert type(found) is type(made)


@pytest.mark.parametrize("title", MADE)
def test_pickled_by_its_content(title, monkeypatch):
    cloudpickle = pytest.importorskip("cloudpickle")
    made, args, gives = MADE[title]
    for method in ("pull", "push"):     # reading it again binds them anew in the class that is here
        monkeypatch.setattr(Spring, method, vars(Spring)[method])
    made(*args)
    cloudpickle.register_pickle_by_value(sys.modules[__name__])
    try:
        text = cloudpickle.dumps(made)
    finally:
        cloudpickle.unregister_pickle_by_value(sys.modules[__name__])
    found = cloudpickle.loads(text)
    np.testing.assert_allclose(found(*args), gives)
    assert found is not made


@pytest.mark.parametrize("title", MADE)
def test_copied(title):
    made, args, gives = MADE[title]
    for copied in (copy.copy(made), copy.deepcopy(made)):
        np.testing.assert_allclose(copied(*args), gives)


def test_what_stands_under_a_name_is_that_again():
    assert pickle.loads(pickle.dumps(energy)) is energy and copy.deepcopy(energy) is energy
    assert pickle.loads(pickle.dumps(cube)) is cube
    assert pickle.loads(pickle.dumps(Spring.pull)) is Spring.pull
    again = pickle.loads(pickle.dumps(s2sad.differentiate(norm, wrt="u", of="return", engine="numpy",
                                                          checkpoint={"k": 3})))
    assert again.__s2sad_selection__ == (("u",), ("return",), "numpy", Recording((("k", s2sad.Snapshots(3)),)))
    assert again.__name__ == "norm"


def test_a_lambda_has_no_name_to_be_pickled_by():
    with pytest.raises((pickle.PicklingError, AttributeError)):
        pickle.dumps(s2sad.gradient(lambda x: x * x))
    cloudpickle = pytest.importorskip("cloudpickle")
    k = 3.0
    assert cloudpickle.loads(cloudpickle.dumps(s2sad.gradient(s2sad.differentiate(lambda x: k * x))))(2.0) == 3.0


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


@pytest.mark.usefixtures("own_garbage")
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


NOTEBOOK = """
import numpy as np, s2sad

def twice(x):
    return k * x

class Spring:
    def pull(self, x):
        return twice(x) * x

@s2sad.differentiate(engine="numpy")
def energy(x):
    return spring.pull(x)

k, spring = 2.0, Spring()
made = [s2sad.gradient(energy), s2sad.value_and_gradient(lambda x: twice(x) ** 2)]
"""


def test_what_a_notebook_defines_goes_to_a_process_that_has_no_source_of_it():
    pytest.importorskip("cloudpickle")
    process = [sys.executable, "-c", "import sys, pickle; print(*[f(3.0) for f in pickle.load(sys.stdin.buffer)])"]
    notebook = f"""if True:
        import linecache, subprocess, cloudpickle
        text = {NOTEBOOK!r}
        linecache.cache["<cell 1>"] = len(text), None, text.splitlines(keepends=True), "<cell 1>"
        exec(compile(text, "<cell 1>", "exec"))
        subprocess.run({process!r}, input=cloudpickle.dumps(made), check=True)
    """
    done = subprocess.run([sys.executable, "-c", notebook], capture_output=True, text=True, env=environment(),
                          check=False)
    assert (done.stdout, done.returncode) == ("12.0 (36.0, 24.0)\n", 0), done.stderr


def test_spawned_processes():
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        assert pool.map(s2sad.gradient(square), [1.0, 2.0]) == [2.0, 4.0]
        assert pool.apply(cube, (2.0,)) == (8.0, 12.0)


def test_workers_of_joblib():
    joblib = pytest.importorskip("joblib")
    k = 3.0
    found = joblib.Parallel(n_jobs=2)(joblib.delayed(s2sad.gradient(lambda x: k * x * x))(x) for x in (1.0, 2.0))
    assert found == [6.0, 12.0]
