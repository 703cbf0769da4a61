"""Reading: names get their meaning, live and from a file alike; every refusal has its exact text."""
from __future__ import annotations

import pytest

from s2sad import read
from s2sad.diagnostics import S2sadError

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
    ("x.shape = (2, 3)", "x.shape", "S201", f"an assignment to the attribute .shape {NO}",
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


# -- files that import each other, and constants without bounds --------------------------------------------------------


# -- functions that have no source ------------------------------------------------------------------------------------


# -- what is read -----------------------------------------------------------------------------------------------------
