"""Functions of files that the evaluator computes: their text is that of the live function, and nothing is run."""
from __future__ import annotations

import inspect
import types

import pytest

import s2sad
from s2sad.diagnostics import Diagnostic, S2sadError
from s2sad.dispatch import compiler
from s2sad.live_objects.unwrap import python_function
from tests.corpus import Case
from tests.evaluate import kernels_of_files
from tests.evaluate.objects import plain_python, solvers

CASES = [*(Case(f, (kernels_of_files.X,)) for f in kernels_of_files.FILED), *plain_python.cases(), *(
    c for c in solvers.cases() if inspect.isfunction(c.kernel))]


@pytest.mark.parametrize("case", CASES, ids=lambda c: c.kernel.__name__)
def test_the_text_is_that_of_the_live_function(ran, tmp_path, monkeypatch, case):
    path = tmp_path / "kernels.py"
    path.write_text(inspect.getsource(inspect.getmodule(case.kernel)) + "\nraise SystemExit('this was run')\n")
    x, = case.arguments
    status, text, err = ran("adjoint", f"{path}:{case.kernel.__name__}", "--wrt", "x", "--of", "return", "--types",
                            f"x: float64[{x.size}]")
    assert not status, err
    text = text.replace(f" (assumed: made for x.shape = {x.shape})", "")
    if text != live_text(case):         # a class of a module is read there, and evaluated in a file
        monkeypatch.setattr(compiler, "program", evaluated)
        assert text == live_text(case)


def live_text(case):
    f = case.kernel
    alone = types.FunctionType(f.__code__, f.__globals__, f.__name__, f.__defaults__)     # nothing is known of it yet
    return s2sad.differentiate(alone, wrt="x", of="return", engine="numpy").adjoint_source(*case.arguments)


def evaluated(function, methods=(), varying=()):
    """The program of a function that reading takes, and that is evaluated all the same."""
    return compiler.waiting(python_function(function), S2sadError(Diagnostic("S201", "evaluated here")), varying)


FILE = '''import numpy as np
import pandas as pd
from dataclasses import dataclass
from enum import Enum
from typing import NamedTuple, TypedDict
import helpers
from helpers import Box

open("run.txt", "w").write("this was run")
FRAME = pd.read_csv("table.csv")
NOISE = {"w": np.random.rand(3)}
CHANGED = {"k": 2.0}
CHANGED["k"] = 3.0
GROWN = [1.0]
ALIAS = GROWN
ALIAS.append(2.0)


def fill(d):
    d["k"] = 5.0


def show(d, x):
    return d["k"] * np.sum(x)


FILLED = {"k": 1.0}
fill(FILLED)
SHOWN = {"k": 1.5}
show(SHOWN, np.random.rand(3))
N = 1
BOXES = [Box(N), Box(2.0)]
N = 2


class Kind(Enum):
    ONE = 1

    def twice(self):
        return 2 * self.value


class Odd(metaclass=helpers.Meta):
    pass


class Node:
    left: "Node"
    v: float


@dataclass
class Params:
    k: float
    w: "float64[:]"
    name: str = "sin"


@dataclass
class State:
    p: Params
    u: "float64[:]"
    pair: tuple[float, int]

    def energy(self):
        return self.p.k * np.sum(self.p.w * self.u) * self.pair[0]


class Pair(NamedTuple):
    a: float
    b: "float64[:]"


class Config(TypedDict):
    dt: float
    u: "float64[:]"


class Point:
    def __init__(self, x, n):
        self.x, self.n = x, n

    def total(self):
        parts = {}
        for k in range(self.n):
            parts[k] = self.x * k
        return sum(np.sum(p) for p in parts.values())


def frame(x):
    return x * FRAME["a"]


def noise(x):
    return np.sum(NOISE["w"] * x)


def changed(x):
    return CHANGED["k"] * x


def grown(x):
    return len(GROWN) * x


def filled(x):
    return FILLED["k"] * x


def shown(x):
    return SHOWN["k"] * x


def boxes(x):
    return BOXES[0].lo * x


def kinds(x):
    return Kind.ONE.twice() * x


def odd(x):
    return Odd() is x


def nodes(n: Node):
    return n.v * 2.0


def imported(x):
    return helpers.Box(x).scaled() * helpers.TABLE["a"][1]


def state(s: State):
    return s.energy()


def pair(p: Pair):
    a, b = p
    return a * np.sum(b) * p._replace(a=2.0).a


def config(c: Config):
    return {k: v for k, v in c.items()}["dt"] * np.sum(c["u"])


def point(p: Point):
    return p.total()


def name(p: Params):
    return {"sin": np.sin}[p.name](p.k)


def method(x, method="rk"):
    return {"rk": 2.0}[method] * x


def counted(x, n: int):
    us = {}
    for k in range(n):
        us[k] = x * k
    return sum(us.values())


def spelled(p, x):
    return {"a": lambda y: y * p["k"] * p["g"].scaled()}["a"](x)
'''
HELPERS = '''K = 3.0
TABLE = {"a": [1.0, 2.0]}


class Meta(type):
    pass


class Box:
    def __init__(self, lo):
        self.lo = lo

    def scaled(self):
        return K * self.lo
'''


@pytest.fixture
def of_file(ran, kernel, tmp_path):
    """What the command gives for a function of the file, which it does not run."""
    def run(function, *types):
        kernel(HELPERS, "helpers.py")
        kernel(FILE)
        status, text, err = ran("adjoint", f"k.py:{function}", *types)
        assert not (tmp_path / "run.txt").exists()
        return err if status else text
    return run


@pytest.mark.parametrize(("function", "error"), {
    "frame": "pd.read_csv(\"table.csv\"): 'pandas.read_csv' is not a function that s2sad knows or can read",
    "noise": "np.random.rand: 'np.random.rand' draws random numbers, or begins a sequence of them",
    "changed": "CHANGED[\"k\"]: 'CHANGED' cannot be used in a kernel: it is changed after it was made",
    "grown": "GROWN: 'GROWN' cannot be used in a kernel: it is changed after it was made",
    "filled": "FILLED[\"k\"]: 'FILLED' cannot be used in a kernel: it is given to a function at module level, which "
    "may change it",
    "boxes": "N: 'N' is set more than once, and the file is read without being run",
    "kinds": "class Kind(Enum):: the enumeration 'Kind' has methods, and is not run",
    "odd": "class Meta(type):: a base of 'Meta' is no class of the user's",
}.items())
def test_what_would_have_to_be_run(of_file, function, error):
    first, source, marked, *_ = of_file(function).splitlines()
    begin = marked.index("^")
    assert f"{source[begin:begin + marked.count('^')]}: {first.partition('error[S201]: ')[2]}" == error


def test_what_is_given_and_not_changed(of_file):
    assert "x_bar = SHOWN_k * result_bar" in of_file("shown")
    text = of_file("imported")
    assert "TABLE_a_1 * result_bar" in text and "return K * self.lo" in text


def test_parameters_of_annotated_classes(of_file):
    text = of_file("state")
    assert [line.strip() for line in text.splitlines()[3:10]] == [
        "s_p_k: float64, in", "s_p_w: float64[:], in", "s_p_name: text, in", "s_u: float64[:], in",
        "s_pair_0: float64, in", "s_pair_1: int64, in", ""]
    assert "def pair_adjoint(p_a, p_b, p_b_bar, result_bar):" in of_file("pair")
    assert "def config_adjoint(c_dt, c_u, c_u_bar, result_bar):" in of_file("config")
    assert "n_v_bar = 2.0 * result_bar" in of_file("nodes")


def test_parameters_of_classes_without_annotations(of_file):
    assert of_file("point") == """k.py:148:12: error[S203]: 'p' has parts, whose types are not known
  148 |     return p.total()
      |            ^^^^^^^
  help: say what it is made of, as --types "p: {x: float64, n: float64}"
"""
    assert of_file("point", "--types", "p: {x: float64[:], n: int}") == """\
k.py:85:18: error[S201]: how often a loop runs, of which each round is written out, must be known before the run
  85 |         for k in range(self.n):
     |                  ^^^^^^^^^^^^^
  help: say which 'p.n' is, as --types "p: {n: 3}"
"""
    text = of_file("point", "--types", "p: {x: float64[:], n: 3}")
    assert "p_n: int64, in (assumed: made for p.n = 3)" in text


def test_values_are_said(of_file):
    assert of_file("method") == """k.py:156:12: error[S201]: a key must be known before the run
  156 |     return {"rk": 2.0}[method] * x
      |            ^^^^^^^^^^^^^^^^^^^
  help: say which 'method' is, as --types "method: '...'"
"""
    assert "method: text, in (assumed: made for method = 'rk')" in of_file("method", "--types", "method: 'rk'")
    assert of_file("name").endswith("""help: say which 'p.name' is, as --types "p: {name: '...'}"\n""")
    assert "np.cos(p_k) * result_bar" in of_file("name", "--types", "p: {name: 'sin'}")
    assert of_file("counted").endswith("""help: say which 'n' is, as --types "n: 3"\n""")
    assert "n: int64, in (assumed: made for n = 3)" in of_file("counted", "--types", "n: 3")


def test_objects_are_spelled(of_file):
    text = of_file("spelled", "--types", "p: {k: float, g: Box{lo: float}}")
    assert "def spelled_adjoint(p_k, p_g_lo, x, result_bar):" in text and "return K * self.lo" in text
    assert of_file("spelled", "--types", "p: {k: float, g: {lo: float}}").endswith(
        "help: if it is of a class, annotate it with that, or name it, as in --types \"a: Grid{...}\"\n")
    assert of_file("spelled", "--types", "p: {k: float, g: Bin{lo: float}}") == (
        "error[S405]: --types names the class 'Bin', which 'k.py' does not define or import\n"
        "  help: say what the object is made of alone, in braces\n")
