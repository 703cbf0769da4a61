"""particle: the control that makes a particle hit the origin, by descent along a derivative of a path that follows one.

The first letter of a function is the mode of the derivative for the control, the second one that of the field's force.
"""
import numpy as np

import s2sad
from benchmarks.gradbench.descent import lowest
from benchmarks.gradbench.function import Function, differentiated, number
from benchmarks.gradbench.kernels import particle

FORCES = {"f": particle.forward, "r": particle.reverse}
miss = differentiated(particle.miss)
gradient = s2sad.gradient(miss, wrt="w")


def control(outer, force):
    """The function that finds the control, for a mode and a force."""
    def slope(w):
        if outer == "r":
            return np.array([gradient(float(w[0]), force)])
        return np.array([s2sad.jvp(miss, (float(w[0]), force), {"w": 1.0})["return"]])
    return lambda w: lowest(lambda x: miss.primal(float(x[0]), force), slope, np.array([w]))[0]


FUNCTIONS = {outer + inner: Function(lambda given: (float(given["w"]),), control(outer, force), number)
             for outer in FORCES for inner, force in FORCES.items()}
