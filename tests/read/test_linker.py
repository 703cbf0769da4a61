"""What names mean, live and from a file alike: callees, modules beside, constants, closures."""
from __future__ import annotations

import builtins
import importlib.util
import inspect
import math
import types

import numpy as np
import pytest

from benchmarks.kernels import brusselator, loops
from s2sad import read, tree
from tests.read.test_supported_subset import printed, refusal, write


def imported(path):
    spec = importlib.util.spec_from_file_location(path.stem, path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def packaged(tmp_path, **files):
    """The names of a package's files with their texts; gives the path of `kern.py`."""
    (tmp_path / "pkg").mkdir()
    for name, text in files.items():
        (tmp_path / "pkg" / f"{name}.py").write_text(text)
    return tmp_path / "pkg" / "kern.py"


@pytest.mark.parametrize("files", [
    {"__init__": "from . import helpers\n", "helpers": "from pkg import kern\ndef h(x):\n    return x * x\n",
     "kern": "from . import helpers\ndef f(x):\n    return helpers.h(x)\n"},
    {"__init__": "from .kern import f\nfrom .helpers import h\n", "helpers": "def h(x):\n    return x * x\n",
     "kern": "from pkg import h\ndef f(x):\n    return h(x)\n"},
    {"__init__": "from .kern import *\n", "helpers": "from .kern import f, G\ndef h(x):\n    return G * x\n",
     "kern": "from .helpers import h\nG = 2.0\ndef f(x):\n    return h(x)\n"},
    {"helpers": "from . import kern\ndef h(x):\n    return kern.G * x\n",          # without __init__
     "kern": "from . import helpers\nG = 2.0\ndef f(x):\n    return helpers.h(x)\n"},
])
def test_files_that_import_each_other(tmp_path, files):
    assert [k.partition("_")[0] for k in read.load_file(packaged(tmp_path, **files), "f").kernels] == ["h", "f"]


def test_names_that_are_imported_in_a_circle_mean_nothing(tmp_path):
    path = packaged(tmp_path, __init__="", helpers="from .kern import g\n",
                    kern="from .helpers import g\ndef f(x):\n    return g(x)\n")
    assert "'g' cannot be used in a kernel: it is not in the module" in refusal(read.load_file, path, "f")


@pytest.mark.parametrize("text", [
    "10 ** 10 ** 10", "1 << 10 ** 12", "round(5, -10 ** 10)", "np.power(2 ** 100, 10 ** 9)", "3 ** 2000 * 3 ** 2000",
    "np.left_shift(2 ** 62, 10 ** 12) * 2 ** 4000", "0x1" + "0" * 2000, "-(1 << 4095) - (1 << 4095) - 1"])
def test_constants_are_computed_in_bounded_time_and_memory(tmp_path, text):
    path = write(tmp_path, f"import numpy as np\nN = {text}\ndef f(x):\n    return N * x\n")
    assert "'N' cannot be used in a kernel" in refusal(read.load_file, path, "f")


def test_constants_that_grow_and_grow(tmp_path):
    path = write(tmp_path, "N = 3\n" + "N = N * N\n" * 60 + "def f(x):\n    return N * x\n")
    assert "'N' cannot be used in a kernel: it is not constant arithmetic" in refusal(read.load_file, path, "f")
    path = write(tmp_path, f"def f(x):\n    return 0x1{'0' * 2000} * x\n")
    assert "error[S201]: an integer of more than 4096 bits is not supported in a kernel" in refusal(
        read.load_file, path, "f")
    path = write(tmp_path, "N = 2 ** 4000 // 2 ** 3990\nM = 10 ** -400\ndef f(x):\n    return (N + M) * x\n")
    assert read.load_file(path, "f").constants == {"N": 1024, "M": 0.0}


@pytest.mark.parametrize("module", [brusselator, loops], ids=lambda m: m.__name__)
def test_reference_kernels_both_ways(module):
    for name, function in inspect.getmembers(module, inspect.isfunction):
        live, still = read.load(function), read.load_file(module.__file__, name)
        assert live.entry == still.entry == list(live.kernels)[-1] == name
        assert list(live.kernels) == list(still.kernels)
        for key, kernel in live.kernels.items():
            assert tree.equal(kernel.tree, still.kernels[key].tree)
            assert kernel.parameters == still.kernels[key].parameters == tuple(inspect.signature(getattr(
                module, key)).parameters)


def test_callees_come_first():
    assert list(read.load(brusselator.integrate).kernels) == ["limit", "forcing", "brusselator", "integrate"]


def names(program, kernel=None):
    nodes = tree.walk(program.kernels[kernel or program.entry].tree.body)
    return sorted({n.id for n in nodes if isinstance(n, tree.Name)})


BOTH = """import math
import numpy as np
import numpy.linalg as la
from math import *
from numpy import exp as e
from numba import prange, njit
import numba
G = 9.81
K = 2 * G
ROOT = math.sqrt(4.0) * np.pi
A, B = 1, True
NAME = "max"

@njit(cache=True)
def limit(a: "float64[:, :]", b: float = G, *, c=-1, d=None):
    "Docstring."
    return a

def f(x, seed=2.5, /, np_=None):
    for i in prange(3):
        for j in numba.prange(3):
            pass
    abs = seed
    y: float = e(x) + la.det(x) + pi + tau + sqrt(2.0) + np.pi + np.linalg.norm(x) + limit(x, b=2)
    z: int
    if A and B:
        raise ValueError("no")
    return G + K + ROOT + abs + x.shape[0] + x.copy().sum() + np.zeros(3, dtype=float).size + len(NAME)
"""


def test_resolved_names_both_ways(tmp_path):
    pytest.importorskip("numba")
    path = write(tmp_path, BOTH, "both.py")
    module = imported(path)
    live, still = read.load(module.f), read.load_file(path, "f")
    wanted = ["abs", "builtins.ValueError", "builtins.float", "builtins.len", "builtins.range", "const.A", "const.B",
              "const.G", "const.K", "const.ROOT", "i", "j", "math.pi", "math.sqrt", "math.tau", "numpy.exp",
              "numpy.linalg.det", "numpy.linalg.norm", "numpy.pi", "numpy.zeros", "seed", "user.limit", "x", "y"]
    assert names(live) == names(still) == wanted
    assert live.constants == still.constants == {
        "A": 1, "B": True, "G": 9.81, "K": 19.62, "ROOT": 2.0 * math.pi}
    for program in (live, still):
        assert program.kernels["f"].defaults == {"seed": 2.5, "np_": None}
        assert program.kernels["limit"].defaults == {"b": 9.81, "c": -1, "d": None}
        assert program.kernels["limit"].annotations == {"a": "float64[:, :]", "b": "float"}
        assert program.kernels["limit"].parameters == ("a", "b", "c", "d")
        assert all(n.lineno for k in program.kernels.values() for n in k.tree.body)


def test_locals_shadow(tmp_path):
    text = ("import numpy as np\nG = 1.0\ndef helper(x): return x\n"
            "def f(x, np):\n    G = np\n    helper = G\n    for abs in range(3):\n        G += abs\n"
            "    return helper\n")
    program = read.load_file(write(tmp_path, text), "f")
    assert names(program) == ["G", "abs", "builtins.range", "helper", "np"]
    assert program.constants == {} and list(program.kernels) == ["f"]


def test_modules_beside_are_read_without_running(tmp_path):
    text = "print('run!')\nraise SystemExit\nG = 1.5\ndef f(x): return x * G\ndef g(x): return f(x)\n"
    write(tmp_path, text, "beside.py")
    write(tmp_path, "from ..pack import deep as d\nG = 2.5\ndef f(x): return d.h(x) + G\n", "pack/__init__.py")
    write(tmp_path, "def h(x): return x\n", "pack/deep.py")
    text = ("import beside\nimport pack\nimport pack.deep\nfrom beside import g as gg\nfrom beside import *\n"
            "def main(x):\n    return beside.f(x) + pack.f(x) + gg(x) + pack.deep.h(x) + beside.G + pack.G\n")
    program = read.load_file(write(tmp_path, text), "main")
    assert list(program.kernels) == ["f", "h", "f_", "g", "main"]
    assert program.constants == {"G": 1.5, "G_": 2.5}
    assert names(program, "f_") == ["const.G_", "user.h", "x"]
    wrong = write(tmp_path, "from beside import nothing\ndef f(x):\n    return nothing(x)\n")
    assert refusal(read.load_file, wrong, "f") == printed(
        wrong, 3, "    return nothing(x)", "nothing", "S201",
        "'nothing' cannot be used in a kernel: it is not in the module 'beside'", "correct the import")


def test_optional_numba_and_imports_in_circles(tmp_path):
    write(tmp_path, "import kernel\ndef g(x): return x * kernel.G\n", "beside.py")
    text = ("try:\n    from numba import prange\nexcept ImportError:\n    prange = range\nimport beside\nG = 2\n"
            "def f(x):\n    for i in prange(2):\n        x[i] = beside.g(x[i])\n")
    program = read.load_file(write(tmp_path, text), "f")
    assert list(program.kernels) == ["g", "f"]
    assert "builtins.range" in names(program)


def make(scale, table):
    def inner(x):
        return scale * x + table[0]
    return inner


def test_closures_and_names_that_differ():
    one, two = make(2.0, np.arange(2.0)), make(3.0, np.arange(3.0))

    def both(x):
        return one(x) + two(x) + scale.shape[0]
    scale = np.ones(2)
    program = read.load(both)
    assert list(program.kernels) == ["inner", "inner_", "both"]
    assert program.constants == {"scale_": 2.0, "scale__": 3.0}
    assert sorted(a.size for a in program.arrays.values()) == [2, 2, 3]


def test_a_name_never_means_a_local(tmp_path):
    write(tmp_path, "def limit(x): return x\n", "beside.py")
    text = "import beside\ndef f(x):\n    limit = 2.0\n    return beside.limit(x) * limit\n"
    program = read.load_file(write(tmp_path, text), "f")
    assert list(program.kernels) == ["limit_", "f"]
    assert names(program) == ["limit", "user.limit_", "x"]


def test_wrapped_kernels():
    wrapper = types.SimpleNamespace(__wrapped_kernel__=loops.minmod)
    dispatcher = types.SimpleNamespace(py_func=loops.minmod)
    assert read.load(wrapper).entry == read.load(dispatcher).entry == "minmod"
    numba = pytest.importorskip("numba")
    assert read.load(numba.njit(loops.advect)).entry == "advect"


def test_asserts_in_a_test_file():
    def guarded(x, n):
        assert n > 0, "positive"
        return x * n
    assert read.load(guarded).entry == "guarded"


def test_live_values_that_a_kernel_cannot_use(tmp_path):
    text = ("import numpy as np\nlist_ = [1, 'a']\ntext = np.array(['a'])\n"
            "class C:\n    a = 1\nobject_ = C()\n"
            "def f(x):\n    return list_[0] + text[0] + C() + object_ + object_.a + x\n")
    found = refusal(read.load, imported(write(tmp_path, text)).f)
    messages = [line.split(": ", 1)[1] for line in found.splitlines() if "error[" in line]
    assert messages == [f"error[S201]: {m}" for m in (
        "'list_' cannot be used in a kernel: it is a list", "'text' cannot be used in a kernel: it is an array of <U1",
        "'C' cannot be used in a kernel: it is a class", "'object_' cannot be used in a kernel: it is a C")]


def test_huge_constants_do_not_hang(tmp_path):
    path = write(tmp_path, "BIG = 9 ** 9 ** 9\nBAD = 1 / 0\ndef f(x):\n    return x * BIG + BAD\n")
    assert refusal(read.load_file, path, "f").count("it is not constant arithmetic") == 2


def test_built_in_names_are_current():
    assert all(hasattr(builtins, word) for word in read.outside_values.BUILTIN_CALLS)
