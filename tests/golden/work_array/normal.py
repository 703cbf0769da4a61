"""Normal form."""

import numpy as np


def kernel(y, x):
    work = np.empty(2)
    for i in range(x.size):
        work[...] = 0.0
        work[0] = x[i] * x[i]
        work_here = work[0]
        work[1] = work_here * x[i]
        work_here_2 = work[0]
        work_here_3 = work[1]
        y[i] = work_here_2 + work_here_3
