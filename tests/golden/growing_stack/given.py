"""A while loop whose number of trips only the data know: the stack grows, and the trips are counted."""
import numpy as np


def kernel(x, tolerance):
    guess = 1.0
    while abs(guess * guess - x[0]) > tolerance:
        guess = 0.5 * (guess + x[0] / guess)
    x[0] = guess * x[1]


ARGUMENTS = (np.array([7.0, 0.3]), 1e-3)
WRT, OF = ("x",), ("x",)
