"""Elements and parts of parts of arrays, and unpacking: what Python raises derivatives raise, and what it computes they
compute, for sizes that leave nothing of a part, too."""
from __future__ import annotations

from random import Random

import numpy as np
import pytest

import s2sad
from tests.harness.engines import running
from tests.harness.kernel_files import kernel_file

RAISED = (IndexError, ValueError)
SIZES = (0, 1, 2, 3, 5)
NUMBERS = ((0, 0), (1, 2), (2, 1), (3, -1), (5, 3), (-1, 0))

WRITTEN = {
    "a counter behind a part": "y = x[1:3]\nfor i in range(n):\n    s += y[i] ** 2",
    "a number behind a part": "s = x[:n][0] ** 2 + x[1:-1][-1]",
    "a counter in a reversed part": "y = x[::-1]\nfor i in range(n):\n    s += y[i] * i",
    "a counter in every second element": "y = x[1::2]\nfor i in range(n):\n    if i <= len(y):\n        s += y[i]",
    "a store behind a part": "y = x[1:]\nz = y[:-1]\nfor i in range(n):\n    z[i] = 2.0 * z[i]",
    "a part of an empty part": "y = x[n:n - 1]\nz = y[1:-2]\ns = np.sum(z * z)",
    "a part of a reversed part of two elements": "y = x[:-3:-1]\nz = y[1:-1]\ns = np.sum(z * z)",
    "a part by symbolic bounds of a part that ends early": "y = x[-1:2]\nz = y[m:n - 1]\ns = np.sum(z) + z[0]",
    "an array that is unpacked": "a, b = x\ns = a * b",
    "a part that is unpacked": "(a, b), c = x[:n], x[0]\ns = a * b * c",
    "a list that is unpacked": "u = [x[0]]\nfor i in range(n):\n    u.append(2.0 * u[-1])\na, b = u\ns = a * b",
    "rows that are unpacked": "for a, b in np.stack((x, 2.0 * x)):\n    s += a * b",
}


def loaded(path, lines):
    return kernel_file(path, "f(x, n, m)", ["s = 0.0", *lines.splitlines()], "s + np.sum(x)")


def outcome(function, *arguments):
    try:
        return function(*arguments)
    except RAISED:
        return None


def compare(path, lines, engine):
    """How many calls both, Python alone and only the derivative computed; raises where they differ otherwise."""
    f, counts = loaded(path, lines), {"both": 0, "Python": 0, "neither": 0}
    with running(engine) as chosen:
        derivative = s2sad.value_and_gradient(s2sad.differentiate(f, engine=chosen), wrt="x")
        for size in SIZES:
            for n, m in NUMBERS:
                x = np.random.default_rng(7).random(size)
                wanted, found = outcome(f, x.copy(), n, m), outcome(derivative, x.copy(), n, m)
                assert wanted is not None or found is None, (lines, size, n, m, found)
                assert found is None or np.isclose(found[0], wanted, rtol=1e-10), (lines, size, n, m, found, wanted)
                counts["neither" if wanted is None else "both" if found is not None else "Python"] += 1
    return counts


@pytest.mark.parametrize("engine", ("numpy", "loops"))
@pytest.mark.parametrize("title", WRITTEN)
def test_python_raises_and_so_does_the_derivative(title, engine, tmp_path):
    counts = compare(tmp_path / "kernel.py", WRITTEN[title], engine)
    assert counts["both"] and (counts["neither"] or counts["Python"])


def written(rng):
    """A kernel that takes a part of a part, and its elements in a loop."""
    def bound():
        return rng.choice(("", "", "1", "2", "-1", "-2", "n", "n - 1", "m"))

    def part():
        return f"{bound()}:{bound()}{rng.choice(('', '', '', ':2', ':-1', ':-2'))}"

    def place():
        return rng.choice(("i", "i", "i - 1", "i + 1", "-1", "0", "-i - 1", "n - i", "2 * i", "i // 2",
                           "len(y) - 1 - i"))
    lines = [f"y = x[{part()}]", *([f"y = y[{part()}]"] if rng.random() < 0.5 else [])]
    stop = rng.choice(("n", "n - 1", "len(y)", "len(y) - 1", "n + 1", "x.shape[0] - 2"))
    lines.append(f"for i in range({rng.choice(('0', '0', '1', 'm'))}, {stop}):")
    inner = "    "
    if rng.random() < 0.4:
        lines.append(inner + rng.choice(("if i < len(y):", "if i < len(y) - 1:", "if i > 0:", "if i < n:")))
        inner += "    "
    stored = rng.choice(("s += y[{}] * y[{}]", "y[{}] = y[{}] * 0.5 + 1.0", "x[{}] = y[{}] * 2.0"))
    return "\n".join([*lines, inner + stored.format(place(), place())])


@pytest.mark.parametrize("seed", range(40))
def test_any_part(seed, tmp_path):
    compare(tmp_path / "kernel.py", written(Random(seed)), "loops" if seed % 4 == 0 else "numpy")


def pairs(xy, n):
    s = 0.0
    for i in range(n):
        for j in range(1, n):
            a, b = xy[i]
            c, d = xy[j]
            s += (a - c) * (b - d)
    return s


def test_items_of_rows_are_counted_before_the_loops():
    xy = np.arange(6.0).reshape(3, 2)
    text = s2sad.differentiate(pairs, wrt="xy", engine="numpy").adjoint_source(xy, 3)
    assert text.count("assert ") == 1 and text.count("for ") == 2
    derivative = s2sad.value_and_gradient(s2sad.differentiate(pairs, engine="numpy"), wrt="xy")
    assert derivative(np.ones((3, 3)), 1)[0] == 0.0
    for n, columns in ((3, 3), (2, 1)):
        with pytest.raises(ValueError, match="unpacked into another number of names than it has items"):
            derivative(np.ones((3, columns)), n)
    assert derivative(np.ones((3, 3)), 0)[0] == 0.0
