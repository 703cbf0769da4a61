"""What the commands write, and which of them run the file."""
from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import s2sad
from tests.conftest import ROOT
from benchmarks.kernels.cases import LOOPS
from tests.cli.files import BRUSSELATOR, KERNELS, SCALE, run_python


def test_adjoint_to_stdout(ran, kernel):
    kernel(SCALE)
    status, out, err = ran("adjoint", "k.py:scale", "--wrt", "u")
    assert (status, err) == (0, "")
    assert out.startswith('''"""Adjoint of scale: d(u) / d(u).

Engine: NumPy. Level: plain. Arguments:
    u: float64[:], in-out (assumed: used as an array with 1 axis)
    c: float64, in (assumed: nothing says otherwise)

It records nothing.
"""
''')
    assert "def scale_adjoint(u, u_bar, c):\n    # reverse sweep\n    for i in range(" in out
    assert ran("adjoint", "k.py:scale", "--wrt", "u")[1] == out


def test_the_two_sweeps_as_two_functions(tmp_path, ran, kernel):
    kernel(SCALE)
    status, out, err = ran("adjoint", "k.py:scale", "--wrt", "u", "--split")
    assert (status, err) == (0, "")
    assert out.startswith('"""Adjoint of scale in two functions: d(u) / d(u).\n')
    assert "def scale_augmented(u, c):\n" in out and "    return None, (u, c)\n" in out
    assert "def scale_reverse(tape, u_bar):\n    u, c = tape\n    # reverse sweep\n    for i in range(" in out
    for case in LOOPS:
        source, options = f"{case.function.__code__.co_filename}:{case.function.__name__}", (
            "--wrt", ",".join(case.wrt), "--of", ",".join(case.of), "--split", "--engine", "numba", "--level", "fast")
        status, _, err = ran("adjoint", source, *options, "-o", tmp_path / f"{case.name}.py")
        assert status == 0, err
    done = run_python("-m", "ruff", "check", "--isolated", str(tmp_path))
    assert done.returncode == 0, done.stdout


@pytest.mark.parametrize("mode", ["adjoint", "tangent"])
def test_files_pass_ruff_and_run_with_numpy_alone(tmp_path, ran, mode):
    for case in LOOPS:
        source = Path(case.function.__code__.co_filename)
        for engine, level in (("numpy", "plain"), ("numba", "fast")):
            path = tmp_path / f"{case.name}_{engine}.py"
            status, _, err = ran(mode, f"{source}:{case.function.__name__}", "--wrt", ",".join(case.wrt), "--of",
                                 ",".join(case.of), "--standalone", "--engine", engine, "--level", level, "-o", path)
            assert status == 0, err
            assert max(map(len, path.read_text().splitlines())) <= 100
    done = run_python("-m", "ruff", "check", "--isolated", str(tmp_path))
    assert done.returncode == 0, done.stdout
    program = ("import sys; sys.modules['s2sad'] = None\n"
               f"sys.path.insert(0, {str(tmp_path)!r})\n"
               f"import {', '.join(p.stem for p in sorted(tmp_path.glob('*.py')))}\n")
    done = run_python("-I", "-c", program, cwd=tmp_path)
    assert done.returncode == 0, done.stderr


def test_a_standalone_adjoint_computes_the_gradient_without_s2sad(tmp_path, ran):
    path = tmp_path / "newton_adjoint.py"
    assert ran("adjoint", f"{KERNELS / 'loops.py'}:newton", "--wrt", "a", "--standalone", "-o", path)[0] == 0
    program = ("import sys; sys.modules['s2sad'] = None\nimport numpy as np\n"
               f"sys.path.insert(0, {str(tmp_path)!r})\nfrom newton_adjoint import newton_adjoint\n"
               "a, a_bar = np.array([1.0, 8.0]), np.zeros(2)\n"
               "newton_adjoint(np.zeros(2), np.ones(2), a, a_bar, 1e-12)\nprint(a_bar.tolist())\n")
    done = run_python("-I", "-c", program, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert np.allclose(json.loads(done.stdout), [1 / 3, 1 / 12])


def test_explain_as_text_json_and_page(ran, kernel):
    kernel("import numpy as np\n\n\n" + SCALE + "    return np.sum(u * u)\n")
    assert ran("explain", "k.py:scale")[1].startswith("Adjoint of scale: d(u, return) / d(u, c), engine numpy\n")
    assert "\nrecords 8 * u.size bytes\n" in ran("explain", "k.py:scale")[1]
    assert "\nrecords 4.00 MB\n" in ran("explain", "k.py:scale", "--arguments", "u=np.ones(500_000)")[1]
    assert json.loads(ran("explain", "k.py:scale", "--json")[1])["functions"][0]["name"] == "scale_adjoint"
    assert ran("explain", "k.py:scale", "--html")[1].startswith("<!DOCTYPE html>")


def test_check_runs_the_file_and_says_so(ran, kernel):
    kernel(SCALE)
    status, out, err = ran("check", "k.py:scale", "--engine", "numpy")
    assert status == 0 and "PARTS" not in out
    assert err == "running k.py and scale on made-up arguments (give yours with --arguments)\n"
    status, out, err = ran("check", "k.py:scale", "--engine", "numpy", "--arguments", "np.ones(3), 2.0")
    assert (status, err) == (0, "running k.py and scale\n")


def test_check_and_bench_of_loops_that_keep_snapshots(ran, kernel):
    kernel("def decay(u, steps: int):\n    for k in range(steps):\n        u *= 1.0 - 0.1 * u\n    return u[0]\n")
    given = "--engine", "numpy", "--arguments", "np.ones(100), 50", "--checkpoint", "k=4"
    assert ran("check", "k.py:decay", *given)[0] == 0
    assert "recorded 4,000 bytes" in ran("bench", "k.py:decay", "--budget", "0", *given)[1]
    status, _, err = ran("check", "k.py:decay", *given[:-1], "m=4")
    assert status == 1 and "checkpoint names 'm', which is no loop of 'decay'" in err


def test_a_limit_for_the_memory_where_sizes_are_known(ran, kernel):
    kernel("def decay(u, steps: int):\n    for k in range(steps):\n        u *= 1.0 - 0.1 * u\n    return u[0]\n")
    given = "--engine", "numpy", "--arguments", "u=np.ones(100), steps=500", "--checkpoint", "30 kB"
    assert "the loop over k keeps " in ran("explain", "k.py:decay", *given)[1]
    assert ran("check", "k.py:decay", *given[:3], "np.ones(100), 500", *given[4:])[0] == 0
    for command in ("adjoint", "stages", "explain"):
        status, _, err = ran(command, "k.py:decay", "--checkpoint", "30 kB")
        assert status == 1
        assert err == ("error[S408]: a limit for the memory chooses loops by the sizes of arguments, which are not "
                       "known here\n  help: name the loops that keep snapshots, and how many: k=20\n")


def test_snapshots_in_files_of_a_folder(ran, kernel):
    """Also of a file that needs NumPy alone."""
    kernel("def decay(u, steps: int):\n    for k in range(steps):\n        u *= 1.0 - 0.1 * u\n    return u[0]\n")
    status, text, _ = ran("adjoint", "k.py:decay", "--standalone", "--checkpoint", "k=4@.")
    assert status == 0 and 'u_snapshots = on_disk(u, min(5, trips), ".")\n' in text
    space: dict = {}
    exec(text, space)
    u_bar = np.zeros(3)
    space["decay_adjoint"](np.ones(3), u_bar, 9, 1.0)
    assert u_bar[0] > 0.0 and not u_bar[1:].any()
    status, _, err = ran("adjoint", "k.py:decay", "--checkpoint", "k=4@")
    assert status == 2 and "is not LOOP=NUMBER or LOOP=NUMBER@FOLDER" in err


def test_the_other_commands_do_not_run_the_file(ran, kernel):
    kernel(SCALE + "raise SystemExit('it was run')\n")
    for command in ("adjoint", "tangent", "explain", "stages"):
        assert ran(command, "k.py:scale")[0] == 0


def test_help_teaches(ran):
    status, out, _ = ran("--help")
    assert status == 0 and "s2sad adjoint kernel.py:step --wrt u,p" in out and "not run" in out
    for command in ("adjoint", "tangent", "explain", "stages", "check", "bench"):
        status, out, _ = ran(command, "--help")
        assert status == 0 and f"s2sad {command} kernel.py:step" in out
    assert ran()[0] == 2


def test_versions(ran):
    status, out, _ = ran("--version")
    assert status == 0 and out.startswith(f"s2sad {s2sad.__version__} (Python 3.") and f"NumPy {np.__version__}" in out


def test_the_module_is_the_command(tmp_path):
    done = run_python("-m", "s2sad", "adjoint", BRUSSELATOR, "--wrt", "u", cwd=ROOT)
    assert done.returncode == 0 and "p_bar" not in done.stdout and "def brusselator_adjoint(" in done.stdout
