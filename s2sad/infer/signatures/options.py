"""The values of options of functions of whole arrays: axes, widths, orders, dtypes."""
from __future__ import annotations

from collections.abc import Mapping

from s2sad.infer.signatures.laws import axes_of, whole_number
from s2sad.infer.promotion import ORDER, dtype_of
from s2sad.tree import AST, Constant, List, Name, Tuple, UnaryOp, USub

Arguments = Mapping[str, AST]


def is_none(node: AST | None) -> bool:
    return isinstance(node, Constant) and node.value is None


def text_of(node: AST) -> str:
    """The string constant of an option, or ''."""
    return node.value if isinstance(node, Constant) and isinstance(node.value, str) else ""


def one_axis(node: AST, rank: int) -> int | None:
    """The one axis of an option."""
    found = None if is_none(node) or whole_number(node) is None else axes_of(node, rank)
    return found[0] if found else None


def widths_of(node: AST, rank: int) -> list[tuple[AST, AST]] | None:
    """How much `np.pad` adds before and after each axis."""
    if not isinstance(node, (Tuple, List)):
        return [(node, node)] * rank
    parts = list(node.elts)
    if all(isinstance(p, (Tuple, List)) for p in parts):
        pairs = [tuple(p.elts) for p in parts]
        if any(len(p) != 2 for p in pairs) or len(pairs) not in (1, rank):
            return None
        return [(p[0], p[1]) for p in (pairs if len(pairs) == rank else pairs * rank)]
    return [(parts[0], parts[1])] * rank if len(parts) == 2 else None


def norm_order(node: AST) -> int | float | str | None:
    """The order of a norm in an option: a number, "inf", "-inf", "fro", "nuc", None; else ""."""
    if isinstance(node, UnaryOp) and isinstance(node.op, USub):
        inner = norm_order(node.operand)
        return "-inf" if inner == "inf" else -inner if isinstance(inner, (int, float)) else ""
    if isinstance(node, Name):
        return "inf" if node.id in ("numpy.inf", "math.inf") else ""
    value = node.value if isinstance(node, Constant) else ""
    return value if value is None or type(value) in (int, float) or value in ("fro", "nuc") else ""


def astype_dtype(options: Arguments) -> str:
    """The dtype argument of `np.astype`, "" if it is none that arrays here have."""
    node = options["dtype"]
    named = node.id if isinstance(node, Name) else text_of(node)
    found = {"builtins.float": "float64", "builtins.int": "int64", "builtins.bool": "bool", "numpy.bool_": "bool",
             "builtins.complex": "complex128",
             "numpy.bool": "bool"}.get(named, named.removeprefix("numpy."))
    return found if found in (*ORDER, "int32") else "complex128" if dtype_of(node) == "complex128" else ""
