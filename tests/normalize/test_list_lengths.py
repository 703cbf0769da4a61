"""Indices of lists whose length the run knows: random programs that append, take out and read compute what Python
computes, or raise where it raises."""
from __future__ import annotations

from random import Random

import numpy as np
import pytest

import s2sad
from tests.harness.engines import running
from tests.harness.kernel_files import kernel_file

ITEMS = ("x[{k} % 4]", "x[0] * s", "np.sin(x[{k} % 4])", "{us}[{at}] * x[1]")
PLACES = ("0", "1", "3", "-1", "-2", "{k}", "{k} - 1", "{k} + 1", "len({us}) - 1", "n - 1 - {k}", "n - 1", "{k} - 2")
TESTS = ("{us}", "len({us}) > 1", "not {us}", "len({us}) >= 3 and {us}[2] > 0.4", "x[{k} % 4] > 0.5", "len({us}) < 2",
         "len({us}) == 0 or {us}[-1] > 0.6", "2 < len({us})", "len({us}) != 0")
LOOPS = ("range(n)", "range(3)", "range(len({us}))", "range(1, len({us}))", "range(len({us}) - 1)", "range(1, n)",
         "range(min(len({us}), 3))", "range(len({us}) - 2)")
LEAVING = ("continue", "break")


def room_of_another(x, n):
    us, vs, t, s = [], [], 0.0, 0.0
    while t < n:
        us.append(x[0] * t)
        t += 1.0
    for k in range(len(us)):
        vs.append(us[k] ** 2)
    for k in range(n + 1):
        s += vs[k]
    return s


def items_of_another(x, n):
    us, t = [], 0.0
    while t < n:
        us.append(x[0] * t)
        t += 1.0
    vs = [u ** 2 for u in us]
    return vs[n - 1] + vs[n]


def minus_zero(x, n):
    us = []
    for k in range(n):
        if x[k] > 0.3:
            us.append(x[k] ** 2)
    return us[-0] + us[0]


def popped_beside_the_test(x, n):
    us, s = [x[0], x[1], x[2]], 0.0
    for k in range(n):
        us.append(x[k] * 0.1)
    while us[2] < 100.0:
        s += us.pop() ** 2
    return s


def columns(x, n):
    ts, s = [], 0.0
    for k in range(n):
        if x[k] > 0.4:
            ts.append((x[k], x[k] ** 2, k))
    for i in range(len(ts)):
        a, b, c = ts[i]
        s += a * b * c
    for i in range(len(ts) - 1):
        s += ts[i + 1][0] - ts[i][1]
    return s + ts[2][1] + ts[-1][0] + ts[n - 2][1]


def columns_that_are_none(x, n):
    us, vs, s = [], [], 0.0
    for k in range(n):
        us.append(x[k])
        if x[k] > 0.4:
            vs.append(x[k])
    for i in range(len(us)):
        s += vs[i] * us[i]
    return s


def shorter_since(x, n):
    us, vs, s = [], [], 0.0
    for k in range(n):
        if x[k] > 0.4:
            us.append(x[k])
            vs.append(x[k] ** 2)
    vs.pop()
    for i in range(len(us)):
        s += vs[i]
    return s


WRITTEN = (room_of_another, items_of_another, minus_zero, popped_beside_the_test, columns, columns_that_are_none,
           shorter_since)


class Writer:
    """Writes statements at random."""

    def __init__(self, rng):
        self.rng, self.lines, self.deep = rng, [], 0

    def filled(self, text, counter):
        us = self.rng.choice(("us", "us", "vs"))
        place = self.rng.choice(PLACES).format(us=us, k=counter)
        return text.format(us=us, k=counter, at=place)

    def block(self, indent, counter, length, looped=False):
        for _ in range(length):
            self.statement(indent, counter, looped)

    def statement(self, indent, counter, looped):
        rng = self.rng
        kinds = ("append", "read", "store", "pop", "clear", "if", "for", "leave")
        kind = rng.choices(kinds, (5, 6, 1, 0.7, 0.2, 2, 3, 1))[0]
        if kind in ("if", "for") and len(indent) > 8:
            kind = "read"
        if kind == "append":
            self.lines.append(indent + self.filled("{us}.append(" + rng.choice(ITEMS) + ")", counter))
        elif kind == "read":
            self.lines.append(indent + self.filled("s += {us}[{at}]", counter))
        elif kind == "store":
            self.lines.append(indent + self.filled("{us}[{at}] = s * 0.5; s += {us}[{at}]", counter))
        elif kind == "pop":
            self.lines.append(indent + self.filled(rng.choice(("s += {us}.pop()", "s += {us}.pop(0)")), counter))
        elif kind == "clear":
            self.lines.append(indent + self.filled("{us}.clear()", counter))
        elif kind == "if":
            self.lines.append(indent + self.filled(f"if {rng.choice(TESTS)}:", counter))
            self.block(indent + "    ", counter, rng.randint(1, 2), looped)
            if rng.random() < 0.3:
                self.lines.append(f"{indent}else:")
                self.block(indent + "    ", counter, 1, looped)
        elif kind == "for":
            inner = f"k{len(indent) // 4}"
            self.lines.append(indent + self.filled(f"for {inner} in {rng.choice(LOOPS)}:", counter))
            self.block(indent + "    ", inner, rng.randint(1, 3), True)
        elif not looped:
            self.lines.append(indent + "s *= 1.1")
        else:
            test = self.filled(f"if {rng.choice(TESTS)}:", counter)
            self.lines += [indent + test, f"{indent}    {rng.choice(LEAVING)}"]


def written(rng):
    """The lines of a kernel."""
    writer = Writer(rng)
    writer.lines += [f"us = {rng.choice(('[]', '[x[0]]', '[x[1], x[2]]'))}", "vs = []", "for k in range(n):"]
    for listed, place in (("us", "k"), ("vs", "(k + 1)")):
        test = rng.choice(("", "", f"if x[{place} % 4] > 0.5: "))
        writer.lines.append(f"    {test}{listed}.append(x[{place} % 4] * 1.5)")
        if rng.random() < 0.5:
            writer.statement("    ", "k", True)
    writer.lines.append("m = len(us)")
    writer.block("", "n", rng.randint(1, 5))
    if rng.random() < 0.3:
        writer.lines += ["for i in range(m):", "    s += us[i] * us[i - 1]"]
    return writer.lines


def loaded(path, lines):
    return kernel_file(path, "f(x, n)", ["s = 0.3", *lines], "s + x[0] * len(us) + sum(us) + sum(vs)")


def value_of(function, *arguments):
    try:
        return function(*arguments)
    except IndexError:
        return None


def compare(f, derivative, n):
    """Asserts that a derivative is that of the kernel, or raises as it does."""
    x, v = np.array([0.71, 0.43, 0.62, 0.18]), np.array([0.3, -0.8, 0.5, 1.1])
    wanted, found = value_of(f, x, n), value_of(derivative, x, n)
    assert (wanted is None) == (found is None)
    if found is None:
        return
    assert np.isclose(found[0], wanted, rtol=1e-10)

    def slope(h):
        return (f(x + h * v, n) - f(x - h * v, n)) / (2 * h)
    expected = (4 * slope(5e-5) - slope(1e-4)) / 3
    assert np.isclose(found[1] @ v, expected, rtol=1e-6, atol=1e-7)


@pytest.mark.parametrize("seed", range(60))
def test_items_that_are_there(seed, tmp_path):
    f = loaded(tmp_path / "kernel.py", written(Random(seed)))
    with running("loops" if seed % 4 == 0 else "numpy") as engine:
        derivative = s2sad.value_and_gradient(s2sad.differentiate(f, engine=engine), "x")
        try:
            derivative(np.ones(4), 4)
        except IndexError:
            pass
        except s2sad.S2sadError as error:
            assert "and no item" in str(error) or "the method 'pop' of a list" in str(error)    # noqa: PT017
            return
        for n in (4, 0, 1, 2, 3):
            compare(f, derivative, n)


@pytest.mark.parametrize("engine_name", ("numpy", "loops"))
@pytest.mark.parametrize("kernel", WRITTEN)
def test_written(kernel, engine_name):
    with running(engine_name) as engine:
        derivative = s2sad.value_and_gradient(s2sad.differentiate(kernel, engine=engine), "x")
        for n in (4, 0, 1, 2, 3):
            compare(kernel, derivative, n)
