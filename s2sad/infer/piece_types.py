"""The type of a function of whole arrays that is written out in pieces, by its name; UNKNOWN where its arguments are
none that the pieces are written for."""
from __future__ import annotations

from s2sad.infer.options import Arguments
from s2sad.infer.promotion import ORDER
from s2sad.infer.types import UNKNOWN, Type
from s2sad.infer.types_of_matrices import FORMS
from s2sad.infer.types_of_places import PLACES
from s2sad.infer.types_of_selections import SELECTIONS
from s2sad.infer.types_of_shapes import SHAPES
from s2sad.infer.types_of_statistics import STATISTICS
from s2sad.infer.types_of_sums import SUMS
from s2sad.infer.types_of_transforms import TRANSFORMS

_DTYPED = ("numpy.arange", "numpy.astype", "numpy.eye", "numpy.identity")
_TYPES = {**SHAPES, **SUMS, **PLACES, **SELECTIONS, **STATISTICS, **TRANSFORMS, **FORMS}


def piece_type(function: str, args: list[Type], options: Arguments) -> Type:
    """The type of a call of such a function; `args` are the types of its operands, then of its options."""
    made = _TYPES[function](args, options)
    known = (*ORDER, "int32") if function in _DTYPED else ORDER
    return UNKNOWN if made.dtype and made.dtype not in known else made
