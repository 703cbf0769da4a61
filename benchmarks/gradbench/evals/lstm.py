"""lstm: ADBench's LSTM, and the gradient for its parameters."""
import numpy as np

from benchmarks.gradbench.function import Function, number, primal, reverse
from benchmarks.gradbench.kernels import lstm

NAMES = ("main_params", "extra_params", "state", "sequence")


def arguments(given):
    """The parameters, the state at the start and the sequence."""
    return tuple(np.array(given[name], dtype=np.float64) for name in NAMES)


def flat(result, given):
    """The gradients row by row, those of the layers first."""
    return np.concatenate([part.ravel() for part in result]).tolist()


FUNCTIONS = {"objective": Function(arguments, primal(lstm.objective), number),
             "jacobian": Function(arguments, reverse(lstm.objective, *NAMES[:2]), flat)}
