"""The comparison with other tools and its document: what is said, drawn and written, without any of the tools."""
from __future__ import annotations

import json
import os
import signal
import sys
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from benchmarks.peers import document, sections
from benchmarks.peers.gradbench import render as render_gradbench
from benchmarks.peers.lines import changed
from benchmarks.peers.measuring import Comparison, too_long
from benchmarks.peers.problems import SIZES, Problem, error
from benchmarks.peers.process import Process
from benchmarks.peers.rendering import loss, render
from benchmarks.peers.results import Kernel
from benchmarks.peers.tools import TOOLS, said
from benchmarks.tables import Table, markdown

CHAPTER = '''
from benchmarks.peers.sections import Chapter, Picture, Section
from benchmarks.tables import Table

def render(found):
    table = Table("Times", ("kernel", "s"), [("heat", found["time"])])
    picture = Picture("heat", "How fast", lambda figure: figure.subplots().plot([1, 2]))
    return Chapter(["Heat is fast."], [table, picture])

SECTION = Section("mine", "My chapter", lambda quick: {"time": "1.0"}, render)
'''


def kernel(**changes: Any) -> dict[str, Any]:
    """Stored results of a kernel at two sizes, the first of which is exact."""
    def line(time: float, **more: Any) -> dict[str, Any]:
        times = {"median": time, "lower": 0.95 * time, "upper": 1.05 * time, "rounds": 7}
        return {"seconds": 1.0, "lines": [3, 9], "times": times, "memory": 1e6 * time, **more}

    small = {"primal, Numba": line(1e-5), "s2sad, Numba": line(2e-5, error=4e-16), "JAX": line(4e-5, error=3e-16),
             "PyTorch": {"left": "its gradient is wrong by 1.0e+00"}, "forward differences": line(1e-2, error=1e-6)}
    large = {"primal, Numba": line(1e-3), "s2sad, Numba": line(6e-3), "JAX": line(3e-3),
             "forward differences": {"left": "over 4 s"}}
    return {"sizes": {"10": {"inputs": 20, "exact": True, "variants": {**small, **changes}},
                      "100": {"inputs": 200, "exact": False, "variants": large}},
            "curves": {"forward differences": [[1e-4, 1e-4], [1e-8, 1e-6]]}}


@pytest.fixture
def chapter(tmp_path, monkeypatch):
    (tmp_path / "a_chapter.py").write_text(CHAPTER)
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setattr(sections, "MODULES", {"mine": "a_chapter", "absent": "no.such.module"})
    monkeypatch.setattr(document, "MODULES", sections.MODULES)
    folder = tmp_path / "performance"
    folder.mkdir()
    (folder / "machine.json").write_text(json.dumps(
        {"date": "2026-01-01", "quick": False, "machine": {"processor": "P", "numpy": "2.0"}}))
    yield folder
    sys.modules.pop("a_chapter", None)


def test_not_installed():
    assert said([]) == ""
    assert said(["MyGrad", "numba-enzyme"]) == (
        'Not installed and left out: MyGrad, numba-enzyme '
        '(pip install "s2sad[peers]" installs those that an index has).')


def test_every_tool_has_its_adapter():
    folder = Path(document.__file__).parent
    assert all((folder / f"{tool.adapter}.py").exists() for tool in TOOLS)
    assert len({v for tool in TOOLS for v in tool.variants}) == sum(len(tool.variants) for tool in TOOLS)


def test_error_is_relative_to_the_largest_of_its_input():
    assert error([np.array([1.0, 2.0]), 3.0], [np.array([1.0, 4.0]), 3.0]) == 0.5
    assert error([np.array([np.nan])], [np.array([1.0])]) == float("inf")
    assert error([np.zeros(2)], [np.zeros(3)[:2]]) == 0.0
    assert error([np.zeros(3)[None]], [np.zeros(3)]) == float("inf")


def test_document_is_the_same_from_the_same_files(chapter):
    pytest.importorskip("matplotlib")
    (chapter / "mine.json").write_text('{"time": "1.0"}')
    first = document.write(chapter).read_bytes(), (chapter / "heat.svg").read_bytes()
    assert first == (document.write(chapter).read_bytes(), (chapter / "heat.svg").read_bytes())
    text = first[0].decode()
    assert "Measured on 2026-01-01, one thread on one core: P. Versions: numpy 2.0." in text
    assert text.index("Heat is fast.") < text.index("## My chapter") < text.index("| heat | 1.0 |")
    assert "![How fast](performance/heat.svg)" in text
    assert text.endswith("\nThe chapter absent is not in this tree.\n")


def test_a_chapter_that_failed_costs_itself(chapter):
    (chapter / "mine.json").write_text('{"failed": "its process ended with status -11"}')
    text = document.write(chapter).read_text()
    assert "## My chapter\n\nThis chapter was left out: its process ended with status -11.\n" in text


def test_a_chapter_says_when_it_was_measured_if_that_was_another_day(chapter):
    said = []
    for day in ("2026-01-01", "2026-02-01"):
        (chapter / "mine.json").write_text(json.dumps({"time": "1.0", "date": day}))
        said.append(document.write(chapter).read_text().partition("## My chapter")[2])
    assert "Measured on" not in said[0] and said[1].startswith("\n\nMeasured on 2026-02-01.\n")


def test_markdown_escapes_bars():
    assert markdown(Table("T", ("a", "b"), [("|x|", "1")])) == "**T**\n\n| a | b |\n|---|---:|\n| \\|x\\| | 1 |"


def test_picture_has_a_point_for_each_tool_and_lines_for_primal_and_rounding():
    figures = pytest.importorskip("matplotlib.figure")
    from benchmarks.peers.pictures import draw
    figure = figures.Figure(layout="constrained")
    draw(Kernel("heat", kernel()), figure)
    work, time, memory = figure.axes
    drawn = {line.get_label(): (list(line.get_xdata()), list(line.get_ydata())) for line in work.get_lines()}
    assert drawn["s2sad, Numba"] == ([2e-5], [4e-16])
    assert drawn["JAX"] == ([4e-5], [3e-16])
    assert drawn["forward differences"] == ([1e-2, 1e-2], [1e-4, 1e-6])
    assert drawn["primal, Numba"][0] == [1e-5, 1e-5]
    assert drawn["rounding, double"][1] == [2.0 ** -52] * 2
    assert "PyTorch" not in drawn
    assert [[10, 100], [2e-5, 6e-3]] in [[list(line.get_xdata()), list(line.get_ydata())] for line in time.get_lines()]
    assert memory.get_title() == "memory of a gradient"


def test_where_it_loses_is_said():
    assert loss(Kernel("heat", kernel())) == (
        "- heat: 2.0 times slower than JAX at n = 100 (6.00 ms against 3.00 ms).")
    slow = {"s2sad, Numba": {**kernel()["sizes"]["10"]["variants"]["s2sad, Numba"], "error": 1e-14}}
    assert loss(Kernel("heat", kernel(**slow))).endswith("; its error 1.0e-14 where JAX has 3.0e-16.")
    assert loss(Kernel("heat", {"sizes": {"10": kernel()["sizes"]["10"]}})) == "- heat: loses nowhere."
    gone = kernel(**{"s2sad, Numba": {"left": "over 30 s"}})["sizes"]["10"]
    assert loss(Kernel("heat", {"sizes": {"10": gone}})) == (
        "- heat: s2sad, Numba is left out (over 30 s); no time of it repeats at n = 10.")


def test_what_does_not_repeat_is_said_and_not_compared():
    noisy = {"median": 1e-6, "lower": 0.5e-6, "upper": 1.5e-6, "rounds": 7}
    found = kernel(JAX={"times": noisy, "seconds": 1.0, "lines": [3, 9], "error": 3e-16})
    assert loss(Kernel("heat", {"sizes": {"10": found["sizes"]["10"]}})) == (
        "- heat: loses nowhere. Not compared, for they do not repeat: JAX at n = 10.")
    body = render({"missing": "", "unreached": ["cold"], "first": {}, "kernels": {"heat": found}}).body
    times = next(part for part in body if isinstance(part, Table))
    assert ("JAX", "3.0e-16", "does not repeat", "3.00 ms ± 5 %", "0.0") in times.rows
    assert "No time was left for cold." in body
    assert ("Left out: PyTorch (its gradient is wrong by 1.0e+00); forward differences (n = 100: over 4 s)."
            in body)


def test_a_wrong_gradient_is_left_out(tmp_path):
    lines: dict[str, Any] = {"s2sad, Numba": {"seconds": 1.0}, "JAX": {"seconds": 1.0}, "MyGrad": {"seconds": 1.0}}
    for variant, value in (("s2sad, Numba", 1.0), ("JAX", 1.0 + 1e-12), ("MyGrad", 1.5)):
        np.savez(tmp_path / f"{variant}.npz", np.array([value]))
    Comparison([], tmp_path, 0.1, 3, 1.0)._checked(lines, [np.array([1.0], np.longdouble)])
    assert lines["s2sad, Numba"] == {"seconds": 1.0, "error": 0.0}
    assert lines["JAX"]["error"] == pytest.approx(1e-12, rel=1e-3)
    assert lines["MyGrad"]["left"] == "its gradient is wrong by 5.0e-01"


@pytest.mark.parametrize("seconds, median, why", [
    ((1.0, 2.0), 1e-3, None),
    ((1.0, 10.0), 1e-3, "the first gradient at n = 512 would take about 100 s"),    # as 1.0 became 10.0
    ((9.0, 9.0), 1e-3, None),                                                       # compiled alike for every size
    ((1.0, 2.0), 0.2, "a gradient at n = 512 would take about 3 s"),
])
def test_what_would_take_too_long_is_not_tried(seconds, median, why):
    times = {"median": median, "lower": median, "upper": median, "rounds": 7}
    at = [{"inputs": n * n, "exact": False, "variants": {"JAX": {"seconds": s, "times": times}}}
          for n, s in zip((32, 128), seconds)]
    found = Kernel("seidel", {"sizes": {"32": at[0], "128": at[1]}})
    assert too_long(found, "JAX", 512) == why


def test_samples_that_are_far_apart_are_asked_for_more(tmp_path):
    comparison = Comparison([], tmp_path, 0.1, 7, 1.0)
    assert comparison._enough([1.0] * 7, 0.1) and not comparison._enough([1.0] * 6, 0.1)
    assert comparison._enough([1.0] * 3, 1.1) and not comparison._enough([1.0] * 2, 1.1)
    assert not comparison._enough([1.0, 2.0, 3.0] * 3, 1.1) and comparison._enough([1.0, 2.0, 3.0] * 3, 4.1)
    assert comparison._enough([1.0, 2.0] * 14, 0.1)


def test_gradbench_says_where_it_loses():
    def case(name, hand, ours, spread=0.01):
        times = {who: {"median": t, "lower": t, "upper": (1.0 + spread) * t, "rounds": 9}
                 for who, t in (("C++ derivative", hand), ("s2sad derivative", ours))}
        return {"eval": name, "input": "n = 1", "apart": 4e-16, "times": times}

    chapter = render_gradbench({"compiler": "g++", "cases": [
        case("lse", 1e-3, 2e-3), case("gmm", 2e-3, 1e-3), case("ht", 1e-3, 9e-3), case("ode", 1e-3, 1e-3, 0.5)]})
    assert chapter.summary == ["GradBench: a derivative takes 2.1 times that of C++ with derivatives by hand in the "
                               "geometric mean; C++ is faster at 2 of 3: ht (n = 1) 9.0, lse (n = 1) 2.0."]
    table = chapter.body[0]
    assert isinstance(table, Table)
    assert [row[-2] for row in table.rows] == ["2.0", "0.5", "9.0", ""]
    assert table.rows[3][5:7] == ("does not repeat", "does not repeat")


def test_memory_has_the_tape_that_is_kept_between_calls():
    pytest.importorskip("numba")
    from benchmarks.peers import ours
    problem = Problem.of("integrate", 6)
    u, p, _, steps = problem.arguments
    tape = ours.prepare("s2sad, Numba", "integrate", problem).held - u.nbytes - p.nbytes
    assert tape >= steps * u.nbytes


def test_lines_of_a_version():
    assert changed(before, before) == (0, 4)
    assert changed(before, after) == (3, 4)     # its first line, too, and the line that is new


def before(u):
    """A docstring does not count."""
    for i in range(u.size):
        u[i] = 2.0 * u[i]
    return u


def after(u):
    # neither does a comment
    for i in range(u.size):
        u = u.at[i].set(2.0 * u[i])
        print(u)
    return u


@pytest.mark.skipif(os.name == "nt", reason="processes are ended by POSIX signals")
def test_a_process_that_ends_is_an_answer():
    pytest.importorskip("numba")
    request = {"do": "prepare", "variant": "numba-enzyme", "kernel": "jacobi", "size": 16, "file": "unused"}
    process = Process("with_enzyme")
    assert process.ask(request, 120.0) == {"unsupported": "it takes numbers, no arrays"}
    assert process.process is not None
    os.kill(process.process.pid, signal.SIGKILL)
    process.process.wait()
    assert process.ask(request, 120.0) == {"failed": "its process ended with SIGKILL"}
    assert process.ask(request, 0.0) == {"failed": "over 0 s"}
    assert process.process is None


@pytest.mark.parametrize("name", SIZES)
def test_adjoints_by_hand(name, monkeypatch):
    pytest.importorskip("numba")
    from benchmarks.calls import adjoint_arguments, differentiated
    from benchmarks.peers import by_hand, by_hand_adbench
    from benchmarks.peers.ours import shadows_of
    monkeypatch.setattr(by_hand, "forward_rates", by_hand.rates)     # nothing is compiled
    monkeypatch.setattr(by_hand_adbench, "BLOCK", 4)                 # a whole block and a part of one
    problem = Problem.of(name, 6)
    hand, ours = (adjoint_arguments(problem.case, problem.arguments) for _ in range(2))
    numbers = by_hand.KERNELS[name](*hand), differentiated(problem.case, "numpy").compiled("adjoint", *ours)(*ours)
    found, expected = (shadows_of(problem.case, arguments) for arguments in (hand, ours))
    for wrt in problem.case.wrt:
        if wrt in expected:
            assert np.allclose(found[wrt], expected[wrt], rtol=1e-9, atol=1e-9 * np.max(np.abs(expected[wrt]))), wrt
    assert np.allclose(*(list(chain([n] if isinstance(n, float) else n or ())) for n in numbers), rtol=1e-8)
