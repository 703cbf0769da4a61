"""llsq: linear least squares, and its gradient."""
from benchmarks.gradbench.function import Function, array, number, primal, reverse
from benchmarks.gradbench.kernels import llsq


def arguments(given):
    """The coefficients and the number of points."""
    return array(given["x"], -1), int(given["n"])


FUNCTIONS = {"primal": Function(arguments, primal(llsq.primal), number),
             "gradient": Function(arguments, reverse(llsq.primal, "x"), lambda found, given: found[0].tolist())}
