"""Questions after the type of an argument: answered before the types of branches are joined."""
from __future__ import annotations

import numpy as np
import pytest

from s2sad import S2sadError, differentiate, gradient
from tests.derivatives import check_derivatives
from tests.engines import each, running

X, M = np.array([0.3, 1.1, 0.7]), np.arange(1.0, 7.0).reshape(2, 3) / 7


def spread(x, p):
    if np.isscalar(p):
        p = np.full(x.size, p)
    return (x * p).sum() * p[0]


def classes(x, p):
    if isinstance(p, float):
        return (x * p).sum()
    if isinstance(p, (np.ndarray, int)):
        return x @ p
    return x[0]


def axes(x, p):
    if np.ndim(p) == 0:
        p = p * np.ones(3)
    elif p.ndim == 2:
        p = p.sum(axis=0)
    if x.ndim > 1:
        x = x[0]
    return x @ p


def mixed(x, p):
    s = 0.0
    for i in range(3):
        if not isinstance(p, np.ndarray) and i != 1:
            s += p * x[i]
        elif isinstance(p, np.ndarray):
            s += p[i] ** 2 * x[i]
    return s


def weighted(x, p):
    if isinstance(p, (int, float)):
        return (x * p).sum()
    return x @ p


def by_a_function(x, p):
    return weighted(x, p) * weighted(x, 2.0 * x)


def several(x, p):
    if np.isscalar(p) and isinstance(p, float):
        return x.sum() * p
    if not (isinstance(p, np.ndarray) and p.ndim == 1 and x.ndim == 1):
        raise ValueError
    if isinstance(p, np.ndarray) and p.ndim == 2 or x.ndim == 2:
        return x[0]
    assert x.ndim == 1 and x.ndim != 2 and p.size == 3
    return x @ p if p.ndim == 1 and p[0] > 0.0 else x[1]


KERNELS = [several, spread, classes, axes, mixed, by_a_function]


def of_nothing(x, p=None):
    if isinstance(p, np.ndarray) and p.ndim == 1:
        return x @ p
    if not isinstance(p, (float, int, np.ndarray)):
        return x @ x
    return x.sum() * p


def nothing_is_a_class(x, p=None):
    w = x * 2.0 if isinstance(p, type(None)) else x * p
    given = isinstance(p, np.ndarray)
    if given:
        w[0] *= 3.0
    return np.sum(w ** 2 if not np.isscalar(p) else w)


class Given:
    def __init__(self, u, m):
        self.u, self.m = u, m


def nothing_in_a_structure(s):
    if isinstance(s.m, np.ndarray):
        return s.u @ s.m
    return s.u @ s.u if isinstance(s.m, type(None)) else s.u.sum() * s.m


def nothing_for_a_function(x, p=None):
    return of_nothing(x) + of_nothing(x, p) * nothing_is_a_class(x ** 2, p)


@pytest.mark.parametrize(("kernel", "engine"), each([of_nothing, nothing_is_a_class, nothing_for_a_function]))
def test_nothing(kernel, engine):
    check_derivatives(kernel, (X,), ("x",), ("return",), engine=engine)
    check_derivatives(kernel, (X, None), ("x",), ("return",), engine=engine)
    for p in (1.3, X[::-1] * 2.0):
        check_derivatives(kernel, (X, p), ("x", "p"), ("return",), engine=engine)


@pytest.mark.parametrize("engine", ["numpy", "loops"])
def test_nothing_in_a_structure(engine):
    with running(engine) as under:
        for m, expected in ((None, 2.0 * X), (0.5, 0.5 * np.ones(3)), (X[::-1] * 1.0, X[::-1])):
            found = gradient(differentiate(nothing_in_a_structure, engine=under))(Given(X.copy(), m))
            np.testing.assert_allclose(found.u, expected, rtol=1e-14)


@pytest.mark.parametrize(("kernel", "engine"), each(KERNELS))
def test_types_asked(kernel, engine):
    for p in (1.3, X[::-1] * 2.0):
        check_derivatives(kernel, (X, p), ("x", "p"), ("return",), engine=engine)


@pytest.mark.parametrize("engine", ["numpy", "loops"])
def test_other_arguments(engine):
    check_derivatives(axes, (X, M), ("x", "p"), ("return",), engine=engine)
    check_derivatives(axes, (M, 0.5), ("x", "p"), ("return",), engine=engine)
    check_derivatives(spread, (X[:1], 0.5), ("x", "p"), ("return",), engine=engine)
    check_derivatives(spread, (X.astype("float32"), X.astype("float32")), ("x", "p"), ("return",), engine=engine)


def whole(x, p):
    return x[0] if isinstance(p, int) else x[1]


def anew(x, p):
    p = p * x
    if isinstance(p, np.ndarray):
        p = p.sum()
    return p * x[0]


@pytest.mark.parametrize("kernel", [whole, anew])
def test_what_is_refused(kernel):
    with pytest.raises(S2sadError) as refused:
        gradient(kernel, wrt="x")(X, 2)
    assert ("error[S201]: the built-in 'isinstance' is not supported in a kernel, but for what an argument is"
            ) in str(refused.value)
    assert "help: write one kernel for each type" in str(refused.value)
