"""The types of names: kind, dtype and rank, and nothing else."""
from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from s2sad.live_objects.guards import VaryingNumber


@dataclass(frozen=True)
class Type:
    """A number (`rank` 0), an array, a tuple of types, or one of the odd ones.

    kind is "number", "array", "tuple", "none", "text" or "unknown"; dtype is NumPy's name
    ("float64", "complex128", "int64", "bool", ...) for numbers and arrays. `ones` are the axes of an argument that
    have length 1, where that matters: NumPy broadcasts them.
    """
    kind: str
    dtype: str = ""
    rank: int = 0
    items: tuple[Type, ...] = ()
    ones: tuple[int, ...] = ()

    @property
    def count(self) -> int:
        """How many values it is made of, those of tuples within tuples counted one by one."""
        return sum(item.count for item in self.items) if self.kind == "tuple" else 1

    @property
    def is_float(self) -> bool:
        return self.kind in ("number", "array") and self.dtype.startswith("float")

    @property
    def is_complex(self) -> bool:
        return self.kind in ("number", "array") and self.dtype.startswith("complex")

    @property
    def is_inexact(self) -> bool:
        """Whether values of this type have derivatives: floats and complex numbers."""
        return self.is_float or self.is_complex

    @property
    def real(self) -> Type:
        """The type of the real part."""
        return replace(self, dtype=self.dtype.replace("complex128", "float64").replace("complex64", "float32"))

    @property
    def is_array(self) -> bool:
        return self.kind == "array"

    @property
    def zero(self) -> float | int | bool:
        """The number that this type's arrays begin with."""
        return 0.0 if self.is_inexact else False if self.dtype == "bool" else 0

    @property
    def is_number(self) -> bool:
        return self.kind == "number"

    @property
    def is_integer(self) -> bool:
        return self.kind == "number" and self.dtype.startswith(("int", "uint", "bool"))

    @property
    def holds_integers(self) -> bool:
        """Whether it is an integer, and no bool, or an array of such."""
        return self.kind in ("number", "array") and self.dtype.startswith(("int", "uint"))

    @property
    def plain(self) -> Type:
        """The type without what is known of lengths."""
        return replace(self, ones=()) if self.ones else self

    def __str__(self) -> str:
        if self.kind == "array":
            return f"{self.dtype}[{', '.join('1' if k in self.ones else ':' for k in range(self.rank))}]"
        if self.kind == "tuple":
            return f"({', '.join(map(str, self.items))})"
        return self.dtype or self.kind


FLOAT, INT, BOOL = Type("number", "float64"), Type("number", "int64"), Type("number", "bool")
NONE, TEXT, UNKNOWN = Type("none"), Type("text"), Type("unknown")


DTYPES = frozenset(("bool", "int8", "int16", "int32", "int64", "uint8", "uint16", "uint32", "uint64", "float64",
                    "float32", "complex128"))      # of arrays that kernels take


def array(dtype: str, rank: int) -> Type:
    return Type("array", dtype, rank)


def misfit_of(value: np.ndarray, name: str) -> tuple[str, str] | None:
    """What keeps an array, of whatever class, from being an argument, and what to do; None if it may be one."""
    kind = type(value)
    if kind is not np.ndarray and kind is not np.memmap:
        word = kind.__name__
        filled = f"pass {name}.filled(...): what is masked would be read"
        return f"is {'an' if word[0] in 'aeioAEIO' else 'a'} {word}", (
            filled if isinstance(value, np.ma.MaskedArray) else f"pass numpy.asarray({name})")
    if value.ndim == 0:
        return "is an array of rank 0", f"pass the number, {name}[()], or an array of shape (1,)"
    if _name(value.dtype) not in DTYPES:
        return f"has dtype {value.dtype}", "use float64, float32, complex128, an integer type or bool"
    if not value.dtype.isnative:
        return "has the other byte order", f'pass {name}.astype("{value.dtype.name}")'
    return None


def of_rank(kind: Type, rank: int) -> Type:
    """The type with another rank: a number for 0."""
    return array(kind.dtype, rank) if rank else Type("number", kind.dtype)


@lru_cache(maxsize=256)
def _name(dtype: np.dtype) -> str:
    """The name of a dtype: NumPy makes it anew each time, which takes longer than all else here."""
    return dtype.name


@lru_cache(maxsize=256)
def _of_array(dtype: np.dtype, rank: int, ones: tuple[int, ...]) -> Type:
    """The type of an array."""
    return Type("array", _name(dtype), rank, ones=ones)


def of_value(value: object) -> Type:
    """The type of a Python value, as an argument or a constant of the kernel's module."""
    if isinstance(value, VaryingNumber):
        value = value.value
    if value is None:
        return NONE
    if isinstance(value, (bool, np.bool_)):
        return BOOL
    if isinstance(value, int):
        return INT
    if isinstance(value, float) and not isinstance(value, np.floating):
        return FLOAT
    if isinstance(value, np.generic):
        return Type("number", value.dtype.name)
    if isinstance(value, complex):
        return Type("number", "complex128")
    if isinstance(value, np.ndarray):
        ones = tuple(k for k, size in enumerate(value.shape) if size == 1) if 1 in value.shape else ()
        return _of_array(value.dtype, value.ndim, ones)
    if isinstance(value, str):
        return TEXT
    if isinstance(value, tuple):
        return Type("tuple", items=tuple(map(of_value, value)))
    return UNKNOWN
