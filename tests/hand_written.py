"""Derivatives written by hand in the form that the compiler generates, to test how they are called.

`derive` and `summary` answer as the pipeline does for the few kernels below; `load` reads them.
"""
from __future__ import annotations

import inspect

import numpy as np

from s2sad.diagnostics import Diagnostic, S2sadError, Source
from s2sad.infer.types import FLOAT, array, of_value
from s2sad.program import Generated, Kernel, Parameter, Program

G = 2.0
TABLE = np.array([1.0, 2.0, 3.0])
calls = []


def square(du, u, n=3):
    for i in range(n):
        du[i] = u[i] * u[i]


def scale(u, c):
    for i in range(u.size):
        u[i] = c * u[i]


def norm(u, c=1.0):
    total = 0.0
    for i in range(u.size):
        total += c * u[i] * u[i]
    return total


def dot(x, y):
    total = 0.0
    for i in range(x.size):
        total += x[i] * y[i]
    return total


def grown(u):
    for i in range(u.size):
        u[i] = 3.0 * u[i]
    return u


def pair(x, n):
    return 2.0 * x, n, x * x


def gravity(x):
    return G * x


def looked_up(x, k):
    return x * TABLE[k]


def guarded(u, limit):
    for i in range(u.size):
        u[i] = 2.0 * u[i]
        assert u[i] < limit
    return u[0]


def unused(x, t):
    return 2.0 * x


WRITES = {"square": ("du",), "scale": ("u",), "grown": ("u",), "guarded": ("u",)}
RESULTS = {"norm": (FLOAT,), "dot": (FLOAT,), "grown": (array("float64", 1),), "gravity": (FLOAT,),
           "looked_up": (FLOAT,), "guarded": (FLOAT,), "unused": (FLOAT,), "pair": (FLOAT, of_value(1), FLOAT)}

# name -> (shadows, seeds, body, returned scalars by name)
ADJOINTS = {
    "square": (("du", "u"), 0, ["for i in range(n):", "    seed = du_bar[i]", "    du_bar[i] = 0.0",
                                "    u_bar[i] += 2.0 * u[i] * seed", "    du[i] = -7.0"], {}),
    "scale": (("u",), 0, ["c_bar = 0.0", "for i in range(u.size):", "    c_bar += u[i] * u_bar[i]",
                          "    u_bar[i] *= c", "    u[i] = -7.0"], {"c": "c_bar"}),
    "norm": (("u",), 1, ["total = 0.0", "for i in range(u.size):", "    total += c * u[i] * u[i]",
                         "for i in range(u.size):", "    u_bar[i] += 2.0 * c * u[i] * result_bar",
                         "result = total"], {"c": "result_bar * total / c"}),
    "dot": (("x", "y"), 1, ["total = 0.0", "for i in range(x.size):", "    total += x[i] * y[i]",
                            "    x_old = x_bar[i]", "    y_bar[i] += x[i] * result_bar",
                            "    x_bar[i] = x_old + y[i] * result_bar", "result = total"], {}),
    "grown": (("u",), 0, ["for i in range(u.size):", "    u_bar[i] *= 3.0"], {}),
    "gravity": ((), 1, ["result = {G} * x"], {"x": "{G} * result_bar"}),
    "looked_up": ((), 1, ["result = x * table[k]"], {"x": "table[k] * result_bar"}),
    "guarded": (("u",), 1, ["for i in range(u.size):", "    u[i] = 2.0 * u[i]", "    assert u[i] < limit",
                            "u_bar[0] += result_bar", "for i in range(u.size):", "    u_bar[i] *= 2.0",
                            "result = u[0]"], {"limit": "0.0"}),
    "unused": ((), 1, ["result = 2.0 * x"], {"x": "2.0 * result_bar"}),
    "pair": ((), 2, ["pass"], {"x": "2.0 * result_0_bar + 2.0 * x * result_1_bar"}),
}
TANGENTS = {
    "scale": (("u", "c"), ["for i in range(u.size):", "    u_dot[i] = c_dot * u[i] + c * u_dot[i]",
                           "    u[i] = c * u[i]"], ()),
    "norm": (("u",), ["dot = 0.0", "for i in range(u.size):", "    dot += 2.0 * c * u[i] * u_dot[i]"], ("dot",)),
    "grown": (("u",), ["for i in range(u.size):", "    u_dot[i] *= 3.0"], ()),
    "pair": (("x",), ["pass"], ("2.0 * x_dot", "2.0 * x * x_dot")),
    "unused": (("x",), ["pass"], ("2.0 * x_dot",)),
}


def load(function):
    text = inspect.getsource(function)
    source = Source(__file__, text)
    signature = inspect.signature(function)
    defaults = {n: p.default for n, p in signature.parameters.items() if p.default is not p.empty}
    kernel = Kernel(function.__name__, None, source, tuple(signature.parameters), defaults)  # type: ignore[arg-type]
    space = function.__globals__
    return Program(kernel.name, {kernel.name: kernel},
                   {"G": space["G"]} if kernel.name == "gravity" else {},
                   {"table": space["TABLE"]} if kernel.name == "looked_up" else {})


class Summary:
    def __init__(self, name):
        self.written, self.results = WRITES.get(name, ()), RESULTS.get(name, ())
        self.returned = {0: "u"} if name == "grown" else {}


def summary(program, types):
    return Summary(program.entry)


def derive(program, request):
    calls.append((program.entry, request))
    kernel, name = program.kernels[program.entry], program.entry
    types = dict(zip(kernel.parameters, request.types))
    if any(t.dtype == "float32" for t in request.types):
        raise S2sadError(Diagnostic("S203", "no float32 here"))
    hidden = [Parameter("array.table", "primal", "array.table", array("float64", 1))] * bool(program.arrays)
    trailing = ["table"] * bool(hidden)
    if request.mode == "primal":
        text = kernel.source.text.replace("TABLE", "table").replace("G *", f"{program.constants.get('G')!r} *")
        parameters = [Parameter(p, "primal", p, t) for p, t in types.items()]
        text = text.replace("):\n", "".join(f", {t}" for t in trailing) + "):\n", 1)
        text = text.replace("n=3", "n").replace("c=1.0", "c")
        return Generated(text, name, (*parameters, *hidden), ("result",))
    suffix, head = ("bar", "adjoint") if request.mode == "adjoint" else ("dot", "tangent")
    shadows, *rest = (ADJOINTS if request.mode == "adjoint" else TANGENTS)[name]
    seeds, body, scalars = rest if request.mode == "adjoint" else (0, *rest)
    parameters = []
    for p, t in types.items():
        parameters.append(Parameter(p, "primal", p, t))
        if p in shadows:
            parameters.append(Parameter(f"{p}_{suffix}", "shadow", p, t))
    names = ["result_bar"] if seeds == 1 else [f"result_{k}_bar" for k in range(seeds)]
    parameters += [Parameter(n, "seed", "result", FLOAT) for n in names]
    signature = ", ".join([p.name for p in parameters] + trailing)
    if request.mode == "adjoint":
        wanted = {p: e for p, e in scalars.items() if p in request.wrt}
        values = [*["result"] * request.with_primal, *wanted.values()]
        returns = (*["result"] * request.with_primal, *wanted)
        ending = f"    return ({', '.join(values)},)" if values else ""
    else:
        values, returns = list(scalars), tuple(f"result_{k}_dot" for k in range(len(scalars)))
        ending = f"    return {', '.join(values)}" if values else ""
    lines = [f"def {name}_{head}({signature}):", *["    " + line for line in body], ending, ""]
    text = "\n".join(lines).replace("{G}", repr(program.constants.get("G")))
    facts = {"independent": ("t",)} if name == "unused" else {}
    return Generated(text, f"{name}_{head}", (*parameters, *hidden), returns, facts)
