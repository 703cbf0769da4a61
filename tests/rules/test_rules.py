"""The table of rules, without the compiler: names, values against differences, edges, overflow."""
from __future__ import annotations

import math
from collections.abc import Callable

import gast
import numpy as np
import pytest
import scipy
from scipy import special

from s2sad import rules, runtime, tree
from s2sad.report.differences import differences
from s2sad.rules import array
from s2sad.rules.rule import RuleTable, template

NAMES = rules.names()
EPSILON = {"float64": 2.0 ** -52, "float32": 2.0 ** -23}


def spelled(node: tree.AST) -> str:
    """An expression of a rule as Python text, `numpy` by its own name."""
    return gast.unparse(node)


def scalar_form(node: tree.AST) -> tree.AST:
    """`numpy.where` as a conditional expression, as the differentiator writes it for numbers."""
    def change(n: tree.AST) -> tree.AST | None:
        if tree.call_name(n) == "numpy.where":
            condition, a, b = (scalar_form(argument) for argument in n.args)
            return tree.IfExp(condition, a, b)
        return None
    return tree.rebuild(node, change)


def compiled(parameters: tuple[str, ...], node: tree.AST) -> Callable:
    text = f"lambda {', '.join(parameters)}: {spelled(node)}"
    return eval(text, {"numpy": np, "math": math, "runtime": runtime, "scipy": scipy})


def primal(name: str) -> Callable:
    rule = rules.find(name)
    if "." in name:
        module, _, function = name.rpartition(".")
        if not hasattr({"numpy": np, "math": math, "builtins": __builtins__, "runtime": runtime,
                        "scipy.special": special}[module], function) \
                and module != "builtins":
            pytest.skip(f"this version has no {name}")
        return compiled(rule.parameters, tree.call(name, *map(tree.name, rule.parameters))) \
            if module != "builtins" else eval(function)
    return compiled(rule.parameters, tree.expression(name))


def partial(name: str, parameter: str, scalar: bool = False, **known: tree.AST) -> Callable:
    """The partial as a function of the parameters and the result."""
    rule = rules.find(name)
    arguments = {p: known.get(p, tree.name(p)) for p in rule.parameters}
    node = rule.partial(parameter, arguments, tree.name("y"))
    return compiled((*rule.parameters, "y"), scalar_form(node) if scalar else node)


def points(name: str, count: int = 7) -> list[dict[str, float]]:
    """Points in the domain, away from ties: no two parameters take the same values."""
    rule = rules.find(name)
    found = []
    for k in range(count):
        point = {}
        for place, p in enumerate(rule.parameters):
            low, high = rule.domain.get(p, (-2.0, 2.0))
            point[p] = low + (high - low) * ((0.37 + 0.29 * place + 0.618 * (k + place * 0.13)) % 1.0)
        found.append(point)
    return found


def slope(function: Callable, point: dict[str, float], parameter: str) -> tuple[float, float]:
    """The derivative by differences, with an estimate of its error."""
    def line(h: float) -> np.ndarray:
        return np.array([float(function(*{**point, parameter: point[parameter] + h}.values()))])
    best, error = differences(line, wanted=1e-11)
    return float(best[0]), float(error[0])


TABLE_ROWS = [(name, p) for name in NAMES for p in rules.find(name).parameters]


@pytest.mark.parametrize(("name", "parameter"), TABLE_ROWS)
def test_partial_agrees_with_differences(name, parameter):
    function = primal("builtins.float" if name == "numpy.float32" else name)  # float32 has too few digits to differ
    for point in points(name):
        expected, error = slope(function, point, parameter)
        y = function(*point.values())
        for scalar in (False, True):
            actual = float(partial(name, parameter, scalar)(*point.values(), y))
            assert actual == pytest.approx(expected, rel=1e-9, abs=1e-11 + 10 * error), (point, scalar)


PLANE_ROWS = [(name, p) for name, p in TABLE_ROWS if rules.find(name).plane is not None
              and not name.startswith("math.") and p not in rules.find(name).plane.zero
              and (name.startswith("a") or p != "b" or "**" not in name)]


@pytest.mark.parametrize(("name", "parameter"), PLANE_ROWS)
def test_partials_hold_for_complex_numbers(name, parameter):
    function, rule = primal(name), rules.find(name).plane
    for k in range(5):
        point = {p: 0.5 + 0.3 * k + 0.2 * j + (0.7 - 0.4 * k) * 1j for j, p in enumerate(rule.parameters)}
        if rule.refine is not None:     # a power: the exponent is real
            point["b"] = (3, -2, 0.5, 2, 1.5)[k]
            if parameter == "b":
                continue
        if name == "numpy.where":
            point["c"] = k % 2 == 0
        known = {"b": tree.const(point["b"])} if rule.refine is not None else {}
        node = rule.partial(parameter, {p: known.get(p, tree.name(p)) for p in rule.parameters}, tree.name("y"))
        y = function(*point.values())
        for form in (node, scalar_form(node)):
            found = compiled((*rule.parameters, "y"), form)(*point.values(), y)
            for step in (1e-3, 1e-3j):
                at = {k: function(*{**point, parameter: point[parameter] + k * step}.values()) for k in (-2, -1, 1, 2)}
                actual = (8.0 * (at[1] - at[-1]) - at[2] + at[-2]) / 12.0
                expected = {"holomorphic": found * step, "gradient": (np.conj(found) * step).real,
                            "conjugate": np.conj(step)}[rule.kind]
                assert actual == pytest.approx(expected, rel=1e-7, abs=1e-12), (point, step)


WIDENING = ("numpy.float64", "numpy.float_power")
OF_ARRAYS = [row for row in TABLE_ROWS if row[0] not in WIDENING and (
    row[0] == "builtins.abs" or not row[0].startswith(("math.", "builtins.", "runtime.")))]


@pytest.mark.parametrize(("name", "parameter"), OF_ARRAYS)
def test_float32_and_arrays(name, parameter):
    function = primal(name)
    columns = {p: np.array([point[p] for point in points(name)]) for p in rules.find(name).parameters}
    wide = partial(name, parameter)(*columns.values(), function(*columns.values()))
    narrow_columns = [c.astype("float32") for c in columns.values()]
    result = function(*narrow_columns)
    assert result.dtype == np.float32
    narrow = partial(name, parameter)(*narrow_columns, result)
    # the inputs are rounded: the second derivative enters
    np.testing.assert_allclose(narrow, wide, rtol=400 * EPSILON["float32"], atol=20 * EPSILON["float32"])
    each = [partial(name, parameter, scalar=True)(*row, function(*row)) for row in zip(*columns.values())]
    np.testing.assert_allclose(np.broadcast_to(wide, len(each)), each, rtol=1e-14, atol=1e-300)


# -- far out and near the edges: the true value in closed form -------------------------------------------------------
E = math.e


COMPOSED = [(rule, axis) for rule in array.TABLE.values() if rule.value
            for axis in ((None, 0) if "axis" in rule.options else (None,))]


@pytest.mark.parametrize(("rule", "axis"), COMPOSED, ids=lambda r: getattr(r, "name", r))
def test_a_composed_function_is_its_expression(rule, axis):
    """On matrices, one of which has a nan."""
    options = {**{o: gast.literal_eval(d) for o, d in rule.options.items()}, **({} if axis is None else {"axis": axis})}
    value = compiled((*rule.operands, *rule.options), template(rule.value))
    function = eval(rule.name, {"numpy": np, "scipy": scipy})
    for hole in (0.7, np.nan):
        operands = [np.array([[0.3, -1.2, hole], [2.0, 0.4, 1.1]]) + k for k in range(len(rule.operands))]
        np.testing.assert_array_equal(value(*operands, *options.values()), function(*operands, **options))


# -- what a rule says of itself -------------------------------------------------------------------------------------
def test_uses_linear_and_zero():
    assert rules.find("a * b").uses("a") == {"b"}
    assert rules.find("a * b").linear == {"a", "b"}
    assert rules.find("a / b").linear == {"a"}
    assert rules.find("numpy.exp").uses("x") == {"y"}
    assert rules.find("numpy.exp").linear == frozenset()
    assert rules.find("numpy.copysign").zero == {"b"}
    assert rules.find("math.exp").name == "math.exp"
    assert rules.find("numpy.linalg.det") is None


def test_substitution_fills_in_operands_once():
    node = rules.find("a / b").partial("b", {"a": tree.name("b"), "b": tree.expression("a + y")}, tree.name("r"))
    assert tree.equal(node, tree.expression("-r / (a + y)"))


def test_constant_results():
    for name, kind in [("numpy.floor", "same"), ("math.floor", "int"), ("numpy.greater", "bool"),
                       ("builtins.len", "int")]:
        assert rules.constant_result(name) == rules.result_kind(name) == kind
        assert rules.find(name) is None
    assert rules.constant_result("numpy.exp") is None
    assert rules.result_kind("numpy.exp") == "float"
    assert rules.result_kind("builtins.max") == "same"
    assert rules.result_kind("numpy.nothing") is None


REFUSED = [
    (("numpy.f(x)",), {}, "'numpy.f(x)': no partial is given for x; write x=\"0.0\" if the derivative is zero"),
    (("numpy.f(x)",), {"x": "z"}, "'numpy.f(x)': the partial x='z' reads z; it may read x and y"),
    (("numpy.f(x)",), {"x": "y", "z": "x"}, "'numpy.f(x)': a partial is given for z, which is no parameter of it"),
    (("numpy.f(x)",), {"x": "y", "singular": ("a",)},
     "'numpy.f(x)': singular is given for a, which is no parameter of it"),
    (("numpy.f(x)",), {"x": "y", "domain": {"a": (0, 1)}},
     "'numpy.f(x)': a domain is given for a, which is no parameter of it"),
    (("numpy.f(x)",), {"x": "y", "result": "int"}, "'numpy.f(x)': result='int' is neither 'float' nor 'same'"),
    (("numpy.f(x)",), {"x": "1.0", "plane": "analytic"},
     "'numpy.f': plane='analytic' is none of holomorphic, gradient, conjugate, with partials"),
    (("numpy.f(y)",), {}, "'numpy.f(y)': parameters must be different names, and not 'y', which is the result"),
    (("a if b else c",), {}, "'a if b else c' is neither a call such as 'numpy.exp(x)' nor an operator such as "
                             "'a / b'"),
]


@pytest.mark.parametrize(("given", "keywords", "message"), REFUSED)
def test_registration_refuses(given, keywords, message):
    with pytest.raises(ValueError) as refused:
        RuleTable().elementwise(*given, **keywords)
    assert str(refused.value) == message


def test_registration_refuses_a_second_rule():
    table = RuleTable()
    table.elementwise("numpy.f(x)", x="1.0")
    with pytest.raises(ValueError, match=r"numpy\.f has a rule already"):
        table.constant("float", "numpy.f")
    with pytest.raises(ValueError, match="result='complex' is none of float, int, bool, same"):
        table.constant("complex", "numpy.g")
    with pytest.raises(ValueError, match="numpy.exp has no parameter 'z', it has x"):
        rules.find("numpy.exp").uses("z")


def test_dotted_names_are_one_name():
    assert tree.names(template("numpy.cos(x) * math.pi")) == ["x"]


# -- Numba ----------------------------------------------------------------------------------------------------------
SAMPLE = ["numpy.tanh", "numpy.hypot", "numpy.maximum", "numpy.sinc", "a % b", "numpy.fmod", "a ** b", "numpy.clip",
          "numpy.arctan2", "numpy.copysign", "numpy.logaddexp", "math.erf", "builtins.abs", "numpy.cbrt"]


@pytest.mark.parametrize("name", SAMPLE)
def test_scalar_form_compiles(name):
    numba = pytest.importorskip("numba")
    rule = rules.find(name)
    for parameter in rule.parameters:
        plain = partial(name, parameter, scalar=True)
        fast = numba.njit(error_model="numpy")(plain)
        for point in points(name, 3):
            y = float(primal(name)(*point.values()))
            assert fast(*point.values(), y) == pytest.approx(float(plain(*point.values(), y)), rel=1e-14, abs=1e-300)
