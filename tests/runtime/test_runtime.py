"""The runtime's functions, with NumPy alone and compiled by Numba as they stand."""
from __future__ import annotations

import math
import subprocess
import sys
from types import FunctionType

import numpy as np
import pytest

from s2sad import runtime
from s2sad.runtime import exponentials, scalars, special, stacks, sums
from tests.harness.seeds import generator


def _compiled(module) -> dict:
    """A module's functions, each compiled, calling each other compiled."""
    numba = pytest.importorskip("numba")
    space = dict(vars(module))
    for name, value in list(space.items()):
        if isinstance(value, FunctionType) and value.__module__.startswith("s2sad.runtime"):
            space[name] = numba.njit(error_model="numpy")(FunctionType(value.__code__, space, value.__name__))
    return space


@pytest.fixture(scope="module", params=["numpy", "numba"])
def functions(request):
    if request.param == "numpy":
        return {"grow": runtime.grow, "pairwise_sum": runtime.pairwise_sum, "blocked_sum": runtime.blocked_sum,
                "digamma": runtime.digamma}
    return {**_compiled(stacks), **_compiled(sums), **_compiled(special)}


@pytest.fixture(scope="module", params=["numpy", "numba"])
def elementary(request):
    return vars(exponentials) if request.param == "numpy" else _compiled(exponentials)


@pytest.mark.parametrize("name", ["exp", "expm1", "sinh", "cosh", "tanh"])
def test_exponentials_are_right_to_the_last_digits(elementary, name):
    """Against NumPy in extended precision where it has it, at most 3 units in the last place off."""
    rng = generator(3)
    inside = 709.7 if name in ("exp", "expm1") else 710.4
    for x in np.concatenate([rng.standard_normal(200), 1e-4 * rng.standard_normal(50), rng.uniform(-0.7, 0.7, 200),
                             rng.uniform(-inside, inside, 200), [-708.4, 1e-300, 5e-324, -1e-9, 22.5, -19.1, inside]]):
        exact = getattr(np, name)(np.longdouble(x))
        assert abs(elementary[name](x) - exact) <= 3 * np.spacing(np.abs(np.float64(exact))), x


def test_the_derivative_of_tanh(elementary):
    rng = generator(3)
    for x in np.concatenate([rng.standard_normal(200), 1e-4 * rng.standard_normal(50), rng.uniform(-350, 350, 200)]):
        exact = 1 / np.cosh(np.longdouble(x)) ** 2
        assert abs(elementary["sech_squared"](x) - exact) <= 4 * np.spacing(np.float64(exact)), x
    assert [elementary["sech_squared"](x) for x in (0.0, 800.0, -np.inf)] == [1.0, 0.0, 0.0]
    assert np.isnan(elementary["sech_squared"](np.nan))


@pytest.mark.parametrize("name", ["exp", "expm1", "sinh", "cosh", "tanh"])
@pytest.mark.parametrize("x", [0.0, -0.0, np.inf, -np.inf, np.nan, 720.0, -800.0, 1e300])
@pytest.mark.filterwarnings("ignore:overflow")
def test_exponentials_at_the_ends(elementary, name, x):
    found, expected = elementary[name](x), getattr(np, name)(x)
    assert np.array_equal(found, expected, equal_nan=True) and np.signbit(found) == np.signbit(expected)


GROWN = [(shape, "float64") for shape in ((3,), (2, 3), (2, 3, 2), (2, 1, 2, 2), (2, 0))] + [
    (shape, dtype) for shape in ((3,), (2, 3), (2, 0)) for dtype in ("float32", "int64", "bool")]


@pytest.mark.parametrize(("shape", "dtype"), GROWN)
def test_grow(functions, shape, dtype):
    grow = functions["grow"]
    stack = (np.arange(math.prod(shape)).reshape(shape) % 2).astype(dtype)
    kept = grow(stack, shape[0] - 1)
    assert np.shares_memory(kept, stack) or not stack.size
    for top in (shape[0], 5 * shape[0]):
        larger = grow(stack, top)
        assert larger.shape == (max(2 * shape[0], top + 1),) + shape[1:] and larger.dtype == stack.dtype
        assert np.array_equal(larger[:shape[0]], stack)


def test_grow_from_nothing(functions):
    stack = np.empty(0)
    for top in range(20):
        stack = functions["grow"](stack, top)
        stack[top] = top
    assert np.array_equal(stack[:20], np.arange(20.0)) and stack.size < 64


@pytest.mark.parametrize("size", [0, 1, 7, 127, 128, 129, 255, 256, 1000, 4096, 100_003])
def test_sum_is_exact_to_a_few_roundings(functions, size):
    x = generator(size).standard_normal(size)
    for name in ("pairwise_sum", "blocked_sum"):
        assert abs(functions[name](x) - math.fsum(x)) <= 8e-16 * np.sum(np.abs(x))


def test_float32_stays_accurate(functions):
    x = np.full(3_000_000, 0.1, np.float32)
    assert abs(float(functions["pairwise_sum"](x)) / math.fsum(map(float, x)) - 1.0) < 1e-6
    if functions["grow"] is runtime.grow:
        assert runtime.pairwise_sum(x).dtype == np.float32


@pytest.mark.parametrize("x", [
    np.arange(600.0).reshape(20, 30), np.arange(600.0).reshape(20, 30).T, np.arange(600.0).reshape(20, 30)[::-2, ::3],
    np.arange(720.0).reshape(4, 5, 6, 6), np.ones((3, 0)), np.asfortranarray(np.arange(24.0).reshape(2, 3, 4)),
], ids=["rows", "transposed", "strided", "4-D", "empty", "Fortran"])
def test_sum_of_any_shape(functions, x):
    assert functions["pairwise_sum"](x) == x.sum()


def test_infinities_and_nans(functions):
    x = np.ones(300)
    x[200] = np.inf
    assert functions["pairwise_sum"](x) == np.inf
    x[10] = np.nan
    assert np.isnan(functions["pairwise_sum"](x))


def test_imports_nothing_of_ours():
    code = ("import sys, types; package = types.ModuleType('s2sad'); "
            f"package.__path__ = {list(__import__('s2sad').__path__)!r}; sys.modules['s2sad'] = package; "
            "import s2sad.runtime; "
            "print(sorted(m for m in sys.modules if m.startswith('s2sad') or m in ('numba', 'gast')))")
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert ran.stdout.strip() == str(["s2sad", "s2sad.runtime", *(
        f"s2sad.runtime.{room}" for room in (
            "arena", "checkpoints", "decompositions", "directions", "exponentials", "factors", "matrices", "places",
            "scalars", "spans", "sparse_matrices", "special", "spread", "stacked_products", "stacks", "sums", "systems",
            "transforms", "triangles"))])


@pytest.fixture(scope="module", params=["numpy", "numba"])
def numbers(request):
    return vars(scalars) if request.param == "numpy" else _compiled(scalars)


def test_remainder_is_that_of_math(numbers):
    values = [0.0, -0.0, 0.3, 1.0, 2.5, -3.5, 7.0, 1e300, 5e-324, -1e-3, math.inf, -math.inf, math.nan]
    for a in values:
        for b in values:
            found = numbers["remainder"](np.float64(a), np.float64(b))
            try:
                expected = math.remainder(a, b)
            except ValueError:
                expected = math.nan
            assert found == expected and math.copysign(1, found) == math.copysign(1, expected) or (
                math.isnan(found) and math.isnan(expected)), (a, b)


def test_integers_are_those_of_math(numbers):
    for n in [*range(40), 2 ** 31, 2 ** 52 + 1, (2 ** 31 + 5) ** 2, (2 ** 31 + 5) ** 2 - 1, 2 ** 63 - 1]:
        assert numbers["isqrt"](n) == math.isqrt(n)
    for n in range(21):
        assert numbers["factorial"](n) == math.factorial(n)
        for k in range(24):
            assert (numbers["comb"](n, k), numbers["perm"](n, k)) == (math.comb(n, k), math.perm(n, k))
            assert numbers["lcm"](n - 7, k) == math.lcm(n - 7, k)
    for name, arguments in (("factorial", (21,)), ("perm", (40, 30)), ("comb", (80, 40)), ("lcm", (2 ** 40, 3 ** 30))):
        with pytest.raises(OverflowError):
            numbers[name](*arguments)
    for name, arguments in (("isqrt", (-1,)), ("factorial", (-1,)), ("perm", (-1, 2)), ("comb", (3, -2))):
        with pytest.raises(ValueError, match="negative"):
            numbers[name](*arguments)


def test_heaviside_and_isclose(numbers):
    for x in (-1.0, -0.0, 0.0, 2.0, math.nan, math.inf):
        assert np.array_equal(numbers["heaviside"](x, 0.25), np.heaviside(x, 0.25), equal_nan=True)
        for y in (0.0, 1e-10, 2.0 + 1e-9, math.inf, math.nan):
            for absolute in (0.0, 1e-9):
                assert numbers["isclose"](x, y, 1e-9, absolute) == math.isclose(x, y, abs_tol=absolute)


def test_digamma(functions):
    """Against SciPy's; near its zeros, and far below 0 where x itself has few digits, to the size of its terms."""
    reference = pytest.importorskip("scipy.special").digamma
    rng = generator(1)
    points = np.concatenate([rng.uniform(-30.0, 30.0, 4000), 10.0 ** rng.uniform(-300, 300, 1000),
                             -10.0 ** rng.uniform(-300, -1, 500), [1.4616321449683622, 9.999999999999998, 10.0]])
    for x in points:
        away = abs(x - np.rint(x)) if x < 0.0 else 1.0
        expected = reference(x)
        assert abs(functions["digamma"](x) - expected) <= 1e-14 * max(1.0, abs(expected)) * max(1.0, 0.1 / away), x
    assert functions["digamma"](0.0) == -math.inf and functions["digamma"](-0.0) == math.inf
    assert math.isnan(functions["digamma"](-3.0))
    assert math.isnan(functions["digamma"](math.nan)) and functions["digamma"](math.inf) == math.inf
    assert math.isnan(functions["digamma"](-math.inf))
