"""What is refused of calls with structures, before anything is derived or written."""
from __future__ import annotations

import numpy as np
import pytest

from s2sad import Active, Const, Duplicated, Reverse, S2sadError, autodiff, differentiate, gradient, jvp, make_zero, vjp
from tests.evaluate.structures.arguments import U, State, params, state_of
from tests.evaluate.structures.kernels import loss
from tests.harness.refusals import refused


@pytest.mark.parametrize(("call", "text"), [
    (lambda f, a: gradient(f, wrt="state.uu")(*a), "error[S401]: wrt names 'state.uu', and 'state' has no such part\n"
     "  help: its parts are state.u, state.v, state.t, state.n, state.log"),
    (lambda f, a: gradient(f, wrt="other")(*a), "error[S401]: wrt names 'other', which is no parameter of 'loss'\n"
     "  help: its parameters are state, p, dt, opts, mask"),
    (lambda f, a: gradient(f, wrt="state.n")(*a), "error[S401]: wrt names 'state.n', which is an integer\n"
     "  help: give a float (3.0, not 3) if it is a real quantity"),
    (lambda f, a: vjp(f, a, {"p": params()}), "error[S401]: 'p' is no output of 'loss', which writes no float in it"),
    (lambda f, a: vjp(f, a, {"state": params()}), "error[S403]: the seed of 'state' is of type Params or has other "
     "parts: 'state' is a dataclass\n  help: make one with s2sad.make_zero(state)"),
    (lambda f, a: vjp(f, a, {"state": State(np.ones(2), U, 0.0)}), "error[S403]: the seed of 'state.u' is an array of "
     "float64 of shape (2,), its output one of float64 of shape (3,)\n  help: give an array of float64 of shape (3,)"),
    (lambda f, a: jvp(f, a, {"state": state_of(), "p": {"k": 1.0}}), "error[S403]: the tangent of 'p' is of type dict "
     "or has other parts: 'p' is a named tuple\n  help: make one with s2sad.make_zero(p)"),
    (lambda f, a: autodiff(Reverse, f, *a), "error[S402]: the argument 'state' has no annotation\n"
     "  help: say Const(state) or Duplicated(state, state_bar)"),
    (lambda f, a: autodiff(Reverse, f, Const(a[0]), Duplicated(a[1], make_zero(a[1])), Active(0.1), Const(a[3])),
     "error[S402]: the float 'p.k' lies in a named tuple: its adjoint cannot be added to the shadow\n"
     "  help: use s2sad.vjp or s2sad.gradient, which return it, or hold 'p.k' in an array"),
    (lambda f, a: autodiff(Reverse, f, Duplicated(a[0], a[0]), Const(a[1]), Const(0.1), Const(a[3])),
     "error[S404]: the argument 'state.u' and the shadow 'state_u_bar' share memory\n"
     "  help: give each shadow memory of its own: s2sad.make_zero(x)"),
    (lambda f, a: f.adjoint(*a), "error[S405]: 'loss.adjoint' was given 4 arguments that do not fit its signature\n"
     "  help: call loss.adjoint(state, p, dt, opts, mask, with a shadow after each that holds float arrays)"),
    (lambda f, a: gradient(f)(*a[:3], {"scale": [0.7] * 600}), "error[S405]: the argument 'opts' is a dict of 600 "
     "values\n  help: pass numpy.array(opts, dtype=float)"),
])
def test_refused_calls(call, text):
    refused(text, call, differentiate(loss, engine="numpy"), (state_of(), params(), 0.1, {"scale": 0.7}))


def weighted(a, state, sequence):
    """Asks what an argument is; two arrays with as many axes stand one behind the other."""
    rows, columns = sequence.shape
    total = 0.0 if state is None else np.sum(state[0] * a)
    for t in range(rows):
        total += np.sum(sequence[t] * a * a)
    return total / columns


def test_an_array_behind_another_that_could_be_its_shadow():
    f = differentiate(weighted, wrt="a", of="return", engine="numpy")
    a_bar = np.zeros(3)
    f.adjoint(np.ones(3), a_bar, np.ones((2, 3)), np.full((4, 3), 2.0), 1.0)
    assert a_bar == pytest.approx(np.full(3, 17.0 / 3.0))
    with pytest.raises(S2sadError, match="2 targets for 0 values"):
        f.adjoint(np.ones(3), np.zeros(3), np.ones((2, 3)), 1.0, 1.0)
