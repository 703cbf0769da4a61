"""`autodiff`: modes, annotations, seeds, and what primals hold afterwards."""
from __future__ import annotations

import numpy as np
import pytest

from s2sad import (
    Active, Const, Duplicated, DuplicatedNoNeed, Forward, ForwardWithPrimal, Reverse,
    ReverseWithPrimal, autodiff, jvp, vjp,
)
from tests.interface import kernels
from tests.harness.refusals import refused

pytestmark = pytest.mark.usefixtures("fresh", "apart")


def test_autodiff_in_reverse(made):
    norm = made("norm")
    u, u_bar = np.array([1.0, 2.0]), np.zeros(2)
    assert autodiff(Reverse, norm, Duplicated(u, u_bar), Active(2.0)) == (5.0,)
    assert u_bar.tolist() == [4.0, 8.0]
    assert autodiff(ReverseWithPrimal, norm, Duplicated(u, u_bar), Active(2), seed=0.5) == ((2.5,), 10.0)
    assert u_bar.tolist() == [6.0, 12.0]
    assert autodiff(Reverse, norm, Duplicated(u, u_bar)) == ()


def test_autodiff_leaves_primals_as_the_function_does(made):
    f = made("square")
    u = np.array([1.0, 2.0, 3.0])
    du, du_bar, u_bar = np.zeros(3), np.ones(3), np.zeros(3)
    autodiff(Reverse, f, Duplicated(du, du_bar), Duplicated(u, u_bar), 3)
    assert du.tolist() == [1.0, 4.0, 9.0] and du_bar.tolist() == [0.0] * 3 and u_bar.tolist() == [2.0, 4.0, 6.0]
    du[:], du_bar[:], u_bar[:] = 0.0, 1.0, 0.0
    autodiff(Reverse, f, DuplicatedNoNeed(du, du_bar), Duplicated(u, u_bar), 3)
    assert u_bar.tolist() == [2.0, 4.0, 6.0]


def test_autodiff_forwards(made):
    scale, pair = made("scale"), made("pair")
    u, u_dot = np.array([1.0, 2.0]), np.array([1.0, 0.0])
    assert autodiff(Forward, scale, Duplicated(u, u_dot), Duplicated(3.0, 1.0)) is None
    assert u_dot.tolist() == [4.0, 2.0] and u.tolist() == [3.0, 6.0]
    assert autodiff(Forward, pair, Duplicated(3.0, 1.0), 4) == (2.0, None, 6.0)
    assert autodiff(ForwardWithPrimal, pair, Duplicated(3.0, 1.0), 4) == ((2.0, None, 6.0), (6.0, 4, 9.0))


def test_a_returned_argument_is_its_name(made):
    f = made("grown")
    u, u_bar = np.array([1.0, 2.0]), np.ones(2)
    derivative, primal = autodiff(ReverseWithPrimal, f, Duplicated(u, u_bar), seed=np.array([1.0, 0.0]))
    assert derivative == () and primal is u and u.tolist() == [3.0, 6.0] and u_bar.tolist() == [6.0, 3.0]
    seeds = {"u": np.ones(2), "return": np.array([1.0, 0.0])}
    assert vjp(f, (u,), seeds)["u"].tolist() == [6.0, 3.0]
    assert vjp(f, (u,), {"return": np.ones(2)})["u"].tolist() == [3.0, 3.0]
    assert seeds["u"].tolist() == [1.0, 1.0] and u.tolist() == [3.0, 6.0]
    tangents = jvp(f, (u,), {"u": np.ones(2)})
    assert tangents["u"].tolist() == [3.0, 3.0] and tangents["return"] is tangents["u"]
    assert f.primal(u) is u


def test_seeds_of_several_results(made):
    f = made("pair")
    assert autodiff(Reverse, f, Active(3.0), 4, seed=(1.0, None, 1.0)) == (8.0,)
    assert vjp(f, (3.0, 4), {"return": (1.0, None, 0.5)}) == {"x": 5.0}
    assert jvp(f, (3.0, 4), {"x": 1.0}) == {"return": (2.0, None, 6.0)}
    refused("error[S403]: the seed of 'return' is missing: the function returns several values\n"
            "  help: give seed=..., shaped as that", autodiff, Reverse, f, Active(3.0), 4)
    refused("error[S403]: the seed of 'return' is a tuple of 2, the result is a tuple of 3\n"
            "  help: give a tuple of the same length, with None for what is no float",
            vjp, f, (3.0, 4), {"return": (1.0, 2.0)})
    refused("error[S403]: the seed of 'return' has a value at 1, where the result is no float\n  help: give None there",
            vjp, f, (3.0, 4), {"return": (1.0, 2.0, 3.0)})


def test_annotations_are_refused():
    u, n = np.ones(2), kernels.norm
    refused("error[S402]: the argument 'u' has no annotation\n  help: say Const(u) or Duplicated(u, u_bar)",
            autodiff, Reverse, n, u)
    refused("error[S402]: the argument 'c' has no annotation\n  help: say Const(c) or Active(c)",
            autodiff, Reverse, n, Const(u), 1.0)
    refused("error[S402]: the argument 'c' is Active, which means nothing in a forward mode\n"
            "  help: use Duplicated(c, c_dot)", autodiff, Forward, n, Const(u), Active(1.0))
    refused("error[S402]: the argument 'u' is Active, but no float\n  help: say Const(u) or Duplicated(u, u_bar)",
            autodiff, Reverse, n, Active(u))
    refused("error[S402]: the argument 'c' is a float, which cannot be Duplicated in reverse\n  help: use Active(c)",
            autodiff, Reverse, n, Const(u), Duplicated(1.0, 0.0))
    refused("error[S402]: the argument 'n' is Duplicated, but holds no floats\n  help: use Const(n)",
            autodiff, Reverse, kernels.square, Const(u), Const(u), Duplicated(np.ones(2, int), np.ones(2, int)))
    refused("error[S402]: 'Reverse' is no mode\n  help: use Forward, ForwardWithPrimal, Reverse or ReverseWithPrimal",
            autodiff, "Reverse", n)
