"""What is seen of a derivative of the user's own when it runs, and what its registration says is wrong."""
from __future__ import annotations

import numpy as np
import pytest

import s2sad
from tests.custom.test_implicit_functions import cubic
from tests.custom.test_user_adjoints import U, wrong_adjoint

# -- implicit functions ---------------------------------------------------------------------------------------------
def hidden_writes(u, u_bar, result_bar):
    spoiled(u)
    u_bar += result_bar


def spoiled(u):
    u[0] = 1.0


@s2sad.rule(adjoint=hidden_writes)
def summed(u):
    return np.sum(u)


def returned_array(u, u_bar, t, result_bar):
    return u


@s2sad.rule(adjoint=returned_array)
def summed_too(u, t):
    return np.sum(u) * t


def keeps_a_view(u):
    return np.sum(u), (1.0, np.reshape(u, (1, 3)))


def of_a_view(kept, u, u_bar, result_bar):
    u_bar += result_bar


@s2sad.rule(forward=keeps_a_view, reverse=of_a_view)
def summed_again(u):
    return np.sum(u)


def returns_an_array(u, u_bar, result_bar):
    u_bar += result_bar


@s2sad.rule(adjoint=returns_an_array, returns=1)
def no_number(u):
    return u + 1.0


def squared(u):
    return no_number(u) ** 2


@pytest.mark.parametrize(("function", "given", "error", "message"), [
    (summed, (U,), ValueError, "read-only"),
    (summed_too, (U, 2.0), TypeError, "returned_array, the adjoint of summed_too, must return numbers, but returned"),
    (summed_again, (U,), TypeError, "keeps_a_view keeps memory of its arguments, which may change: keep a copy"),
    (squared, (U,), TypeError, "no_number, itself of no_number, must return numbers")])
def test_what_is_seen_when_it_runs(function, given, error, message):
    with pytest.raises(error, match=message):
        s2sad.vjp(s2sad.differentiate(function, engine="numpy"), given, {"return": 1.0})


def plain(u, n):
    return u[0] * n


def writing(u):
    u[0] = 1.0
    return 2.0


def wrong_order(u, n, u_bar, result_bar):
    return 0.0


def wrong_name(v, v_bar, n, result_bar):
    return 0.0


def too_many(u, u_bar, n, result_bar, more):
    return 0.0


def good(u, u_bar, n, result_bar):
    return 0.0


def good_reverse(kept, u, u_bar, n, result_bar):
    return 0.0


def good_forward(u, n):
    return u[0] * n, u[0]


def strange_residual(x, y):
    return x - y


def starred(*u):
    return 0.0


ITSELF = f"rule for '{__name__}.plain': "
WRONG = [
    ({"adjoint": wrong_order}, f"the adjoint '{__name__}.wrong_order' has 'u_bar' where nothing more is "
     "expected", "it takes u, n, each float array followed by its shadow '..._bar', and then the seeds, result_bar"),
    ({"adjoint": wrong_name}, f"the adjoint '{__name__}.wrong_name' has 'v' where 'u' is expected",
     "it takes u, n, each float array followed by its shadow '..._bar', and then the seeds, result_bar"),
    ({"adjoint": too_many}, f"the adjoint '{__name__}.too_many' has 'more' where nothing more is expected",
     "it takes u, n, each float array followed by its shadow '..._bar', and then the seeds, result_bar"),
    ({"tangent": good}, f"the tangent '{__name__}.good' has 'u_bar' where 'n' is expected",
     "it takes u, n, each float followed by its shadow '..._dot'"),
    ({"forward": good_forward}, "forward= is given without reverse=",
     "an adjoint in two halves has both; one that keeps nothing is adjoint="),
    ({"forward": good_forward, "reverse": good}, f"the reverse '{__name__}.good' begins without a "
     "parameter for what the first half kept", "it takes what was kept, then u, n, each float array followed by its "
     "shadow '..._bar', and then the seeds, result_bar"),
    ({"forward": good_forward, "reverse": good_reverse, "adjoint": good}, "adjoint= and forward= are two adjoints",
     "give one of them"),
    ({"solver": "cg", "adjoint": good}, "solver= is given without implicit=",
     "a solver is for the linear system of a residual"),
    ({"implicit": strange_residual}, f"the residual '{__name__}.strange_residual' takes x, y",
     "its first parameter is the solution, or the array that it fills; the others are of u, n"),
    ({"implicit": cubic, "solver": "lu"}, "solver='lu' is none of dense, cg, gmres", "or give a function that solves"),
    ({"adjoint": "good"}, "adjoint='good' is no function", "give a function, or its dotted name"),
    ({"adjoint": starred}, f"the parameter 'u' of '{__name__}.starred' is not positional",
     "take plain positional parameters"),
    ({"adjoint": good, "writes": "v"}, "writes= names v, which is no parameter of it", "its parameters are u, n"),
    ({"adjoint": good, "returns": 1.0}, "returns=1.0 is no number of floats", "write 0, 1, 2, ..."),
]


@pytest.mark.parametrize(("given", "message", "help"), WRONG, ids=[m for _, m, _ in WRONG])
def test_registration_says_what_is_wrong(given, message, help):
    with pytest.raises(s2sad.S2sadError) as caught:
        s2sad.rule(plain, **given)
    assert str(caught.value) == f"error[S302]: {ITSELF}{message}\n  help: {help}"


def test_registration_of_other_mistakes():
    with pytest.raises(s2sad.S2sadError, match="rule: adjoint= does not go together with partials"):
        s2sad.rule(plain, adjoint=good, u="1.0")
    with pytest.raises(s2sad.S2sadError, match="rule: a Python function is needed, not <ufunc 'sin'>"):
        s2sad.rule(np.sin, adjoint=good)
    with pytest.raises(s2sad.S2sadError, match="it writes its argument 'u', which writes= does not name"):
        s2sad.rule(writing, adjoint=wrong_adjoint, returns=1)
    with pytest.raises(s2sad.S2sadError, match="there is no function 'no.such'"):
        s2sad.rule(plain, adjoint="no.such")


def test_a_derivative_that_cannot_be_imported_is_refused():
    def local(u, u_bar, result_bar):
        u_bar += result_bar
    with pytest.raises(s2sad.S2sadError, match=r"'.*local' cannot be imported by name"):
        s2sad.rule(writing, adjoint=local)
