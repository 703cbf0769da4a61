"""What docs/functions.md names, as expressions: of x, y (four numbers), m (4 by 4, positive definite), s (three such),
p (a permutation), k (an integer) and g (a list of edges); statements before the last `;` are written before it."""
from __future__ import annotations

import numpy as np

from tests.docs.functions import arrays, linear_algebra, reductions

PAGE = {**arrays.ROWS, **reductions.ROWS, **linear_algebra.ROWS}
FLOATS = ("x", "y", "m", "s")


def arguments():
    """Values of x, y, m, s, p, k and g."""
    x, y = np.array([0.31, 0.83, 0.47, 0.62]), np.array([0.71, 0.22, 0.93, 0.54])
    m = 2.0 * np.eye(4) + np.outer(x, x) + np.diag(y)
    m += 0.1 * np.array([[0, 1, 2, 4], [1, 0, 5, 3], [2, 5, 0, 7], [4, 3, 7, 0]])
    return x, y, m, np.stack((m, m @ m, m + np.eye(4))), np.array([2, 0, 3, 1]), 5, np.array([0.0, 0.4, 0.8, 1.2])


def expressions() -> list[str]:
    return [line.strip() for row in PAGE.values() for line in row.strip().splitlines()]


def function(name: str, expression: str) -> str:
    """The text of a kernel that sums the squares of what the expression gives; what is first is called z."""
    *before, last = expression.split("; ")
    lines = [f"z = {before[0]}", *before[1:]] if before else []
    return "\n    ".join([f"def {name}(x, y, m, s, p, k, g):", *lines, f"result = {last}",
                          "return np.sum(result * result)"]) + "\n"
