"""Lists of which only the run knows the length, changed within and ordered: random programs against Python."""
from __future__ import annotations

import bisect
from random import Random

import numpy as np
import pytest

import s2sad
from tests.harness.engines import running
from tests.harness.kernel_files import kernel_file
from tests.normalize.test_list_lengths import ITEMS, Writer, compare, value_of

X = np.array([0.71, 0.43, 0.62, 0.18])
CHANGES = (
    "{us}.insert({at}, x[{k} % 4] * 0.5)", "{us}.insert(0, s * x[1])", "s += {us}.pop({at})", "{us}.reverse()",
    "{us}.sort()", "{us}.sort(reverse=True)", "{us}.sort(key=lambda u: (u - 0.5) ** 2)", "del {us}[{at}]",
    "{us}.remove({us}[{at}])", "for v in sorted({us}): s = 0.5 * s + v",
    "for v in sorted({us}, key=lambda u: -u * x[0], reverse=True): s = 0.4 * s + v",
    "s += max({us}) - min({us}, key=lambda u: (u - 0.7) ** 2) if {us} else 0.1",
)
ROWS = (
    "ps.append((x[{k} % 4], {k}))", "ps.append((s * x[2], 1))", "ps.insert(0, (x[0] * x[{k} % 4], 2))",
    "if len(ps) > 1: a, b = ps.pop(); s += a * b", "if ps: s += ps.pop(0)[0]", "ps.sort()", "ps.reverse()",
    "ps.sort(key=lambda p: p[0])", "ps.sort(key=lambda p: p[1])", "ps.sort(key=lambda p: (-p[1], p[0]), reverse=True)",
    "if ps: s += max(ps)[0] * min(ps)[1]", "if ps: s += max(ps, key=lambda p: p[1])[0]", "s += ps[{at}][0]",
    "for a, b in ps: s += a * (b + 1)", "for j, p in enumerate(sorted(ps, reverse=True)): s += p[0] * j - p[1]",
    "qs = [p for p in ps if p[0] > 0.4]; s += sum(p[0] for p in qs)", "s += sum(p[1] for p in ps)",
)


class Changes(Writer):
    """Writes statements at random that change lists within, and read them in another order."""

    def statement(self, indent, counter, looped):
        chance = self.rng.random()
        if chance < 0.25:
            self.lines.append(indent + self.filled(self.rng.choice(CHANGES), counter))
        elif chance < 0.5:
            self.lines.append(indent + self.filled(self.rng.choice(ROWS), counter))
        else:
            super().statement(indent, counter, looped)


def written(rng):
    """The lines of a kernel."""
    writer = Changes(rng)
    writer.lines += [f"us = {rng.choice(('[]', '[x[0]]', '[x[1], x[2]]'))}", "vs, ps = [], []", "for k in range(n):"]
    writer.lines += ["    us.append(x[k % 4] * 1.5)", f"    if x[k % 4] > 0.5: vs.append({ITEMS[0].format(k='k')})",
                     "    if x[k % 4] > 0.3: ps.append((x[k % 4] * s, k))"]
    for _ in range(rng.randint(1, 2)):
        writer.statement("    ", "k", True)
    writer.lines.append("m = len(us)")
    writer.block("", "n", rng.randint(2, 5))
    return writer.lines


def loaded(path, lines):
    return kernel_file(path, "f(x, n)", ["s = 0.3", *lines], "s + x[0] * len(us) + sum(us) + sum(vs) + sum("
                       "(k + 1) * p[0] * (p[1] + 1) for k, p in enumerate(ps))")


@pytest.mark.parametrize("seed", range(36))
def test_changed_within(seed, tmp_path):
    f = loaded(tmp_path / "kernel.py", written(Random(seed)))
    with running("loops" if seed % 4 == 0 else "numpy") as engine:
        derivative = s2sad.value_and_gradient(s2sad.differentiate(f, engine=engine), "x")
        for n in (4, 0, 1, 2, 3):
            try:
                compare(f, derivative, n)
            except s2sad.S2sadError as error:       # a list whose items are known does not have the item
                assert value_of(f, X, n) is None and "no item" in str(error) or "no such item" in str(error)  # noqa: PT017


def into_what_is_not_in_order(x):
    us = [3.0, 1.0, 2.0]
    for v in x:
        bisect.insort_right(us, v)
        bisect.insort_left(us, 0.7 * v)
    return sum((k + 1) * u for k, u in enumerate(us))


def before_and_behind_equal_ones(x):
    us = [(0.5, 1.0), (1.0, 2.0), (1.0, 3.0)]
    if x[0] > 0.0:
        us.append((2.0, 4.0))
    bisect.insort_left(us, (1.0, x[0]), key=lambda p: p[0])
    bisect.insort(us, (1.0, x[1]), key=lambda p: p[0])
    return sum((k + 1) * p[1] for k, p in enumerate(us))


@pytest.mark.parametrize("engine", ["numpy", "loops"])
@pytest.mark.parametrize("kernel", [into_what_is_not_in_order, before_and_behind_equal_ones])
def test_insort_is_a_search_and_an_insertion(kernel, engine):
    with running(engine) as name:
        value, gradient = s2sad.value_and_gradient(s2sad.differentiate(kernel, engine=name))(X)
    assert value == pytest.approx(kernel(X), rel=1e-14)
    slope = [(kernel(X + h) - kernel(X - h)) / 2e-6 for h in 1e-6 * np.eye(4)]
    np.testing.assert_allclose(gradient, slope, rtol=1e-7)


def by_parts_of_rows(x):
    ps = []
    for k, v in enumerate(x):
        if v > 0.05:
            ps.append((v, k, v * v))
    return x * min(ps, key=lambda p: p[1:])[2]


@pytest.mark.parametrize("engine", ["numpy", "loops"])
def test_arrays_have_no_order(engine):
    """Sorted along an axis they would give the items of other places."""
    with running(engine) as name, pytest.raises(ValueError, match="arrays are ordered: give a key that is a number"):
        s2sad.vjp(s2sad.differentiate(by_parts_of_rows, engine=name), (X,), {"return": np.ones(4)})
