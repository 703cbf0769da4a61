"""Spellings that mean no more than plainer ones: texts of errors and of print, and what NumPy is to warn of."""
# ruff: noqa: UP031, UP032
from __future__ import annotations

import numpy as np
import pytest

import s2sad
from tests.derivatives import check_derivatives

V = np.array([0.3, 1.2, 0.8, 2.0])


def texts(x, n, name="it"):
    if n < 0:
        raise ValueError("bad %d in %s" % (n, name))
    if n > 100:
        raise ValueError("bad {} ".format(n) + str(n))
    assert n < 50, "n is " + str(n)
    return np.sum(x * x) * n


def printed(x, n):
    print("n=%d %.3e" % (n, x[0]))
    print("s: {}".format(n), "plain", "a" + str(n), f"{n}!")
    return np.sum(x * x)


def quiet(x):
    with np.errstate(divide="ignore", invalid="ignore"):
        y = np.where(x > 0, 1.0 / x, 0.0)
        z = y * y
    return np.sum(z)


def quiet_in_a_loop(x):
    t = 0.0
    for i in range(x.size):
        with np.errstate(all="ignore"):
            if x[i] < 0.5:
                continue
            t += np.sqrt(x[i])
    return t


@pytest.mark.parametrize("engine", ["numpy", "loops"])
@pytest.mark.parametrize(("kernel", "arguments"), [(texts, (V, 3)), (printed, (V, 3)), (quiet, (V,)),
                                                   (quiet_in_a_loop, (V,))])
def test_gradients(kernel, arguments, engine, capsys):
    check_derivatives(kernel, arguments, ("x",), ("return",), engine=engine)


@pytest.mark.parametrize(("n", "error", "text"), [(-1, ValueError, "'bad %d in %s' % (n, name)"),
                                                  (101, ValueError, "'bad {} '.format(n) + str(n)"),
                                                  (60, AssertionError, "'n is ' + str(n)")])
def test_errors_show_how_their_text_is_written(n, error, text):
    with pytest.raises(error) as raised:
        s2sad.vjp(s2sad.differentiate(texts, engine="numpy"), (V, n), {"return": 1.0})
    assert str(raised.value) == text


@pytest.mark.parametrize(("engine", "text"), [("numpy", "n=3 3.000e-01\ns: 3 plain a3 3!\n"),
                                              ("numba", "n=%d %.3e 3 0.3\ns: {} 3 plain a 3 3 !\n")])
def test_what_is_printed(engine, text, capfd):
    """Compiled code prints values without a format."""
    s2sad.differentiate(printed, engine=engine).primal(V, 3)
    assert capfd.readouterr().out == text
