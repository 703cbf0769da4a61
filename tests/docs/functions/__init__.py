"""What docs/functions.md names, as expressions: of x, y (four numbers), m (4 by 4, positive definite), s (three such),
p (a permutation), k (an integer) and g (a list of edges); statements before the last `;` are written before it."""
from __future__ import annotations

from tests.docs.functions import arrays, linear_algebra, reductions

PAGE = {**arrays.ROWS, **reductions.ROWS, **linear_algebra.ROWS}


def expressions() -> list[str]:
    return [line.strip() for row in PAGE.values() for line in row.strip().splitlines()]


def function(name: str, expression: str) -> str:
    """The text of a kernel that sums the squares of what the expression gives; what is first is called z."""
    *before, last = expression.split("; ")
    lines = [f"z = {before[0]}", *before[1:]] if before else []
    return "\n    ".join([f"def {name}(x, y, m, s, p, k, g):", *lines, f"result = {last}",
                          "return np.sum(result * result)"]) + "\n"
