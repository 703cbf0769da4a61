"""Reading: names get their meaning, live and from a file alike; every refusal has its exact text."""
from __future__ import annotations

import builtins
import importlib.util
import inspect
import linecache
import math
import os
import subprocess
import sys
import types

import numpy as np
import pytest

from s2sad import read, tree
from s2sad.diagnostics import S2sadError
from benchmarks.kernels import brusselator, loops

NO = "is not supported in a kernel"
STRINGS = "write a plain string; print takes several values: print('step', i)"
STATE = "return the new value, or keep it in an element of an array argument"
ASYNC_FOR = "write a plain function with plain loops"
YIELD = "write the values to an array argument, one element for each yield"
FILL = "allocate an array before and fill it in a for loop"
TRY = "test for the bad case with an if before it happens; errors that are raised pass through"
ATTRIBUTE = "return the value, or write it to an element of an array argument"
BY_NAME = "call a function of the module by its name"
AT_MODULE = "pass it to the kernel as an argument, or write it at module level as a plain number"
WHERE_NEEDED = "call it where it is needed"

HEAD = """import functools
import math
import subprocess
import sys
import numpy as np
import scipy.special as special
G = 9.81
NAMES = ["a", "b"]
COMPLEX = 1e999j
TEXT = "abc"
if G > 1.0:
    MAYBE = 1.0
def other(x):
    return x
"""

# statement; what the caret marks; code; message; help
REFUSED = [
    ("try: x[0] = 1\n    finally: pass", "try: x[0] = 1", "S201", f"try {NO}", TRY),
    ("with x: pass", "with x: pass", "S201", f"with {NO}",
     "open and lock outside the kernel, and give it the arrays as arguments"),
    ("yield x", "yield x", "S201", f"yield {NO}", YIELD),
    ("yield from x", "yield from x", "S201", f"yield from {NO}", YIELD),
    ("y = [lambda t: t]", "lambda t: t", "S201", f"lambda {NO}",
     "give it a name and call it by that, give it to a call of a function, or write one with def"),
    ("def inner(q): return q\n    y = inner", "def inner(q): return q", "S201", f"a nested function {NO}",
     "define it once, outside of loops and branches, and call it or give it to a call; or write it at module level"),
    ("class C: pass", "class C: pass", "S201", f"a class {NO}",
     "pass what it would hold as arguments, numbers and arrays"),
    ("global G", "global G", "S201", f"global {NO}", STATE),
    ("del x[0]", "del x[0]", "S201", f"del {NO}", "leave the line out: local arrays are freed when the kernel returns"),
    ("for i in range(3): import os", "import os", "S201",
     f"an import in a branch or loop, or of a name that is bound twice {NO}",
     "move the import to the top of the function or of the module"),
    ("from os import path\n    path = 1", "from os import path", "S201",
     f"an import in a branch or loop, or of a name that is bound twice {NO}",
     "move the import to the top of the function or of the module"),
    ("match x:\n        case 1: pass", "match x:", "S201", f"match {NO}", "write if, elif and else"),
    ("y = {i for i in x}", "{i for i in x}", "S201", f"a set comprehension {NO}", FILL),
    ("y = {i: i for i in x}", "{i: i for i in x}", "S201", f"a dict comprehension {NO}", FILL),
    ("y = {1: 2}", "{1: 2}", "S201", f"a dict {NO}", "use one name, or one array element, for each value"),
    ("y = {1, 2}", "{1, 2}", "S201", f"a set {NO}", "use an array, or compare with each value in turn"),
    ("y = f'{x}'", "f'{x}'", "S201", f"an f-string {NO}", STRINGS),
    ("y = '%d' % x", "'%d' % x", "S201", f"arithmetic on strings {NO}", STRINGS),
    ("y = '{}'.format(x)", "'{}'.format", "S201", f"a method of a string {NO}", STRINGS),
    ("print('abc'[0])", "'abc'[0]", "S201", f"a subscript of a string {NO}", STRINGS),
    ("print(TEXT.upper())", "TEXT.upper", "S201", f"a method of a string {NO}", "write the string out"),
    ("print(b'a')", "b'a'", "S201", f"a bytes string {NO}", "use an array of integers"),
    ("y = n + (n := 3)", "n := 3", "S201", f"an assignment inside an expression (:=) {NO}",
     "write the assignment as a statement of its own before"),
    ("p, *q = x; p = q", "*q", "S201", f"a target with a star {NO}",
     "bind the others one by one, and take the rest by a slice: rest = x[1:]"),
    ("other(*x)", "*x", "S201", f"a starred expression {NO}", "write the elements out, one by one"),
    ("other(**x)", "x", "S201", f"** in a call {NO}", "write the keyword arguments out"),
    ("x.shape = (2, 3)", "x.shape", "S201", f"an assignment to the attribute x.shape {NO}",
     "bind the new shape to a new name: y = x.reshape(...)"),
    ("y = COMPLEX", "COMPLEX", "S201", "'COMPLEX' cannot be used in a kernel: it is a complex number that is not "
     "finite, or of 64 bits", "make it in the kernel"),
    ("if x is G: pass", "x is G", "S201", f"'is' {NO}", "compare values: =="),
    ("if x is not G: pass", "x is not G", "S201", f"'is not' {NO}", "compare values: !="),
    ("if 1 in x: pass", "1 in x", "S201", f"'in' {NO}", "write the comparisons out: x == a or x == b"),
    ("if 1 not in x: pass", "1 not in x", "S201", f"'not in' {NO}", "write the comparisons out: x != a and x != b"),
    ("y = special.ellipk(x)", "special.ellipk", "S201", "'special.ellipk' is not a function that s2sad can read",
     'write it with numpy and math, or give its derivative: s2sad.rule("scipy.special.ellipk(x)", x=...)'),
    ("y = open(x)", "open", "S201", f"the built-in 'open' {NO}",
     "these are: abs, all, any, bool, complex, divmod, enumerate, float, int, isinstance, len, max, min, pow, print, "
     "range, reversed, round, slice, sum, zip"),
    ("y = x(1)", "x(1)", "S201", f"a call through the variable 'x' {NO}", BY_NAME),
    ("y = x[0](1)", "x[0](1)", "S201", f"a call of what an expression gives {NO}", BY_NAME),
    ("y = G(1)", "G", "S201", "'G' is a number, not a function", "correct the name, or subscript with []"),
    ("y = np.pi(1)", "np.pi", "S201", "'np.pi' is a number, not a function", "correct the name"),
    ("y = other", "other", "S201", f"the function 'other' as a value {NO}", WHERE_NEEDED),
    ("y = np.sin", "np.sin", "S201", f"the function 'np.sin' as a value {NO}", WHERE_NEEDED),
    ("y = abs", "abs", "S201", f"the function 'abs' as a value {NO}", WHERE_NEEDED),
    ("y = np", "np", "S201", f"the module 'np' as a value {NO}", "name what is in it"),
    ("y = other.cache", "other.cache", "S201", f"an attribute of the function 'other' {NO}",
     "call the function itself"),
    ("y = MAYBE", "MAYBE", "S201", "'MAYBE' cannot be used in a kernel: it is set under a condition, in a loop or by "
     "more than an assignment", AT_MODULE),
    ("y = NAMES[0]", "NAMES", "S201", "'NAMES' cannot be used in a kernel: it is not constant arithmetic, and the file "
     "is read without being run", AT_MODULE),
    ("y = lenght * 2", "lenght", "S202", "the name 'lenght' is not known",
     "give it a value in the kernel, define it at module level, or pass it as an argument"),
    ("y = othr(x)", "othr", "S202", "the name 'othr' is not known", "did you mean 'other'?"),
    ("y = np.expp(x)", "np.expp", "S202", "'np' has no 'expp'", "did you mean 'np.exp'?"),
    ("y = math.zzzz(x)", "math.zzzz", "S202", "'math' has no 'zzzz'", "define it in 'math', or correct the name"),
    ("y = 'é', lenght", "lenght", "S202", "the name 'lenght' is not known",
     "give it a value in the kernel, define it at module level, or pass it as an argument"),
]


def write(folder, text, name="kernel.py"):
    path = folder / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")
    return path


def imported(path):
    spec = importlib.util.spec_from_file_location(path.stem, path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def refusal(call, *args):
    with pytest.raises(S2sadError) as caught:
        call(*args)
    return str(caught.value)


def printed(path, line_number, line, marked, code, message, help):
    column = line.index(marked) if not (marked == "x" and "**x" in line) else line.index("**x") + 2
    gutter = f"  {line_number} | "
    return (f"{path}:{line_number}:{column + 1}: error[{code}]: {message}\n{gutter}{line}\n"
            f"{' ' * (len(gutter) - 2)}| {' ' * column}{'^' * len(marked)}\n  help: {help}")


@pytest.mark.parametrize(("statement", "marked", "code", "message", "help"), REFUSED, ids=[r[0] for r in REFUSED])
def test_refused(tmp_path, statement, marked, code, message, help):
    text = f"{HEAD}def f(x):\n    {statement}\n"
    path = write(tmp_path, text)
    number = HEAD.count("\n") + 2
    line = text.splitlines()[number - 1]
    assert refusal(read.load_file, path, "f") == printed(path, number, line, marked, code, message, help)


@pytest.mark.parametrize(("header", "marked", "message", "help"), [
    ("def f(x, *rest):", "rest", f"*rest {NO}", "give each argument a parameter of its own"),
    ("def f(x, **rest):", "rest", f"**rest {NO}", "give each argument a parameter of its own"),
    ("def f(x, y=[1]):", "[1]", "the default of 'y' is not a number, a string or None",
     "write a number, or leave the default out and pass the value"),
    ("def f(x, y=open('z')):", "open('z')", "the default of 'y' is not a number, a string or None",
     "write a number, or leave the default out and pass the value"),
    ("async def f(x):", "async def f(x):", f"async def {NO}", ASYNC_FOR),
])
def test_refused_headers(tmp_path, header, marked, message, help):
    path = write(tmp_path, f"{header}\n    return x\n")
    assert refusal(read.load_file, path, "f") == printed(path, 1, header, marked, "S201", message, help)


def test_await_and_async_inside(tmp_path):
    path = write(tmp_path, "async def f(x):\n    async with x: pass\n    async for i in x: await i\n")
    assert refusal(read.load_file, path, "f").count("error[S201]") == 1


def test_decorators(tmp_path):
    text = ("import functools\nimport numba as nb\nfrom numba import njit\nfrom s2sad import differentiate\n"
            "import s2sad\nfast = njit(cache=True)\n@nb.jit(nopython=True)\n@fast\n@s2sad.differentiate(wrt=('x',))\n"
            "@differentiate\n@njit\ndef f(x): return x\n@functools.lru_cache\ndef g(x): return x\nh = njit(f)\n")
    path = write(tmp_path, text)
    assert read.load_file(path, "f").kernels["f"].tree.decorator_list == []
    assert read.load_file(path, "h").entry == "f"
    assert refusal(read.load_file, path, "g") == printed(
        path, 13, "@functools.lru_cache", "functools.lru_cache", "S201",
        "the decorator @functools.lru_cache is not supported on a kernel",
        "take it off, and wrap the kernel elsewhere under another name; Numba's jit and njit are fine")


def test_all_at_once_in_order(tmp_path):
    path = write(tmp_path, "def g(x):\n    return unknown\ndef f(x):\n    del x[0]\n    return g(x) + {1}\n")
    lines = [line.split(": error")[0] for line in refusal(read.load_file, path, "f").splitlines() if ": error" in line]
    assert lines == [f"{path}:4:5", f"{path}:5:19", f"{path}:2:12"]


def test_recursion(tmp_path):
    text = "def f(x):\n    return f(x - 1)\ndef g(x):\n    return h(x)\ndef h(x):\n    return g(x)\n"
    path = write(tmp_path, text)
    help = "write it as a loop, with a work array for what each level holds"
    assert refusal(read.load_file, path, "f") == (
        f"{path}:2:12: error[S204]: recursion is not supported: f -> f\n"
        f"  2 |     return f(x - 1)\n    |            ^\n  help: {help}")
    assert refusal(read.load_file, path, "g") == (
        f"{path}:6:12: error[S204]: recursion is not supported: g -> h -> g\n"
        f"  6 |     return g(x)\n    |            ^\n  help: {help}")


# -- files that cannot be read ----------------------------------------------------------------------------------------

def test_missing_directory_encoding(tmp_path):
    gone = tmp_path / "gone.py"
    assert refusal(read.load_file, gone, "f") == (
        f"error[S101]: {gone}: no such file\n  help: check the path, which is relative to the working directory")
    assert refusal(read.load_file, tmp_path, "f") == (
        f"error[S101]: {tmp_path}: this is a directory\n  help: give a Python file: kernel.py:function")
    latin = tmp_path / "latin.py"
    latin.write_bytes(b"def f(x):\n    return x\n\n# caf\xe9\n")
    assert refusal(read.load_file, latin, "f") == (
        f"{latin}:4:6: error[S101]: not UTF-8 (byte 0xe9)\n  4 | # caf\ufffd\n    |      ^\n"
        "  help: save the file as UTF-8, or name its encoding in the first line: # -*- coding: latin-1 -*-")
    latin.write_bytes(b"# caf\xe9\n")
    assert refusal(read.load_file, latin, "f") == (
        f"{latin}:1:6: error[S101]: not UTF-8 (byte 0xe9)\n  1 | # caf\ufffd\n    |      ^\n  help: save the file as "
        "UTF-8, or name its encoding in the first line: # -*- coding: latin-1 -*-")
    for first, column in ((b"# coding: klingon", 11), (b"\xef\xbb\xbf# coding: latin-1", 12), (b"# coding: hex", 11)):
        latin.write_bytes(first + b"\ndef f(x):\n    return x\n")
        assert refusal(read.load_file, latin, "f") == printed(
            latin, 1, first.decode(), first.decode()[column - 1:], "S101",
            "an encoding that Python does not read files in", "save the file as UTF-8")
    latin.write_bytes(b"\xef\xbb\xbfdef f(x):\n    return x  # caf\xc3\xa9\n")
    assert read.load_file(latin, "f").entry == "f"
    latin.write_bytes(b"# -*- coding: latin-1 -*-\r\ndef f(x):\r\n    \xe4 = x\r\n    return \xe4\r\n")
    assert read.load_file(latin, "f").entry == "f"
    latin.write_bytes(b"# -*- coding: latin-1 -*-\n# caf\xe9\ndef f(x):\n    return x\n")
    assert read.load_file(latin, "f").entry == "f"


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="POSIX files")
def test_pipes_and_devices_are_not_read(tmp_path):
    os.mkfifo(tmp_path / "pipe.py")
    for path in (tmp_path / "pipe.py", "/dev/zero"):
        assert refusal(read.load_file, path, "f") == (
            f"error[S101]: {path}: this is no file, but a pipe or a device\n"
            "  help: write the text to a file: kernel.py:function")
    (tmp_path / "k.py").write_text("from pipe import g\ndef f(x):\n    return g(x)\n")
    assert "error[S201]" in refusal(read.load_file, tmp_path / "k.py", "f")


# -- files that import each other, and constants without bounds --------------------------------------------------------

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


def test_not_python(tmp_path):
    path = write(tmp_path, "def f(x):\n    return x +* 2\n")
    assert refusal(read.load_file, path, "f") == printed(
        path, 2, "    return x +* 2", "*", "S102", "not Python: invalid syntax",
        "correct the line; the file must be one that Python itself can read")
    path = write(tmp_path, "return 1\n")
    assert refusal(read.load_file, path, "f") == printed(
        path, 1, "return 1", "return 1", "S102", "not Python: 'return' outside function",
        "correct the line; the file must be one that Python itself can read")
    path = write(tmp_path, "x = 1\0\n")
    assert "error[S102]" in refusal(read.load_file, path, "f")


def test_no_such_function(tmp_path):
    path = write(tmp_path, "def limit(a): return a\ndef step(a): return a\nG = 2\n")
    assert refusal(read.load_file, path, "limt") == (
        f"error[S103]: {path}: no function 'limt' at module level\n"
        "  help: did you mean 'limit'? the file defines: limit, step")
    assert refusal(read.load_file, path, "G") == (
        f"error[S103]: {path}: no function 'G' at module level\n  help: the file defines: limit, step")
    assert refusal(read.load_file, write(tmp_path, ""), "f") == (
        f"error[S103]: {path}: no function 'f' at module level\n  help: the file defines no function at module level")


# -- functions that have no source ------------------------------------------------------------------------------------

def test_no_source(tmp_path):
    space = {}
    exec("def made(x):\n    return x\n", space)
    assert refusal(read.load, space["made"]) == (
        "error[S101]: the source of 'made' cannot be had: it was defined in <string>, not in a file\n"
        "  help: write the function to a .py file and import it from there")
    assert refusal(read.load, math.exp) == (
        "error[S101]: 'exp' has no Python source: it is a builtin_function_or_method\n"
        "  help: give a function defined with def in a .py file, which may call it")
    assert refusal(read.load, np.exp) == (
        "error[S101]: 'exp' has no Python source: it is an ufunc\n"
        "  help: give a function defined with def in a .py file, which may call it")
    assert refusal(read.load, 3) == (
        "error[S101]: a function is needed, not an int\n  help: give a function defined with def in a .py file")
    assert refusal(read.load, dict) == (
        "error[S101]: 'dict' is a class, not a function\n  help: give a function defined with def")
    module = imported(write(tmp_path, "class C:\n    def m(self): return 1\nf = [lambda x: x, lambda x: 2 * x]\n"))
    assert read.load(module.C().m).kernels["m"].parameters == ()
    assert refusal(read.load, module.f[0]) == printed(
        module.__file__, 3, "f = [lambda x: x, lambda x: 2 * x]", "lambda x: x", "S101",
        "two lambdas with the same parameters begin in this line", "write it in a line of its own, or with def")


@pytest.mark.parametrize("text", ["", "x = 1\n", "def made(x):\n    return 2 * x\n", "not Python"])
def test_executed_text_is_never_taken_for_the_text_of_a_command(text, monkeypatch):
    """Since Python 3.13 linecache has the text of `python -c` under "<string>", where `exec` puts its functions."""
    monkeypatch.setitem(linecache.cache, "<string>", (len(text), None, text.splitlines(True), "<string>"))
    space = {}
    exec("def made(x):\n    return x\n", space)
    assert refusal(read.load, space["made"]) == (
        "error[S101]: the source of 'made' cannot be had: it was defined in <string>, not in a file\n"
        "  help: write the function to a .py file and import it from there")


def test_function_of_a_command():
    """`python -c` keeps its text since Python 3.13; before, its functions have no source."""
    command = ("from s2sad import S2sadError, read\ndef f(x):\n    return 2.0 * x\n"
               "try:\n    print(read.load(f).entry)\nexcept S2sadError as error:\n    print(error)\n")
    made = subprocess.run([sys.executable, "-c", command], capture_output=True, text=True, check=True)
    expected = "f" if sys.version_info >= (3, 13) else "error[S101]: the source of 'f' cannot be had"
    assert made.stdout.startswith(expected)


def test_helper_without_source_is_shown_at_the_call(tmp_path):
    module = imported(write(tmp_path, "exec('def made(x): return x')\ndef f(x):\n    return made(x)\n"))
    assert refusal(read.load, module.f) == printed(
        module.__file__, 3, "    return made(x)", "made", "S101",
        "the source of 'made' cannot be had: it was defined in <string>, not in a file",
        "write the function to a .py file and import it from there")


def test_file_removed(tmp_path):
    path = write(tmp_path, "def f(x):\n    return x\n")
    module = imported(path)
    path.unlink()
    assert refusal(read.load, module.f) == (
        f"error[S101]: the source of 'f' cannot be had: {path} cannot be read\n"
        "  help: restore the file that the function was imported from")


STALE = "import the module again (importlib.reload, or a new process) and use the function from there"


@pytest.mark.parametrize(("old", "new"), [
    ("return 2.0 * x", "return 3.0 * x"), ("return 2 * x", "return 2.0 * x"), ("return x + y", "return x - y"),
    ("return abs(x)", "return min(x)"), ("z = x\n    return z", "w = x\n    return w"),
    ("return 0.0 * x", "return -0.0 * x"),
    ("g = lambda: 1\n    return g()", "g = lambda: 2\n    return g()"),
])
def test_changed_on_disk(tmp_path, old, new):
    path = write(tmp_path, f"def f(x, y):\n    {old}\n")
    module = imported(path)
    write(tmp_path, f"# a line more, of another length\ndef f(x, y):\n    {new}\n")
    assert refusal(read.load, module.f) == printed(
        path, 2, "def f(x, y):", "f", "S104", "the source of 'f' has changed since the function was defined", STALE
    ).replace("2:3:", "2:5:").replace("  ^\n", "    ^\n")


def test_changed_on_disk_beyond_recognition(tmp_path):
    path = write(tmp_path, "def f(x):\n    return x\n")
    module = imported(path)
    write(tmp_path, "def g(x, y):\n    return x\n")
    text = f"error[S104]: {path}: the source of 'f' has changed since the function was defined\n  help: {STALE}"
    assert refusal(read.load, module.f) == text
    write(tmp_path, "def f(x):\n    return x +* 2 # not Python now\n")
    assert refusal(read.load, module.f) == text


def test_changed_elsewhere_is_no_matter(tmp_path):
    path = write(tmp_path, "def f(x):\n    return 2.0 * x\n")
    module = imported(path)
    write(tmp_path, "def f(x):\n    return 3.0 * x\n\n\ndef g(x):\n    pass\n\n\ndef f(x):\n    return 2.0 * x\n")
    assert read.load(module.f).kernels["f"].tree.lineno == 9


# -- what is read -----------------------------------------------------------------------------------------------------

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
