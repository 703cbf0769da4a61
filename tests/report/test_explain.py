"""What explain says, read where it says it, and what check finds."""
from __future__ import annotations

import json
import math
import re

import numpy as np
import pytest

from benchmarks.kernels.cases import CASES
from s2sad import S2sadError, differentiate, explain


def explained(name, engine="numpy", size="small"):
    case = CASES[name]
    return explain(case.function, *case.arguments(size), wrt=case.wrt, of=case.of, engine=engine)


def facts(report):
    return json.loads(report.json())["functions"]


def floats(report):
    """The stacks of floats, of all functions, as (name, formula, bytes, grows)."""
    return [(s["name"], s["formula"], s["bytes"], s["grows"]) for f in facts(report) for s in f["recorded"]
            if s["dtype"].startswith("float")]


# -- what is recorded -----------------------------------------------------------------------------------------------

@pytest.mark.parametrize("engine", ["numpy", "numba"])
@pytest.mark.parametrize("name", ["brusselator", "jacobi", "seidel", "upwind", "spmv", "assemble", "cholesky",
                                  "mixture"])
def test_records_no_float(name, engine):
    assert floats(explained(name, engine)) == []


@pytest.mark.parametrize("engine", ["numpy", "numba"])
@pytest.mark.parametrize(("name", "expected"), [
    ("thomas", [("rhs_stack", "8 * len(range(n - 2, -1, -1))", 8 * 7, False)]),
    ("integrate", [("u_stack", "8 * len(range(steps)) * u.size", 8 * 5 * 72, False)]),
    ("nbody", [("position_stack", "8 * len(range(steps)) * n * len(range(3))", 8 * 3 * 4 * 3, False)]),
    ("newton", [("guess_stack", "8 per push", 8, True)]),
])
def test_records_what_is_needed(name, expected, engine):
    found = floats(explained(name, engine))
    if engine == "numba":  # there a snapshot is taken element by element
        found = [(s, f.replace("u.shape[0] * u.shape[1] * u.shape[2]", "u.size"), *rest) for s, f, *rest in found]
    assert found == expected


@pytest.mark.parametrize("engine", ["numpy", "numba"])
def test_advect_records_u_and_the_scalars_it_carries(engine):
    """u, which each cell overwrites, and `left`, the old value of the cell before, are both read by the limiter, which
    is not linear; `first` and the first `left` once per step. The rest is computed again."""
    found, steps, n = floats(explained("advect", engine)), 4, 24
    assert {name.partition("_")[0] for name, *_ in found} <= {"u", "left", "first"}
    assert sum(size for _, _, size, _ in found) <= 8 * steps * (2 * n + 2)


def test_bytes_of_large_arguments_are_computed_without_running():
    assert floats(explained("integrate", size="large"))[0][2] == 8 * 100 * 32 * 32 * 2


def test_says_which_statement_needs_a_recorded_value():
    [entry, _] = facts(explained("integrate"))
    [stack] = entry["recorded"]
    assert stack["what"] == "u before `u += dt * du`"
    assert [p["text"] for p in stack["needed_by"]] == ["brusselator(du, u, p, s * dt)"]
    text = str(explained("integrate"))
    assert "u_stack: 2,880 bytes = 8 * len(range(steps)) * u.size bytes, u before `u += dt * du`" in text
    assert re.search(r"needed by line \d+: brusselator\(du, u, p, s \* dt\)", text)


def test_a_growing_stack_is_known_per_push_only():
    assert "8 bytes per push, the number of pushes is known only at run time" in str(explained("newton"))


def caller(x, m):
    total = 0.0
    for k in range(m):
        total += helper(x[k], k)
    return total


def helper(row, n):
    value = row
    for _ in range(4):
        value = value * value
    return value + n


def several(u, w, m):
    for _ in range(m):
        for i in range(w.size):
            w[i] = w[i] * w[i]
        for i in range(u.size):
            u[i] = u[i] * u[i]
    return doubled(u[0], 3) + tripled(w[0], 5)


def doubled(x, n):
    for _ in range(n):
        x = x * x
    return x


def tripled(x, n):
    for _ in range(n):
        x = x * x * x
    return x


def test_the_total_stands_first_and_the_largest_record_before_the_others():
    report = explain(several, np.ones(100_000), np.ones(500_000), 2, engine="numpy")
    assert str(report).startswith("Adjoint of several: d(u, w, return) / d(u, w), engine numpy\nrecords 9.60 MB\n\n")
    assert [s.name for s in report.functions[0].recorded] == ["w_stack", "u_stack"]
    assert [f.recorded[0].bytes for f in report.functions[1:]] == [24, 40]   # one after the other, not both at a time
    assert report.bytes == json.loads(report.json())["bytes"] == 8 * 2 * 600_000 + 40


def test_the_total_says_what_it_leaves_out():
    assert str(explained("newton")).splitlines()[1] == "records what grows as it runs: guess_stack"
    assert str(explained("jacobi")).splitlines()[1] == "records nothing"


def test_sizes_reach_into_callees():
    [_, inner] = facts(explain(caller, np.ones(5), 3, engine="numpy"))
    assert [(s["formula"], s["bytes"]) for s in inner["recorded"]] == [("8 * len(range(4))", 32)]


# -- what is skipped ------------------------------------------------------------------------------------------------

def test_the_brusselator_does_not_compute_du_nor_ask_for_x_y_and_t():
    [entry] = facts(explained("brusselator"))
    verdicts = {v["variable"]: v["reason"] for v in entry["variables"]}
    assert {n: verdicts[n] for n in ("u", "p", "alpha", "t", "x", "n")} == {
        "u": "active", "p": "active", "alpha": "active", "t": "inactive: it never depends on an input",
        "x": "inactive: it reaches no output", "n": "inactive: int64 has no derivative"}
    dropped = [p["text"].partition(" = ")[0] for p in entry["dropped"]]
    assert dropped == ["x, y", "du[i, j, 0]", "du[i, j, 1]"]
    assert {a["variable"] for a in entry["again"]} == {"ip1", "im1", "jp1", "jm1"}


def test_a_subset_leaves_no_line_about_the_rest():
    case = CASES["brusselator"]
    text = differentiate(wrt="u", engine="numpy")(case.function).adjoint_source(*case.arguments("small"))
    assert "p_bar" not in text
    [entry] = facts(explain(case.function, *case.arguments("small"), wrt="u", engine="numpy"))
    assert next(v for v in entry["variables"] if v["variable"] == "p")["active"] is False


def test_loops_that_run_again():
    [entry] = facts(explained("newton"))
    assert [p["text"] for p in entry["loops"]] == ["for i in range(x.size):"]
    assert "x[i] = guess" in [p["text"] for p in entry["dropped"]]


def viewed(x, c):
    row = x[0]
    row[:] = 2.0 * row
    for line in x:
        line[0] += c


def test_a_view_is_as_active_as_its_array():
    [entry] = facts(explain(viewed, np.ones((2, 3)), 1.0, engine="numpy"))
    verdicts = {v["variable"]: v["reason"] for v in entry["variables"]}
    assert verdicts["row"] == verdicts["line"] == "active, as x, which stands in its place"


# -- kinks ----------------------------------------------------------------------------------------------------------

def kinked(x, c, k):
    a = abs(x)
    b = max(x, c)
    d = math.sqrt(x)
    e = x ** 1.5
    f = x ** 2 + k ** 2
    g = math.floor(x)
    if x > c:
        a = 2.0 * a
    return a + b + d + e + f + g


def test_every_place_that_is_not_differentiable():
    [entry] = facts(explain(kinked, 1.3, 0.2, 3.0, engine="numpy", wrt="x"))
    assert [(k["place"]["text"], k["what"].partition(":")[0]) for k in entry["kinks"]] == [
        ("a = abs(x)", "the derivative of abs at 0 is taken as 0"),
        ("b = max(x, c)", "at a tie max(a, b) is a"),
        ("d = math.sqrt(x)", "the derivative of sqrt at 0 is infinite"),
        ("e = x ** 1.5", "a power with the exponent 1.5"),
        ("g = math.floor(x)", "floor of an active value jumps"),
        ("if x > c:", "an active value is compared")]


def test_nothing_is_said_of_inactive_values():
    [entry] = facts(explain(kinked, 1.3, 0.2, 3.0, engine="numpy", wrt="k"))
    assert entry["kinks"] == []


# -- forms ----------------------------------------------------------------------------------------------------------

def test_the_decorator_s_selection_is_explained():
    kernel = differentiate(wrt="u", of="du", engine="numpy")(CASES["upwind"].function)
    assert str(explain(kernel, *CASES["upwind"].arguments("small"))).startswith(
        "Adjoint of upwind: d(du) / d(u), engine numpy\n")


def test_explain_refuses_as_the_adjoint_does():
    with pytest.raises(S2sadError, match="S401.*wrt names 'q'"):
        explain(kinked, 1.0, 1.0, 1.0, wrt="q")


def test_the_header_says_what_for_what_and_the_roles():
    case = CASES["integrate"]
    text = differentiate(wrt=case.wrt, of=case.of, engine="numpy")(case.function).adjoint_source(
        *case.arguments("small"))
    assert text.startswith('''"""Adjoint of integrate: d(return) / d(u, p).

Engine: NumPy. Level: plain. Arguments:
    u: float64[:, :, :], in-out
    p: float64[:], in
    dt: float64, in
    steps: int64, in

It records:
    u_stack: u before `u += dt * du`, 8 * len(range(steps)) * u.size bytes
"""
''')
    spmv = CASES["newton"]
    text = differentiate(engine="numpy")(spmv.function).adjoint_source(*spmv.arguments("small"))
    assert "    x: float64[:], out\n    a: float64[:], in\n" in text


# -- check ----------------------------------------------------------------------------------------------------------


# -- what was computed before the run -------------------------------------------------------------------------------

class Channel:
    def __init__(self, u, t):
        self.u, self.t = u, t


def weighted(channel, x, mode, n):
    total = 0.0
    for k, w in enumerate([0.5, 2.0, x[0]]):
        total = total + w * channel.u[k]
    sums = []
    for _ in range(n):
        sums.append(total if mode == "all" else x[1])
    channel.t += sums[0]
    return total * sum(sums[:n])


def test_what_is_computed_before_the_run():
    report = explain(differentiate(weighted, engine="numpy"), Channel(np.ones(3), 0.5), np.ones(3), "all", 2)
    first = weighted.__code__.co_firstlineno
    assert json.loads(report.json())["evaluated"] == [
        "channel.u is the parameter channel_u",
        "channel.t is the parameter channel_t",
        f"written out, 3 rounds: line {first + 2}: for k, w in enumerate([0.5, 2.0, x[0]]):",
        f"written out, 2 rounds: line {first + 5}: for _ in range(n):",
        "made for n = 2; anything else makes another derivative",
        "made for mode = 'all'; anything else makes another derivative",
    ]
    assert "computed before the run\n  channel.u is" in str(report)


def test_nothing_is_computed_before_the_run_of_an_array_program():
    assert explained("brusselator").evaluated == ()
