"""Functions that return arrays: helpers, kernels, names bound anew in loops, functions inside functions."""
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
from tests import called_arrays
from tests.derivatives import check_derivatives
from tests.seeds import generator

GRAVITY = 2.0
RNG = generator(3)
N = 6
U, V, M = RNG.random(N) + 0.1, RNG.random(N) + 0.5, RNG.random((4, N))
Y = np.zeros(N)


# -- helpers --------------------------------------------------------------------------------------------------------

def laplacian(u, dx=0.5):
    out = np.zeros_like(u)
    for i in range(1, u.size - 1):
        out[i] = (u[i - 1] - 2.0 * u[i] + u[i + 1]) / dx ** 2
    return out


def products(u, v):
    a = u * v
    return a, u[1:] - u[:-1], np.sum(a)


def rhs(u, p):
    return p[0] * laplacian(u) - u ** 3


def middle(u):
    return u[1:-1]


def filled(u, x):
    u[0] = x
    return u


def limited(u, c):
    if c > 0.3:
        return u
    if c > 0.2:
        return u * c
    out = np.zeros_like(u)
    for i in range(u.size):
        out[i] = u[i] ** 2
    return out


def first_above(u, level):
    for k in range(u.size):
        for j in range(2):
            if u[k] + j > level:
                return u * u[k]
    return u * 2.0


def helpers(du, u, v, p):
    out = 2.0
    lap = laplacian(u, dx=p[1])
    a, b, s = products(lap, v)
    du[:] = a * s + out * rhs(u + 0.1 * a, p)
    du[1:] += b
    m = middle(du)
    m *= called_arrays.scaled(v, out)[1:-1]
    w = v.copy()
    x = filled(w, p[0])
    x[1] = w[0] * u[2]
    du += w * limited(u, p[1]) * limited(u, 0.25) + limited(limited(v, 0.1), p[0])


def swapped(u, v):
    return v, u


def in_expressions(y, u, v, n):
    a, b = swapped(u, v)
    a, b = swapped(a, b)
    for k in range(n):
        if np.sum(laplacian(a)) > -100.0 and laplacian(b)[1] != 0.0:
            y += laplacian(a, 1.0 + k) @ laplacian(v) * first_above(b, 0.3 + k)


# -- names bound anew -----------------------------------------------------------------------------------------------

def stepped(u, dt):
    v = u.copy()
    for i in range(1, u.size - 1):
        v[i] = u[i] + dt * (u[i - 1] - 2.0 * u[i] + u[i + 1])
    return v


def time_loop(y, u, p, n):
    v = u.copy()
    for _ in range(n):
        v = v + 0.01 * rhs(v, p)
    w = u
    for _ in range(n):
        w = stepped(w, 0.1)
    y[:] = v + w


def swaps(y, u, v, n):
    a = u.copy()
    b = v * 2.0
    new = np.zeros_like(u)
    for _ in range(n):
        a, b = b, a * b
        for i in range(1, u.size - 1):
            new[i] = a[i] * a[i - 1] + a[i + 1]
        a, new = new, a
    y[:] = a + 3.0 * b


def previous(y, u, n):
    old = u
    err, k = 1.0, 0
    while err > 1e-3 and k < n:
        old = u
        u = stepped(u, 0.1)
        err = np.sum((u - old) ** 2)
        k += 1
    y[:] = u + old * err


def left_early(y, u, n):
    for _ in range(n):
        u = stepped(u, 0.2)
        if u[2] > 0.9:
            u = u * 2.0
            break
        u = u * u + 0.4
    y[:] = u


def branches(y, u, n, c):
    if c > 0.0:
        u = stepped(u, c)
    for s in range(n):
        if u[1] > 0.5:
            u = stepped(u, 0.2 * c)
        else:
            u = u * 0.9
        v = u[::-1]
        if s == 2:
            v = u
        u = v + 0.1
        u = u[::-1]
    y[:] = u


def nested_loops(y, u, m, n):
    r = m[0]
    for a in range(n):
        w = u
        for _ in range(2):
            w = stepped(w, 0.1)
        u = w * u
        y += r
        r = m[a] * u
    y[:] += u


# -- kernels that return arrays --------------------------------------------------------------------------------------

def scaled_products(u, c):
    out = np.zeros_like(u)
    for i in range(1, u.size):
        out[i] = c * u[i] * u[i - 1]
    return out


def several(u, c):
    a = stepped(u, c)
    s = np.sum(a * u)
    return a, s, u[1:] - c, 3, a, u


def iterated(x, n):
    for _ in range(n):
        r = x ** 2 - 2.0
        if np.sum(r * r) < 1e-3:
            return x
        x = x - r / (2.0 * x)
    return x


def searched(u, c):
    if c > 0.0:
        if c > 1.0:
            return first_above(u, c - 1.0)
        u = u + c
    else:
        u = u - c
    return u ** 2


def part_of_written(u):
    u[0] = u[1] * u[2]
    return u[1:], u


def written_and_new(u, w):
    u *= 2.0
    w[:] = u ** 2
    return u * w, w


def inner_tuple(u, c):
    return (u * c, (np.sum(u), c)), u + c


def tuples(u, c):
    (a, (s, d)), b = inner_tuple(u, c)
    p, q = inner_tuple(b, c)[0]
    if c > 0.0:
        return ((a * s, b), d), u[1], (3, 4), a + p * q[0]
    return ((a, b * 2.0), s), u[2], (4, 5), p


def dot(u, v):                          # NumPy has one, too
    return np.dot(u, v) * u


def constant(u, c):
    return np.ones(3) * 2.0, c


# -- functions inside functions, functions given to functions ---------------------------------------------------------

def rk2(f, u, p, dt):
    k = f(u, p)
    return u + dt * f(u + 0.5 * dt * k, p)


def decay(u, p):
    return -p * u ** 2


def twice(f, x):
    return composed(f, f, x)


def composed(f, g, x):
    return f(g(x))


def closures(u, a):
    n = u.size

    def slope(v):
        out = np.zeros_like(v)
        for i in range(1, n):
            out[i] = a * v[i] * v[i - 1] + GRAVITY
        return out

    def put(i, x):
        w[i] = combine(x) * a ** power(i)

    def power(i, base=2.0):
        return base + i
    w = np.zeros(3)
    combine = lambda x: a + x * u[0]  # noqa: E731
    k = slope(u + 0.1 * slope(u))
    put(0, u[1])
    a = a * 2.0
    put(2, u[0])
    return k, w, combine(3.0), twice(combine, u[1]), composed(np.sin, lambda x: x * a, u[0])


def time_stepper(u, p, dt, n):
    for _ in range(n):
        u = rk2(decay, u, p, dt)
        u = rk2(u=u, f=lambda v, q: q * v, p=p, dt=dt)
    return u


RETURN = ("return",)
CASES = [
    (helpers, (Y, U, V, np.array([0.35, 0.7])), ("u", "v", "p"), ("du",)),
    (in_expressions, (Y, U, V, 2), ("u", "v"), ("y",)),
    (time_loop, (Y, U, np.array([0.3, 0.7]), 3), ("u", "p"), ("y",)),
    (swaps, (Y, U, V, 3), ("u", "v"), ("y",)),
    (previous, (Y, U, 3), ("u",), ("y",)),
    (left_early, (Y, U, 4), ("u",), ("y",)),
    (left_early, (Y, 0.1 * U, 2), ("u",), ("y",)),
    (branches, (Y, U, 4, 0.3), ("u", "c"), ("y",)),
    (branches, (Y, U, 0, -0.3), ("u", "c"), ("y",)),
    (nested_loops, (Y, U, M, 2), ("u", "m"), ("y",)),
    (scaled_products, (U, 0.3), ("u", "c"), RETURN),
    (several, (U, 0.3), ("u", "c"), RETURN),
    (iterated, (U + 1.0, 2), ("x",), RETURN),
    (iterated, (U + 1.0, 9), ("x",), RETURN),
    *[(searched, (U, c), ("u", "c"), RETURN) for c in (0.3, 1.5, 9.0, -0.4)],
    (part_of_written, (U,), ("u",), RETURN),
    (part_of_written, (U,), ("u",), ("u", "return")),
    (written_and_new, (U, V), ("u", "w"), ("u", "w", "return")),
    (written_and_new, (U, V), ("u", "w"), RETURN),
    (tuples, (U, 0.3), ("u", "c"), RETURN),
    (tuples, (U, -0.3), ("u", "c"), RETURN),
    (constant, (U, 0.3), ("c",), RETURN),
    (dot, (U, V), ("u", "v"), RETURN),
    (closures, (U, 0.3), ("u", "a"), RETURN),
    (time_stepper, (U, 0.3, 0.1, 2), ("u", "p", "dt"), RETURN),
]
COMPILED = {swaps, branches, several, searched, closures}


@pytest.mark.parametrize(("function", "arguments", "wrt", "of"), CASES)
def test_derivatives(function, arguments, wrt, of):
    check_derivatives(function, arguments, wrt, of)


@pytest.mark.parametrize(("function", "arguments", "wrt", "of"),
                         [case for k, case in enumerate(CASES) if case[0] in COMPILED
                          and case[0] not in [c[0] for c in CASES[:k]]])
def test_compiled_derivatives(function, arguments, wrt, of):
    check_derivatives(function, arguments, wrt, of, engine="numba")


def test_comments_and_places_are_of_the_helper_s_source():
    text = s2sad.differentiate(helpers, engine="numpy").adjoint_source(Y, U, V, np.ones(2))
    assert "# out[i] = (u[i - 1] - 2.0 * u[i] + u[i + 1]) / dx ** 2" in text
    assert "# return FACTOR * factor * u" in text       # of another file


# -- refusals ---------------------------------------------------------------------------------------------------------

def double_buffer_of_an_argument(y, u, n):
    new = np.zeros_like(u)
    for _ in range(n):
        for i in range(1, u.size - 1):
            new[i] = u[i] * u[i - 1] + u[i + 1]
        u, new = new, u
    y[:] = u


def written_in_the_first_turn(y, u, n):
    v = u
    for _ in range(n):
        v[0] = 0.0
        v = v * 2.0
    y[:] = v


def start_is_written(y, u, n):
    v = u
    for s in range(n):
        u[0] = u[0] * 0.5
        y[s] = v[0]
        v = v * 2.0


def one_array_twice(y, u, n):
    a = u.copy()
    b = u * 2.0
    for _ in range(n):
        a[0] += b[0]
        c = a * b
        a = c
        b = c
    y[:] = a + b


def row_of_the_matrix(y, m, n):
    r = m[0]
    for i in range(n):
        r[0] = 2.0 * r[1]
        y += r
        r = m[i]


def old_after_the_loop(y, u, n):
    for _ in range(n):
        old = u
        u = u * 2.0
    y[:] = old


TOLD = "an array is written that another name may stand for here, as it did before a loop or branch bound it anew"
SIZE = "'u' may change its size from one iteration to the next"


def grown(y, u, n):
    for k in range(n):
        u = np.ones(k + 2) * u[0]
    y[0] = u[0]


def shrunk(y, u, n):
    for _ in range(n):
        u = u[1:] - u[:-1]
    y[0] = u[0]


def found_in_a_loop(u, n):
    for k in range(n):
        if u[k] > 0.5:
            return np.ones(k + 2) * u[k]
    return u


@pytest.mark.parametrize(("function", "line", "said"), [
    (written_in_the_first_turn, 3, TOLD), (start_is_written, 3, TOLD),
    (one_array_twice, 4, TOLD), (row_of_the_matrix, 3, TOLD), (grown, 2, SIZE), (shrunk, 2, SIZE),
    (old_after_the_loop, 4, "'old' may stand for different arrays here"),
])
def test_refused(function, line, said):
    given = M.copy() if function is row_of_the_matrix else U.copy()
    with pytest.raises(s2sad.S2sadError) as caught:
        vjp(s2sad.differentiate(function, engine="numpy"), (Y.copy(), given, 3), {"y": Y})
    diagnostic = caught.value.diagnostics[0]
    assert (diagnostic.code, diagnostic.message) == ("S201", said)
    assert diagnostic.span is not None and diagnostic.span.line == function.__code__.co_firstlineno + line


def test_a_size_that_a_loop_makes_cannot_be_returned_from_inside_it():
    with pytest.raises(s2sad.S2sadError, match="an array of a size that a loop makes is returned from inside it"):
        jvp(s2sad.differentiate(found_in_a_loop, engine="numpy"), (U, 3), {"u": U})


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
    assert "v before `v = v + 0.01 * rhs(v, p)`" in said


def test_command(tmp_path):
    path = tmp_path / "fresh.py"
    path.write_text("import numpy as np\n\n\ndef fresh(u, c):\n    return c * u[1:] * u[:-1]\n")
    run = subprocess.run([sys.executable, "-m", "s2sad", "adjoint", f"{path}:fresh", "--engine", "numpy", "--types",
                          "u: float64[:], c: float64"], capture_output=True, text=True, check=True)
    assert "def fresh_adjoint(u, u_bar, c, result_bar):" in run.stdout


@pytest.mark.parametrize("engine", ("numpy", "loops"))
def test_an_argument_may_take_turns_with_another_array(engine):
    check_derivatives(double_buffer_of_an_argument, (Y.copy(), U.copy(), 3), ("u",), ("y", "u"), engine)


def turn(axis, a):
    c, s = np.cos(a), np.sin(a)
    if axis == "x":
        return np.array([[1.0, 0, 0], [0, c, -s], [0, s, c]])
    if axis == "z":
        return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]])
    raise ValueError("no such axis")


def turned(a, n):
    m = np.eye(3)
    for k in range(n):
        m = turn("x", a * k) @ m
        m = turn("z", a) @ m
    return np.sum(m[0] * np.array([1.0, 2.0, 3.0]))


@pytest.mark.parametrize("engine", ["numpy", "loops"])
def test_a_branch_is_decided_by_what_is_given(engine):
    check_derivatives(turned, (0.7, 3), ("a",), ("return",), engine)
