"""Adjoints, tangents and residuals of the user's own, for functions that are read."""
from __future__ import annotations


import numpy as np
import pytest

import s2sad
from s2sad.run.compiled import _runtime
from tests.derivatives import check_derivatives

ENGINES = ("numpy", "numba")
U, P = np.array([0.3, -0.5, 0.7]), np.array([1.1, 0.8, 0.9])


# -- an adjoint and a tangent ---------------------------------------------------------------------------------------
def scaled_adjoint(u, u_bar, p, p_bar, t, n, result_bar):
    """Overwrites u as it goes, as the function does."""
    t_bar = 0.0
    for i in range(n):
        seed = u_bar[i] + result_bar
        t_bar += u[i] * p[i] * seed
        p_bar[i] += u[i] * t * seed
        u_bar[i] = p[i] * t * seed
        u[i] = -7.0
    return t_bar


def scaled_tangent(u, u_dot, p, p_dot, t, t_dot, n):
    s = s_dot = 0.0
    for i in range(n):
        u_dot[i] = u_dot[i] * p[i] * t + u[i] * p_dot[i] * t + u[i] * p[i] * t_dot
        u[i] *= p[i] * t
        s += u[i]
        s_dot += u_dot[i]
    return s, s_dot


@s2sad.rule(adjoint=scaled_adjoint, tangent=scaled_tangent)
def scaled(u, p, t, n):
    s = 0.0
    for i in range(n):
        u[i] *= p[i] * t
        s += u[i]
    return s


def both_adjoint(x, y, k, result_0_bar, result_2_bar):
    return y * result_0_bar + result_2_bar, x * result_0_bar + k * result_2_bar


def both_tangent(x, x_dot, y, y_dot, k):
    return x * y, k, x + k * y, x * y_dot + y * x_dot, x_dot + k * y_dot


@s2sad.rule(adjoint=both_adjoint, tangent=both_tangent)
def both(x, y, k):
    return x * y, k, x + k * y


def within(x, y):
    a, k, b = both(x, y, 3)
    return a * b + k


def in_loops_and_branches(u, p, t):
    total = 0.0
    for k in range(2):
        total += scaled(u, p, t * k + total + 0.8, 3)
        if total > 0.1:
            scaled(u[1:], p[:-1], 1.3, 2)
        total *= 0.5 * total + within(total, u[k])
        while total > 1.0:
            total = 0.2 * scaled(u, p, 0.9, 3) + 0.5 * np.abs(total)
        a, _, b = both(u[0], total, k)
        u[2] += a * b
    return total


@pytest.mark.parametrize("engine", ENGINES)
def test_an_adjoint_and_a_tangent(engine):
    check_derivatives(in_loops_and_branches, (U, P, 0.7), ("u", "p", "t"), ("u", "return"), engine)


def test_a_subset_and_the_function_itself():
    check_derivatives(scaled, (U, P, 0.7, 3), ("u", "p", "t"), ("u", "return"))
    check_derivatives(scaled, (U, P, 0.7, 2), ("p",), ("return",))
    check_derivatives(scaled, (U, P, 0.7, 2), ("u",), ("return",))
    check_derivatives(scaled, (U.astype("float32"), P.astype("float32"), 0.7, 3), ("u", "t"), ("u",))
    check_derivatives(both, (0.4, 0.7, 2), ("x", "y"), ("return",))
    assert s2sad.check(scaled, U, P, 0.7, 3, engine="numpy")


def flat_part(x):
    return np.floor(3.0 * x)


def straight_adjoint(x, result_bar):
    return 3.0 * result_bar


s2sad.rule(flat_part, adjoint=straight_adjoint)


def through_steps(u):
    return flat_part(u[0]) * u[1]


def test_a_derivative_that_the_text_does_not_have():
    found = s2sad.gradient(s2sad.differentiate(through_steps, engine="numpy"))(np.array([0.5, 2.0]))
    np.testing.assert_array_equal(found, [6.0, 1.0])


# -- an adjoint in two halves ---------------------------------------------------------------------------------------
CALLS = {"first": 0}


def halved_forward(u, t):
    kept = u.copy()
    s = 0.0
    for i in range(u.size):
        u[i] = np.sin(u[i]) * t
        s += u[i]
    return s, (kept, s)


def halved_reverse(kept, u, u_bar, t, result_bar):
    before, s = kept
    t_bar = 0.0
    for i in range(u_bar.size):
        seed = u_bar[i] + result_bar
        t_bar += np.sin(before[i]) * seed
        u_bar[i] = np.cos(before[i]) * t * seed
    return t_bar + 0.0 * s


@s2sad.rule(forward=halved_forward, reverse=halved_reverse)
def halved(u, t):
    s = 0.0
    for i in range(u.size):
        u[i] = np.sin(u[i]) * t
        s += u[i]
    return s


def filled_forward(v, u):
    v[:] = u * u
    return u.copy()


def filled_reverse(kept, v, v_bar, u, u_bar):
    u_bar += 2.0 * kept * v_bar
    v_bar[:] = 0.0


@s2sad.rule(forward=filled_forward, reverse=filled_reverse)
def filled(v, u):
    v[:] = u * u


def helper(u, t):
    if u[0] > 0.0:
        halved(u, t)
    return halved(u, t)


def with_halves(u, v, t):
    total = 0.0
    for k in range(2):
        total += helper(u, t * k + 0.9 + total)
        while total < 1.0:
            total += halved(u[:2], 0.2 + t) + 0.6
        filled(v, u)
        u[:] = v * 0.3 + u
        total *= total * 0.5
    return total


def plainly(u, v, t):
    """`with_halves` without rules."""
    total = 0.0
    for k in range(2):
        for _ in range(2 if u[0] > 0.0 else 1):
            u[:] = np.sin(u) * (t * k + 0.9 + total)
        total += np.sum(u)
        while total < 1.0:
            u[:2] = np.sin(u[:2]) * (0.2 + t)
            total += np.sum(u[:2]) + 0.6
        v[:] = u * u
        u[:] = v * 0.3 + u
        total *= total * 0.5
    return total


@pytest.mark.parametrize("engine", ENGINES)
def test_an_adjoint_in_two_halves(engine):
    given, seeds = (np.array([0.4, 0.3]), np.zeros(2), 0.7), {"u": np.array([1.0, -2.0]), "return": 0.7}
    found = s2sad.vjp(s2sad.differentiate(with_halves, engine=engine), given, seeds)
    expected = s2sad.vjp(s2sad.differentiate(plainly, engine="numpy"), given, seeds)
    for name, gradient in expected.items():
        np.testing.assert_allclose(found[name], gradient, rtol=1e-13)


def test_what_is_kept_lies_on_a_list():
    text = s2sad.differentiate(halved, engine="numpy").adjoint_source(U, 0.5)
    assert "    result, kept = halved_own_forward(u, t)\n    kept_stack.append(kept)\n" in text
    assert "kept = kept_stack.pop()" in text
    text = s2sad.differentiate(helper, engine="numpy").adjoint_source(U, 0.5)
    assert "    kept_stack: what `halved(u, t)` keeps\n    kept_stack_2: what `return halved(u, t)` keeps\n" in text
    told = str(s2sad.explain(helper, U, 0.5, engine="numpy"))
    assert "kept_stack: bytes known only at run time, what `halved(u, t)` keeps\n" in told
    assert s2sad.check(halved, U, 0.5, engine="numpy").with_differences


# -- implicit functions ---------------------------------------------------------------------------------------------
def cubic(x, a, b):
    return x * x * x + a * x - b


@s2sad.rule(implicit=cubic)
def root(x, a, b, most):
    steps = 0
    while abs(cubic(x, a, b)) > 1e-14 and steps < most:
        x -= cubic(x, a, b) / (3.0 * x * x + a)
        steps += 1
    return x, steps


def roots(u, a):
    total, x = 0.0, 1.0
    for i in range(u.size):
        x, steps = root(x, a, u[i] + total, 50)
        total += x * x + 0.0 * steps
        u[i] *= x
    return total


SHIFT = np.array([0.1, -0.2, 0.3])


def coupled(r, x, p, t):
    for i in range(x.size):
        r[i] = x[i] ** 3 + p[i] * x[i] - t - SHIFT[i]
    for i in range(1, x.size):
        r[i] += 0.3 * x[i - 1] * p[i]


def newton_steps(x, p, t):
    """Newton's method, as the user writes it."""
    n = x.size
    r, jacobian = np.zeros(n), np.zeros((n, n))
    for _ in range(30):
        coupled(r, x, p, t)
        for i in range(n):
            jacobian[i, i] = 3.0 * x[i] ** 2 + p[i]
            if i:
                jacobian[i, i - 1] = 0.3 * p[i]
        x[:] = x - np.linalg.solve(jacobian, r)


@s2sad.rule(implicit=coupled)
def newton(x, p, t):
    newton_steps(x, p, t)


@s2sad.rule(implicit=coupled, solver="gmres")
def newton_by_gmres(x, p, t):
    newton_steps(x, p, t)


def richardson(product, b, operands):
    x = np.zeros(b.shape)
    for _ in range(400):
        x = x + 0.2 * (b - product(x, operands))
    return x


@s2sad.rule(implicit=coupled, solver=richardson)
def newton_by_hand(x, p, t):
    newton_steps(x, p, t)


def laplace(r, x, p, b):
    for i in range(x.shape[0]):
        for j in range(x.shape[1]):
            r[i, j] = (2.0 + p[j]) * x[i, j] - b[i, j]
            if j:
                r[i, j] -= p[j] * p[j - 1] * x[i, j - 1]
                r[i, j - 1] -= p[j] * p[j - 1] * x[i, j]


def conjugate_gradients(x, p, b):
    """A linear system, solved without its matrix by the user's own code."""
    r, q = np.zeros(x.shape), np.zeros(x.shape)
    nothing = np.zeros(x.shape)
    laplace(r, x, p, b)
    d = -r
    square = np.sum(r * r)
    for _ in range(4 * x.size):
        laplace(q, d, p, nothing)
        step = square / np.sum(d * q)
        x[:] = x + step * d
        r[:] = r + step * q
        before = square
        square = np.sum(r * r)
        if square < 1e-30:
            break
        d[:] = square / before * d - r


@s2sad.rule(implicit=laplace, solver="cg")
def diffused(x, p, b):
    conjugate_gradients(x, p, b)


def several(x, p, t):
    total = 0.0
    for k in range(2):
        newton(x, p, t + total)
        total += np.sum(x * x)
        x[:] = x * p
        newton_by_gmres(x, p, 0.3 * total)
        total += x[k]
    newton_by_hand(x[:2], p[:2], total)
    return total


def test_implicit_functions():
    x, b = np.array([0.5, 0.6, 0.7]), np.array([[1.0, 2.0, 3.0], [-1.0, 0.5, 0.0]])
    check_derivatives(roots, (np.array([0.3, 0.5, 0.7]), 0.4), ("u", "a"), ("u", "return"))
    check_derivatives(several, (x, P, 0.4), ("x", "p", "t"), ("x", "return"))
    check_derivatives(diffused, (0.0 * b, P, b), ("x", "p", "b"), ("x",))


@s2sad.rule(implicit=coupled)
def relaxed(x, p, t):
    for _ in range(80):
        for i in range(x.size):
            r = x[i] ** 3 + p[i] * x[i] - t - SHIFT[i]
            if i:
                r += 0.3 * x[i - 1] * p[i]
            x[i] -= r / (3.0 * x[i] ** 2 + p[i])


def compiled_too(x, p, t):
    total, steps = root(1.0, 0.4, t, 50)
    for _ in range(2):
        relaxed(x, p, t + total)
        total += 0.05 * np.sum(x * x) + 0.01 * steps
    return total


def test_implicit_functions_are_compiled():
    pytest.importorskip("numba")
    given, seeds = (np.array([0.5, 0.6, 0.7]), P, 0.4), {"x": np.array([1.0, -1.0, 2.0]), "return": 0.7}
    found, expected = (s2sad.vjp(s2sad.differentiate(compiled_too, engine=e), given, seeds) for e in ENGINES)
    for name, gradient in expected.items():
        np.testing.assert_allclose(found[name], gradient, rtol=1e-12, atol=1e-14)


def test_solvers_without_a_matrix_are_compiled():
    numba = pytest.importorskip("numba")
    product = numba.njit(lambda v, operands: np.dot(operands[0], v))
    matrix, b = np.array([[2.0, 0.5], [0.5, 1.0]]), np.array([1.0, -3.0])
    solvers = _runtime("s2sad.runtime.systems", True)

    @numba.njit
    def both_ways(matrix, b):
        return cg(product, b, (matrix,)), gmres(product, b, (matrix,))
    cg, gmres = solvers["cg"], solvers["gmres"]
    for found in both_ways(matrix, b):
        np.testing.assert_allclose(matrix @ found, b, rtol=1e-14)


def test_the_iteration_has_the_same_derivative():
    seeds = {"x": np.array([1.0, -1.0, 2.0])}
    given = (np.array([0.5, 0.6, 0.7]), P, 0.4)
    ours = s2sad.vjp(s2sad.differentiate(newton, engine="numpy"), given, seeds)
    through = s2sad.vjp(s2sad.differentiate(newton_steps, engine="numpy"), given, seeds)
    np.testing.assert_array_equal(ours["x"], 0.0)
    np.testing.assert_allclose(through["x"], 0.0, atol=1e-15)
    for name in "pt":
        np.testing.assert_allclose(ours[name], through[name], rtol=1e-13)
    b = np.array([[1.0, 2.0, 3.0]])
    ours = s2sad.vjp(s2sad.differentiate(diffused, engine="numpy"), (0.0 * b, P, b), {"x": b})
    through = s2sad.vjp(s2sad.differentiate(conjugate_gradients, engine="numpy"), (0.0 * b, P, b), {"x": b})
    for name in "pb":
        np.testing.assert_allclose(ours[name], through[name], rtol=1e-12)


# -- functions that are not read ------------------------------------------------------------------------------------
def smoothed_adjoint(v, v_bar, u, u_bar, width):
    u_bar += np.convolve(v_bar, np.ones(width), "same") / width
    v_bar[:] = 0.0


@s2sad.rule(adjoint=smoothed_adjoint, writes="v")
def smoothed(v, u, width):
    v[:] = [float(x) for x in np.convolve(u, np.ones(width), "same") / width]


def norms_adjoint(u, u_bar, result_0_bar, result_1_bar):
    u_bar += u / np.linalg.norm(u) * result_0_bar + result_1_bar


def norms_tangent(u, u_dot):
    norm = float(np.linalg.norm(u))
    return norm, float(sum(u)), float(u @ u_dot) / norm, float(sum(u_dot))


@s2sad.rule(adjoint=norms_adjoint, tangent=norms_tangent, returns=2)
def norms(u):
    return float(np.linalg.norm(u)), float(sum(list(u)))


def bare_system(r, x, p):
    r[:] = x ** 3 + p * x - 1.0


@s2sad.rule(implicit=bare_system, writes="x")
def solved(x, p):
    try:
        for _ in range(100):
            x -= (x ** 3 + p * x - 1.0) / (3.0 * x * x + p)
    except ArithmeticError:
        pass


def of_what_is_not_read(u, p):
    v = np.zeros(u.size)
    smoothed(v, u, 3)
    solved(p, v)
    u[:] = v * p
    a, b = norms(u)
    return a * b


def test_functions_that_are_not_read():
    u = np.array([0.3, 0.5, 0.7])
    report = s2sad.check(of_what_is_not_read, u, P, engine="numpy")
    assert report and report.with_differences
    check_derivatives(norms, (u,), ("u",), ("return",))
    check_derivatives(solved, (P, u), ("x", "p"), ("x",))


def test_check_compares_with_differences_and_names_what_parts():
    report = s2sad.check(takes_wrong, U, engine="numpy")
    assert str(report).splitlines()[1:] == [
        "  adjoint with differences (dot product): PARTS, apart by 3.3e-01, 1e-06 allowed",
        "  adjoints of the user's own, without tangents: tests.test_own_adjoints.wrong_adjoint"]
    report = s2sad.check(takes_wrong_too, U, engine="numpy")
    assert str(report).endswith(": return wrong_too(u) * 2.0") and not report.adjoint_holds and report.tangent_holds


def wrong_adjoint(u, u_bar, result_bar):
    u_bar += 4.0 * u * result_bar


def right_tangent(u, u_dot):
    return np.sum(u * u), 2.0 * np.sum(u * u_dot)


@s2sad.rule(adjoint=wrong_adjoint)
def wrong(u):
    return np.sum(u * u)


@s2sad.rule(adjoint=wrong_adjoint, tangent=right_tangent)
def wrong_too(u):
    return np.sum(u * u)


def takes_wrong(u):
    return wrong(u) * 2.0


def takes_wrong_too(u):
    return wrong_too(u) * 2.0


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
    (call_no_p, "'no_p' has a derivative, 'tests.test_own_adjoints.no_p_adjoint', that takes no "
     "shadow of 'p', which is differentiated"),
    (call_copied, "'copied' has a derivative, 'tests.test_own_adjoints.spoils_p', that overwrites 'p', "
     "which it does not write itself"),
    (call_copied_on_itself, "'copied' is given one array twice, and writes it; no derivative of its own is for "
     "that"),
    (call_placed, "'placed' has a derivative, 'tests.test_own_adjoints.returns_none', that must "
     "return the adjoint of t, for these arguments, and does not"),
    (call_placed_too, "'placed_too' has a first half, 'tests.test_own_adjoints.keeps_itself', that "
     "keeps 'u' itself, which may change: keep a copy"),
    (call_twice, "'twice' has an adjoint, 'tests.test_own_adjoints.no_seed', that takes no 'result_bar', "
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
    with pytest.raises(s2sad.S2sadError, match="Numba cannot compile 'tests.test_own_adjoints.no_p_adjoint', the "
                                               "adjoint of 'no_p'"):
        s2sad.vjp(s2sad.differentiate(call_no_p, engine="numba"), (U, P), {"return": 1.0}, wrt="u")
    with pytest.raises(s2sad.S2sadError, match="'reads_table' reads the array 'TABLE' of its module, whose content"):
        s2sad.gradient(s2sad.differentiate(with_table, engine="numba"))(U)
    for function in (with_table, with_table_too):
        np.testing.assert_array_equal(s2sad.gradient(s2sad.differentiate(function, engine="numpy"))(U), TABLE)


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


ITSELF = "rule for 'tests.test_own_adjoints.plain': "
WRONG = [
    ({"adjoint": wrong_order}, "the adjoint 'tests.test_own_adjoints.wrong_order' has 'u_bar' where nothing more is "
     "expected", "it takes u, n, each float array followed by its shadow '..._bar', and then the seeds, result_bar"),
    ({"adjoint": wrong_name}, "the adjoint 'tests.test_own_adjoints.wrong_name' has 'v' where 'u' is expected",
     "it takes u, n, each float array followed by its shadow '..._bar', and then the seeds, result_bar"),
    ({"adjoint": too_many}, "the adjoint 'tests.test_own_adjoints.too_many' has 'more' where nothing more is expected",
     "it takes u, n, each float array followed by its shadow '..._bar', and then the seeds, result_bar"),
    ({"tangent": good}, "the tangent 'tests.test_own_adjoints.good' has 'u_bar' where 'n' is expected",
     "it takes u, n, each float followed by its shadow '..._dot'"),
    ({"forward": good_forward}, "forward= is given without reverse=",
     "an adjoint in two halves has both; one that keeps nothing is adjoint="),
    ({"forward": good_forward, "reverse": good}, "the reverse 'tests.test_own_adjoints.good' begins without a "
     "parameter for what the first half kept", "it takes what was kept, then u, n, each float array followed by its "
     "shadow '..._bar', and then the seeds, result_bar"),
    ({"forward": good_forward, "reverse": good_reverse, "adjoint": good}, "adjoint= and forward= are two adjoints",
     "give one of them"),
    ({"solver": "cg", "adjoint": good}, "solver= is given without implicit=",
     "a solver is for the linear system of a residual"),
    ({"implicit": strange_residual}, "the residual 'tests.test_own_adjoints.strange_residual' takes x, y",
     "its first parameter is the solution, or the array that it fills; the others are of u, n"),
    ({"implicit": cubic, "solver": "lu"}, "solver='lu' is none of dense, cg, gmres", "or give a function that solves"),
    ({"adjoint": "good"}, "adjoint='good' is no function", "give a function, or its dotted name"),
    ({"adjoint": starred}, "the parameter 'u' of 'tests.test_own_adjoints.starred' is not positional",
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
