"""det: a determinant by expansion by minors, and its gradient."""
import numpy as np

from benchmarks.gradbench.function import Function, array, number, primal, reverse
from benchmarks.gradbench.kernels import det


def argument(given):
    """The matrix; one of fewer than four rows in the corner of the identity, which has the same determinant."""
    ell = given["ell"]
    a = np.eye(max(ell, 4))
    a[:ell, :ell] = array(given["A"], ell, ell)
    return (a,)


def rows(result, given):
    """The gradient as one list, row by row."""
    return result[0][:given["ell"], :given["ell"]].ravel().tolist()


FUNCTIONS = {"primal": Function(argument, primal(det.primal), number),
             "gradient": Function(argument, reverse(det.primal, "a"), rows)}
