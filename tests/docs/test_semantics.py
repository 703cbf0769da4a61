"""docs/semantics.md is true: every row of its tables is executed under both engines, and so are its kernels."""
from __future__ import annotations

import importlib
import importlib.util
import inspect
import itertools
import re
import warnings
from pathlib import Path
from types import FunctionType, ModuleType
from typing import Any

import numpy as np
import pytest

import s2sad
from s2sad import Const, Differentiated, Duplicated, Forward, Reverse, S2sadError, autodiff, gradient, jvp, vjp
from tests.docs import semantics
from tests.interface import kernels

PAGE = Path(__file__).resolve().parents[2] / "docs" / "semantics.md"
ENGINES = ["numpy", "numba"]
_NUMBER = itertools.count()


def lines_under(head: tuple[str, ...]) -> list[str]:
    """The lines of the table with this head."""
    lines = PAGE.read_text().splitlines()
    start = lines.index(f"| {' | '.join(head)} |")
    return list(itertools.takewhile(lambda line: line.startswith("|"), lines[start:]))


def blocks() -> list[str]:
    return re.findall(r"```python\n(.*?)```", PAGE.read_text(), re.S)


@pytest.fixture(params=ENGINES)
def engine(request, tmp_path_factory, monkeypatch):
    if request.param == "numba":
        pytest.importorskip("numba")
    monkeypatch.setenv("S2SAD_CACHE_DIR", str(tmp_path_factory.getbasetemp() / "modules"))
    return request.param


# -- roles ----------------------------------------------------------------------------------------------------------

def test_the_page_shows_the_kernel():
    assert blocks()[0] == inspect.getsource(semantics.roles)


def test_every_role_and_annotation(engine):
    assert "\n".join(semantics.table(engine)) == "\n".join(lines_under(semantics.HEAD))


def after(values: dict[str, Any]) -> np.ndarray:
    """The exit state of `roles`, all arguments in a row."""
    given = {n: np.array(v) if n != "k" else v for n, v in values.items()}
    semantics.roles(**given)
    return np.concatenate([np.atleast_1d(given[n]) for n in given])


def test_the_table_agrees_with_differences():
    """The law as a formula: the shadow on exit is the transposed Jacobian times the shadow on entry."""
    entry = {n: np.array(v) if n != "k" else v for n, v in semantics.ENTRY.items()}
    flat = after(entry)
    owners = [n for n in entry for _ in np.atleast_1d(entry[n])]
    jacobian = np.zeros((flat.size, flat.size))
    for column, (name, start) in enumerate((n, owners.index(n)) for n in owners):
        up, down = ({n: np.array(v, dtype=float) for n, v in entry.items()} for _ in range(2))
        for shifted, h in ((up, 1e-3), (down, -1e-3)):
            place = np.atleast_1d(shifted[name])
            place[column - start] += h
            shifted[name] = place if name != "k" else place[0]
        up["k"], down["k"] = float(up["k"]), float(down["k"])
        jacobian[:, column] = (after(up) - after(down)) / 2e-3
    for line in lines_under(semantics.HEAD)[2:]:
        name, _, said, wrt, of, before, shadow, _ = [cell.strip(" `") for cell in line.strip("|").split("|")]
        if not re.match(r"\[|\d", shadow) or said == "gradient":
            continue
        seeds = np.concatenate([semantics.SHADOW if n == name else np.ones(2) for n in entry if n != "k"] + [[0.0]])
        mine = np.array([n == name for n in owners])
        read = np.array([n not in semantics.WRITTEN for n in owners])
        if of == "no" or said == "vjp":
            seeds[read & mine] = 0.0
        added = np.zeros(2)
        if of == "no" and not read[mine][0]:
            added, seeds[mine] = (np.array(semantics.SHADOW) if before else 0.0), 0.0
        elif of == "no" and before:
            added = np.array(semantics.SHADOW)
        expected = (jacobian.T @ seeds)[mine] + (added if name != "k" else 0.0)
        found = np.array([float(x) for x in re.findall(r"-?[\d.]+", shadow)])
        np.testing.assert_allclose(found, expected, atol=1e-6, err_msg=line)


# -- rules ----------------------------------------------------------------------------------------------------------

RULES = ("rule", "call", "gives", "afterwards")


def rules() -> list[tuple[str, ...]]:
    return [tuple(c.strip() for c in line.strip("|").split("|")) for line in lines_under(RULES)[2:]]


def module(folder: Path) -> ModuleType:
    path = folder / f"kernels_{next(_NUMBER)}.py"
    path.write_text(blocks()[1])
    spec = importlib.util.spec_from_file_location(path.stem, path)
    made = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(made)
    return made


def space(engine: str, folder: Path) -> dict[str, Any]:
    """The names that a row may use."""
    made = module(folder)

    def rewrite(old: str, new: str) -> None:
        path = Path(made.__file__)
        assert old in path.read_text()
        path.write_text(path.read_text().replace(old, new))

    values = {"u": np.array([1.0, 2.0]), "du": np.zeros(2), "u_bar": np.zeros(2), "du_bar": np.ones(2)}
    wrapped = {n: Differentiated(f, engine=engine) for n, f in vars(made).items() if isinstance(f, FunctionType)}
    public = {n: getattr(s2sad, n) for n in s2sad.__all__}
    return {"np": np, "kernels": made, "rewrite": rewrite, **public, **values, **wrapped}


def shown(value: Any) -> str:
    if isinstance(value, (tuple, list)):
        return f"({', '.join(map(shown, value))})"
    if isinstance(value, dict):
        return f"{{{', '.join(f'{k}: {shown(v)}' for k, v in value.items())}}}"
    return str(value).lower() if isinstance(value, bool) else str(value) if isinstance(value, int) \
        else semantics.shown(value)


def played(call: str, names: dict[str, Any]) -> str:
    *before, last = call.split("; ")
    exec("\n".join(before), names)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            return shown(eval(last, names))
    except S2sadError as error:
        return f"{error.diagnostics[0].code}: {error.diagnostics[0].message}"
    except Exception as error:
        return type(error).__name__


@pytest.mark.parametrize("number", range(len(rules()) if PAGE.exists() else 0))
def test_every_rule(number, engine, tmp_path):
    _, call, gives, afterwards = rules()[number]
    names = space(engine, tmp_path)
    assert played(call.strip("`"), names) == gives
    for part in filter(None, afterwards.split("; ")):
        name, _, value = part.partition(" = ")
        assert shown(eval(name.strip("`"), names)) == value, name


# -- what functions may be, and what they may be given ----------------------------------------------------------------

def test_dispatchers_and_decorated_functions():
    u = np.array([1.0, 2.0])
    assert gradient(kernels.cube)(2.0) == 12.0 and gradient(kernels.cubes)(u).tolist() == [3.0, 12.0]
    numba = pytest.importorskip("numba")
    assert gradient(numba.njit(kernels.norm), "u")(u).tolist() == [2.0, 4.0]


def test_closures_keep_apart(engine):
    for c in (2.0, 3.0):
        inner = Differentiated(kernels.enclosing(c, np.array([1.0, 10.0])), engine=engine)
        assert gradient(inner)(np.array([1.0, 2.0])).tolist() == [c, 10.0 * c]


def test_float32_stays_float32(engine):
    found = gradient(Differentiated(kernels.norm, engine=engine))(np.array([1.0, 2.0], np.float32), np.float32(2.0))
    assert found["u"].dtype == np.float32 and found["u"].tolist() == [4.0, 8.0]
    assert type(found["c"]) is np.float32 and found["c"] == 5.0


def test_an_int_is_a_float_where_the_annotation_says_so(engine):
    f = gradient(Differentiated(kernels.power, engine=engine))
    assert f(2, 3) == 12.0 and f(2, n=3) == 12.0


def test_a_parameter_named_as_an_array_that_a_helper_reads(engine):
    f = Differentiated(kernels.weighted, engine=engine)
    found = vjp(f, (np.array([1.0, 2.0, 3.0]), 2.0), {"return": 1.0})
    assert found["table"].tolist() == [2.0, 4.0, 6.0] and found["x"] == 14.0


def test_results_and_returned_arguments_together(engine):
    f, args = Differentiated(kernels.both_ways, engine=engine), (np.array([1.0, 2.0]), np.array([3.0, 4.0]))
    found = vjp(f, args, {"u": np.ones(2), "return": (np.ones(2), 1.0, None)})
    assert found["u"].tolist() == [27.0, 36.0] and found["v"].tolist() == [9.0, 18.0]
    tangent = jvp(f, args, {"u": np.ones(2)})["return"]
    assert tangent[0].tolist() == [9.0, 12.0] and tangent[1:] == (21.0, None)


def test_few_shadows_among_many_arrays(engine):
    values, h_bar = [np.full(2, k + 1.0) for k in range(8)], np.zeros(2)
    Differentiated(kernels.many, wrt="h", engine=engine).adjoint(*values, h_bar, np.zeros(2), np.ones(2))
    assert h_bar.tolist() == [7.0, 7.0]


def test_const_where_derivatives_would_flow(engine):
    f = Differentiated(kernels.through, engine=engine)
    for mode in (Reverse, Forward):
        with pytest.raises(S2sadError) as caught:
            autodiff(mode, f, Duplicated(np.zeros(2), np.ones(2)), Duplicated(np.ones(2), np.zeros(2)),
                     Const(np.zeros(2)))
        error, = caught.value.diagnostics
        assert error.code == "S406" and "'work' is Const" in error.message and "work[i] = u[i] * u[i]" in str(error)
    u_bar = np.zeros(2)
    autodiff(Reverse, Differentiated(kernels.read_before, engine=engine), Duplicated(np.ones(2), u_bar),
             Const(np.array([3.0, 4.0])))
    assert u_bar.tolist() == [3.0, 4.0]


def scaled_and_returned(x, c):
    x *= c
    return x, c * c


@pytest.mark.parametrize("engine", ["numpy", "numba"])
def test_a_const_argument_that_is_returned_with_active_values_is_refused(engine):
    f = s2sad.differentiate(scaled_and_returned, engine=engine)
    calls = [(s2sad.ForwardWithPrimal, s2sad.Duplicated(2.0, 1.0), {}),
             (s2sad.Reverse, s2sad.Active(2.0), {"seed": (None, 1.0)})]
    for mode, c, options in calls:
        with pytest.raises(s2sad.S2sadError) as refused:
            s2sad.autodiff(mode, f, s2sad.Const(np.ones(3)), c, **options)
        assert str(refused.value) == (
            "error[S406]: the argument 'x' is Const, but active values are stored in it and it is returned\n"
            "  help: say Duplicated(x, s2sad.make_zero(x)), or return nothing")
    assert s2sad.autodiff(s2sad.Reverse, f, s2sad.Duplicated(np.ones(3), np.zeros(3)), s2sad.Active(2.0),
                          seed=(np.ones(3), 1.0)) == (7.0,)


def test_the_shadow_of_an_array_without_elements_does_not_overlap_itself():
    def total(z, c):
        return np.sum(z) * c
    empty = np.zeros((0, 4))
    assert s2sad.autodiff(s2sad.Reverse, total, s2sad.Duplicated(empty, s2sad.make_zero(empty)),
                          s2sad.Active(2.0)) == (0.0,)



def test_a_default_that_was_changed(engine, monkeypatch):
    f = gradient(Differentiated(kernels.norm, engine=engine), "u")
    assert f(np.ones(2)).tolist() == [2.0, 2.0]
    monkeypatch.setattr(kernels.norm, "__defaults__", (3.0,))
    assert f(np.ones(2)).tolist() == [6.0, 6.0]


def test_a_default_by_name_that_was_changed(monkeypatch):
    def scaled(u, *, a=2.0):
        return u * a

    def norm(u):
        return np.sum(scaled(u) * u)

    f = gradient(Differentiated(norm, engine="numpy"), "u")
    assert f(np.ones(2)).tolist() == [4.0, 4.0]
    monkeypatch.setattr(scaled, "__kwdefaults__", {"a": 3.0})
    assert f(np.ones(2)).tolist() == [6.0, 6.0]
    scaled.__kwdefaults__["a"] = 4.0
    assert f(np.ones(2)).tolist() == [8.0, 8.0]


def test_a_room_does_not_hide_the_function_of_its_name():
    importlib.import_module("s2sad.differentiate.adjoint")
    assert isinstance(s2sad.differentiate, FunctionType)
