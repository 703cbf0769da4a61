"""Normal form."""

import math


def kernel(y, x):
    assert x.size > 0, "no data"
    spread = 0.0
    spread_1 = spread
    for i in range(x.size):
        exp_value = math.exp(x[i])
        spread_1 += exp_value
        y[i] = 2.0 * x[i]
    print("spread", spread_1)
