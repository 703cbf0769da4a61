"""Every function of the tables of rules and constants, in a small kernel under both engines; edges of domains."""
from __future__ import annotations

import builtins
import importlib.util
import math
import re
import warnings
from pathlib import Path

import numpy as np
import pytest
import scipy.special

import s2sad
from s2sad.rules.rule import TABLE
from tests.harness.derivatives import check_derivatives

ENGINES = ("numpy", "numba")
LIBRARIES = {"numpy": np, "math": math, "builtins": builtins, "scipy.special": scipy.special}
NAMES = [n for n in (*TABLE.rules, *TABLE.constants) if not n.startswith(("runtime.", "given."))]

# what the functions without a derivative take: of the array x, the float x[0] and the integers 7 and k
ARRAY = dict.fromkeys(("builtins.len", "numpy.argmax", "numpy.argmin", "numpy.argsort", "numpy.count_nonzero",
                       "numpy.size", "numpy.ndim", "numpy.any", "numpy.all"), "x")
ARRAY |= {"numpy.searchsorted": "x, 0.5", "numpy.array_equal": "x, x", "numpy.allclose": "x, x"}
INTEGER = dict.fromkeys(("numpy.bitwise_not", "numpy.invert", "math.factorial", "math.isqrt"), "k")
INTEGER |= dict.fromkeys(("numpy.bitwise_and", "numpy.bitwise_or", "numpy.bitwise_xor", "numpy.left_shift",
                          "numpy.right_shift", "math.gcd", "math.lcm", "math.comb", "math.perm"), "7, k")
TWO = {"numpy.floor_divide", "numpy.greater", "numpy.greater_equal", "numpy.less",
       "numpy.less_equal", "numpy.equal", "numpy.not_equal", "numpy.logical_and", "numpy.logical_or",
       "numpy.logical_xor", "math.isclose", "numpy.isclose", "a // b"}


def called(name: str) -> tuple[str, bool]:
    """The function on its arguments, and whether these are numbers that a helper can take."""
    spelled = name.removeprefix("builtins.")
    rule = TABLE.rules.get(name)
    count = len(rule.parameters) if rule else 2 if name in TWO else 1
    numbers = [f"x[{k}]" for k in range(count)]
    if "." not in name:
        return re.sub(r"\b[ab]\b", lambda m: {"a": "x[0]", "b": "x[1]"}[m.group()], name), True
    if name in ARRAY:
        return f"{spelled}({ARRAY[name]}){'[0]' if name == 'numpy.argsort' else ''}", False
    return f"{spelled}({INTEGER.get(name) or ', '.join(numbers)})", True


def module(text: str, folder: Path):
    """A kernel's module from its text."""
    path = folder / "kernel.py"
    path.write_text(f"import math\nimport numpy\nimport numpy as np\nimport scipy.special\n\n\n{text}")
    spec = importlib.util.spec_from_file_location("kernel", path)
    assert spec is not None and spec.loader is not None
    made = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(made)
    return made


def point(name: str) -> np.ndarray:
    rule = TABLE.rules.get(name)
    if rule is None:
        return np.array([1.7, 0.6, 0.9])
    found = [low + (high - low) * (0.37 + 0.21 * k) for k, (low, high) in enumerate(
        rule.domain.get(p, (-2.0, 2.0)) for p in rule.parameters)]
    return np.array([*found, 0.7, 0.6][:3])


def is_there(name: str) -> bool:
    """Whether this version of the library has the function."""
    library, _, member = name.rpartition(".")
    return not library or hasattr(LIBRARIES[library], member)


@pytest.mark.parametrize("name", list(filter(is_there, NAMES)))
def test_both_engines(name, tmp_path):
    """Alone in a kernel, and in a helper of numbers, which stands in the generated file as it was written."""
    expression, numbers = called(name)
    helper = re.sub(r"x\[(\d)\]", r"x\1", expression)
    text = f"def f(x, k):\n    return x[0] * x[1] * {expression}\n"
    if numbers:
        text = (f"def helper(x0, x1, x2, k):\n    return {helper}\n\n\n"
                f"def f(x, k):\n    return x[0] * x[1] * {expression} + x[1] * helper(x[0], x[1], x[2], k)\n")
    kernel, x = module(text, tmp_path).f, point(name)
    found = [s2sad.value_and_gradient(s2sad.differentiate(kernel, engine=e), wrt="x")(x, 3) for e in ENGINES]
    assert found[0][0] == pytest.approx(float(kernel(x, 3)), rel=1e-13)
    assert found[1][0] == pytest.approx(found[0][0], rel=1e-13)
    np.testing.assert_allclose(found[1][1], found[0][1], rtol=1e-13, atol=1e-15)


# -- where the primal is nan, so is every derivative -----------------------------------------------------------------
OUTSIDE = [
    ("log(x)", (-1.0,)), ("log2(x)", (-1.0,)), ("log10(x)", (-1.0,)), ("log1p(x)", (-2.0,)), ("sqrt(x)", (-1.0,)),
    ("asin(x)", (2.0,)), ("acos(x)", (-2.0,)), ("acosh(x)", (0.5,)), ("acosh(x)", (-2.0,)), ("atanh(x)", (2.0,)),
    ("atanh(x)", (-2.0,)), ("fmod(x, b)", (1.0, 0.0)), ("hypot(x, b)", (math.nan, 1.0)), ("pow(x, b)", (-1.0, 0.5)),
    ("remainder(x, b)", (1.0, 0.0)), ("x % b", (1.0, 0.0)), ("x ** b", (-1.0, 0.5)), ("x ** 1.5", (-1.0,)),
    ("x ** -1.5", (-1.0,)), ("x ** 0.5", (-1.0,)), ("log(x, 2.0)", (-1.0,)), ("sin(x)", (math.inf,)),
]
NUMPYS = {"asin": "arcsin", "acos": "arccos", "acosh": "arccosh", "atanh": "arctanh", "pow": "power"}


def spellings(text: str) -> list[str]:
    word = text.partition("(")[0]
    if "(" not in text:
        return [text]
    if word == "remainder" or ", 2.0" in text:
        return [f"math.{text}"]
    return [f"math.{text}", f"np.{NUMPYS.get(word, word)}{text[len(word):]}"]


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize(("text", "values"), [(s, v) for text, v in OUTSIDE for s in spellings(text)])
def test_outside_of_a_domain(text, values, engine, tmp_path):
    names = ("x", "b")[:len(values)]
    kernel = module(f"def f({', '.join(names)}):\n    return 3.0 * {text}\n\n\n"
                    f"def g(u):\n    {', '.join(names)}{',' if len(names) == 1 else ''} = u\n    return 3.0 * {text}\n",
                    tmp_path)
    f, g = (s2sad.differentiate(k, engine=engine) for k in (kernel.f, kernel.g))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        gradients = s2sad.vjp(f, values, {"return": 1.0})
        tangents = [s2sad.jvp(f, values, {n: 1.0})["return"] for n in names]
        narrow = s2sad.gradient(g)(np.array(values, "float32"))
    assert np.all(np.isnan([*gradients.values(), *tangents, *narrow])), (gradients, tangents, narrow)


# -- where CPython's numbers raise, derivatives are inf or nan -------------------------------------------------------
def root(x):
    return math.sqrt(x)


def reciprocal(x):
    return 1.0 / x


def inverse_power(x):
    return x ** -1.0


def overflowing_power(x):
    return (x + 1e200) ** 2 * 0.5


def overflowing_exponential(x):
    return math.exp(x + 1000.0)


def logarithm(x):
    return math.log(x)


def quotient_of_a_sum(x):
    total = 0.0
    for _ in range(3):
        total += x
    return 1.0 / total


def rest(x):
    return 1.0 % x


def by_a_helper(x):
    return reciprocal(2.0 * x) + 1.0 / (reciprocal(2.0) * x)


def by_an_integer(x):
    n = int(x)
    return (x + 1.0) / n + (x + 1.0) * (2.0 / (n * n))


def choice(x):
    return (2.0 if x > 0.0 else x) / max(x, 0.0)


def questions_as_numbers(x):
    """Booleans of Python's add up to 2, NumPy's to True."""
    return 1.0 / x * ((x < 1.0) + (x > -1.0)) / -(x < 1.0)


def logistic(x):
    return 1.0 / (1.0 + math.exp(-x))


@pytest.mark.parametrize("engine", ENGINES)
def test_no_nan_from_a_zero_times_an_overflow(engine):
    assert s2sad.gradient(s2sad.differentiate(logistic, engine=engine))(-2000.0) == 0.0


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize(("kernel", "value", "slope"), [
    (root, 0.0, math.inf), (reciprocal, math.inf, -math.inf), (inverse_power, math.inf, -math.inf),
    (overflowing_power, math.inf, 1e200), (overflowing_exponential, math.inf, math.inf),
    (logarithm, -math.inf, math.inf), (quotient_of_a_sum, math.inf, -math.inf), (rest, math.nan, math.nan),
    (by_a_helper, math.inf, -math.inf), (by_an_integer, math.inf, math.inf), (choice, math.nan, math.nan),

    (questions_as_numbers, -math.inf, math.inf),
])
def test_inf_where_python_raises(kernel, value, slope, engine):
    differentiated = s2sad.differentiate(kernel, engine=engine)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = s2sad.value_and_gradient(differentiated)(0.0)
        tangent = s2sad.jvp(differentiated, (0.0,), {"x": 1.0})["return"]
        zero = s2sad.vjp(differentiated, (0.0,), {"return": 0.0})["x"]
    assert [found[0], found[1], tangent] == pytest.approx([value, slope, slope], nan_ok=True)
    assert zero == 0.0 or kernel is by_an_integer  # 2.0 / (n * n) is a factor like any other
    assert all(type(v) is float for v in (*found, tangent))
    if kernel is not root:
        with pytest.raises((ArithmeticError, ValueError)):
            kernel(0.0)


def test_numpy_may_be_told_to_raise():
    with np.errstate(divide="raise"), pytest.raises(FloatingPointError):
        s2sad.gradient(s2sad.differentiate(reciprocal, engine="numpy"))(0.0)


def several_bindings_at_once(a, b):
    (low, high), (ratio, half) = (a, b), (1.0, 0.5)
    first = second = 2.0
    if low > high:
        first, ratio = high, low
    return low / high + half * second / first + 1.0 / ratio


def with_such_a_helper(x, y):
    return several_bindings_at_once(x * 1.0, y * 2.0) + several_bindings_at_once(y, x)


@pytest.mark.parametrize("engine", ENGINES)
def test_helper_with_several_bindings_at_once(engine):
    check_derivatives(with_such_a_helper, (1.3, 0.4), ("x", "y"), ("return",), engine=engine)
    found = s2sad.gradient(s2sad.differentiate(with_such_a_helper, engine=engine))(1.0, 0.0)
    assert not math.isfinite(found["x"]) and not math.isfinite(found["y"])
