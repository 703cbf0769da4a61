"""Linear least squares: a polynomial that is fitted to the sign of t."""
import numpy as np


def primal(x, n: int):
    """Half the sum of squares of sign(t) - x[0] - x[1] t - x[2] t^2 - ... at n points t from -1 to 1."""
    total = 0.0
    for i in range(n):
        t = -1.0 + i * 2.0 / (n - 1)
        residual, power = np.sign(t), 1.0
        for j in range(x.size):
            residual -= x[j] * power
            power *= t
        total += residual * residual
    return 0.5 * total
