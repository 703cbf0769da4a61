"""promotion: the dtype and the type of several values, by promotion, by a cast, as the bindings of one name."""
from __future__ import annotations

import numpy

from s2sad.infer.types import UNKNOWN, Type, array
from s2sad.tree import AST, Constant, Name

RANKS = ("bool", "int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64", "float32", "float64",
         "complex64", "complex128")
ORDER = ("bool", "int64", "float32", "float64", "complex128")     # of arrays that `normalize.library.expand` takes
CASTS = {"builtins.float": "float64", "builtins.int": "int64", "builtins.bool": "bool", "numpy.float64": "float64",
         "numpy.float32": "float32", "numpy.int64": "int64", "numpy.int32": "int32", "numpy.bool_": "bool",
         "builtins.complex": "complex128", "numpy.complex128": "complex128"}

_COMPLEX = {**dict.fromkeys(("complex", "D", "c16", "numpy.cdouble", "numpy.complexfloating"), "complex128"),
            **dict.fromkeys(("F", "c8", "numpy.csingle"), "complex64")}


def array_of_items(items: Type) -> Type:
    """The type of the array of nested lists of numbers."""
    if not items.items:
        return array("float64", 1)
    joined: Type | None = None
    for item in items.items:
        inner = array_of_items(item) if item.kind == "tuple" else item
        joined = inner if joined is None else promote(joined, inner)
    assert joined is not None
    return array(joined.dtype, joined.rank + 1) if joined.dtype else UNKNOWN


def dtype_of(node: AST) -> str | None:
    """The dtype that an expression names: `np.float32`, `float`, `"f4"`; None if it is none that kernels have."""
    spelling = node.id if isinstance(node, Name) else node.value if isinstance(node, Constant) else None
    if not isinstance(spelling, str):
        return None
    if spelling in _COMPLEX or isinstance(node, Name) and spelling in CASTS:
        return _COMPLEX.get(spelling) or CASTS[spelling]
    room, _, last = spelling.rpartition(".")
    named = spelling if isinstance(node, Constant) else getattr(numpy, last, None) if room == "numpy" else None
    if not isinstance(named, str) and not (isinstance(named, type) and issubclass(named, numpy.generic)):
        return None
    try:
        found = numpy.dtype(named).name
    except TypeError:  # no dtype's name, or that of an abstract one
        return None
    return found if found in RANKS else None


def promote(a: Type, b: Type) -> Type:
    """NumPy's promotion: arrays decide over numbers of the same kind, wider ranks over narrower."""
    if "unknown" in (a.kind, b.kind) or not a.dtype or not b.dtype:
        return UNKNOWN
    if a.is_array != b.is_array:
        arr, number = (a, b) if a.is_array else (b, a)
        kind = arr.dtype if arr.is_inexact or not number.is_inexact else "float64"
        if arr.dtype == "bool" and number.is_integer:
            kind = number.dtype     # a mask times 2 is of integers
        if number.is_complex and not arr.is_complex:
            kind = "complex64" if arr.dtype == "float32" else "complex128"
        return array(kind, arr.rank)
    dtype = max(a.dtype, b.dtype, key=RANKS.index)
    return Type(a.kind, dtype, max(a.rank, b.rank))


def join(a: Type, b: Type) -> Type | None:
    """The type of a name that is bound to both, or None if there is none."""
    if a == b or b.kind == "unknown":
        return a
    if a.kind == "unknown":
        return b
    if a.is_number and b.is_number:
        return promote(a, b)
    if a.kind == b.kind == "tuple" and len(a.items) == len(b.items):
        items = [join(x, y) for x, y in zip(a.items, b.items)]
        return None if None in items else Type("tuple", items=tuple(i for i in items if i is not None))
    return None


def common(args: list[Type]) -> str:
    """The common dtype of arrays and numbers."""
    arrays = [a for a in args if a.is_array] or args
    found = max((a.dtype for a in arrays), key=lambda d: ORDER.index(d) if d in ORDER else len(ORDER), default="")
    whole = found.startswith(("int", "uint", "bool"))
    return "float64" if whole and any(a.is_number and a.is_float for a in args) else found


def is_expandable(args: list[Type]) -> bool:
    """Whether the first of these is an array of a dtype that expansions take."""
    return bool(args) and args[0].is_array and args[0].dtype in ORDER
