"""How the time to write an adjoint grows with a kernel: a table of process times, and the exponent of each on a log-log
scale.

Each kernel is a family of texts of growing size: statements, terms and factors of one expression, operators before one
operand, functions and choices one in the other, branches of one `elif`, calls one in the other, helpers, parameters,
nested loops. `s2sad adjoint` reads the text and writes the adjoint, in this process.
"""
from __future__ import annotations

import gc
import math
import statistics
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from time import process_time

from benchmarks.tables import Table, seconds, verdict
from s2sad.cli import main as command

LARGEST = 1.3           # the exponent of no family is above it
ENGINES = {"numpy": ("--engine", "numpy"), "numba": ("--engine", "numba", "--level", "fast")}


def statements(n: int) -> str:
    """A loop whose body has n statements, stores and numbers in turn."""
    lines = [f"        y[i] += v * {k}.5" if k % 2 else f"        v = x[i] * v + {k}.0" for k in range(n)]
    return "def f(x, y):\n    for i in range(len(x)):\n        v = x[i]\n" + "\n".join(lines) + "\n"


def straight(n: int) -> str:
    """n statements, each of which reads what the one before it binds."""
    lines = [f"    a = np.sin(a) * x + {k}.0" if k % 3 else f"    b{k} = a * x\n    a = a + b{k}" for k in range(n)]
    return "import numpy as np\n\n\ndef f(x):\n    a = x\n" + "\n".join(lines) + "\n    return a\n"


def terms(n: int) -> str:
    return "def f(x):\n    return " + " + ".join(f"{k}.0 * x" for k in range(n)) + "\n"


def factors(n: int) -> str:
    return "def f(x, y):\n    return " + " * ".join(["x", "y"] * (n // 2)) + "\n"


def minuses(n: int) -> str:
    return "def f(x):\n    return " + "-" * n + "x\n"


def functions(n: int) -> str:
    """n functions, each of the other."""
    return "import numpy as np\n\n\ndef f(x):\n    return " + "np.sin(x + " * n + "x" + ")" * n + "\n"


def choices(n: int) -> str:
    """n choices, each in the other."""
    first = " else ".join(f"{k}.0 * x if x > {k}.0" for k in range(n))
    return f"def f(x):\n    return {first} else x\n"


def lines_of_terms(n: int) -> str:
    """A statement of 40 terms for every 40 of n."""
    line = "    a += " + " + ".join(f"x[{k}] * {k}.0" for k in range(40)) + "\n"
    return "def f(x):\n    a = 0.0\n" + line * (n // 40) + "    return a\n"


def branches(n: int) -> str:
    rest = "".join(f"    elif k == {m}:\n        y = {m}.0 * x\n" for m in range(1, n))
    return f"def f(x, k):\n    y = 0.0\n    if k == 0:\n        y = x\n{rest}    return y\n"


def depth(n: int) -> str:
    """n helpers, each of which calls the one before it twice."""
    helpers = "".join(f"def h{k}(x, c):\n    return h{k - 1}(x, c) + c * h{k - 1}(x + c, c)\n\n\n" for k in range(1, n))
    return f"def h0(x, c):\n    return x * x * c\n\n\n{helpers}def f(x):\n    return h{n - 1}(x, 0.5)\n"


def helpers(n: int) -> str:
    made = "".join(f"def h{k}(x, c):\n    y = x * c\n    return y * y + {k}.0\n\n\n" for k in range(n))
    called = "".join(f"    a = a + h{k}(a, 0.{k})\n" for k in range(n))
    return f"{made}def f(x):\n    a = x\n{called}    return a\n"


def parameters(n: int) -> str:
    names = [f"p{k}" for k in range(n)]
    return f"def f({', '.join(names)}):\n    a = 0.0\n" + "".join(
        f"    a = a + {p} * a\n" for p in names) + "    return a\n"


def loops(n: int) -> str:
    """n loops, each in the other."""
    lines = [f"{'    ' * (k + 1)}for i{k} in range(2):" for k in range(n)]
    inner = "    " * (n + 1)
    return "def f(x, y):\n" + "\n".join(lines) + f"\n{inner}y[i{n - 1}] = y[i{n - 1}] * x[i0] + x[i{n - 1}]\n"


def loops_in_turn(n: int) -> str:
    """n loops, one after the other."""
    return "def f(x, y):\n" + "".join(
        f"    for i in range(1, len(x)):\n        y[i] = y[i - 1] * x[i] + {k}.0\n" for k in range(n))


def mixed(n: int) -> str:
    """n lines as simulations have them: whole arrays, a helper, numbers, loops and branches."""
    block = """    w = np.exp(-0.5 * u) * v + {k}.0
    u = u + 0.01 * (w - decay(u, 0.{k}))
    total = np.sum(w * v)
    for i in range(1, n - 1):
        slope = u[i + 1] - u[i - 1]
        if slope > 0.{k}:
            v[i] += 0.1 * slope * total
        else:
            v[i] = v[i] - slope * w[i]
    v[0], v[n - 1] = v[1], v[n - 2]
"""
    head = "import numpy as np\n\n\ndef decay(x, c):\n    return x * np.tanh(c * x)\n\n\n"
    return (f"{head}def f(u, v):\n    n = len(u)\n" + "".join(block.format(k=k) for k in range(n // 10))
            + "    return np.sum(u * v)\n")


FAMILIES: dict[str, tuple[Callable[[int], str], tuple[int, ...]]] = {
    "statements in a loop": (statements, (10, 20, 40, 80, 160, 320, 640, 1280)),
    "statements": (straight, (10, 20, 40, 80, 160, 320, 640, 1280)),
    "terms": (terms, (10, 20, 40, 80, 160, 320, 640)),
    "factors": (factors, (10, 20, 40, 80, 160, 320)),
    "minuses": (minuses, (10, 20, 40, 80)),
    "functions": (functions, (5, 10, 20, 40, 80)),
    "choices": (choices, (5, 10, 20, 40, 80)),
    "terms in statements of 40": (lines_of_terms, (40, 80, 160, 320, 640, 1280)),
    "branches of one elif": (branches, (10, 20, 40, 80, 160, 320)),
    "depth of calls": (depth, (2, 4, 8, 16, 32, 64)),
    "helpers": (helpers, (5, 10, 20, 40, 80, 160)),
    "parameters": (parameters, (10, 20, 40, 80, 160)),
    "nested loops": (loops, (2, 4, 8, 16)),
    "loops": (loops_in_turn, (5, 10, 20, 40, 80, 160)),
    "lines of a simulation": (mixed, (60, 120, 250, 500, 1000, 2000)),
}


def tables(quick: bool, kernels: list[str]) -> list[Table]:
    """One table for each engine: a line for each family, with its times from the smallest size to the largest."""
    return [_table(engine, quick) for engine in ENGINES]


def _table(engine: str, quick: bool) -> Table:
    made = Table(f"Time to write an adjoint, engine {engine}", ("family", "sizes", "times", "exponent", ""))
    for family, (text, sizes) in FAMILIES.items():
        taken = times(text, sizes[:4] if quick else sizes, engine, 1 if quick else 3)
        found = exponent(list(taken), list(taken.values()))
        made.rows.append((family, f"{min(taken)} to {max(taken)}",
                          f"{seconds(min(taken.values()))} to {seconds(max(taken.values()))}", f"{found:.2f}",
                          verdict(found, LARGEST)))
    made.notes.append("process time, medians; exponents are fitted to the larger half of the sizes")
    return made


def times(text: Callable[[int], str], sizes: tuple[int, ...], engine: str, rounds: int) -> dict[int, float]:
    """The median process time for each size; large kernels, which take long, are written once."""
    with tempfile.TemporaryDirectory() as folder:
        path, found = Path(folder) / "kernel.py", {}
        for size in sizes:
            path.write_text(text(size))
            taken = [_seconds(path, engine)]
            while len(taken) < rounds and sum(taken) < 2.0:
                taken.append(_seconds(path, engine))
            found[size] = statistics.median(taken)
        return found


def _seconds(path: Path, engine: str) -> float:
    gc.collect()
    before = process_time()
    status = command(["adjoint", f"{path}:f", *ENGINES[engine], "-o", str(path.with_name("adjoint.py"))])
    if status:
        sys.exit(f"{path.read_text()[:200]} is refused")
    return process_time() - before


def exponent(sizes: list[int], taken: list[float]) -> float:
    """The slope of a straight line through the larger half of the points, on a log-log scale.

    >>> round(exponent([1, 2, 4, 8], [5.0, 3.0, 12.0, 48.0]), 2)
    2.0
    """
    half = len(sizes) // 2
    points = [(math.log(n), math.log(t)) for n, t in zip(sizes[half:], taken[half:])]
    across, up = (statistics.mean(p[k] for p in points) for k in (0, 1))
    return sum((x - across) * (y - up) for x, y in points) / sum((x - across) ** 2 for x, _ in points)
