"""Normal form."""

import math


def kernel(y, x, scale):
    n = x.size
    exp_value = math.exp(scale)
    factor = exp_value / n
    for i in range(n):
        last = n - 1 - i
        bent = math.sin(x[last]) * factor
        y[i] = bent * bent
