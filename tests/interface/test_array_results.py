"""Derivatives of functions that return arrays: how they are called, and what is said of wrong seeds."""
from __future__ import annotations

import re
import subprocess
import sys

import numpy as np
import pytest

import s2sad
from s2sad import (
    Active, Const, Duplicated, Forward, ForwardWithPrimal, Reverse, ReverseWithPrimal, autodiff, gradient, jvp, vjp,
)
from tests.corpus.buffers.rebinding import time_loop
from tests.corpus.calls.array_results import (
    N, U, V, Y, helpers, part_of_written, scaled_products, several, tuples,
)


def test_comments_and_places_are_of_the_helper_s_source():
    text = s2sad.differentiate(helpers, engine="numpy").adjoint_source(Y, U, V, np.ones(2))
    assert "# out[i] = (u[i - 1] - 2.0 * u[i] + u[i + 1]) / dx ** 2" in text
    assert "# return FACTOR * factor * u" in text       # of another file
SIZE = "'u' may change its size from one iteration to the next"


def resized(u, n):
    for _ in range(n):
        u = np.ones(n) * u[0]
    return u


def test_a_size_that_is_another_one_is_said_when_it_shows():
    f = s2sad.differentiate(resized, engine="numpy")
    assert vjp(f, (U, N), {"return": np.ones(N)})["u"][0] == N
    with pytest.raises(s2sad.S2sadError, match=re.escape(SIZE)):
        vjp(f, (U, 3), {"return": np.ones(3)})


# -- the interface ----------------------------------------------------------------------------------------------------

F = s2sad.differentiate(scaled_products, engine="numpy")
X, ONES = np.array([1.0, 2.0, 3.0, 4.0]), np.ones(4)


def test_autodiff():
    x_bar = np.zeros(4)
    assert autodiff(Reverse, F, Duplicated(X, x_bar), Active(0.5), seed=ONES) == (20.0,)
    assert np.array_equal(x_bar, [1.0, 2.0, 3.0, 1.5])
    (c_bar,), primal = autodiff(ReverseWithPrimal, F, Duplicated(X, x_bar), Active(0.5), seed=ONES)
    assert c_bar == 20.0 and np.array_equal(primal, scaled_products(X, 0.5))
    assert np.array_equal(autodiff(Forward, F, Duplicated(X, ONES), Const(0.5)), [0.0, 1.5, 2.5, 3.5])
    dot, primal = autodiff(ForwardWithPrimal, F, Duplicated(X, ONES), Const(0.5))
    assert np.array_equal(dot, [0.0, 1.5, 2.5, 3.5]) and np.array_equal(primal, scaled_products(X, 0.5))
    assert np.array_equal(autodiff(Forward, F, Const(X), Const(0.5)), np.zeros(4))


def test_a_returned_argument_and_a_returned_part_of_it():
    f, u_bar = s2sad.differentiate(part_of_written, engine="numpy"), np.ones(4)
    assert autodiff(Reverse, f, Duplicated(X.copy(), u_bar), seed=(np.ones(3), ONES)) == ()
    assert np.array_equal(u_bar, [0.0, 3.0 + 6.0 + 0.0, 3.0 + 4.0 - 0.0, 3.0])
    assert f.primal(u := X.copy())[1] is u
    G = s2sad.differentiate(several, engine="numpy")
    assert G.primal(X, 0.5)[5] is X
    dots = jvp(G, (X, 0.5), {"u": ONES})["return"]
    assert dots[3] is None and np.array_equal(dots[5], ONES) and dots[2].shape == (3,)


def test_adjoint_and_tangent():
    x_bar = np.zeros(4)
    assert F.adjoint(X, x_bar, 0.5, ONES) == (20.0,)
    assert np.array_equal(x_bar, [1.0, 2.0, 3.0, 1.5])
    assert F.adjoint(X, x_bar, 0.5, X) == (70.0,)         # the seed is only read
    assert np.array_equal(F.tangent(X, ONES, 0.5, 0.0)[0], [0.0, 1.5, 2.5, 3.5])
    assert "def scaled_products_adjoint(u, u_bar, c, c_bar" not in F.adjoint_source(X, 0.5)
    assert "def scaled_products_adjoint(u, u_bar, c, result_bar):" in F.adjoint_source(X, 0.5)


WRONG = [
    (lambda x_bar: autodiff(Reverse, F, Duplicated(X, x_bar), Active(0.5)), "S403",
     "the seed of 'return' is missing: the function returns an array", "give seed=..., shaped as that"),
    (lambda x_bar: autodiff(Reverse, F, Duplicated(X, x_bar), Active(0.5), seed=2.0), "S403",
     "the seed of 'return' is of type float, the result is an array", "give an array of float64 with 1 axis"),
    (lambda x_bar: autodiff(Reverse, F, Duplicated(X, x_bar), Active(0.5), seed=np.ones(3)), "S403",
     "the seed 'result_bar' has shape (3,), what 'scaled_products' returns there has (4,)",
     "give an array of its shape"),
    (lambda x_bar: F.adjoint(X, x_bar, 0.5, np.ones(3)), "S403",
     "the seed 'result_bar' has shape (3,), what 'scaled_products' returns there has (4,)",
     "give an array of its shape"),
    (lambda x_bar: autodiff(Reverse, F, Duplicated(X, x_bar), Active(0.5), seed=np.ones((4, 1), "float32")), "S403",
     "the seed of 'return' is an array of float32 of shape (4, 1), the result one of float64 with 1 axis",
     "give an array of float64 with 1 axis"),
    (lambda x_bar: F.adjoint(X, x_bar, 0.5, x_bar), "S404",
     "the shadow 'u_bar' and the seed 'result_bar' share memory",
     "give each shadow memory of its own: s2sad.make_zero(x)"),
    (lambda x_bar: gradient(F)(X, 0.5), "S401",
     "a gradient needs a function that returns one float; 'scaled_products' returns float64[:]",
     "use s2sad.vjp, which takes a seed for each output"),
    (lambda x_bar: vjp(s2sad.differentiate(tuples, engine="numpy"), (X, 0.3), {"return": (((ONES,), 1.0), 1.0)}),
     "S403", "the seed of 'return' is a tuple of 2, the result is a tuple of 4",
     "give a tuple of the same length, with None for what is no float"),
]


@pytest.mark.parametrize(("call", "code", "said", "help"), WRONG)
def test_wrong_seeds(call, code, said, help):
    x_bar = np.zeros(4)
    with pytest.raises(s2sad.S2sadError) as caught:
        call(x_bar)
    diagnostic = caught.value.diagnostics[0]
    assert (diagnostic.code, diagnostic.message, diagnostic.help) == (code, said, help)
    assert not x_bar.any()


def test_check_and_explain():
    assert s2sad.check(helpers, Y, U, V, np.array([0.3, 0.7]), engine="numpy")
    assert s2sad.check(tuples, U, 0.3, engine="numpy")
    said = str(s2sad.explain(s2sad.differentiate(time_loop, engine="numpy"), Y, U, np.ones(2), 3))
    assert "v where an iteration of `for" in said


def test_command(tmp_path):
    path = tmp_path / "fresh.py"
    path.write_text("import numpy as np\n\n\ndef fresh(u, c):\n    return c * u[1:] * u[:-1]\n")
    run = subprocess.run([sys.executable, "-m", "s2sad", "adjoint", f"{path}:fresh", "--engine", "numpy", "--types",
                          "u: float64[:], c: float64"], capture_output=True, text=True, check=True)
    assert "def fresh_adjoint(u, u_bar, c, result_bar):" in run.stdout
