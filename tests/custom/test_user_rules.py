"""Functions with a derivative of the user's own, and functions that are held fixed."""
from __future__ import annotations

import importlib
import math
import sys

import numpy as np
import pytest

import s2sad
from s2sad.read import load_file
from tests.harness.derivatives import check_derivatives

ENGINES = ("numpy", "numba")
special = pytest.importorskip("scipy.special")


s2sad.nondifferentiable("numpy.nanmedian")


# -- partials -------------------------------------------------------------------------------------------------------
def logistic(x):
    return 1.0 / (1.0 + math.exp(-x))


@s2sad.rule(x="a * logistic(x)", a="y / a", domain={"a": (0.5, 2.0)})
def softplus(x, a):
    return a * math.log(1.0 + math.exp(x))


s2sad.rule("scipy.special.dawsn(x)", x="1.0 - 2.0 * x * y")
s2sad.rule("scipy.special.j0(x)", x="-scipy.special.j1(x)")
s2sad.rule("scipy.special.i1(x)", x="scipy.special.ivp(1.0, x)")


def softened(u, a):
    total = 0.0
    for i in range(1, u.size):
        u[i] = softplus(u[i - 1] * u[i], a)
        total += softplus(total, 2.0 * a) ** 2
    return total


def of_a_library(u):
    total = 0.0
    for i in range(u.size):
        total = special.dawsn(u[i] * total + 0.3) * special.j0(u[i])
    return total


def of_whole_arrays(u, v):
    v[1:] = special.dawsn(u[:-1] * v[1:]) * u[1:]


@pytest.mark.parametrize("engine", ENGINES)
def test_partials_serve_both_modes(engine):
    check_derivatives(softened, (np.array([0.3, -0.9, 1.2]), 0.7), ("u", "a"), ("u", "return"), engine)


def of_modified_bessel(u):
    return special.i1(u[0])


@pytest.mark.parametrize("engine", ENGINES)
def test_functions_of_a_library_with_partials(engine):
    u = np.array([0.3, 0.9, 1.2])
    check_derivatives(of_a_library, (u,), ("u",), ("return",), engine)
    check_derivatives(of_whole_arrays, (u, 0.5 * u), ("u", "v"), ("v",), engine)


def test_a_library_that_numba_does_not_know_is_refused():
    with pytest.raises(s2sad.S2sadError, match="Numba cannot compile 'scipy.special.ivp', which the derivative calls"):
        s2sad.gradient(s2sad.differentiate(of_modified_bessel, engine="numba"))(np.ones(2))


def test_the_generated_file_imports_the_functions():
    text = s2sad.differentiate(of_a_library, engine="numpy").adjoint_source(np.ones(2))
    assert "from scipy.special import dawsn  # isort: skip\n" in text
    assert "from scipy.special import j1  # isort: skip\n" in text


KERNEL = """
import math

import s2sad

G = 2.0


def slope(x):
    return G


@s2sad.rule(x="slope(x)")
def curve(x):
    return G * x


def f(x):
    return curve(x) * 3.0
"""


@pytest.fixture
def module(tmp_path, monkeypatch):
    """A module of the user's that may change while it is loaded."""
    name = f"user_rules_{tmp_path.name}"
    (tmp_path / f"{name}.py").write_text(KERNEL)
    monkeypatch.syspath_prepend(str(tmp_path))
    yield importlib.import_module(name)
    del sys.modules[name]


@pytest.mark.parametrize("engine", ENGINES)
def test_a_changed_module_is_another_derivative(module, engine):
    gradient = s2sad.gradient(s2sad.differentiate(module.f, engine=engine))
    assert gradient(1.0) == 6.0
    module.G = 5.0
    assert gradient(1.0) == 15.0
    s2sad.rule(x="-1.0", check=False)(module.curve)
    assert gradient(1.0) == -3.0
    s2sad.nondifferentiable(module.curve)
    assert s2sad.vjp(module.f, (1.0,), {"return": 1.0})["x"] == 0.0


def test_a_function_that_is_no_longer_the_one_of_its_name_is_refused(module):
    gradient = s2sad.gradient(s2sad.differentiate(module.f, engine="numpy"))
    gradient(1.0)
    module.slope = lambda x: 0.0
    with pytest.raises(s2sad.S2sadError, match="does not give 'slope', which its derivative calls"):
        gradient(1.0)


def test_a_file_that_is_not_run_knows_no_rule(module):
    with pytest.raises(s2sad.S2sadError, match="'curve' cannot be used in a kernel: it is given a derivative of"):
        load_file(module.__file__, "f")


def test_a_function_with_a_derivative_of_its_own_is_not_read():
    with pytest.raises(s2sad.S2sadError) as caught:
        s2sad.gradient(softplus)(1.0, 2.0)
    assert str(caught.value) == (
        "error[S101]: 'softplus' has a derivative of its own, and is not read\n"
        "  help: differentiate a function that calls it")


def local():
    def inner(x):
        return x
    return inner


def writes(u):
    u[0] = 1.0
    return 2.0


def named(x):
    return math.sin(x)


def defaulted(x, a=1.0):
    return a * x


WRONG = [
    (lambda: s2sad.nondifferentiable(3), "a function is needed, not 3", "give a function, or its dotted name"),
    (lambda: s2sad.nondifferentiable("no.such"), "there is no function 'no.such'",
     "write the name by which it can be imported"),
    (lambda: s2sad.nondifferentiable(local()), "'local.<locals>.inner' cannot be imported by name",
     "define it with def at module level"),
    (lambda: s2sad.nondifferentiable(special.dawsn), "the module of <ufunc 'dawsn'> is not known",
     'give its dotted name, as "scipy.special.erf"'),
    (lambda: s2sad.nondifferentiable(named, result="array"),
     "nondifferentiable: result='array' is none of float, int, bool", ""),
    (lambda: s2sad.nondifferentiable(writes), f"nondifferentiable: '{__name__}.writes' writes its argument "
     "'u'", "write it without, `u = u + 1.0` in place of `u += 1.0`"),
    (lambda: s2sad.rule("erf", x="1"), "rule: 'erf' is not a function's dotted name with its parameters",
     'write "scipy.special.erf(x)", with different names, and not y, which is the result'),
    (lambda: s2sad.rule(x="1.0")(defaulted), "rule for 'defaulted': the parameter 'a' has a default or is not "
     "positional", "take plain positional parameters"),
    (lambda: s2sad.rule("math.hypot(a, b)", a="a / y"), "rule for 'math.hypot': no partial is given for b",
     'write b="0.0" if the derivative is zero'),
    (lambda: s2sad.rule("math.gamma(x)", x="1.0", z="x"), "rule for 'math.gamma': a partial is given for z, which is "
     "no parameter of it", "its parameters are x"),
    (lambda: s2sad.rule("math.sin(x)", x="q(x)"), "rule for 'math.sin': the partial x='q(x)' reads q",
     "it may read x and y, and call functions by their name"),
    (lambda: s2sad.rule("math.sin(x)", x="cos("), "rule for 'math.sin': the partial x='cos(' is no expression", ""),
    (lambda: s2sad.rule(x="-math.cos(x)")(named), f"rule for '{__name__}.named': the partial "
     "x='-math.cos(x)' is -0.118517 at x = -1.452, but differences give 0.118517",
     "correct it, or say with domain= where it holds; check=False registers it unchecked"),
    (lambda: s2sad.rule("math.acosh(x)", x="1.0", domain={"x": (-2.0, 0.5)}), "rule for 'math.acosh': nowhere on the "
     "domain could it be compared with differences", 'say where it is smooth, as domain={"x": (0.5, 2.0)}'),
]


@pytest.mark.parametrize(("given", "message", "help"), WRONG, ids=[m for _, m, _ in WRONG])
def test_registration_says_what_is_wrong(given, message, help):
    with pytest.raises(s2sad.S2sadError) as caught:
        given()
    assert str(caught.value) == f"error[S302]: {message}" + (f"\n  help: {help}" if help else "")


@s2sad.rule(x="x / y", eps="eps / y", domain={"x": (0.5, 2.0)})
def smooth_abs(x, eps):
    return math.sqrt(x * x + eps * eps)


def chosen(u, eps):
    return min(u[0], smooth_abs(u[1], eps))


@pytest.mark.parametrize("engine", ENGINES)
def test_a_zero_seed_contributes_zero_also_against_an_infinite_partial(engine):
    found = s2sad.gradient(s2sad.differentiate(chosen, engine=engine))(np.array([-1.0, 0.0]), 0.0)
    np.testing.assert_array_equal(found["u"], [1.0, 0.0])
    assert found["eps"] == 0.0
