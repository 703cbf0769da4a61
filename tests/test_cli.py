"""The command: what it writes, the types it takes, its messages and exit statuses."""
from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import s2sad
from s2sad.cli import main
from s2sad.diagnostics import Report
from s2sad.infer.assumed_types import assumed_types
from s2sad.report.stages import KERNEL_STAGES, STAGES, stages
from s2sad.dispatch.arguments import types as types_of
from s2sad import read
from s2sad.infer.types import of_value
from s2sad.program import Request
from s2sad.run import store
from tests.conftest import ROOT
from benchmarks.kernels.cases import LOOPS

KERNELS = Path(__file__).resolve().parents[1] / "benchmarks" / "kernels"
BRUSSELATOR = f"{KERNELS / 'brusselator.py'}:brusselator"


@pytest.fixture
def ran(capsys):
    """Runs the command; gives (status, stdout, stderr)."""
    def run(*arguments):
        try:
            status = main([str(a) for a in arguments])
        except SystemExit as end:
            status = end.code
        return (status, *capsys.readouterr())
    return run


@pytest.fixture
def kernel(tmp_path, monkeypatch):
    """Writes a file `k.py` into the working directory."""
    monkeypatch.chdir(tmp_path)

    def write(text, name="k.py"):
        (tmp_path / name).write_text(text, encoding="utf-8")
    return write


def run_python(*arguments, cwd=None):
    return subprocess.run([sys.executable, *arguments], check=False, capture_output=True, text=True, cwd=cwd)


SCALE = "def scale(u, c):\n    for i in range(u.size):\n        u[i] = c * u[i]\n"


# -- what it writes -------------------------------------------------------------------------------------------------

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


def test_a_file_is_written_whole(ran, kernel, tmp_path):
    kernel(SCALE)
    assert ran("tangent", "k.py:scale", "-o", "out.py")[:2] == (0, "")
    assert "def scale_tangent(u, u_dot, c, c_dot):" in (tmp_path / "out.py").read_text()
    assert sorted(p.name for p in tmp_path.iterdir()) == ["k.py", "out.py"]


def test_a_refusal_leaves_the_file_as_it_was(ran, kernel, tmp_path):
    kernel("def f(a):\n    total = 0.0\n    with a:\n        total += 1.0\n    return total\n")
    (tmp_path / "out.py").write_text("kept")
    status, out, err = ran("adjoint", "k.py:f", "-o", "out.py")
    assert (status, out) == (1, "") and "k.py:3:" in err
    assert (tmp_path / "out.py").read_text() == "kept"


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
    kernel(SCALE)
    assert ran("explain", "k.py:scale")[1].startswith("Adjoint of scale: d(u) / d(u, c), engine numpy\n")
    assert "\nrecords 8 * u.size bytes\n" in ran("explain", "k.py:scale")[1]
    assert "\nrecords 4.00 MB\n" in ran("explain", "k.py:scale", "--arguments", "u=np.ones(500_000)")[1]
    assert json.loads(ran("explain", "k.py:scale", "--json")[1])["functions"][0]["name"] == "scale_adjoint"
    assert ran("explain", "k.py:scale", "--html")[1].startswith("<!DOCTYPE html>")


@pytest.mark.parametrize("engine", ["numpy", "numba"])
def test_every_stage_is_python_that_can_be_run(engine):
    program = read.load_file(*BRUSSELATOR.split(":"))
    case = next(c for c in LOOPS if c.name == "brusselator")
    types = tuple(map(of_value, case.arguments("small")))
    texts = stages(program, Request("adjoint", types, ("u", "p"), ("du",), engine, "fast"))
    assert list(texts) == list(STAGES)
    for stage, text in {text: (stage, text) for stage, text in texts.items()}.values():
        space = {}
        exec(compile(text, stage, "exec"), space)
        if stage in KERNEL_STAGES:
            given, expected = case.arguments("small"), case.arguments("small")
            case.function(*expected)
            space["brusselator"](*given)
            assert np.allclose(given[0], expected[0], rtol=1e-14)
        else:
            du, u, p, t = case.arguments("small")
            u_bar, p_bar = np.zeros_like(u), np.zeros_like(p)
            space["brusselator_adjoint"](du, np.ones_like(du), u, u_bar, p, p_bar, t)
            assert abs(p_bar[1] - 49.0) < 1e-9


def test_a_stage_by_its_name(ran):
    status, text, err = ran("stages", BRUSSELATOR, "--after", "single_exit", "--wrt", "u,p")
    assert status == 0, err
    assert text.splitlines()[0] == '"""brusselator after single_exit."""'


def test_all_stages_and_rooms(ran):
    text = ran("stages", BRUSSELATOR)[1]
    assert [line.split()[3] for line in text.splitlines() if line.startswith("# ---- after")] == list(STAGES)
    room, stage = (ran("stages", BRUSSELATOR, "--after", after)[1] for after in ("normalize", "check_known"))
    assert room == stage


def test_check_runs_the_file_and_says_so(ran, kernel):
    kernel(SCALE)
    status, out, err = ran("check", "k.py:scale", "--engine", "numpy")
    assert status == 0 and "PARTS" not in out
    assert err == "running k.py and scale on made-up arguments (give yours with --arguments)\n"
    status, out, err = ran("check", "k.py:scale", "--engine", "numpy", "--arguments", "np.ones(3), 2.0")
    assert (status, err) == (0, "running k.py and scale\n")


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


# -- types ----------------------------------------------------------------------------------------------------------

@pytest.mark.parametrize("case", LOOPS, ids=lambda c: c.name)
def test_types_from_use_are_those_of_the_arguments(case):
    program = read.load(case.function)
    entry = program.kernels[program.entry]
    report = Report(entry.source)
    found = assumed_types(program.entry, {n: k.tree for n, k in program.kernels.items()}, entry.parameters,
                    entry.annotations, entry.defaults, {}, report)
    report.finish()
    assert tuple(found[p].type for p in entry.parameters) == types_of(case.arguments("small"))


def arguments(text):
    return [line.strip() for line in text.splitlines() if line.startswith("    ") and ": " in line][:5]


def test_types_are_given_annotated_defaulted_or_assumed(ran, kernel):
    kernel('def f(a: "float32[:, :]", n: int, c: float, m, scale=2.0):\n'
           "    for i in range(m):\n        a[i, n] *= c * scale\n")
    assert arguments(ran("tangent", "k.py:f", "--types", "m: int32")[1]) == [
        "a: float32[:, :], in-out", "n: int64, in", "c: float64, in", "m: int32, in",
        "scale: float64, in (assumed: its default value)"]


def test_types_through_views_helpers_and_unpacking(ran, kernel):
    kernel("def add(row, k, s):\n    row[k] += s\n\n\n"
           "def f(x, p, j, shift):\n    a, b = p\n    for row in x:\n        add(row, j, a * b)\n"
           "    x[0, 1 << shift] = a\n")
    assert arguments(ran("tangent", "k.py:f")[1])[:4] == [
        "x: float64[:, :], in-out (assumed: used as an array with 2 axes)",
        "p: float64[:], in (assumed: used as an array with 1 axis)",
        "j: int64, in (assumed: used as a bound, an index or a shift)",
        "shift: int64, in (assumed: used as a bound, an index or a shift)"]


def test_types_of_what_tuples_and_lists_spell_out(ran, kernel):
    kernel("def f(x, u, v, m, n, a, b):\n    for w in (u, v):\n        w[0] += x[1]\n    for i in [m, n]:\n"
           "        x[i] = u[0]\n    pair = a, b\n    x[0] *= pair[1]\n")
    lines = [line.strip() for line in ran("tangent", "k.py:f")[1].splitlines() if "(assumed: " in line]
    assert [line.partition(",")[0] for line in lines] == [
        "x: float64[:]", "u: float64[:]", "v: float64[:]", "m: int64", "n: int64", "a: float64", "b: float64"]


def test_axes_are_integers_where_an_array_is_moved(ran, kernel):
    kernel('import numpy as np\n\n\ndef f(x: "float64[:, :]"):\n    return np.sum(np.moveaxis(x, 0, 1)[0])\n')
    assert arguments(ran("tangent", "k.py:f")[1]) == ["x: float64[:, :], in"]


def test_types_that_contradict_each_other(ran, kernel):
    kernel("def f(x):\n    for i in range(x):\n        x[i] = 0.5\n    return 1.0\n")
    assert ran("adjoint", "k.py:f") == (1, "", """\
k.py:2:20: error[S203]: the type of 'x' cannot be inferred: it is used as an array and as a bound, an index or a shift
  2 |     for i in range(x):
    |                    ^ here as an integer
  help: say which: --types "x: float64[:]"
""")
    kernel('def f(x: "float64[:]", y: float):\n    return x[0, 1] * y\n')
    assert ran("adjoint", "k.py:f") == (1, "", """\
k.py:2:12: error[S203]: 'x' is annotated as float64[:] and used as an array with 2 axes
  2 |     return x[0, 1] * y
    |            ^^^^^^^ here
  help: correct the annotation, or say it here: --types "x: float64[:, :]"
""")
    kernel("def f(x, n: float):\n    return x[n]\n")
    assert ran("adjoint", "k.py:f") == (1, "", """\
k.py:2:14: error[S203]: 'n' is annotated as float64 and used as a bound, an index or a shift
  2 |     return x[n]
    |              ^ here
  help: correct the annotation, or say it here: --types "n: int64"
""")


# -- bad input ------------------------------------------------------------------------------------------------------

def test_a_file_that_is_not_python(ran, kernel):
    kernel("def f(x:\n    return x\n")
    status, out, err = ran("adjoint", "k.py:f")
    assert (status, out) == (1, "")
    assert err.startswith("k.py:1:6: error[S102]: not Python: '(' was never closed\n  1 | def f(x:\n")


def test_a_file_that_is_missing_a_directory_or_not_utf8(ran, kernel, tmp_path):
    kernel(SCALE)
    (tmp_path / "bad.py").write_bytes(b"# first\n# second\nx = '\xff'\n")
    assert ran("adjoint", "none.py:f") == (1, "", "error[S101]: none.py: no such file\n"
                                           "  help: check the path, which is relative to the working directory\n")
    assert ran("adjoint", ".:f") == (1, "", "error[S101]: .: this is a directory\n"
                                     "  help: give a Python file: kernel.py:function\n")
    assert ran("adjoint", "bad.py:f") == (
        1, "", "bad.py:3:6: error[S101]: not UTF-8 (byte 0xff)\n  3 | x = '\ufffd'\n    |      ^\n"
        "  help: save the file as UTF-8, or name its encoding in the first line: # -*- coding: latin-1 -*-\n")


def test_a_function_that_is_not_in_the_file(ran, kernel):
    kernel(SCALE)
    assert ran("adjoint", "k.py:scal") == (1, "", "error[S103]: k.py: no function 'scal' at module level\n"
                                           "  help: did you mean 'scale'? the file defines: scale\n")


def test_wrt_that_cannot_be_meant(ran, kernel):
    kernel("def f(u, n):\n    total = 0.0\n    for i in range(n):\n        total += u[i]\n    return total\n")
    assert ran("adjoint", "k.py:f", "--wrt", "v") == (
        1, "", "error[S401]: wrt names 'v', which is no parameter of 'f'\n  help: its parameters are u, n\n")
    assert ran("adjoint", "k.py:f", "--wrt", "n") == (
        1, "", "error[S401]: wrt names 'n', which is an integer\n"
        "  help: give a float (3.0, not 3) if it is a real quantity\n")
    assert ran("adjoint", "k.py:f", "--of", "u")[2].startswith(
        "error[S401]: 'u' is no output of 'f', which does not write it\n")


def test_wrt_that_no_output_depends_on_is_a_warning(ran, kernel):
    kernel("def f(u, c):\n    return u[0]\n")
    status, out, err = ran("adjoint", "k.py:f", "--wrt", "u,c")
    assert status == 0 and "c_bar = 0.0" in out
    assert err == "warning[S401]: no output asked for of 'f' depends on 'c': its gradient is zero\n"
    assert ran("adjoint", "k.py:f")[2] == ""


STRUCTURES = """def step(state, p, layers, dt, mask=None):
    for w, b in layers:
        for i in range(state.u.size):
            state.u[i] += dt * p["k"] * w[i] * b
    if mask is not None:
        state.u[0] *= mask[0]
    state.t += dt
"""


def test_structures(ran, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "s.py").write_text(STRUCTURES)
    types = "state: {u: float64[:], t: float}, p: {k: float64}, layers: ((float64[:], float),)"
    status, text, _ = ran("adjoint", "s.py:step", "--types", types, "--wrt", "state.u,p", "--of", "state")
    assert not status
    assert "state_u, state_u_bar, state_t, state_t_bar, p_k, layers_0_0, layers_0_1, dt" in text
    assert "    return (p_k_bar,)" in text
    assert "mask" in ran("adjoint", "s.py:step", "--types", f"{types}, mask: float64[:]")[1]
    assert ran("adjoint", "s.py:step")[2] == """s.py:3:24: error[S203]: 'state' has parts, whose types are not known
  3 |         for i in range(state.u.size):
    |                        ^^^^^^^
  help: say what it is made of, as --types "state: {u: float64, t: float64}"
s.py:4:32: error[S203]: 'p' has parts, whose types are not known
  4 |             state.u[i] += dt * p["k"] * w[i] * b
    |                                ^^^^^^
  help: say what it is made of, as --types "p: {k: float64}"
"""
    assert ran("check", "s.py:step", "--types", types)[2] == (
        "error[S405]: 'step' takes structures, and none can be made up\n  help: give its arguments as Python, in "
        "--arguments, or call s2sad.check\n")


@pytest.mark.parametrize(("options", "message"), [
    (("k.py",), "'k.py' names no function at module level; k.py defines   s2sad adjoint k.py:scale"),
    (("k.py:",), "'k.py:' names no function at module level; k.py defines   s2sad adjoint k.py:scale"),
    (("k.py:C.scale",), "'k.py:C.scale' names no function at module level; k.py defines   s2sad adjoint k.py:scale"),
    (("k",), "'k' is not FILE:FUNCTION, as kernel.py:step"),
    (("k.py:scale", "--types", "u: flaot64[:]"), "--types: 'flaot64[:]' is no type for 'u'; use float64, float32, "
     "complex128, int64 or bool, an array of these, as float64[:, :], or a structure, as {u: float64[:], t: float}"),
    (("k.py:scale", "--types", "float64"), "--types: 'float64' is not NAME: TYPE, as u: float64[:, :]"),
    (("k.py:scale", "--types", "v: float64"), "--types names 'v', which is no parameter of 'scale': its parameters are "
     "u, c"),
    (("k.py:scale", "--engine", "jax"), "argument --engine: invalid choice: 'jax'"),
])
def test_wrong_usage(ran, kernel, options, message):
    kernel(SCALE)
    status, out, err = ran("adjoint", *options)
    assert (status, out) == (2, "") and message in err.replace("\n", " ")
    assert ran("stages", "k.py:scale", "--after", "supper")[0] == 2


def test_a_word_that_is_no_command(ran, kernel):
    kernel(SCALE)
    for words, message in ((("adjont", "k.py:scale"), "there is no command 'adjont'; did you mean 'adjoint'?"),
                           (("k.py:scale", "--wrt", "u"), "a command is missing: s2sad adjoint k.py:scale"),
                           (("k.py",), "a command is missing: s2sad adjoint k.py"),
                           (("supper",), "there is no command 'supper': the commands are adjoint, tangent, explain, "
                            "stages, check, bench, cache")):
        status, out, err = ran(*words)
        assert (status, out) == (2, "") and err.endswith(f"s2sad: error: {message}\n")


def test_a_file_without_functions_has_none_to_list(ran, kernel):
    kernel("x = 1\n")
    status, _, err = ran("adjoint", "k.py")
    assert status == 2 and err.endswith("'k.py' names no function, and k.py defines none at module level\n")
    assert ran("adjoint", "none.py")[::2] == (1, "error[S101]: none.py: no such file\n  help: check the path, which is "
                                              "relative to the working directory\n")


def test_versions(ran):
    status, out, _ = ran("--version")
    assert status == 0 and out.startswith(f"s2sad {s2sad.__version__} (Python 3.") and f"NumPy {np.__version__}" in out


def test_the_cache_is_shown_and_cleared(ran, tmp_path, monkeypatch):
    monkeypatch.setenv("S2SAD_CACHE_DIR", str(tmp_path / "cache"))
    monkeypatch.setenv("S2SAD_CACHE_SIZE", "200M")
    limits = "limits: 200.0 MB (S2SAD_CACHE_SIZE), 90 days without use (S2SAD_CACHE_DAYS)\n"
    assert ran("cache") == (0, f"{tmp_path / 'cache'}\n  nothing\n{limits}", "")
    store.put("a", bytes(2000), "code")
    store.put("b", bytes(200), "code")
    store.keep("f_0123456789abcdef0123.py", "x = 1\n")
    for k, path in enumerate(sorted((tmp_path / "cache" / "v2").iterdir(), key=lambda p: p.suffix)):
        os.utime(path, (time.time() + k - 86_400.0 * 7,) * 2)
    assert ran("cache")[1] == (
        f"{tmp_path / 'cache'}\n"
        "  machine code        2 entries     2.2 kB\n"
        "  generated text        1 entry    6 bytes\n"
        f"  in all              3 entries     2.2 kB, the oldest used 7 days ago\n{limits}")
    assert ran("cache", "--where") == (0, f"{tmp_path / 'cache'}\n", "")
    assert ran("cache", "--clear") == (0, f"3 entries removed (2.2 kB) from {tmp_path / 'cache'}\n", "")
    assert "  nothing\n" in ran("cache")[1]


@pytest.mark.skipif(not hasattr(os, "getuid"), reason="POSIX permissions")
def test_a_cache_that_others_can_write_is_shown_as_such(ran, tmp_path, monkeypatch):
    monkeypatch.setenv("S2SAD_CACHE_DIR", str(tmp_path / "cache"))
    store.put("a", bytes(2000), "code")
    (tmp_path / "cache").chmod(0o777)
    assert f"  NOT USED: {tmp_path / 'cache'} can be written by other users, and what it holds is executed\n" in ran(
        "cache")[1]


def test_a_user_without_a_home_has_no_cache(ran, monkeypatch):
    def homeless(*_):
        raise RuntimeError("Could not determine home directory.")
    monkeypatch.delenv("S2SAD_CACHE_DIR", raising=False)
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    monkeypatch.setattr(Path, "home", homeless)
    monkeypatch.setattr(sys, "platform", "linux")
    for option in ((), ("--where",), ("--clear",)):
        assert ran("cache", *option) == (1, "", "error[S407]: there is no cache: Could not determine home directory.\n"
                                         "  help: set S2SAD_CACHE_DIR to a folder of your own\n")
    assert store.put("key", b"content") and store.get("key") == b"content"      # in a folder of the process


def test_what_was_read_is_not_written_over(ran, kernel, tmp_path):
    kernel("from helpers import double\nfrom constants import G\n\n\ndef f(x):\n    return double(x) * G\n")
    kernel("def double(x):\n    return 2.0 * x\n", "helpers.py")
    kernel("G = 9.81\n", "constants.py")
    os.link("k.py", "hard.py")
    os.symlink("helpers.py", "soft.py")
    before = {p.name: p.read_bytes() for p in tmp_path.iterdir()}
    for output, same in (("k.py", ""), ("hard.py", f", which is {tmp_path / 'k.py'}"), ("constants.py", ""),
                         ("soft.py", f", which is {tmp_path / 'helpers.py'}")):
        for command in ("adjoint", "explain", "stages", "check"):
            assert ran(command, "k.py:f", "-o", output) == (
                1, "", f"error[S407]: {output}: the function is read from this file{same}\n"
                "  help: give -o another file\n")
    assert {p.name: p.read_bytes() for p in tmp_path.iterdir()} == before


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="POSIX files")
def test_only_plain_files_are_written_over(ran, kernel, tmp_path):
    kernel(SCALE)
    os.mkfifo("pipe")
    (tmp_path / "there.py").write_text("old\n")
    (tmp_path / "there.py").chmod(0o640)
    os.symlink("there.py", "link.py")
    for output, what in (("pipe", "no plain file"), (os.devnull, "no plain file"), (".", "a directory")):
        assert ran("adjoint", "k.py:scale", "-o", output) == (
            1, "", f"error[S407]: {output}: cannot be written (it is {what})\n"
            "  help: give -o a file, or leave it out to print\n")
    assert ran("adjoint", "k.py:scale", "-o", "link.py")[0] == 0
    assert (tmp_path / "link.py").is_symlink() and "def scale_adjoint" in (tmp_path / "there.py").read_text()
    assert (tmp_path / "there.py").stat().st_mode & 0o777 == 0o640
    assert ran("adjoint", "k.py:scale", "-o", "-")[1] == (tmp_path / "there.py").read_text()


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="Linux's device")
def test_letters_that_the_terminal_lacks_and_a_full_disk(tmp_path):
    (tmp_path / "k.py").write_bytes("# coding: latin-1\ndef f(x):\n    ä = x * x\n    return ä\n".encode("latin-1"))
    done = subprocess.run([sys.executable, "-m", "s2sad", "adjoint", "k.py:f"], capture_output=True, cwd=tmp_path,
                          env={**os.environ, "PYTHONIOENCODING": "ascii"}, check=True)
    assert "ä_bar = result_bar" in done.stdout.decode()
    with open("/dev/full", "w") as full:
        done = subprocess.run([sys.executable, "-m", "s2sad", "adjoint", "k.py:f"], stdout=full, text=True,
                              stderr=subprocess.PIPE, cwd=tmp_path, check=False)
    assert (done.returncode, done.stderr) == (
        1, "error[S407]: standard output cannot be written (No space left on device)\n  help: give -o a file\n")


def test_an_output_that_cannot_be_written(ran, kernel):
    kernel(SCALE)
    assert ran("adjoint", "k.py:scale", "-o", "nowhere/out.py") == (
        1, "", "error[S407]: nowhere/out.py: cannot be written (No such file or directory)\n"
        "  help: give -o a file in a folder that is there and can be written to\n")


def test_a_check_that_cannot_run(ran, kernel):
    kernel("def f(u, n):\n    return u[7 * n]\n")
    status, out, err = ran("check", "k.py:f", "--engine", "numpy")
    assert (status, out) == (1, "")
    assert "error[S405]: 'f' raised IndexError on made-up arguments: index 21 is out of bounds" in err
    kernel("1 / 0\n" + SCALE, "broken.py")
    assert "error[S101]: broken.py: raised ZeroDivisionError when it was run" in ran("check", "broken.py:scale")[2]
    assert "error[S405]: --arguments: NameError: name 'q'" in ran("check", "k.py:f", "--arguments", "q")[2]


def test_the_module_is_the_command(tmp_path):
    done = run_python("-m", "s2sad", "adjoint", BRUSSELATOR, "--wrt", "u", cwd=ROOT)
    assert done.returncode == 0 and "p_bar" not in done.stdout and "def brusselator_adjoint(" in done.stdout
