"""Random kernels: `kernels()` for Hypothesis, `random_kernel(seed)` for bulk runs, from one generator.

A program is source text with its arguments, what to differentiate, and nothing else: it ends, raises nothing, and its
values stay between about -2 and 2 (running sums excepted). `load` writes it to a file and imports it, as the
compiler wants to read source.

>>> program = random_kernel(3)
>>> function = program.load()
>>> arguments = program.arguments()
>>> _ = function(*arguments)
"""
from __future__ import annotations

import hashlib
import importlib.util
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from hypothesis import strategies as st

from tests.programs.expressions import Choices, Scope
from tests.programs.loops import Writer

_FOLDER: list[tempfile.TemporaryDirectory] = []
HEAD = "import math\n\nimport numpy as np\n\nG = 0.37\n\n"
SHAPES = {"vector": lambda n: (n,), "three": lambda n: (3,), "matrix": lambda n: (n, 3)}


@dataclass(frozen=True)
class Program:
    """A kernel's text, its name, its arguments' kinds by name, and what to differentiate."""
    source: str
    name: str
    parameters: tuple[tuple[str, str], ...]
    wrt: tuple[str, ...]
    of: tuple[str, ...]
    seed: int = 0
    n: int = 4
    dtype: str = "float64"

    def load(self) -> Callable:
        """The function, imported from a real file."""
        if not _FOLDER:
            _FOLDER.append(tempfile.TemporaryDirectory(prefix="kernels_"))
        stem = "kernel_" + hashlib.sha256(self.source.encode()).hexdigest()[:16]
        path = Path(_FOLDER[0].name) / f"{stem}.py"
        path.write_text(self.source)
        spec = importlib.util.spec_from_file_location(stem, path)
        module = importlib.util.module_from_spec(spec)
        sys.modules[stem] = module
        spec.loader.exec_module(module)
        return getattr(module, self.name)

    def arguments(self) -> tuple:
        """Fresh arguments, the same at every call."""
        rng = np.random.default_rng(self.seed)
        return tuple(self._argument(kind, rng) for _, kind in self.parameters)

    def _argument(self, kind: str, rng: np.random.Generator) -> object:
        if kind in SHAPES:
            return rng.uniform(-1.5, 1.5, SHAPES[kind](self.n)).astype(self.dtype)
        if kind == "positions":
            return rng.integers(0, self.n, self.n)
        if kind == "flags":
            return rng.random(self.n) < 0.5
        return float(rng.uniform(-1.2, 1.2)) if kind == "float" else int(rng.integers(2, 4))

    def with_source(self, source: str) -> Program:
        return replace(self, source=source)


# -- helpers --------------------------------------------------------------------------------------------------------
def _pure(choices: Choices, name: str, earlier: list[str], without: frozenset[str]) -> list[str]:
    """A helper from two numbers to one, sometimes with an early return."""
    writer = Writer(choices, Scope(floats=["a", "b"]), without)
    writer.pure, writer.sizes = list(earlier), ["3"]
    if choices.chance(40):
        writer.write(f"if {writer.condition()}:")
        writer.write(f"    return {writer.tame(1)}")
    writer.statements(0, choices.integer(0, 2))
    writer.write(f"return {writer.tame(2)}")
    return [f"def {name}(a, b):", *writer.lines]


def _pair(choices: Choices, name: str, earlier: list[str], without: frozenset[str]) -> list[str]:
    writer = Writer(choices, Scope(floats=["a", "b"]), without)
    writer.pure, writer.sizes = list(earlier), ["3"]
    writer.statements(0, choices.integer(0, 2))
    writer.write(f"return {writer.tame(1)}, {writer.tame(1)}")
    return [f"def {name}(a, b):", *writer.lines]


def _mutator(choices: Choices, name: str, arrays: int, earlier: list[str], without: frozenset[str],
             whole: bool, returns: bool = False) -> list[str]:
    """A helper that writes its first array, and returns an element of it if asked; called with one array twice, both
    names are the same memory."""
    vectors = {"u": "n", "v": "n"} if arrays == 2 else {"u": "n"}
    scope = Scope(floats=["a"], vectors=dict(vectors), frozen={"v"})
    writer = Writer(choices, scope, without | {"trips", "result"})
    writer.pure = list(earlier)
    writer.arrays, writer.least = whole, 3
    writer.budget = 6
    writer.write("n = u.shape[0]")
    writer.statements(1, choices.integer(1, 3))
    writer.store()
    if returns:
        writer.write(f"return u[{writer.index('n')}]")
    return [f"def {name}({', '.join(vectors)}, a):", *writer.lines]


def _maker(choices: Choices, name: str, earlier: list[str], without: frozenset[str]) -> list[str]:
    """A helper that returns a new array of the shape of its first; sometimes it writes it element by element."""
    writer = Writer(choices, Scope(floats=["a"], vectors={"u": "n"}, frozen={"u"}), without | {"trips", "result"})
    writer.pure, writer.arrays, writer.least, writer.budget = list(earlier), True, 3, 5
    writer.write("n = u.shape[0]")
    writer.statements(0, choices.integer(0, 2))
    if choices.chance(50):
        writer.write(f"r = np.{choices.pick(['zeros', 'empty'])}_like(u)")
        writer.write("for e in range(n):")
        writer.scope.ints["e"] = "n"
        writer.write(f"    r[e] = {writer.tame(2)}")
        writer.write("return r")
    else:
        writer.write(f"return {writer.new_values(('n',))}")
    return [f"def {name}(u, a):", *writer.lines]


def _helpers(choices: Choices, writer: Writer, without: frozenset[str]) -> list[str]:
    """The text of some helpers; the writer is told what it may call."""
    lines: list[str] = []
    for k in range(choices.integer(0, 2)):
        lines += [*_pure(choices, f"pure{k}", writer.pure, without), "", ""]
        writer.pure.append(f"pure{k}")
    if choices.chance(30):
        lines += [*_pair(choices, "pair0", writer.pure, without), "", ""]
        writer.pairs.append("pair0")
    for k in range(choices.integer(0, 2)):
        arrays = choices.integer(1, 2)
        lines += [*_mutator(choices, f"change{k}", arrays, writer.pure, without, writer.arrays), "", ""]
        writer.mutators.append((f"change{k}", arrays))
    if choices.chance(25):
        lines += [*_mutator(choices, "turn0", 1, writer.pure, without, writer.arrays, returns=True), "", ""]
        writer.returning = ["turn0"]
    if writer.arrays:
        for k in range(choices.integer(0, 2)):
            lines += [*_maker(choices, f"make{k}", writer.pure, without), "", ""]
            writer.makers = [*writer.makers, f"make{k}"]
    return lines


# -- the kernel -----------------------------------------------------------------------------------------------------
def _parameters(choices: Choices) -> list[tuple[str, str]]:
    found = [("x", "vector")]
    for name, kind, percent in (("y", "vector", 60), ("m", "matrix", 50), ("q", "three", 30), ("acc", "vector", 30),
                                ("c", "float", 60), ("d", "float", 25), ("where", "positions", 30),
                                ("mask", "flags", 20)):
        if choices.chance(percent):
            found.append((name, kind))
    return [*found, ("steps", "int")]


def _scope(parameters: list[tuple[str, str]]) -> Scope:
    scope = Scope(ints={"steps": None}, frozen={"steps"})
    for name, kind in parameters:
        if name == "acc":
            scope.wide_vectors[name] = "n"
        elif kind in ("vector", "three"):
            scope.vectors[name] = "n" if kind == "vector" else "3"
        elif kind != "int":
            {"matrix": scope.matrices, "float": scope.floats, "positions": scope.positions,
             "flags": scope.flags}[kind].append(name)
    return scope


def _results(writer: Writer, count: int) -> str:
    """What is returned: nothing, or floats."""
    return ", ".join(writer.tame(1) for _ in range(count))


def generate(choices: Choices, without: frozenset[str] = frozenset()) -> Program:
    """One program, decided by the choices."""
    parameters = _parameters(choices)
    count = choices.integer(0, 2)
    writer = Writer(choices, _scope(parameters), without)
    writer.arrays = "arrays" not in without and choices.chance(50)
    writer.given = frozenset(name for name, _ in parameters)
    helpers = _helpers(choices, writer, without)
    writer.results = lambda: _results(writer, count)
    writer.budget = choices.integer(4, 26)
    writer.write(choices.pick(["n = x.shape[0]", "n = len(x)", "n = x.size", "n, = x.shape"]))
    if choices.chance(35):
        writer.accumulate()
    writer.statements(3, choices.integer(2, 7))
    if count == 0:
        writer.write(f"{writer.marked('x')}[{writer.index('n')}] = {writer.tame(1)}")
    else:
        writer.write(f"return {_results(writer, count)}")
    arrays = [name for name, kind in parameters if kind in SHAPES]
    floats = [name for name, kind in parameters if kind == "float"]
    wrt = tuple(n for n in arrays + floats if n == "x" or choices.chance(80))
    of = tuple(n for n in arrays if n in writer.written and (not count or choices.chance(85)))
    of += ("return",) if count else ()
    lines = [*helpers, f"def kernel({', '.join(name for name, _ in parameters)}):", *writer.lines]
    return Program(HEAD + "\n" + "\n".join(lines) + "\n", "kernel", tuple(parameters), wrt, of,
                   seed=choices.integer(0, 999), n=choices.pick([4, 5, 6] if writer.arrays else [4, 3, 5]),
                   dtype="float32" if "float32" not in without and choices.chance(6) else "float64")


def random_kernel(seed: int, without: frozenset[str] = frozenset()) -> Program:
    """The program with this number; `without` leaves out features, see `loops.FEATURES`."""
    return generate(Choices.seeded(seed), without)


@st.composite
def kernels(draw: Callable, without: frozenset[str] = frozenset()) -> Program:
    """A Hypothesis strategy of programs."""
    return generate(Choices(lambda low, high: draw(st.integers(low, high))), without)
