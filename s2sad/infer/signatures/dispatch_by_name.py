"""The type of a function of whole arrays that `normalize.library.expand` expands, by its name; UNKNOWN where its
arguments have no expansion."""
from __future__ import annotations

from s2sad.infer.signatures.options import Arguments
from s2sad.infer.promotion import ORDER
from s2sad.infer.types import UNKNOWN, Type
from s2sad.infer.signatures.norms_and_products import FORMS
from s2sad.infer.signatures.indexing_and_sorting import PLACES
from s2sad.infer.signatures.selections import SELECTIONS
from s2sad.infer.signatures.rearrangement import SHAPES
from s2sad.infer.signatures.statistics import STATISTICS
from s2sad.infer.signatures.reductions import SUMS
from s2sad.infer.signatures.fft import TRANSFORMS

_DTYPED = ("numpy.arange", "numpy.astype", "numpy.eye", "numpy.identity")
_TYPES = {**SHAPES, **SUMS, **PLACES, **SELECTIONS, **STATISTICS, **TRANSFORMS, **FORMS}


def expansion_type(function: str, args: list[Type], options: Arguments) -> Type:
    """The type of a call of such a function; `args` are the types of its operands, then of its options."""
    made = _TYPES[function](args, options)
    known = (*ORDER, "int32") if function in _DTYPED else ORDER
    return UNKNOWN if made.dtype and made.dtype not in known else made
