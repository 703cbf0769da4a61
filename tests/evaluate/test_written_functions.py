"""What functions in the place of NumPy's do not know is refused or raised, where NumPy's do it or raise themselves."""
from __future__ import annotations

import numpy as np
import pytest

from s2sad import S2sadError, differentiate, gradient

X, A = np.array([0.7, 0.2, 1.4, 0.35, 0.9]), np.array([[0.3, -0.9, 0.7], [0.5, 0.2, -0.6]])


def compared(x, a):
    return x[0] if np.poly1d([x[0], 1.0]) == np.poly1d([x[1], 1.0]) else x[1]


def series_of_several(x, a):
    return np.sum(np.polynomial.chebyshev.chebval(x[:2], np.outer(np.ones(3), np.arange(2.0))))


def lines_of_three_axes(x, a):
    return np.sum(np.apply_along_axis(np.ptp, 1, np.ones((2, 2, 2)) * x[0]) ** 2)


def too_few_functions(x, a):
    return np.sum(np.piecewise(x, [x < 0.0, x > 0.5, x > 0.7], [lambda v: v ** 2]))


def diagonal_of_another_shape(x, a):
    whole = np.ones((2, 3)) * a
    whole[np.diag_indices_from(whole)] += x[0]
    return np.sum(whole ** 2)


def diagonal_of_more_axes(x, a):
    whole = np.ones((3, 3, 3)) * x[0]
    whole[np.diag_indices_from(whole)] += x[1]
    return np.sum(whole ** 2)


@pytest.mark.parametrize("engine", ["numpy", "numba"])
@pytest.mark.parametrize(("kernel", "said"), [
    (compared, "polynomials that are compared"), (series_of_several, "coefficients with several axes"),
    (lines_of_three_axes, "arrays of more than two axes"),
    (diagonal_of_another_shape, "axes of different lengths"), (diagonal_of_more_axes, "axes than two"),
    (too_few_functions, "as many functions as conditions, or one more")], ids=lambda v: getattr(v, "__name__", ""))
def test_what_they_do_not_know(kernel, said, engine):
    with pytest.raises((S2sadError, NotImplementedError, ValueError), match=said):
        gradient(differentiate(kernel, engine=engine), wrt="x")(X.copy(), A.copy())


def polynomial_of_several(x, a):
    whole = 2.0 * x
    return np.sum(np.polyadd(whole, np.outer(x, x)))


@pytest.mark.parametrize(("kernel", "place"), [
    (too_few_functions, "np.piecewise(x, [x < 0.0, x > 0.5, x > 0.7], [lambda v: v ** 2])"),
    (polynomial_of_several, "np.polyadd(whole, np.outer(x, x))")], ids=lambda v: getattr(v, "__name__", ""))
def test_what_they_do_not_know_is_refused_where_they_are_called(kernel, place):
    with pytest.raises(S2sadError) as refused:
        gradient(kernel, wrt="x")(X.copy(), A.copy())
    [span] = {d.span for d in refused.value.diagnostics}
    assert span.source.path == __file__
    assert span.source.line(span.line)[span.column:span.end_column] == place
