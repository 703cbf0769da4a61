"""Integers that do not fit 64 bits, of few bits, and sums of bools: what Numba would compute otherwise."""
from __future__ import annotations

import numpy as np
import pytest

import s2sad
from s2sad.cli import main
from tests.harness.derivatives import check_derivatives

ENGINES = ("numpy", "numba")
BIG = 10 ** 20


def grown(x, n):
    fact = 1
    for k in range(1, n):
        fact *= k
    return x[0] / fact


def raised(x, n):
    return x[0] * 10 ** n


def cubed(x, n):
    return x[0] * (n * 100000000) ** 3


def lowered(x, n):
    total = 0.0
    for i in range(-n, 1):
        total += x[0] * 2 ** i
    return total


@pytest.mark.parametrize("kernel, error, message", [
    (grown, OverflowError, "an integer that does not fit 64 bits: begin with a float, 1.0, not 1"),
    (raised, OverflowError, "an integer that does not fit 64 bits: begin with a float, 1.0, not 1"),
    (cubed, OverflowError, "an integer that does not fit 64 bits: begin with a float, 1.0, not 1"),
    (lowered, ValueError, "an integer to a negative power is no integer: write float(a) ** n")])
def test_what_numba_would_wrap_around_raises(kernel, error, message):
    with pytest.raises(error) as caught:
        s2sad.gradient(s2sad.differentiate(kernel, engine="numba"), wrt="x")(np.ones(1), 30)
    assert str(caught.value) == message
    assert s2sad.gradient(s2sad.differentiate(lowered, engine="numpy"), wrt="x")(np.ones(1), 2)[0] == 1.75


def of_few_bits(x, k):
    return x[0] * (k[0] + k[1])


def two_bools(x, k):
    return x[0] * ((x[0] > 0.0) + (x[1] > 0.0))


def too_big(x, k):
    return x[0] * BIG


def power_written(x):
    return x * 2 ** 70


def sum_written(x):
    return x * (2 ** 62 + 2 ** 62)


def shift_written(x):
    return x * (1 << 64)


def product_of_names(x):
    n = 10 ** 15
    m = n * n
    return x * m


def difference_written(x):
    return x * (10 ** 19 - 10 ** 19 + 1)


def tower_written(x):
    return x * 0.0 * (10 ** 10 ** 10)


@pytest.mark.parametrize("kernel, line, part", [
    (power_written, 1, "2 ** 70"), (sum_written, 1, "2 ** 62 + 2 ** 62"), (shift_written, 1, "1 << 64"),
    (product_of_names, 2, "m = n * n"), (difference_written, 1, "10 ** 19"), (tower_written, 1, "10 ** 10 ** 10")])
def test_constants_beyond_64_bits_are_refused_under_numba(kernel, line, part):
    with pytest.raises(s2sad.S2sadError) as refused:
        s2sad.gradient(s2sad.differentiate(kernel, engine="numba"))(1.0)
    found = refused.value.diagnostics[0]
    assert (found.message, found.help) == ("an integer that does not fit 64 bits", "write it as a float: 1e20")
    assert found.span.line == kernel.__code__.co_firstlineno + line
    assert found.span.source.line(found.span.line)[found.span.column:].startswith(part)
    if kernel is not tower_written:
        assert s2sad.gradient(s2sad.differentiate(kernel, engine="numpy"))(1.0) == float(kernel(1))


@pytest.mark.parametrize("statement", ["a = (a, a)", "a = [a, a]", "a = a + a"])
def test_tuples_that_grow_are_refused_before_they_are_large(statement, tmp_path, capsys):
    path = tmp_path / "k.py"
    first = "(x,)" if "(" in statement else "[x]"
    path.write_text(f"def f(x):\n    a = {first}\n" + f"    {statement}\n" * 40 + "    return a[0]\n")
    assert main(["adjoint", f"{path}:f"]) == 1
    assert "k.py:17:9: error[S201]: a tuple or list of more than 16384 items\n" in capsys.readouterr().err


def constants_that_fit(x):
    n = 2 ** 31
    m = n * n + (n - 1) * 2
    return x * m + x * (2 ** 62 - 1 + 2 ** 62) + x * 10 ** -400 + x * (3 ** 39 // 3 ** 38)


def test_constants_that_fit_are_computed():
    for engine in ENGINES:
        assert np.isclose(s2sad.gradient(s2sad.differentiate(constants_that_fit, engine=engine))(1.0),
                          constants_that_fit(1))


GROWING = "    n0 = 3\n" + "".join(f"    n{k + 1} = n{k} * n{k}\n" for k in range(50))


@pytest.mark.parametrize("body", [
    "    return x[0] * n50\n", "    return np.sum(x, axis=n50)\n",
    "    return np.sum(np.zeros(n50) + np.zeros(n50)) * x[0]\n",
    "    s = 0.0\n    for k in range(n50):\n        s += x[k] * x[k + n50]\n    return s\n",
    "    a = [x[0]] * n50\n    return a[0]\n", "    a = (x[0],) * 10 ** 12\n    return a[0]\n",
    "    a = [x[0]] * 1000000000\n    return a[0]\n", "    a = [[0.0] * 4000] * 4000\n    return x[0] + a[0][0]\n",
    "    return sum(x[i] for i, j in itertools.product(range(3), repeat=1000000000))\n"])
def test_integers_that_grow_take_bounded_time_and_memory(body, tmp_path, capsys):
    """Whether they are refused or not: the last of fifty squares has 10 ** 14 digits."""
    path = tmp_path / "k.py"
    path.write_text(f"import itertools\nimport numpy as np\ndef f(x):\n{GROWING}{body}")
    for engine in ENGINES:
        assert main(["adjoint", f"{path}:f", "--types", "x: float64[:]", "--engine", engine]) in (0, 1)
        assert "S901" not in capsys.readouterr().err


@pytest.mark.parametrize("kernel, message", [
    (of_few_bits, "arithmetic of uint8, which wraps around"),
    (two_bools, "the sum of two bools, which is a bool for NumPy's and a number for Python's"),
    (too_big, "an integer that does not fit 64 bits")])
def test_refused_for_numba(kernel, message):
    with pytest.raises(s2sad.S2sadError) as caught:
        s2sad.gradient(s2sad.differentiate(kernel, engine="numba"), wrt="x")(np.ones(2), np.array([200, 100], "uint8"))
    assert caught.value.diagnostics[0].message == message


def bools_of_elements(x, k):
    total, seen = 0.0, k > 2
    for i in range(x.size - 1):
        first = x[i] > 0.5
        total += x[i] ** 2 * (first + (x[i + 1] > 0.5)) + x[i] * (seen[i] + seen[i + 1]) - x[i] * ~first
    return total


def test_bools_of_elements_are_numpys():
    check_derivatives(bools_of_elements, (np.array([0.6, 0.3, 0.9]), np.array([1, 4, 5])), ("x",), ("return",))
