"""The logarithm of a sum of exponentials."""
import numpy as np


def primal(x):
    """log(sum(exp(x))), without overflow."""
    largest = np.max(x)
    return largest + np.log(np.sum(np.exp(x - largest)))
