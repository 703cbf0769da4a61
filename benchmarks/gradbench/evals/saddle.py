"""saddle: the minimum of a maximum, by descent along a derivative of an ascent along another one.

The first letter of a function is the mode of the outer derivative, the second one that of the inner.
"""
import numpy as np

import s2sad
from benchmarks.gradbench.descent import lowest
from benchmarks.gradbench.function import Function, array, differentiated, listed
from benchmarks.gradbench.kernels import saddle

SLOPES = {"f": saddle.forward, "r": saddle.reverse}
highest = differentiated(saddle.highest)
gradient = s2sad.gradient(highest, wrt="p")


def point(outer, slope):
    """The function that finds both points, for an outer mode and an inner slope."""
    def along(p, start):
        if outer == "r":
            return gradient(p, start, slope)
        return np.array([s2sad.jvp(highest, (p, start, slope), {"p": d})["return"] for d in np.eye(2)])

    def found(start):
        p = lowest(lambda p: highest.primal(p, start, slope), lambda p: along(p, start), start)
        out = np.empty(2)

        def downwards(q):
            SLOPES[outer](p, q, out)
            return -out
        return np.concatenate([p, lowest(lambda q: -saddle.value(p, q), downwards, start)])
    return found


FUNCTIONS = {outer + inner: Function(lambda given: (array(given["start"], 2),), point(outer, slope), listed)
             for outer in SLOPES for inner, slope in SLOPES.items()}
