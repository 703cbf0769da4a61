"""Views that functions make, written and read beside what they are views of; every kernel against differences."""
from __future__ import annotations

import numpy as np
import pytest

import s2sad
from s2sad.emit import text
from s2sad import pipeline, read
from s2sad.infer.types import of_value
from tests.harness.derivatives import check_derivatives
from tests.harness.engines import running
from tests.harness.seeds import generator


def written_in_turn(u):
    f = u.reshape(-1)
    for _ in range(3):
        u[0] = u[0] * f[1:5]
        f[2:] = f[2:] * u[1, 0] + f[:-2] ** 2
        u *= 0.9
    return f[3] * u[0, 1]


def two_views(u):
    f, t = u.ravel(), u.T
    f[1:] += f[:-1] ** 2
    t[0] *= t[1]
    f[0] = t[2, 1] * u[1, 1]
    u[0, 0] *= 3.0
    return f[0] * t[0, 0]


def view_of_view(u):
    f = u.reshape(-1)
    g = f.reshape(2, -1)
    g[0] += g[1] ** 2
    f[0] *= f[1]
    g[1, 0] = g[0, 0] * u[0, 1]
    u[1, 1] *= g[0, 1]
    return np.sum(g * g)


def bound_anew(u):
    s = 0.0
    for i in range(u.shape[0]):
        r = u[i].reshape(2, -1)
        r[0] += r[1] ** 2
        r = u[:, i].reshape(-1, 2)
        r[:, 1] *= r[:, 0]
        s += r[0, 0]
    r = u.T
    r[0] *= s


def left_early(u, k):
    f = u.ravel()
    f[1] *= f[0]
    if k > 2:
        return u[0, 1] ** 2
    f[2] = u[0, 1] * f[1]
    for i in range(f.size):
        f[i] *= 1.5
        if f[i] > 1.2:
            return np.sum(u)
        f[i] += 0.1
    return np.sum(u * u)


def branches(u, c):
    t = u.T
    if c > 0:
        t[0] = t[1] ** 2
    else:
        u[1] = u[0] * u[2]
    if t[0, 1] > 0.0:
        u[0] *= t[0]
        if c > 1:
            t[:, 1] += u[1] ** 2
    return np.sum(u ** 2) + t[1, 0]


def step(p, q):
    for i in range(p.shape[0]):
        for j in range(p.shape[1]):
            p[i, j] = p[i, j] * q[j] + q[i] ** 2


def helper_view(y, q):
    step(y.reshape(4, -1), q)
    r = y.reshape(2, -1)
    step(r.T[:4], q)
    y[0] *= r[1, 1]
    step(r[:, :4], q[::-1])


def total(a):
    return np.sum(a ** 2)


def helper_base(u, q):
    f = u.ravel()
    step(u, q)
    f[1:] *= f[:-1]
    step(u, f[:4] * 1.0)
    return total(u) * total(f.reshape(2, -1))


def flat(z):
    return z.ravel()


def returned_view(u):
    f = flat(u)
    f[1:3] *= f[:2]
    w = u.copy()
    g = flat(w)
    g[0] = u[0, 1] ** 2
    return np.sum(w ** 2)


def input_only(u, v):
    w = u * 2.0
    f = w.ravel()
    f += v.ravel() * f[::-1]
    turned = v.T
    x = turned.copy()
    x *= 2.0
    return np.sum(w * x)


def of_a_local(x, n):
    w = np.zeros((n, n))
    f = w.reshape(-1)
    for k in range(n):
        f[k::4] = x[k] ** 2
        w[k] += f[:n]
    t = w.T
    s = 0.0
    while s < 3.0:
        t[0] += 0.5 * w[:, 1]
        s += 1.0
        if w[0, 0] > 1e3:
            break
        w[1] *= 1.1
    return np.sum(w * w)


def element_mix(u):
    f = u.ravel()
    t = u.transpose(1, 0)
    for k in range(f.size - 1):
        f[k] += f[k + 1] * u[0, 0]
    for i in range(t.shape[0]):
        for j in range(t.shape[1]):
            t[i, j] *= u[i, j]
    f[-1] = u[-1, -2] ** 2


def sections(x):
    a, b = np.split(x, 2)
    a *= 2.0
    b += a ** 2
    c, d, e = np.split(x, [2, 3])
    c[0] = d[0] * e[0]
    x[1] *= b[0]
    return a[1] * np.sum(e)


def squeezed(u):
    s = np.expand_dims(u, 0)
    q = np.squeeze(s, axis=0)
    q[0] *= q[1]
    m = np.moveaxis(u, 0, 1)
    m[1, 0] = u[0, 1] * q[1, 1]
    z = np.atleast_2d(u[0])
    z[0, 1:] += z[0, :-1] ** 2
    w = np.swapaxes(s, 0, 2)
    w[0] *= w[1]
    return np.sum(q * u)


def alias(u):
    a = np.asarray(u)
    b = np.asarray(a, dtype=float)
    c = np.ascontiguousarray(b)
    c[0] = a[1] ** 2
    u[1] *= b[0]
    return np.sum(c * b)


def three_fields(dy, y, n):
    N = n * n
    u, v, w = y[:N].reshape(n, n), y[N:2 * N].reshape(n, n), y[2 * N:].reshape(n, n)
    du, dv, dw = dy[:N].reshape(n, n), dy[N:2 * N].reshape(n, n), dy[2 * N:].reshape(n, n)
    for i in range(1, n - 1):
        for j in range(1, n - 1):
            du[i, j] = u[i, j + 1] * v[i, j]
            dv[i, j] = v[i, j - 1] - w[i, j] ** 2
            dw[i, j] += u[i + 1, j] * du[i, j]
    du[0] = du[-1] = 0.0
    dv[:, 0] = u[:, 1] ** 2


def interleaved(dy, y):
    u, v = y[::2].reshape(2, -1), y[1::2].reshape(2, -1)
    du, dv = dy[::2].reshape(2, -1), dy[1::2].reshape(2, -1)
    for i in range(2):
        for j in range(u.shape[1]):
            du[i, j] = u[i, j] * v[i, j]
            dv[i, j] = u[i, j] ** 2


def rhs(dy, y, n):
    u, v = y[:n * n].reshape(n, n), y[n * n:].reshape(n, n)
    du, dv = dy[:n * n].reshape(n, n), dy[n * n:].reshape(n, n)
    du[1:-1, 1:-1] = u[2:, 1:-1] * v[1:-1, 1:-1]
    dv[:] = u * u - v


def integrate(y, n, steps):
    dy = np.zeros_like(y)
    for _ in range(steps):
        rhs(dy, y, n)
        y += 0.1 * dy
    return np.sum(y ** 2)


def bound_by_itself(u):
    s = np.sum(u)
    u = u.ravel()
    u[1:] *= u[:-1]
    u = u.reshape(2, -1)
    u[0] += s * u[1]
    return np.sum(u)


def three_axes(u):
    t = u.transpose(2, 0, 1)
    t[0] += t[1] ** 2
    f = u.ravel()
    for k in range(f.size):
        f[k] *= u[0, 0, 0]
    t[1, 0] = u[0, :, 1] * t[2, 1]


def ravelled(p):
    f = p.ravel()
    f[0] *= f[1]


def pass_row(u):
    ravelled(u[1])
    ravelled(u)
    return np.sum(u ** 2)


def one_in_each_branch(u, c):
    if c > 0:
        r = u.T
        r[0] *= r[1]
    else:
        r = u.ravel()
        r[1:] *= r[:-1]
    return np.sum(u ** 2 * np.arange(4.0))


def size_changes(y, n):
    f = y[:n].reshape(1, -1)
    n += 1
    f[0, 0] = y[n] ** 2
    y[1] *= f[0, 0]
    n = 2
    f[0] *= y[2]
    return np.sum(y ** 2)


def index_array(y, idx):
    k = idx[0]
    f = y[k:].reshape(2, -1)
    idx[0] = 0
    f[0] *= f[1]
    y[1] *= 2.0
    return np.sum(f)


def negative_bound(y, k):
    a = y[:k].reshape(-1, 1)
    b = y[k:].reshape(-1, 1)
    a *= b[0, 0]
    b += a[0]
    return np.sum(y ** 2)


def parts_that_overlap(y, k):
    a = y[:4].reshape(2, 2)
    b = y[2:].reshape(2, 2)
    a *= b
    b += a.T
    a[0] = b[1]
    return np.sum(y ** 2)


def self_overlap(u):
    t = u.T
    u += t
    t += u
    u[:] = t
    t -= 0.5 * u


def while_test(u):
    f = u.ravel()
    k = 0
    while f[k] < 2.0:
        u *= 1.2
        f[3] += 0.1 * u[1, 1]
        if u[0, 3] > 1.9:
            k = 3
    return f[2]


def in_loops(u, n):
    f = u.ravel()
    for _ in range(n):
        for i in range(1, f.size):
            f[i] += 0.1 * f[i - 1]
        for i in range(u.shape[0]):
            if i == 2:
                break
            u[i] *= f[0]
            if f[1] > 1.5:
                f[2] *= u[1, 1]
                continue
            f[3:5] += 1.0
        if u[0, 1] > 50.0:
            break
    return np.sum(f * f)


def by_masks(u):
    f = u.reshape(-1)
    f[f > 0.7] = 0.5 * f[0]
    u[u < 0.5] *= f[1]
    f[np.array([1, 3])] += u[1, 1]
    return np.sum(u * u)


def in_a_tuple(u):
    pair = (u.ravel(), u)
    f, w = pair
    f[1] = w[0, 0] ** 2
    return np.sum(w)


def parts_of_a_cube(x, n):
    c = x.reshape(n, n, n)
    for k in range(n):
        p = c[k].reshape(-1)
        p[1:] += p[:-1] * x[0]
        q = c[:, k].T
        q[0] *= 2.0
    return np.sum(x ** 2)


def of_any_size(u):
    f = u.ravel()
    f *= 2.0
    u += f.reshape(u.shape) ** 2
    t = u.T
    t *= u[:1, :1].sum()
    return np.sum(f)


def kept_part(u, k):
    w = u * 1.5
    for s in range(k):
        r = w[s].reshape(2, 2)
        c = r.T
        c[0] += r[1] ** 2
        for i in range(2):
            r[i, i] *= c[0, 1]
        w[s - 1] *= 1.1
    return np.sum(w ** 2)


def branches_in_a_loop(u, c):
    f = u.ravel()
    for i in range(3):
        if u[0, i] > 0.5:
            f[i] *= 2.0
            if c > 0:
                u[1, i] *= f[i]
        elif c > 5:
            break
        else:
            u[2] *= 1.1
    return f[1] * f[5]


def two_of_three_axes(q, n):
    u = q.reshape(2, n, n)
    rho, e = u[0], u[1]
    for i in range(1, n):
        for j in range(n):
            rho[i, j] += e[i - 1, j] * rho[i - 1, j]
    q *= 2.0
    e[0] = rho[1] ** 2
    return np.sum(q * q)


def views_of_parts(u):
    top, bottom = u[:2], u[2:]
    f = top.ravel()
    g = bottom.ravel()
    for i in range(f.size):
        f[i] *= g[i]
        g[i] += f[i] ** 2
    top[0] = bottom[1]
    return np.sum(u * f[1])


def lines_of_a_transpose(u):
    t = u.T
    t[0] += t[1, ::-1] ** 2 * u[0, 0]
    for i in range(1, t.shape[0]):
        t[i] *= t[i - 1]
        t[i, 1:] -= u[i, :-1]
        for j in range(3):
            t[-1, j] += t[i, j + 1] * u[1, 2]
    u[:, 1] = t[0]
    t[:, 2] = u[2]


def given(*shape):
    return generator(3).uniform(0.3, 1.1, shape)


SQUARE = (
    written_in_turn, two_views, view_of_view, bound_anew, returned_view, element_mix, squeezed, alias, bound_by_itself,
    pass_row, self_overlap, while_test, by_masks, in_a_tuple, of_any_size, views_of_parts,
    lines_of_a_transpose)
CASES = {
    left_early: (given(4, 4), 1), branches: (given(4, 4), 2), helper_view: (given(16), given(4)),
    helper_base: (given(4, 4), given(4)), input_only: (given(4, 4), 1.3 * given(4, 4)), of_a_local: (given(4), 4),
    sections: (given(8),), three_fields: (given(27), 0.9 * given(27), 3), interleaved: (given(12), 0.9 * given(12)),
    integrate: (given(18), 3, 2), three_axes: (given(3, 2, 4),), one_in_each_branch: (given(4, 4), 1),
    size_changes: (given(8), 4), index_array: (given(9), np.array([1])), negative_bound: (given(4), -2),
    parts_that_overlap: (given(6), 1), in_loops: (given(4, 4), 2), parts_of_a_cube: (given(8), 2),
    kept_part: (given(4, 4), 2), branches_in_a_loop: (given(3, 4), 1), two_of_three_axes: (given(18), 3),
    **{kernel: (given(4, 4),) for kernel in SQUARE}}


def selected(kernel, arguments):
    """Every float array, and what the kernel writes or returns."""
    names = kernel.__code__.co_varnames[:kernel.__code__.co_argcount]
    after = [np.copy(a) if isinstance(a, np.ndarray) else a for a in arguments]
    returned = kernel(*after)
    floats = [n for n, a in zip(names, arguments) if isinstance(a, np.ndarray) and a.dtype.kind == "f"]
    written = [n for n, a, b in zip(names, arguments, after) if n in floats and not np.array_equal(a, b)]
    return tuple(floats), (*written, *(() if returned is None else ("return",)))


@pytest.mark.parametrize("engine", ("numpy", "loops"))
@pytest.mark.parametrize("kernel", CASES, ids=lambda kernel: kernel.__name__)
def test_views_and_operands_are_kept_in_step(kernel, engine):
    check_derivatives(kernel, CASES[kernel], *selected(kernel, CASES[kernel]), engine=engine)


@pytest.mark.parametrize("kernel", (integrate, in_loops, element_mix), ids=lambda kernel: kernel.__name__)
def test_they_are_when_compiled(kernel):
    check_derivatives(kernel, CASES[kernel], *selected(kernel, CASES[kernel]), engine="numba")


@pytest.mark.parametrize("shape", ((1, 1), (1, 3), (3, 1)))
def test_sizes_of_1(shape):
    check_derivatives(of_any_size, (given(*shape),), ("u",), ("u", "return"), engine="numpy")


def whole(u):
    f = u.ravel()
    f *= 2.0
    u *= f.size
    f += 1.0


@pytest.mark.parametrize("engine", ("numpy", "loops"))
def test_no_elements(engine):
    with running(engine) as name:
        found = s2sad.vjp(s2sad.differentiate(whole, engine=name), (np.zeros((0, 3)),), {"u": np.zeros((0, 3))})
    assert found["u"].shape == (0, 3)


# -- what NumPy copies -----------------------------------------------------------------------------------------------
def turned_then_ravelled(x):
    f = np.flip(x)
    g = np.ravel(f)
    g[0] = x[1] ** 2
    f[1] = g[0] * x[0]
    return g[0] + x[2]


def every_other_column(u):
    f = u[:, ::2].reshape(-1)
    f[0] = f[1] ** 2
    return np.sum(u)


def made_of_a_transpose(u):
    w = u.T * 2.0
    f = w.reshape(-1)
    f[1] = f[0] ** 2
    return np.sum(w ** 2)


def of_an_earlier_iteration(u):
    row = u[0]
    for i in range(u.shape[0]):
        r = u[i].reshape(2, 2)
        if i > 0:
            row[0] = r[1, 1] ** 2
        row = r[0]
        r[1] *= row
    return np.sum(u ** 2)


def in_either_branch(u):
    if u[0, 0] > 0.0:
        r = u.T
    else:
        r = u
    r[0] *= r[1]


def given_twice(u, q):
    f = u.ravel()
    step(u, f[:4])


def rebinding_other(u):
    f = u.ravel()
    f[0] *= 2.0
    u = u * 3.0
    f[1] *= u[0, 0]
    g = u.ravel()
    g[0] = f[1]
    return np.sum(u) * np.sum(f)


def bound_to_its_own_memory(u):
    f = u.ravel()
    if u[0, 0] > 0.0:
        f = f * 2.0
    f[0] = 7.0 * u[0, 1]
    return np.sum(u ** 2)


def its_own_after_a_round(u):
    x = u.reshape(-1)
    for _ in range(2):
        x = x + 0.1 * x ** 2
        x[0] = 0.5
    return np.sum(x ** 2)


def a_copy_in_a_branch(u):
    t = u.T
    if u[0, 0] > 0.0:
        t = t.copy()
    t[1] *= 2.0
    return np.sum(u * t)


def under_the_parameters_name(u):
    s = u[0, 0]
    u = u.ravel()
    for _ in range(2):
        u = u + 0.1 * u ** 2
        u[0] = 0.5
    return np.sum(u ** 2) + s


def scaled(u):
    s = 0.0
    for i in range(u.shape[0]):
        s += u[i, 0]
    return u * s


def result_of_a_function(u):
    a = scaled(u.T)
    f = a.ravel()
    f[1] = 0.0
    return np.sum(a ** 2 * scaled(u))


def zeroed(u):
    r = np.zeros_like(u)
    f = r.ravel()
    for i in range(u.size):
        f[i] = u[i // 4, i % 4] ** 2
    return r


def reshaped_in_a_function(u):
    return np.sum(zeroed(u.T) * zeroed(u + 1.0))


def swapped_in_a_branch(u):
    a = u * 1.0
    b = u.T * 2.0
    if u[0, 0] > 0.0:
        a, b = b, a
    f = a.ravel()
    f[1] = 0.0
    return np.sum(a ** 2 * b)


def picked_from_a_list(u):
    m = [u.T * (i + 1.0) for i in range(2)]
    for k in range(2):
        f = m[k % 2].ravel()
        f[1] = 0.0
    return np.sum(m[0] ** 2 * m[1])


def put_into_a_list(u):
    m = []
    for i in range(2):
        m.append(u.T * (i + 1.0))
    f = m[1].ravel()
    f[1] = 0.0
    return np.sum(m[0] ** 2 * m[1])


@pytest.mark.parametrize("kernel", (
    rebinding_other, bound_to_its_own_memory, its_own_after_a_round, a_copy_in_a_branch, under_the_parameters_name,
    result_of_a_function, reshaped_in_a_function, swapped_in_a_branch, picked_from_a_list, put_into_a_list),
    ids=lambda kernel: kernel.__name__)
def test_names_that_may_stand_for_other_memory_are_refused(kernel):
    """Or the memory that they stand for may lie otherwise: NumPy would write a copy."""
    with pytest.raises(s2sad.S2sadError) as caught:
        s2sad.differentiate(kernel, engine="numpy").adjoint_source(given(4, 4))
    assert caught.value.diagnostics[0].code == "S201"


def for_each_element(x):
    f = np.flip(x)
    for i in range(1, 4):
        f[i] += 2.0 * f[i - 1] * x[0]


@pytest.mark.parametrize("kernel", (turned_then_ravelled, every_other_column, made_of_a_transpose,
                                    of_an_earlier_iteration, in_either_branch, given_twice, for_each_element),
                         ids=lambda kernel: kernel.__name__)
def test_what_may_be_a_copy_or_would_cost_too_much_is_refused(kernel):
    arguments = (given(8),) if kernel.__code__.co_varnames[0] == "x" else (given(4, 4), given(4))
    with pytest.raises(s2sad.S2sadError, match="an array is written that NumPy shares with another one"):
        s2sad.differentiate(kernel, engine="numpy").adjoint_source(*arguments[:kernel.__code__.co_argcount])


def given_a_column(u):
    ravelled(u[:, 1])


def given_what_is_made(u):
    w = u.T * 2.0
    ravelled(w)
    return np.sum(w)


@pytest.mark.parametrize("kernel", (given_a_column, given_what_is_made), ids=lambda kernel: kernel.__name__)
def test_a_helper_that_reshapes_is_given_what_is_contiguous(kernel):
    with pytest.raises(s2sad.S2sadError, match="an array that the function reshapes and writes may not be contiguous"):
        s2sad.differentiate(kernel, engine="numpy").adjoint_source(given(4, 4))


def through_a_helper(u):
    ravelled(u)


@pytest.mark.parametrize("engine", ("numpy", "numba"))
@pytest.mark.parametrize("array", (given(4, 8)[:, ::2], np.asfortranarray(given(4, 4))), ids=("columns", "Fortran"))
def test_arguments_that_are_not_contiguous_are_refused(array, engine):
    function = s2sad.differentiate(through_a_helper, engine=engine)
    said = "'u' is not contiguous, where it or an array made like it is reshaped and written"
    with pytest.raises(s2sad.S2sadError, match=said):
        s2sad.vjp(function, (array,), {"u": np.ones((4, 4))})
    with pytest.raises(s2sad.S2sadError, match=said):
        s2sad.autodiff(s2sad.Reverse, function, s2sad.Duplicated(array, np.ones((4, 4))))
    if engine == "numpy":
        with pytest.raises(s2sad.S2sadError, match="an array that is reshaped and written is not contiguous"):
            function.adjoint(array, np.ones((4, 4)))
    assert np.all(array < 1.2)


def test_a_bound_that_counts_from_the_end_is_refused_where_parts_are_to_lie_side_by_side():
    def beside(y, n):
        a, b = y[:n].reshape(2, -1), y[2 * n:].reshape(2, -1)
        for i in range(2):
            a[i, 0] *= 2.0
            b[i, 0] *= a[i, 0]
    found = s2sad.vjp(beside, (given(6), 2), {"y": np.ones(6)})
    assert found["y"][0] != 1.0
    with pytest.raises(s2sad.S2sadError, match="a bound of a slice counts from the end"):
        s2sad.vjp(beside, (given(6), -2), {"y": np.ones(6)})


def test_copies_are_made_where_they_must_be():
    """What the pass writes is Python that computes the same; the usual right-hand side has one copy back."""
    seen = []
    program = read.load(rhs)
    types = tuple(map(of_value, (given(18), given(18), 3)))
    pipeline.entry(program, types, "numpy", lambda stage, tree: seen.append(tree) if stage == "coherence" else None)
    lines = [line.strip() for line in text(seen[0]).splitlines()]
    assert lines[1:] == [
        "u = np.reshape(y[:n * n], (n, n))", "v = np.reshape(y[n * n:], (n, n))",
        "du = np.copy(np.reshape(dy[:n * n], (n, n)))", "dv = np.copy(np.reshape(dy[n * n:], (n, n)))",
        "du[1:-1, 1:-1] = u[2:, 1:-1] * v[1:-1, 1:-1]", "dv[:] = u * u - v", "dy[:n * n] = np.ravel(du)",
        "dy[n * n:] = np.ravel(dv)", "return"]


def part_added_to_by_its_own_elements(u):
    u[0, :2] += 0.5 * u[1, 1] + 0.1 * u[0, 1] ** 2


@pytest.mark.parametrize("engine", ("numpy", "loops"))
def test_the_seed_of_a_part_is_what_it_was_before_its_elements_gain(engine):
    check_derivatives(part_added_to_by_its_own_elements, (given(4, 4),), ("u",), ("u",), engine=engine)


def columns_and_rows(x):
    c, r = x.reshape(-1, 1), np.reshape(x, (1, -1))
    for k in range(3):
        c[k, 0] *= x[3]
    r[0, 1] += 2.0 * c[2, 0]
    f = x[::-1].reshape(-1)
    f[0] = f[1] ** 2
    d = x[::2].reshape(-1, 1)
    d *= 0.5
    return np.sum(c * r) + np.sum(d)


@pytest.mark.parametrize("engine", ("numpy", "loops"))
def test_an_array_of_one_axis_is_a_column_and_a_row_wherever_it_lies(engine):
    check_derivatives(columns_and_rows, (given(4),), ("x",), ("x", "return"), engine=engine)
