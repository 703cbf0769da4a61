"""Generated text as files and modules, compiled with Numba, its arguments checked."""
from __future__ import annotations

import multiprocessing
import os
import subprocess
import sys
import traceback

import numpy as np
import pytest

from s2sad.diagnostics import S2sadError
from s2sad.run import compiled as engine
from s2sad.run.module_loader import load
from s2sad.run.special_functions import used
from s2sad.run.overlap import Check, Slot, overlap

TEXT = "def double(x):\n    return 2.0 * x\n"


@pytest.fixture(autouse=True)
def cache(tmp_path, monkeypatch):
    monkeypatch.setenv("S2SAD_CACHE_DIR", str(tmp_path / "cache"))
    for name in [n for n in sys.modules if n.startswith("s2sad_")]:
        monkeypatch.delitem(sys.modules, name)
    return tmp_path / "cache"


def forget(module):
    del sys.modules[module.__name__]


def test_special_functions_are_found_beside_arrays():
    """Whatever else the process has imported: an array of the module is not compared with SciPy's."""
    import scipy.special

    def called(x):
        return special.j0(x)  # noqa: F821
    assert used({"TABLE": np.arange(3.0), "special": scipy.special, "called": called}) == ["j0"]
    assert used({"TABLE": np.arange(3.0), "called": called}) == []


def test_text_becomes_a_module_with_a_real_file(cache):
    module = load(TEXT, "double")
    assert module.double(3.0) == 6.0
    assert open(module.__file__).read() == TEXT
    assert module.__file__.startswith(str(cache))
    assert load(TEXT, "double") is module
    assert load(TEXT + "\n", "double") is not module
    assert load(TEXT, "double", "other").__file__ != module.__file__


def test_guards_stay_without_assertions(cache):
    """The guards of generated text are assertions, which `python -O` leaves out of other modules."""
    program = ("from s2sad.run.module_loader import load\n"
               "try:\n    load('def f(x):\\n    assert x > 0\\n', 'f').f(-1)\n"
               "except AssertionError:\n    print('guarded')")
    done = subprocess.run([sys.executable, "-O", "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout == "guarded\n"


def test_an_intact_file_is_not_written_and_a_damaged_one_is_written_again():
    module = load(TEXT, "double")
    number = os.stat(module.__file__).st_ino
    forget(module)
    load(TEXT, "double")
    assert os.stat(module.__file__).st_ino == number
    with open(module.__file__, "w") as file:
        file.write(TEXT[:10])
    forget(module)
    assert load(TEXT, "double").double(3.0) == 6.0
    assert open(module.__file__).read() == TEXT


def test_tracebacks_show_the_generated_line():
    module = load("def fails(x):\n    return x / 0  # here\n", "fails")
    with pytest.raises(ZeroDivisionError) as caught:
        module.fails(1)
    assert "return x / 0  # here" in "".join(traceback.format_exception(caught.value))


def test_a_text_that_fails_leaves_no_module():
    before = set(sys.modules)
    with pytest.raises(NameError):
        load("nothing_of_the_sort\n", "fails")
    assert {n for n in set(sys.modules) - before if n.startswith("s2sad_")} == set()


def _concurrently(number):
    return load(TEXT, "double").double(float(number))


def test_processes_may_write_the_same_file_at_once(cache):
    with multiprocessing.get_context("fork").Pool(4) as pool:
        assert pool.map(_concurrently, range(16)) == [2.0 * k for k in range(16)]
    assert not [f for _, _, files in os.walk(cache) for f in files if f.endswith(".part")]


def test_functions_and_runtime_functions_are_compiled():
    pytest.importorskip("numba")
    text = "import numpy as np\n\n\ndef inner(x):\n    return 1.0 / x\n\n\ndef outer(x):\n    return inner(x[0])\n"
    module = engine.compiled(text, "outer")
    engine.prepare(module.outer, (np.zeros(1),), "'outer'")
    assert module.outer(np.zeros(1)) == np.inf
    assert engine.compiled(text, "outer") is module
    assert module.inner.targetoptions["error_model"] == engine.error_model()


def test_bounds_checks_on_request(monkeypatch):
    pytest.importorskip("numba")
    text = "def last(x, k):\n    return x[k]\n"
    with pytest.raises(IndexError):
        engine.compiled(text, "last", bounds=True).last(np.zeros(3), 7)
    monkeypatch.setenv("S2SAD_BOUNDSCHECK", "1")
    with pytest.raises(IndexError):
        engine.compiled(text, "last").last(np.zeros(3), 7)


def test_what_numba_cannot_compile_is_an_internal_error():
    pytest.importorskip("numba")
    module = engine.compiled("def odd(x):\n    return x.nothing\n", "odd")
    with pytest.raises(S2sadError, match="internal error: Numba cannot compile 'odd'"):
        engine.prepare(module.odd, (np.zeros(1),), "'odd'")


def test_numba_absent(monkeypatch):
    monkeypatch.setattr(engine, "available", lambda: False)
    assert engine.chosen("auto") == "numpy"
    with pytest.raises(S2sadError) as caught:
        engine.chosen("numba")
    assert str(caught.value) == ('error[S405]: engine="numba" needs Numba, which is not installed\n'
                                 '  help: pip install "s2sad[jit]", or use engine="auto"')
    with pytest.raises(S2sadError, match="there is no engine 'cuda'"):
        engine.chosen("cuda")


SLOTS = [Slot("a", "primal", "a", False), Slot("a_bar", "shadow", "a", True),
         Slot("b", "primal", "b", False), Slot("b_bar", "shadow", "b", True)]
ENGINES = ["numpy", "numba"]


@pytest.fixture(params=ENGINES)
def check(request):
    if request.param == "numba":
        pytest.importorskip("numba")
    made = Check(SLOTS, request.param)
    for _ in range(20):
        made([np.zeros(1), np.zeros(1), np.zeros(1), np.zeros(1)])
    assert (made.quick is not None) == (request.param == "numba")
    return made


def test_arrays_that_lie_apart_pass(check):
    assert check([np.zeros(3), np.zeros(3), np.zeros((2, 2)), np.zeros((2, 2))]) == ()
    memory = np.zeros((4, 2))
    assert check([memory[:, 0], memory[:, 1], memory[::-1, 0], np.zeros(4)]) == ()
    assert check([np.zeros(0)] * 4) == ()


def test_shapes_and_overlaps_are_refused(check):
    a, b = np.zeros(3), np.zeros(3)
    with pytest.raises(S2sadError) as caught:
        check([a, np.zeros(4), b, np.zeros(3)])
    assert str(caught.value) == ("error[S403]: the shadow 'a_bar' has shape (4,), its primal 'a' has (3,)\n"
                                 "  help: make one with s2sad.make_zero(a)")
    with pytest.raises(S2sadError) as caught:
        check([a, a, b, np.zeros(3)])
    assert str(caught.value) == ("error[S404]: the argument 'a' and the shadow 'a_bar' share memory\n"
                                 "  help: give each shadow memory of its own: s2sad.make_zero(x)")
    shared = np.zeros(3)
    with pytest.raises(S2sadError, match="the shadow 'a_bar' and the shadow 'b_bar' share memory"):
        check([a, shared, b, shared[::-1]])
    assert check([a, shared, a, shared]) == (3,)


def test_written_primals_must_not_overlap():
    slots = [Slot("a", "primal", "a", True), Slot("b", "primal", "b", False)]
    memory = np.zeros(5)
    with pytest.raises(S2sadError) as caught:
        Check(slots, "numpy")([memory[1:], memory[:-1]])
    assert str(caught.value) == ("error[S404]: the arguments 'a' and 'b' share memory, and 'a' is written\n"
                                 "  help: pass a copy of one of them")
    assert Check([SLOTS[0], SLOTS[2]], "numpy")([memory[1:], memory[:-1]]) == ()


def test_overlap_is_exact():
    memory = np.zeros(10)
    assert not overlap(memory[::2], memory[1::2])
    assert overlap(memory[::2], memory[::3])
