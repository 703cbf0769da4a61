"""Arithmetic of numbers that are known while deriving, in bounded time and memory.

`10 ** 10 ** 10` is nobody's constant.
Operands are bounded, so that no chain of operations grows beyond them: `N = N * N`, forty times.
"""
from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any

BITS = 4096     # of an integer: more than any float's exponent takes

_OPERATORS: dict[str, Callable[..., Any]] = {
    "Add": operator.add, "Sub": operator.sub, "Mult": operator.mul, "Div": operator.truediv, "Mod": operator.mod,
    "FloorDiv": operator.floordiv, "Pow": operator.pow, "LShift": operator.lshift, "RShift": operator.rshift,
    "BitAnd": operator.and_, "BitOr": operator.or_, "BitXor": operator.xor,
    "USub": operator.neg, "UAdd": operator.pos, "Invert": operator.invert, "Not": operator.not_,
}


def is_bounded(value: Any) -> bool:
    """Whether a number is none of Python's integers that are too large.

    >>> is_bounded(10 ** 1000), is_bounded(10 ** 10000), is_bounded(1e300)
    (True, False, True)
    """
    return not isinstance(value, int) or value.bit_length() <= BITS


def operation(name: str, *operands: Any) -> Any:
    """What an operation gives, by its name in a tree: "Add", "USub".

    Raises OverflowError if an operand or the result is too large, and what the operation raises: ArithmeticError,
    TypeError, ValueError, and KeyError for a name that there is not.

    >>> operation("Mult", 6, 7), operation("USub", 1.5)
    (42, -1.5)
    >>> operation("Pow", 10, 10 ** 10)
    Traceback (most recent call last):
    OverflowError: an integer of more than 4096 bits
    """
    whole = all(isinstance(o, int) for o in operands)
    if not all(map(is_bounded, operands)) or whole and (
            name == "Pow" and (operands[0].bit_length() - 1) * operands[1] > BITS
            or name == "LShift" and operands[0].bit_length() + operands[1] > BITS):
        raise OverflowError(f"an integer of more than {BITS} bits")
    result = _OPERATORS[name](*operands)
    if not is_bounded(result):
        raise OverflowError(f"an integer of more than {BITS} bits")
    return result
