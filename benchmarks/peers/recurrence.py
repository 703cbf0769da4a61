"""What a row of Gauss-Seidel needs in a tool without loops over elements: x[j] = (x[j - 1] + c[j]) / 9 as a product."""
from __future__ import annotations

import numpy as np


def ninths(n: int) -> tuple[np.ndarray, np.ndarray]:
    """The factors of x[-1] and the matrix by which the row c is multiplied, for n cells.

    >>> first, matrix = ninths(2)
    >>> (first * 81.0).tolist(), (matrix * 81.0).tolist()
    ([9.0, 1.0], [[9.0, 1.0], [0.0, 9.0]])
    """
    powers = 9.0 ** -np.arange(1.0, n + 1.0)
    k = np.arange(n)
    return powers, np.where(k[:, None] <= k, powers[np.maximum(k - k[:, None], 0)], 0.0)
