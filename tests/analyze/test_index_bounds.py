"""Which arguments are known to keep a kernel within its arrays: never any with which it asks for more."""
from __future__ import annotations

import itertools

import numpy as np
import pytest

from s2sad import pipeline, read
from s2sad.dispatch.index_check import condition
from s2sad.infer.types import of_value
from s2sad.program import Request
from tests.harness.seeds import generator, seeded


def inside(path, text, sample):
    """A function of arguments that says whether they are known to keep the kernel `f` of a text within its arrays."""
    path.write_text(f"import numpy as np\n\n\n{text}")
    types = tuple(of_value(value).plain for value in sample)
    made = pipeline.derive(read.load_file(path, "f"), Request("primal", types, (), (), "numba"))
    limits = made.facts["index_limits"]
    if limits is None:
        return lambda arguments: False
    return condition(limits, {p.name: k for k, p in enumerate(made.parameters)})


def runs(text, arguments):
    """Whether NumPy runs the kernel without an index out of bounds."""
    space = {"np": np}
    exec(text, space)
    try:
        space["f"](*(a.copy() if isinstance(a, np.ndarray) else a for a in arguments))
    except IndexError:
        return False
    except (ValueError, ZeroDivisionError):      # said where it happens
        return True
    return True


def array(*shape):
    return np.zeros(shape)


def integers(*elements):
    return np.array(elements, dtype=np.int64)


KERNELS = {
    "neighbours": ("""def f(x, y):
    n = len(x)
    for i in range(1, n - 1):
        y[i] = x[i - 1] + x[i + 1]
""", [(array(5), array(5)), (array(5), array(4)), (array(2), array(0)), (array(0), array(0))], [(array(6), array(4))]),
    "one too small": ("""def f(x, y):
    for i in range(x.shape[0]):
        y[i + 1] = x[i]
""", [(array(3), array(4)), (array(0), array(0))], [(array(3), array(3)), (array(1), array(1))]),
    "a negative step": ("""def f(x, y, n):
    for i in range(n, 0, -2):
        y[i] = x[i - 1]
""", [(array(4), array(5), 4), (array(0), array(0), 0)], [(array(4), array(4), 4), (array(3), array(9), 4)]),
    "counted from the end": ("""def f(x, y, k):
    y[0] = x[-1] + x[-k]
""", [(array(3), array(1), 3), (array(1), array(1), -0)], [(array(3), array(1), 4), (array(0), array(1), 1)]),
    "around the end": ("""def f(x):
    for i in range(x.shape[0]):
        x[i] = x[i - 1]
""", [(array(3),), (array(1),), (array(0),)], []),
    "no trip": ("""def f(x, n):
    for i in range(n):
        x[i + 100] = 1.0
""", [(array(3), 0), (array(3), -7)], [(array(3), 1)]),
    "a branch": ("""def f(x, y, k):
    for i in range(x.shape[0]):
        if i > 0 and i < k:
            y[i - 1] = x[i]
        elif i == 0:
            y[k] = x[i]
""", [(array(5), array(4), 3)], [(array(5), array(4), 4), (array(5), array(3), 9)]),
    "a helper": ("""def shift(a, b, n):
    for i in range(n):
        b[i] = a[i + 1]


def f(x, y):
    shift(x, y, y.shape[0])
    shift(y, x, 2)
""", [(array(4), array(3))], [(array(4), array(4)), (array(3), array(2))]),
    "rows that a helper is given": ("""def total(a):
    s = 0.0
    for i in range(3):
        s += a[i]
    return s


def f(x, y):
    for k in range(x.shape[0]):
        y[k] = total(x[k]) + total(x[k, :])
""", [(array(4, 3), array(4))], [(array(4, 2), array(4)), (array(4, 3), array(3))]),
    "an index that a helper finds": ("""def wrap(i, n):
    if i < 0:
        return i + n
    if i != n:
        return i
    return 0


def f(x, y):
    n = y.shape[0]
    for i in range(n):
        y[i] = x[wrap(i + 1, n)] - x[wrap(i - 1, n)]
""", [(array(4), array(4)), (array(5), array(4))], [(array(3), array(4))]),
    "a remainder that is negative": ("def f(x):\n    for i in range(9):\n        x[i % -3] = 1.0\n",
                                     [(array(3),), (array(2),)], [(array(1),)]),
    "the place of a maximum": ("""def f(x, y):
    place = 0
    for j in range(x.shape[0]):
        if x[j] > x[place]:
            place = j
    y[0] = x[place]
""", [(array(3), array(1))], [(array(0), array(1)), (array(3), array(0))]),
    "an array of a size that is cut off at 0": ("""def f(x, n):
    work = np.zeros(max(n - 2, 0))
    for i in range(work.shape[0]):
        work[i] = x[i]
    x[5] = np.sum(work)
""", [(array(6), 4), (array(6), 0)], [(array(3), 0), (array(6), 9)]),
    "remainders and quotients": ("""def f(x, y):
    for i in range(2 * y.shape[0]):
        y[i // 2] = y[i // 2] + x[i % 3] + x[i % x.shape[0]]
""", [(array(3), array(4))], [(array(2), array(4))]),
    "a name that one of several ways binds": ("""def f(x, y, k):
    place = 0
    if k > 0:
        x[place] = 1.0
        if k > 1:
            place = len(y)
    else:
        x[place] = 2.0
    y[place] = 1.0
""", [(array(3), array(2), 1)], [(array(3), array(2), 2)]),
    "the least of two sizes": ("""def f(x, y):
    n = min(x.shape[0], y.shape[0])
    for i in range(n):
        y[i] = x[n - 1 - i]
    if n > 2:
        y[max(n - 3, 1)] = 0.0
""", [(array(3), array(4)), (array(9), array(4))], []),
    "a reshape": ("""def f(x, y):
    flat = (2.0 * x).reshape(-1)
    quarters = (x * x).reshape(x.shape[0] // 2, 2, x.shape[1] // 2, 2)
    for i in range(y.shape[0]):
        y[i] = np.sum(flat) + quarters[i, 1, 0, 1]
""", [(array(4, 2), array(2)), (array(4, 6), array(1))], [(array(4, 2), array(3)), (array(4, 0), array(1))]),
    "rows side by side": ("""def f(x, y):
    flat = np.zeros(x.shape[0] * x.shape[1])
    for i in range(x.shape[0]):
        for j in range(x.shape[1]):
            flat[i * x.shape[1] + j] = x[i, j]
    for k in range(x.size):
        x[k // x.shape[1], k % x.shape[1]] = 2.0 * flat[k]
    y[0] = x[0, 0]
""", [(array(2, 3), array(1)), (array(3, 2), array(2))], [(array(2, 3), array(0))]),
    "an array of indices": ("def f(x, k):\n    return np.sum(x[k])\n", [
        (array(3), integers(2, 0, -3))], [(array(3), integers(2, 3)), (array(3), integers(-4))]),
    "a number times an index, and more": ("""def f(x, k):
    for i in range(len(k)):
        at = k[i]
        x[3 * at + 1, int(at) // 2] = x[at, min(at, x.shape[1] - 1)]
""", [(array(5, 1), integers(0, 1)), (array(8, 2), integers(2))],
        [(array(5, 2), integers(2)), (array(8, 1), integers(2))]),
    "columns of a table": ("""def f(x, triangles):
    for e in range(triangles.shape[0]):
        a, b, c = triangles[e]
        x[triangles[e, 0]] = x[a] + x[b] * x[c]
""", [(array(3), integers([0, 1, 2], [2, 0, 1]))], [(array(2), integers([0, 1, 2]))]),
    "rows from one place on to the next": ("""def f(y, data, indices, starts, x):
    for row in range(len(y)):
        for k in range(starts[row], starts[row + 1]):
            y[row] += data[k] * x[indices[k]]
""", [(array(2), array(3), integers(0, 3, 1), integers(0, 1, 3), array(4))],
        [(array(2), array(3), integers(0, 3, 1), integers(0, 1, 4), array(4)),
         (array(2), array(3), integers(0, 3, 1), integers(0, 1), array(4)),
         (array(2), array(3), integers(0, 3, 4), integers(0, 1, 3), array(4)),
         (array(2), array(2), integers(0, 3, 1), integers(0, 1, 3), array(4))]),
    "parts of indices": ("""def f(y, indices, starts, x):
    for row in range(len(y)):
        part = indices[starts[row]:starts[row + 1]]
        for j in range(part.shape[0]):
            y[row] += x[part[j]]
""", [(array(2), integers(0, 3, 1), integers(0, 1, 3), array(4))],
        [(array(2), integers(0, 4, 1), integers(0, 1, 3), array(4))]),
    "indices that a helper is given": ("""def gather(x, k, n):
    total = 0.0
    for i in range(n):
        total += x[k[i]]
    return total


def f(y, x, k, rows):
    y[0] = gather(x, k, len(k))
    for e in range(rows.shape[0]):
        y[rows[e, 0]] += gather(x, rows[e], 2)
""", [(array(2), array(3), integers(2, -1), integers([0, 1], [1, 1]))],
        [(array(2), array(3), integers(3), integers([0, 1])), (array(2), array(3), integers(2), integers([0, 4])),
         (array(2), array(3), integers(2), integers([2, 1]))]),
    "an index that is asked": ("""def f(x, k, n):
    for i in range(len(k)):
        if k[i] >= 0 and k[i] < len(x):
            x[k[i]] = 1.0
""", [(array(3), integers(7, -9), 0)], []),
}


@pytest.mark.parametrize("title", KERNELS)
def test_arguments_are_told_apart(title, tmp_path):
    text, within, beyond = KERNELS[title]
    known = inside(tmp_path / "kernel.py", text, within[0])
    assert all(runs(text, arguments) and known(arguments) for arguments in within)
    assert not any(runs(text, arguments) or known(arguments) for arguments in beyond)


UNKNOWN = {
    "a row of another width": ("""def f(x):
    flat = np.zeros(x.shape[0] * x.shape[1])
    for i in range(x.shape[0]):
        for j in range(x.shape[1]):
            flat[i * x.shape[0] + j] = x[i, j]
""", (array(3, 3),)),
    "a column too many": ("""def f(x):
    for k in range(x.size + 1):
        x[k // x.shape[1], k % x.shape[1]] = 1.0
""", (array(3, 3),)),
    "the other axis": ("""def f(x):
    for k in range(x.size):
        x[k // x.shape[0], k % x.shape[1]] = 1.0
""", (array(3, 3),)),
    "a quotient that is negative": ("""def f(x, y):
    n = -x.shape[0]
    for i in range(x.shape[0] * y.shape[0]):
        x[i % n] = y[i // n]
""", (array(3), array(2))),
    "a negative product": ("""def f(x, n, m):
    for k in range(n * m):
        x[k // m] = 1.0
""", (array(3), 3, 2)),
    "an index out of an array that is written": ("def f(x, k):\n    k[0] += 1\n    x[k[0]] = 1.0\n", (
        array(3), np.array([1]))),
    "an index made of a float": ("def f(x):\n    x[int(x[0])] = 1.0\n", (array(3),)),
    "a number that a loop counts up": ("""def f(x, y):
    k = 0
    for i in range(x.shape[0]):
        if x[i] > 0.0:
            y[k] = x[i]
            k += 1
""", (array(3), array(3))),
    "a loop without a counter": ("""def f(x):
    i = 0
    while x[i] < 1.0:
        x[i] += 1.0
        i = i + 1
""", (array(3),)),
    "an index of another loop": ("""def wrap(i, n):
    if i == n:
        return 0
    return i


def f(x, y):
    for i in range(10):
        place = wrap(i, 20)
    for i in range(2):
        y[i] = x[place]
""", (array(5), array(2))),
    "a product of sizes": ("def f(x, n, m):\n    for i in range(n * m):\n        x[i] = 1.0\n", (array(6), 2, 3)),
    "a size that changes": ("""def f(x, n):
    m = n
    work = np.zeros(m)
    for k in range(3):
        m = m - 1
        work = np.zeros(m)
    x[0] = work[n - 1 - 3]
""", (array(3), 6)),
}


@pytest.mark.parametrize("title", UNKNOWN)
def test_what_nothing_is_known_of(title, tmp_path):
    text, sample = UNKNOWN[title]
    assert not inside(tmp_path / "kernel.py", text, sample)(sample)


def written(rng):
    """A kernel with loops, branches, a helper, numbers that are bound several times and sizes of all kinds."""
    symbols = ["n", "k", "x.shape[0]", "len(y)", "x.shape[1]"]

    def form(names, depth=1):
        choice = rng.integers(0, 8 if depth else 4)
        if choice < 4:
            return f"{rng.choice(names)} {'+-'[rng.integers(2)]} {rng.integers(0, 3)}"
        inner = form(names, depth - 1), form(names, depth - 1)
        return (f"max({inner[0]}, {inner[1]})", f"min({inner[0]}, {inner[1]})",
                f"({inner[0]}) % ({rng.integers(1, 4)})", f"moved({inner[0]}, {rng.choice(symbols)})")[choice - 4]

    def store(names):
        index = ", ".join(f"({form(names)})" for _ in range(2))
        return rng.choice([f"y[{form(names)}] = x[{index}]", f"x[{index}] = y[{form(names)}]",
                           f"work[{form(names)}] = y[{form(names)}]", f"place = {form(names)}",
                           f"y[place] = {form(names)}"])

    def block(names, depth, indent):
        lines = []
        for _ in range(rng.integers(1, 3)):
            choice = rng.integers(0, 4) if depth else 3
            counter = f"i{len(names)}"
            if choice < 2:
                step = rng.choice(["", "", ", 2", ", -1"])
                bounds = f"{form(names, 0)}, {form(names, 0)}{step}"
                lines += [f"{indent}for {counter} in range({bounds}):",
                          *block([*names, counter, counter, counter], depth - 1, indent + "    ")]
            elif choice == 2:
                test = f"{form(names, 0)} {rng.choice(['<', '>=', '==', '!='])} {form(names, 0)}"
                lines += [f"{indent}if {test}:", *block(names, depth - 1, indent + "    "), f"{indent}else:",
                          *block(names, depth - 1, indent + "    ")]
            else:
                lines.append(indent + store(names))
        return lines
    helper = ("def moved(i, m):\n    if i < 0:\n        return i + m\n    if i >= m and i != 3:\n        return i - m\n"
              "    return i\n\n\n")
    return (f"{helper}def f(x, y, n, k):\n    place = 0\n    work = np.zeros(max({form(symbols, 0)}, 0))\n"
            + "\n".join(block(symbols, 3, "    ")) + "\n")


@pytest.mark.parametrize("program", range(20))
def test_what_is_known_holds(program, tmp_path):
    """Random kernels with random sizes: where they are known to stay within their arrays, NumPy runs them."""
    _holds(written(generator(seeded(program))), tmp_path)


def with_products(rng):
    """A kernel that goes through an array of several axes as one row of elements, most often with the sizes that it
    has, else with a wrong one, a number too many, or a divisor that may be negative."""
    sizes = ["x.shape[0]", "x.shape[1]", "len(y)", "3", "2", "(x.shape[0] // 2)", "(x.shape[1] // 2)"]
    axes = [str(rng.choice(sizes)) for _ in range(rng.integers(2, 4))]
    lines = [f"row = np.zeros({' * '.join(axes)})", f"whole = np.zeros(({', '.join(axes)}))"]
    walked, divisors = [str(size) for size in rng.permutation(axes)], list(axes)
    if rng.random() < 0.5:
        walked[rng.integers(len(walked))] = str(rng.choice(sizes))
    if rng.random() < 0.3:
        divisors[rng.integers(len(axes))] = str(rng.choice([*sizes, "-2", "(2 - len(y))"]))
    if rng.random() < 0.5:
        counters = [f"i{k}" for k in range(len(walked))]
        lines += [f"{'    ' * k}for i{k} in range({size}):" for k, size in enumerate(walked)]
        place = counters[0]
        for counter, size in zip(counters[1:], walked[1:]):
            place = f"({place}) * {size} + {counter}"
        place += str(rng.choice(["", "", "", " + 1"]))
    else:
        counters, place = ["i0"], "i0"
        lines.append(f"for i0 in range({' * '.join(walked)}{rng.choice(['', '', ' + 1', ' - 1'])}):")
    places, rest = [], place
    for size in reversed(divisors[1:]):
        places.append(f"({rest}) % {size}")
        rest = f"({rest}) // {size}"
    stores = [f"row[{place}] = 1.0"] * int(rng.integers(2)) + [f"whole[{', '.join([rest, *reversed(places)])}] = 1.0"]
    lines += ["    " * len(counters) + store for store in stores]
    return "def f(x, y, n, k):\n" + "\n".join(f"    {line}" for line in lines) + "\n"


@pytest.mark.parametrize("program", range(60))
def test_what_is_known_of_products_holds(program, tmp_path):
    _holds(with_products(generator(seeded(program))), tmp_path, numbers=False)


def _holds(text, tmp_path, numbers=True):
    known = inside(tmp_path / "kernel.py", text, (array(2, 2), array(2), 1, 1))
    numbers = [(n, k) for n in range(-1, 4) for k in range(-1, 3)] if numbers else [(1, 1)]
    for rows, columns, length, (n, k) in itertools.product(range(5), range(5), range(4), numbers):
        arguments = array(rows, columns), array(length), n, k
        if known(arguments):
            assert runs(text, arguments), (text, rows, columns, length, n, k)
