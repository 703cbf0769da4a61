"""Values whose operands stay as they are: computed again, not recorded."""
import math

import numpy as np


def kernel(y, x, scale):
    n = x.size
    factor = math.exp(scale) / n
    for i in range(n):
        last = n - 1 - i
        bent = math.sin(x[last]) * factor
        y[i] = bent * bent


ARGUMENTS = (np.zeros(3), np.array([0.7, -1.3, 0.4]), 0.3)
WRT, OF = ("x", "scale"), ("y",)
