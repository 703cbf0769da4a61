"""The type of a reduction of a number, to NumPy an array without axes: the number itself, or its absolute value."""
from __future__ import annotations

from collections.abc import Mapping

from s2sad.infer.signatures.laws import whole_number
from s2sad.infer.types import FLOAT, UNKNOWN, Type
from s2sad.tree import AST, Constant

ITSELF = ("numpy.sum", "numpy.max", "numpy.amax", "numpy.min", "numpy.amin", "numpy.prod")
AVERAGED = ("numpy.mean", "numpy.median", "numpy.average")
SPREAD = ("numpy.std", "numpy.var")     # nothing, with the number's own dtype; NaN where it is not finite
NORM = "numpy.linalg.norm"


def reduced_number(name: str, kind: Type, options: Mapping[str, AST]) -> Type:
    """The type of the reduction `name` of a number of a type; UNKNOWN for other functions and options that matter."""
    if not kind.is_number or not all(_is_neutral(o, v, name in ITSELF) for o, v in options.items() if o != "x"):
        return UNKNOWN
    if name in ITSELF:
        return kind if kind.dtype == "int64" or kind.is_inexact else UNKNOWN
    if name in AVERAGED and (kind.is_inexact or kind.dtype == "int64"):
        return kind if kind.is_inexact else FLOAT
    return kind if name in (*SPREAD, NORM) and kind.is_float else UNKNOWN


def _is_neutral(option: str, value: AST, ufunc: bool) -> bool:
    """Whether an option of a reduction leaves a number as it is; an axis is a ufunc's alone to name."""
    if ufunc and option == "axis" and whole_number(value) in (0, -1):
        return True
    if not isinstance(value, Constant):
        return False
    return value.value is None or option == "keepdims" and isinstance(value.value, bool) or (
        option == "ddof" and value.value == 0)
