"""hello: a square, and its derivative."""
import s2sad
from benchmarks.gradbench.function import Function, differentiated, number
from benchmarks.gradbench.kernels.hello import square


def argument(given):
    """The number."""
    return (float(given),)


FUNCTIONS = {"square": Function(argument, square, number),
             "double": Function(argument, s2sad.gradient(differentiated(square)), number)}
