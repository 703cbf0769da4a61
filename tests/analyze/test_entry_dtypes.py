"""Which integers take less on the tape, and that nothing else changes by it."""
from __future__ import annotations

import re
import sys
from types import FunctionType

import numpy as np
import pytest

import s2sad
from tests.corpus.recording.narrow_integers import NARROW, WIDE, cases
from tests.harness.engines import running
from tests.harness.seeds import generator, seeded

ARGUMENTS = {case.kernel: case.arguments for case in cases()}
INTEGER = re.compile(r"(\w+_stack\w*) = np\.empty\(.*, np\.(int\d+)\)")


def integer_stacks(kernel, arguments, **options):
    """The dtypes of the stacks of integers in the text for NumPy."""
    text = s2sad.differentiate(kernel, engine="numpy", **options).adjoint_source(*arguments)
    return [dtype for _, dtype in INTEGER.findall(text)]


@pytest.fixture
def unnarrowed(monkeypatch):
    """Lets integers be recorded as they are, from when it is called."""
    monkeypatch.setenv("S2SAD_CACHE_SIZE", "0")

    def use():
        module = sys.modules["s2sad.analyze.tape_entries.entry_dtypes"]
        monkeypatch.setattr(module, "integer_ranges", lambda structure, plan: {})
    return use


def anew(kernel):
    """The kernel as another function, of which nothing has been derived yet."""
    return FunctionType(kernel.__code__, kernel.__globals__, kernel.__name__)


@pytest.mark.parametrize("kernel", NARROW, ids=lambda k: k.__name__)
def test_what_is_proven_is_narrow(kernel):
    found = integer_stacks(kernel, ARGUMENTS[kernel], memory="fastest")
    assert found
    assert set(found) == {NARROW[kernel]}


@pytest.mark.parametrize("kernel", WIDE, ids=lambda k: k.__name__)
def test_what_is_not_proven_is_as_it_was(kernel):
    assert set(integer_stacks(kernel, ARGUMENTS[kernel], memory="fastest")) == {"int64"}


@pytest.mark.parametrize("engine", ["numpy", "loops"])
@pytest.mark.parametrize("case", list(cases()), ids=lambda c: c.kernel.__name__)
def test_gradients_have_the_same_bits(case, engine, unnarrowed):
    found = []
    for _ in range(2):
        with running(engine) as name:
            f = s2sad.differentiate(anew(case.kernel), engine=name, memory="fastest")
            found.append(s2sad.gradient(f, wrt="x")(*case.arguments))
        unnarrowed()
    assert np.array_equal(*found)


def test_memory_says_what_is_recorded(unnarrowed):
    kernel, said = next(iter(NARROW)), []
    for _ in range(2):
        f = s2sad.differentiate(anew(kernel), engine="numpy", memory="fastest")
        said.append((f.adjoint.memory(*ARGUMENTS[kernel]).tape, str(s2sad.explain(f, *ARGUMENTS[kernel]))))
        unnarrowed()
    assert said[1][0] - said[0][0] == 7 * 40
    assert "state_stack: 40 bytes" in said[0][1]
    assert "state_stack: 320 bytes" in said[1][1]


def integer_program(random):
    """A kernel that carries integers through choices, sums, products, quotients and remainders."""
    def term():
        chosen = random.integers(4)
        return f"{'abc'[random.integers(3)]}" if chosen < 2 else str(random.choice([-130, -3, 0, 1, 2, 5, 126, 127])) \
            if chosen == 2 else "i"

    def value():
        kind = random.integers(6)
        return [f"{term()} + {term()}", f"{term()} - {term()}", f"({term()} + {term()}) % {random.integers(2, 300)}",
                f"min({term()}, {random.integers(0, 200)})", f"max({term()}, {random.integers(-200, 9)})",
                f"{term()} * {random.integers(-2, 3)}"][kind]
    lines = ["import numpy as np", "", "", "def f(x, n: int):", "    a, b, c, y = 0, 1, 2, 0.4",
             "    for i in range(n):",
             "        y = np.sin(1.3 * y + x[(a + b) % x.size] + 1e-3 * (a % 1000) + 1e-3 * (c % 1000))"]
    for _ in range(random.integers(1, 5)):
        test = [f"y > {random.random():.2f}", f"{term()} < {random.integers(-9, 130)}"][random.integers(2)]
        name = "abc"[random.integers(3)]
        lines += [f"        if {test}:", f"            {name} = {value()}"]
        if random.integers(2):
            lines += ["        else:", f"            {name} = {value()}"]
    return "\n".join([*lines, "    return y", ""])


def test_generated_programs_have_the_same_bits(tmp_path, unnarrowed):
    texts = [integer_program(generator(seeded(k))) for k in range(40)]
    x, found, texts_found = generator(8).random(5), [], []
    for _ in range(2):
        each = []
        for number, text in enumerate(texts):
            path = tmp_path / f"program_{number}.py"
            path.write_text(text)
            space: dict = {}
            exec(compile(text, str(path), "exec"), space)
            f = s2sad.differentiate(space["f"], engine="numpy", memory="fastest")
            each.append(s2sad.gradient(f, wrt="x")(x, 30))
            texts_found.append(f.adjoint_source(x, 30))
        found.append(each)
        unnarrowed()
    narrow = [INTEGER.search(t) is not None and "np.int64(" in t for t in texts_found]
    assert sum(narrow[:40]) > 5
    assert not any(narrow[40:])
    assert all(np.array_equal(a, b) for a, b in zip(*found))
