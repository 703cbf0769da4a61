"""What is refused of derivatives of the user's own: at the call, when they run, and when they are registered."""
from __future__ import annotations

import numpy as np
import pytest

import s2sad
from tests.custom.test_user_adjoints import P, U, right_tangent, takes_wrong

# -- what is refused ------------------------------------------------------------------------------------------------
TABLE = np.array([1.0, 2.0, 3.0])


def no_p_adjoint(u, u_bar, p, t, result_bar):
    u_bar += p * t * result_bar
    return float(f"{np.sum(u * p) * result_bar:.17g}")


@s2sad.rule(adjoint=no_p_adjoint)
def no_p(u, p, t):
    return np.sum(u * p) * t


def spoils_p(u, u_bar, p, p_bar):
    p[0] = 1.0
    p_bar += u_bar
    u_bar[:] = 0.0


@s2sad.rule(adjoint=spoils_p)
def copied(u, p):
    u[:] = p


def returns_none(u, u_bar, t):
    u_bar[0] = 0.0


@s2sad.rule(adjoint=returns_none)
def placed(u, t):
    u[0] = t


def keeps_itself(u, t):
    u[0] = t
    return u[1:]


def kept_reverse(kept, u, u_bar, t):
    return u_bar[0]


@s2sad.rule(forward=keeps_itself, reverse=kept_reverse)
def placed_too(u, t):
    u[0] = t


def no_seed(x):
    return 2.0


@s2sad.rule(adjoint=no_seed)
def twice(x):
    return 2.0 * x


def reads_table(u, u_bar, result_bar):
    u_bar += TABLE * result_bar


@s2sad.rule(adjoint=reads_table)
def with_table(u):
    return np.sum(u * TABLE)


def table_forward(u):
    return np.sum(u * TABLE), TABLE.copy()


def table_reverse(kept, u, u_bar, result_bar):
    u_bar += kept * result_bar


@s2sad.rule(forward=table_forward, reverse=table_reverse)
def with_table_too(u):
    return np.sum(u * TABLE)


def writes_table(u):
    TABLE[0] = u[0]
    return with_table(u)


def difference(r, x, p):
    r[:] = x - p


@s2sad.rule(implicit=difference)
def with_work(x, p, work):
    work[:] = p
    x[:] = work


def reads_work(u, p):
    work = np.zeros(3)
    with_work(u, p, work)
    return u[0] + work[0]


@s2sad.rule(implicit=difference)
def changes_p(x, p):
    p[0] = 1.0
    x[:] = p


def returns_p(x, p):
    return p


@s2sad.rule(implicit=returns_p)
def no_filling(x, p):
    x[:] = p


def call_no_p(u, p):
    return no_p(u, p, 2.0)


def call_copied(u, p):
    copied(u, p)


def call_copied_on_itself(u, p):
    copied(u, u)


def call_placed(u, p):
    placed(u, p[0])


def call_placed_too(u, p):
    placed_too(u, p[0])


def call_twice(u, p):
    return twice(u[0])


def call_writes_table(u, p):
    return writes_table(u)


def call_changes_p(u, p):
    changes_p(u, p)


def call_no_filling(u, p):
    no_filling(u, p)


def returned_misfit(x, p):
    return x * x - p


@s2sad.rule(implicit=returned_misfit)
def square_roots(x, p):
    for _ in range(30):
        x -= (x * x - p) / (2.0 * x)


def call_square_roots(u, p):
    square_roots(u, p)


REFUSED = [
    (call_square_roots, "'square_roots' has a residual, 'returned_misfit', that must return a float, or take an array "
     "that it writes second"),
    (call_no_p, f"'no_p' has a derivative, '{__name__}.no_p_adjoint', that takes no "
     "shadow of 'p', which is differentiated"),
    (call_copied, f"'copied' has a derivative, '{__name__}.spoils_p', that overwrites 'p', "
     "which it does not write itself"),
    (call_copied_on_itself, "'copied' is given one array twice, and writes it; no derivative of its own is for "
     "that"),
    (call_placed, f"'placed' has a derivative, '{__name__}.returns_none', that must "
     "return the adjoint of t, for these arguments, and does not"),
    (call_placed_too, f"'placed_too' has a first half, '{__name__}.keeps_itself', that "
     "keeps 'u' itself, which may change: keep a copy"),
    (call_twice, f"'twice' has an adjoint, '{__name__}.no_seed', that takes no 'result_bar', "
     "though what it returns is differentiated"),
    (call_writes_table, "'with_table' reads 'TABLE', an array of its module that is written; so may its "
     "own derivative, too late"),
    (reads_work, "'with_work' has a residual, 'difference', that gives no derivative of 'work', which is "
     "differentiated"),
    (call_changes_p, "'changes_p' overwrites 'p', which its residual, 'difference', reads"),
    (call_no_filling, "'no_filling' has a residual, 'returns_p', that must return a float, or take an array that it "
     "writes second"),
]


@pytest.mark.parametrize(("kernel", "message"), REFUSED, ids=[m for _, m in REFUSED])
def test_what_a_derivative_does_not_give_is_refused_at_the_call(kernel, message):
    seeds = {"u": np.ones(3)} if "call_" in kernel.__name__ and kernel(np.ones(3), np.ones(3)) is None else {
        "return": 1.0}
    with pytest.raises(s2sad.S2sadError) as caught:
        s2sad.vjp(s2sad.differentiate(kernel, engine="numpy"), (np.ones(3), np.full(3, 2.0)), seeds)
    (found,) = caught.value.diagnostics
    assert (found.code, found.message) == ("S301", message)
    assert found.span is not None and found.span.line == kernel.__code__.co_firstlineno + (
        2 if kernel in (writes_table, reads_work) else 1) or kernel is call_writes_table


def test_a_tangent_or_an_adjoint_that_is_not_there():
    with pytest.raises(s2sad.S2sadError) as caught:
        s2sad.jvp(s2sad.differentiate(takes_wrong, engine="numpy"), (U,), {"u": U})
    assert str(caught.value).partition("error")[2].splitlines()[0] == (
        "[S301]: 'wrong' has no tangent of its own, only its adjoint")
    with pytest.raises(s2sad.S2sadError, match="'only_tangent' has no adjoint of its own, only its tangent"):
        s2sad.gradient(s2sad.differentiate(takes_only_tangent, engine="numpy"))(U)
    assert s2sad.jvp(s2sad.differentiate(takes_only_tangent, engine="numpy"), (U,), {"u": U})["return"] == (
        pytest.approx(4.0 * np.sum(U * U)))


@s2sad.rule(tangent=right_tangent)
def only_tangent(u):
    return np.sum(u * u)


def takes_only_tangent(u):
    return only_tangent(u) * 2.0


def test_what_numba_cannot_do_is_refused():
    pytest.importorskip("numba")
    with pytest.raises(s2sad.S2sadError, match=f"Numba cannot compile '{__name__}.no_p_adjoint', the "
                                               "adjoint of 'no_p'"):
        s2sad.vjp(s2sad.differentiate(call_no_p, engine="numba"), (U, P), {"return": 1.0}, wrt="u")
    with pytest.raises(s2sad.S2sadError, match="'reads_table' reads the array 'TABLE' of its module, whose content"):
        s2sad.gradient(s2sad.differentiate(with_table, engine="numba"))(U)
    for function in (with_table, with_table_too):
        np.testing.assert_array_equal(s2sad.gradient(s2sad.differentiate(function, engine="numpy"))(U), TABLE)
