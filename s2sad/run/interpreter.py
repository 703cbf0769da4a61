"""What Numba cannot compile, as compiled code can call it: the interpreter runs it, in Numba's object mode.

The type of what comes back follows from the function's name and its first argument, as Numba must know it beforehand.
"""
from __future__ import annotations

import importlib
from types import FunctionType
from typing import Any

import numpy as np

# functions of an array, by their name, with the dtype of the array that they give, which has as many axes
DTYPES = {"fft": "complex128", "ifft": "complex128", "rfft": "complex128", "irfft": "float64",
          "fft_adjoint": "complex128", "ifft_adjoint": "complex128", "rfft_adjoint": "float64",
          "irfft_adjoint": "complex128"}


def interpreted(function: FunctionType) -> Any:
    """The function for compiled code; its result is in row-major order."""
    numba = importlib.import_module("numba")
    extending = importlib.import_module("numba.core.extending")
    objmode, dtype = numba.objmode, getattr(numba, DTYPES[function.__name__])

    def in_rows(*arguments: Any) -> np.ndarray:
        return np.ascontiguousarray(function(*arguments))

    code = function.__code__
    parameters = ", ".join(code.co_varnames[:code.co_argcount])
    space: dict[str, Any] = {"numba": numba, "dtype": dtype, "in_rows": in_rows, "objmode": objmode}
    exec(_TEXT.format(parameters=parameters, first=code.co_varnames[0]), space)
    extending.overload(space["called"])(space["made"])
    return space["called"]


_TEXT = """
def called({parameters}):
    raise AssertionError("it is called by compiled code")

def made({parameters}):
    result = numba.types.Array(dtype, {first}.ndim, "C")

    def body({parameters}):
        with objmode(found=result):
            found = in_rows({parameters})
        return found
    return body
"""
