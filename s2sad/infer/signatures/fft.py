"""The type of a transform along several axes, of shifts and frequencies; UNKNOWN where it has no expansion."""
from __future__ import annotations

from collections.abc import Callable

from s2sad.infer.signatures.laws import axes_of, distinct_axes
from s2sad.infer.signatures.options import Arguments, is_none, text_of
from s2sad.infer.types import UNKNOWN, Type, array
from s2sad.tree import List, Tuple


def transformed_axes(options: Arguments, rank: int) -> list[int] | None:
    """The axes that a transform goes along, from 0, in its order; None if they are no constants."""
    if not is_none(options["axes"]):
        return distinct_axes(options["axes"], rank)
    count = len(options["s"].elts) if isinstance(options["s"], (Tuple, List)) else rank
    return list(range(rank - count, rank)) if count <= rank else None


def _transform(dtype: str) -> Callable[[list[Type], Arguments], Type]:
    def type_of(args: list[Type], options: Arguments) -> Type:
        axes, sizes = transformed_axes(options, args[0].rank) if args[0].is_array else None, options["s"]
        fits = is_none(sizes) or isinstance(sizes, (Tuple, List)) and axes is not None and len(sizes.elts) == len(axes)
        known = is_none(options["norm"]) or text_of(options["norm"]) in ("backward", "ortho", "forward")
        if not axes or not fits or not known or args[0].dtype in ("float32", "complex64"):
            return UNKNOWN
        return array(dtype, args[0].rank)
    return type_of


def _shifted(args: list[Type], options: Arguments) -> Type:
    return args[0] if args[0].is_array and axes_of(options["axes"], args[0].rank) is not None else UNKNOWN


def _frequencies(args: list[Type], options: Arguments) -> Type:
    return array("float64", 1) if args[0].is_integer and args[1].is_number else UNKNOWN


TRANSFORMS: dict[str, Callable[[list[Type], Arguments], Type]] = {
    **{f"numpy.fft.{f}{several}": _transform("float64" if f == "irfft" else "complex128")
       for f in ("fft", "ifft", "rfft", "irfft") for several in ("2", "n")},
    "numpy.fft.fftshift": _shifted, "numpy.fft.ifftshift": _shifted, "numpy.fft.fftfreq": _frequencies,
    "numpy.fft.rfftfreq": _frequencies,
}
