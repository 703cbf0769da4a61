"""gmm: the log posterior of a mixture of Gaussians, and its gradient.

The eval's input has `mu`, `q` and `l`. Earlier ones have `means` and `icf`, the rows of `q` and `l` side by side, ask
for one list, and take the prior's logarithm with the other sign, as ADBench does.
"""
import numpy as np

from benchmarks.gradbench.function import Function, array, number, primal, reverse
from benchmarks.gradbench.kernels import gmm

NAMES = ("alpha", "mu", "q", "l")


def arguments(given):
    """Parameters, points, the prior's gamma and m, and the sign of the prior's logarithm."""
    d, k, n = given["d"], given["k"], given["n"]
    if "icf" in given:
        icf = array(given["icf"], k, d * (d + 1) // 2)
        mu, q, l = given["means"], icf[:, :d].copy(), icf[:, d:].copy()  # noqa: E741
    else:
        mu, q = given["mu"], array(given["q"], k, d)
        l = np.array([by_columns(row) for row in given["l"]], dtype=np.float64).reshape(k, d * (d - 1) // 2)  # noqa: E741
    sign = -1.0 if "icf" in given else 1.0
    return (array(given["alpha"], k), array(mu, k, d), q, l, array(given["x"], n, d), float(given["gamma"]),
            int(given["m"]), sign)


def by_columns(row):
    """What lies below the diagonal as one list, column by column, also if it is given as rows of growing length.

    >>> by_columns([[], [1.0], [2.0, 3.0]]), by_columns([1.0, 2.0, 3.0])
    ([1.0, 2.0, 3.0], [1.0, 2.0, 3.0])
    """
    if not row or not isinstance(row[0], list):
        return row
    return [row[i][j] for j in range(len(row)) for i in range(j + 1, len(row))]


def rows_of(values, like):
    """A list of `by_columns` in the form in which it was given."""
    if not like or not isinstance(like[0], list):
        return values
    entries = iter(values)
    rows = [[0.0] * len(row) for row in like]
    for j in range(len(rows)):
        for i in range(j + 1, len(rows)):
            rows[i][j] = next(entries)
    return rows


def gradient(result, given):
    """The gradients by name; for an earlier input all in one list."""
    alpha, mu, q, l = result  # noqa: E741
    if "icf" in given:
        return np.concatenate([alpha, mu.ravel(), np.hstack([q, l]).ravel()]).tolist()
    below = [rows_of(values, like) for values, like in zip(l.tolist(), given["l"])]
    return {"alpha": alpha.tolist(), "mu": mu.tolist(), "q": q.tolist(), "l": below}


FUNCTIONS = {"objective": Function(arguments, primal(gmm.objective), number),
             "jacobian": Function(arguments, reverse(gmm.objective, *NAMES), gradient)}
