"""bench: what is compared, what it is held against, what is said where something is not there, and its picture."""
from __future__ import annotations

import math
import subprocess
import sys

import numpy as np
import pytest

import s2sad
from s2sad import S2sadError, bench
from s2sad.cli import main
from s2sad.report.slopes import ReferenceSlopes

U = np.array([1.0, 2.0, 0.5, 1.5])
REVERSE = ["primal", "adjoint, bare"]
DIFFERENCES = [*(f"central difference, step 1e-{k:02}" for k in (2, 4, 6, 8, 10)), "forward difference, step 1e-08"]


def burgers(u, c, steps):
    for _ in range(steps):
        for i in range(u.size - 1, 0, -1):
            u[i] -= c * u[i] * (u[i] - u[i - 1])


def energy(u):
    """Reads its array and writes nothing."""
    return 0.5 * np.sum(u ** 2)


def distance(u, c):
    total = 0.0
    for i in range(u.size):
        total += abs(c * u[i] - 1.0) ** 1.5
    return total


def quick(f, *args, **options):
    return bench(f, *args, budget=0.0, **{"engine": "numpy", **options})


def errors(found):
    return {r.name: r.error for r in found.runs}


# -- what is compared -----------------------------------------------------------------------------------------------

@pytest.mark.parametrize("engine", ["numpy", pytest.param("numba", marks=pytest.mark.skipif(
    "not __import__('importlib.util').util.find_spec('numba')"))])
def test_every_way_is_timed_and_held_against_the_complex_step(engine):
    found = quick(burgers, U, 0.1, 3, engine=engine)
    assert [r.name for r in found.runs] == [*REVERSE, "vjp", "tangent", "complex step", *DIFFERENCES]
    assert [r.count for r in found.runs] == [0, 1, 1, *[5] * 8]
    assert found.inputs == found.compared == 5 and found.floor == 0.0
    error = errors(found)
    assert max(error[n] for n in ("adjoint, bare", "vjp", "tangent")) < 1e-14 < error[DIFFERENCES[0]] < 1e-1
    assert all(r.times.lower <= r.times.median <= r.times.upper and r.times.rounds >= 3 for r in found.runs)
    assert found.remarks == (
        "error: the largest of the 5 derivatives, as a fraction of the largest; against the complex step, which is "
        "exact to rounding", "memory: arrays 32 bytes, shadows 32 bytes, recorded 72 bytes; 136 bytes in all")
    assert np.array_equal(U, [1.0, 2.0, 0.5, 1.5])


def test_a_function_that_returns_one_float_is_called_as_gradient():
    found = quick(energy, U)
    assert [r.name for r in found.runs][:3] == [*REVERSE, "gradient"] and errors(found)["gradient"] == 0.0
    assert found.remarks[-1] == "memory: arrays 32 bytes, shadows 32 bytes, recorded nothing; 64 bytes in all"


def test_what_a_function_carries_counts_and_can_be_overridden():
    carried = s2sad.differentiate(burgers, wrt="u", engine="numpy")
    assert "d(u) / d(u), engine numpy" in bench(carried, U, 0.1, 3, budget=0.0).title
    assert "d(u) / d(c), engine numpy" in bench(carried, U, 0.1, 3, budget=0.0, wrt="c").title


def test_structures_and_single_precision():
    def step(state, k):
        for i in range(state["u"].size):
            state["u"][i] *= k * state["w"][i]
    found = quick(step, {"u": U.copy(), "w": np.ones(4, "float32")}, 2.0)
    assert "d(state_u) / d(state_u, state_w, k)" in found.title
    assert "differences and the complex step are taken in float64" in found.remarks
    assert errors(found)["vjp"] < 1e-6


def test_some_of_many_inputs_are_compared():
    found = quick(energy, np.ones(100))
    assert (found.inputs, found.compared) == (100, 6)
    assert found.remarks[0].startswith("error: the largest of 6 of the 100 derivatives, ")


# -- what is held against what --------------------------------------------------------------------------------------

def test_a_complex_step_that_is_another_number_is_left_out():
    found = quick(distance, U, 0.3)
    assert "complex step" not in errors(found)
    assert "no complex step: differences do not confirm it, as with abs, or near a kink" in found.remarks
    assert "against extrapolated differences, which estimate their own error at" in found.remarks[0]
    assert 0.0 < found.floor < 1e-9 and errors(found)["gradient"] <= 10 * found.floor
    assert f"<= {found.floor:.1e}" in str(found)


def absolute(x):
    return math.fabs(x)


def test_a_kernel_that_takes_no_complex_numbers():
    assert any(r.startswith("no complex step: TypeError: ") for r in quick(absolute, 2.0).remarks)


def test_nothing_is_compared_at_a_kink():
    found = quick(absolute, 0.0)
    assert np.isnan(errors(found)["gradient"]) and "unknown" in str(found)
    assert "(and say nothing of 1 of them: a kink or a jump is near)" in found.remarks[0]


def choosing(u):
    return np.sum(np.where(u > 0.0, u, -u))


def logarithms(u):
    return np.sum(np.log(u))


@pytest.mark.filterwarnings("ignore:invalid value:RuntimeWarning")
@pytest.mark.parametrize(("kernel", "u"), [(choosing, np.zeros(2)), (logarithms, -np.ones(2))])
def test_a_complex_step_that_nothing_confirms_is_left_out(kernel, u):
    found = quick(kernel, u)
    assert "complex step" not in errors(found) and np.isnan(errors(found)["gradient"])
    assert "no complex step: differences do not confirm it, as with abs, or near a kink" in found.remarks


def test_an_error_is_a_fraction_of_the_largest_derivative():
    assert ReferenceSlopes(np.array([1.0, -4.0]), 0.0, "").error(np.array([1.0, -3.0])) == 0.25
    assert ReferenceSlopes(np.zeros(2), 0.0, "").error(np.array([0.0, 2.0])) == 2.0


def test_a_refusal_is_that_of_the_adjoint():
    def doubled(u):
        return np.partition(u, 1)
    with pytest.raises(S2sadError) as refused:
        quick(doubled, U)
    with pytest.raises(S2sadError) as expected:
        s2sad.differentiate(doubled, engine="numpy").adjoint_source(U)
    assert str(refused.value) == str(expected.value)


# -- how it is shown ------------------------------------------------------------------------------------------------

def test_a_notebook_shows_a_table():
    shown = quick(energy, U)._repr_html_()
    assert shown.count("<tr>") == 1 + 5 + 6 and "<caption>Bench of energy: d(return) / d(u), engine numpy" in shown


@pytest.mark.parametrize("kind, begins", [("png", b"\x89PNG"), ("svg", b"<?xml"), ("pdf", b"%PDF")])
def test_the_picture_is_written(tmp_path, kind, begins):
    pytest.importorskip("matplotlib")
    found = quick(distance, U, 0.3)
    found.picture(str(tmp_path / f"bench.{kind}"))
    assert (tmp_path / f"bench.{kind}").read_bytes().startswith(begins)


def test_no_picture_of_an_unknown_kind(tmp_path):
    pytest.importorskip("matplotlib")
    with pytest.raises(S2sadError) as refused:
        quick(energy, U).picture("bench.txt")
    assert str(refused.value) == ("error[S407]: bench.txt: matplotlib writes no such picture\n"
                                  "  help: give a file that ends in .png, .svg or .pdf")


def test_no_picture_without_matplotlib(monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    with pytest.raises(S2sadError) as refused:
        quick(energy, U).picture(str(tmp_path / "bench.png"))
    assert str(refused.value) == ("error[S405]: a picture needs matplotlib, which is not installed\n"
                                  '  help: pip install "s2sad[plot]", or leave the picture out')
    assert not list(tmp_path.iterdir())


# -- the command ----------------------------------------------------------------------------------------------------

SCALE = "def scale(u, c):\n    for i in range(u.size):\n        u[i] = c * u[i]\n"


@pytest.fixture
def ran(tmp_path, monkeypatch, capsys):
    """Runs the command beside a file `k.py`; gives (status, stdout, stderr)."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "k.py").write_text(SCALE, encoding="utf-8")

    def run(*arguments):
        return (main(["bench", "k.py:scale", "--budget", "0", *arguments]), *capsys.readouterr())
    return run


def test_the_command(ran, tmp_path):
    status, out, err = ran("--engine", "numpy")
    assert (status, err) == (0, "running k.py and scale on made-up arguments (give yours with --arguments)\n")
    assert out.startswith("Bench of scale: d(u) / d(u, c), engine numpy, one thread") and "memory: arrays 48 " in out
    status, out, err = ran("--engine", "numpy", "--arguments", "np.ones(3), 2.0", "--wrt", "c", "-o", "bench.txt")
    assert (status, out, err) == (0, "", "running k.py and scale\n")
    assert "d(u) / d(c)" in (tmp_path / "bench.txt").read_text(encoding="utf-8")


def test_the_command_draws(ran, tmp_path):
    pytest.importorskip("matplotlib")
    assert ran("--engine", "numpy", "--picture", "k.png")[0] == 0
    assert (tmp_path / "k.png").read_bytes().startswith(b"\x89PNG")


def test_the_command_refuses_a_picture_before_it_runs(ran, tmp_path, monkeypatch):
    assert ran("--picture", "k.py")[1:] == (
        "", "error[S407]: k.py: the function is read from this file\n  help: give --picture another file\n")
    assert ran("--picture", ".")[1:] == (
        "", "error[S407]: .: cannot be written (it is a directory)\n  help: give --picture a file\n")
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    assert ran("--picture", "k.png")[1:] == (
        "", "error[S405]: a picture needs matplotlib, which is not installed\n"
        '  help: pip install "s2sad[plot]", or leave the picture out\n')
    assert (tmp_path / "k.py").read_text(encoding="utf-8") == SCALE


def test_structures_are_not_made_up(ran, tmp_path, capsys):
    (tmp_path / "s.py").write_text("def f(s):\n    s['u'][0] *= 2.0\n", encoding="utf-8")
    assert main(["bench", "s.py:f", "--types", "s: {u: float64[:]}"]) == 1
    assert capsys.readouterr().err == (
        "error[S405]: 'f' takes structures, and none can be made up\n"
        "  help: give its arguments as Python, in --arguments, or call s2sad.bench\n")


def test_a_word_that_is_nearly_the_command(capsys):
    with pytest.raises(SystemExit):
        main(["bensh", "k.py:f"])
    assert "there is no command 'bensh'; did you mean 'bench'?" in capsys.readouterr().err


def test_the_package_loads_no_matplotlib():
    code = "import sys, s2sad; s2sad.bench; sys.exit('matplotlib' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], check=False)
    assert done.returncode == 0
