"""A row as a view, read and written: it is its base, and its shadow the base's."""
import numpy as np


def kernel(x):
    for i in range(1, x.shape[0]):
        above, row = x[i - 1], x[i]
        for j in range(row.size):
            row[j] = row[j] * above[j]


ARGUMENTS = (np.array([[0.7, -1.3], [0.4, 1.1], [1.2, 0.3]]),)
WRT, OF = ("x",), ("x",)
