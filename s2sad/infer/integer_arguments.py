"""integer_arguments: the arguments of a call of NumPy's or math's that are integers whatever they are computed of.

    np.tile(x, k + 1)               k + 1
    x.reshape(k, -1)                k, -1
    np.linspace(0.0, 1.0, num=n)    n
"""
from __future__ import annotations

from collections.abc import Iterator

from s2sad.tree import AST, Attribute, Call, call_name

_ALL = range(99)
_POSITIONS: dict[str, tuple[int, ...] | range] = {
    **dict.fromkeys(("zeros", "ones", "empty", "full", "identity", "tri", "hanning", "hamming", "blackman",
                     "bartlett"), (0,)),
    **dict.fromkeys(("eye", "ndindex", "indices"), _ALL),
    **dict.fromkeys(("tile", "repeat", "roll", "diff", "pad", "trace", "diag", "diagonal", "tril", "triu", "vander",
                     "split", "array_split", "hsplit", "vsplit", "dsplit", "expand_dims", "broadcast_to", "rot90",
                     "transpose", "take", "squeeze", "partition", "flip", "swapaxes",
                     "moveaxis", "rollaxis", "lib.stride_tricks.sliding_window_view"), range(1, 99)),
    **dict.fromkeys(("linspace", "logspace", "geomspace"), (2,)),
    "reshape": range(1, 99), "resize": range(1, 99), "linalg.matrix_power": (1,),
    **dict.fromkeys(("sum", "prod", "mean", "std", "var", "cumsum", "cumprod", "max", "min", "argmax", "argmin", "sort",
                     "argsort", "concatenate", "stack"), (1,)),
}
_OF_MATH = {"comb": _ALL, "perm": _ALL, "factorial": _ALL, "gcd": _ALL, "lcm": _ALL, "isqrt": _ALL, "ldexp": (1,)}
_KEYWORDS = ("shape", "newshape", "num", "k", "offset", "shift", "axis", "axes", "axis1", "axis2", "n", "N", "M",
             "repeats", "reps", "pad_width", "indices_or_sections", "minlength", "window_shape")


def integer_arguments(node: Call) -> Iterator[AST]:
    """The arguments of a call that must be integers; of a method, it is taken for an array's."""
    called = call_name(node) or ""
    room, _, name = called.partition(".")
    if room in ("numpy", "math"):
        positions = (_POSITIONS if room == "numpy" else _OF_MATH).get(name, ())
        yield from (argument for k, argument in enumerate(node.args) if k in positions)
    elif not called and isinstance(node.func, Attribute):
        positions = _POSITIONS.get(node.func.attr, ())
        yield from (argument for k, argument in enumerate(node.args) if k + 1 in positions)
    if room in ("numpy", "math") or not called:
        yield from (keyword.value for keyword in node.keywords if keyword.arg in _KEYWORDS)
