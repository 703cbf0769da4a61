"""Arguments that `explain` is given on the command line: values without running anything."""
from __future__ import annotations

import numpy as np
import pytest

from s2sad import S2sadError
from s2sad.cli import main
from s2sad.report.argument_literals import evaluate_arguments, form_of_literal

NAMES = ("u", "v", "n")


@pytest.mark.parametrize(("text", "shape", "dtype"), [
    ("np.ones((3, 4))", (3, 4), "float64"),
    ("numpy.zeros(5, dtype=np.float32)", (5,), "float32"),
    ("np.full((2, 2), 7)", (2, 2), "int64"),
    ("np.empty(2 ** 10 - 24)", (1000,), "float64"),
    ("np.arange(10)", (10,), "int64"),
    ("np.arange(0, 1, 0.25)", (4,), "float64"),
    ("np.linspace(0.0, 1.0, 11)", (11,), "float64"),
    ("np.eye(3)", (3, 3), "float64"),
    ("np.array([[1.0, 2.0], [3.0, -4.0]])", (2, 2), "float64"),
    ("np.random.rand(6, 7)", (6, 7), "float64"),
    ("float32[8, 9]", (8, 9), "float32"),
    ("np.complex128[1, 9]", (1, 9), "complex128"),
    ("np.ones((100_000, 100_000))", (100_000, 100_000), "float64"),     # takes no memory
])
def test_arrays(text, shape, dtype):
    value = evaluate_arguments(f"u={text}", NAMES)["u"]
    assert (value.shape, value.dtype.name) == (shape, dtype)
    kind = form_of_literal(value)
    assert (kind.dtype, kind.rank, kind.ones) == (dtype, len(shape), tuple(k for k, s in enumerate(shape) if s == 1))


def test_numbers_and_names():
    assert evaluate_arguments("1.5, n=-3 * 4 // 5, v=True", NAMES) == {"u": 1.5, "v": True, "n": -3}
    assert evaluate_arguments("u: 1.5, n: (2 + 1) ** 2", NAMES) == {"u": 1.5, "n": 9}
    assert evaluate_arguments("u=2, n=2", NAMES, ["u"]) == {"u": 2.0, "n": 2} and evaluate_arguments("", NAMES) == {}
    assert isinstance(evaluate_arguments("u=2", NAMES, ["u"])["u"], float)
    assert isinstance(evaluate_arguments("np.float32(2)", NAMES)["u"], np.float32)


@pytest.mark.parametrize(("text", "message"), [
    ("__import__('os').system('touch seen')", "__import__('os').system('touch seen') would have to be run"),
    ("u=open('k.py').read()", "open('k.py').read() would have to be run"),
    ("u=[x for x in (1, 2)]", "[x for x in (1, 2)] would have to be run"),
    ("u=np.ones.__class__", "np.ones.__class__ would have to be run"),
    ("u=np.load('k.npy')", "'k.npy' would have to be run"),
    ("u=np.ones(*(3, 4))", "np.ones(*(3, 4)) would have to be run"),
    ("u=n", "n would have to be run"),
    ("1)(2", "this is neither NAME=VALUE, ... nor NAME: VALUE, ..."),
    ("u=1, v: 2", "this is neither NAME=VALUE, ... nor NAME: VALUE, ..."),
    ("w=1", "'w' is no parameter: they are u, v, n"),
    ("**{'u': 1}", "'**' is no parameter: they are u, v, n"),
    ("1.0, u=2", "'u' is given twice"),
    ("1, 2, 3, 4", "4 are given, and there are 3 parameters"),
    ("u: float64[:, :]", "float64[:, :] has no sizes"),
    ("u: float63[2]", "'float63' is no dtype; use float64, float32, complex128, int64, int32, int16, int8, uint64, "
     "uint32, uint16, uint8, bool"),
    ("u=9 ** 9 ** 9", "9 ** 9 ** 9 is too large"),
    ("u=2 ** 62 * 2", "an integer does not fit 64 bits"),
    ("u=1 / 0", "ZeroDivisionError: division by zero"),
    ("u=np.ones(-1)", "-1 is no shape"),
    ("u=np.ones((2 ** 40, 2 ** 40))", "an array of the shape (1099511627776, 1099511627776) is too large"),
    ("u=np.array(['a'])", "'a' would have to be run"),
    ("u=[1] * 10 ** 9", "[1] is no number"),
])
def test_refusals(text, message):
    with pytest.raises(S2sadError) as refusal:
        evaluate_arguments(text, NAMES)
    [found] = refusal.value.diagnostics
    assert (found.code, found.message) == ("S405", f"--arguments: {message}")


STRUCTURED = """def step(state, dt: float, n):
    for k in range(n):
        for i in range(state.u.size):
            state.u[i] += dt * state.u[i] ** 2
        state.t += dt


raise SystemExit("it was run")
"""


@pytest.mark.parametrize("arguments", [
    "state={'u': np.ones(100_000), 't': 0.0}, dt=1, n=3", "state: {u: float64[100_000], t: 0.0}, dt: 1, n: 3"])
def test_structures_and_the_command(arguments, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "k.py").write_text(STRUCTURED)
    assert main(["explain", "k.py:step", "--arguments", arguments]) == 0
    assert capsys.readouterr().out.splitlines()[:10] == [
        "Adjoint of step: d(state_u, state_t) / d(state_u, state_t, dt), engine numpy", "records 2.40 MB", "",
        "computed before the run", "  state.u is the parameter state_u", "  state.t is the parameter state_t", "",
        "step_adjoint", "  recorded", "    state_u_stack: 2.40 MB = 8 * len(range(n)) * state_u.size bytes, state_u "
        "before `state.u[i] += dt * state.u[i] ** 2`"]
    assert main(["explain", "k.py:step", "--types", "state: {u: float64[:], t: float}", "--arguments", "n=3"]) == 0
    assert capsys.readouterr().out.splitlines()[1] == "records 8 * len(range(n)) * state_u.size bytes"
