"""ode: Runge-Kutta's method, and the gradient of the last element of its result."""
from benchmarks.gradbench.function import Function, array, listed, primal, reverse
from benchmarks.gradbench.kernels import ode


def arguments(given):
    """The coefficients and the number of steps."""
    return array(given["x"], -1), int(given["s"])


FUNCTIONS = {"primal": Function(arguments, primal(ode.primal), listed),
             "gradient": Function(arguments, reverse(ode.last, "x"), lambda found, given: found[0].tolist())}
