"""lse: the logarithm of a sum of exponentials, and its gradient."""
from benchmarks.gradbench.function import Function, array, number, primal, reverse
from benchmarks.gradbench.kernels import lse


def arguments(given):
    """The vector."""
    return (array(given["x"], -1),)


FUNCTIONS = {"primal": Function(arguments, primal(lse.primal), number),
             "gradient": Function(arguments, reverse(lse.primal, "x"), lambda found, given: found[0].tolist())}
