"""Constant arithmetic of a file that is not run: `G = 9.81`, `K = 2 * G`, `R = math.sqrt(G) * np.pi`."""
from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy

from s2sad import tree
from s2sad.infer.bounded_arithmetic import BITS, is_bounded, operation
from s2sad.read.outside_values import AST, Library, Meaning, NotConstant, Number, StringValue, is_number, library_value

_CALLS = ("builtins.abs", "builtins.float", "builtins.int", "builtins.max", "builtins.min", "builtins.round")


def folded(node: AST, meaning: Callable[[AST], Meaning | None]) -> Any:
    """The value of a constant expression; raises NotConstant for any other. `meaning` tells what a name is."""
    if isinstance(node, tree.Constant):
        return node.value
    known = meaning(node) if isinstance(node, (tree.Name, tree.Attribute)) else None
    if isinstance(known, (Number, StringValue)):
        return known.value
    if isinstance(known, Library) and is_number(library_value(known.path)):
        return library_value(known.path)
    try:
        if isinstance(node, tree.UnaryOp):
            return operation(type(node.op).__name__, _number(folded(node.operand, meaning)))
        if isinstance(node, tree.BinOp):
            left, right = (_number(folded(side, meaning)) for side in (node.left, node.right))
            return _number(operation(type(node.op).__name__, left, right))
        if isinstance(node, tree.Call) and not node.keywords:
            function = meaning(node.func)
            if isinstance(function, Library) and _is_arithmetic(function.path):
                arguments = [_number(folded(argument, meaning)) for argument in node.args]
                return _number(_called(function.path, arguments))
    except (ArithmeticError, ValueError, TypeError, KeyError):
        raise NotConstant from None
    raise NotConstant


def _number(value: Any) -> Any:
    if not is_number(value) or not is_bounded(value):
        raise NotConstant
    return value


def _is_arithmetic(path: str) -> bool:
    value = library_value(path)
    if path.startswith("math."):
        return callable(value) and value not in (math.factorial, math.comb, math.perm)
    return path in _CALLS or isinstance(value, numpy.ufunc) or (path.startswith("numpy.") and isinstance(value, type)
                                                                and issubclass(value, (numpy.number, numpy.bool_)))


def _called(path: str, arguments: list[Any]) -> Any:
    """What a function of numbers gives. NumPy's take integers of 64 bits: beyond these they compute with Python's."""
    limit = 64 if path.startswith("numpy.") else BITS
    digits = arguments[1:] if path == "builtins.round" else []
    if any(isinstance(a, int) and a.bit_length() >= limit for a in arguments) or any(abs(d) > BITS for d in digits):
        raise NotConstant
    return library_value(path)(*arguments)
