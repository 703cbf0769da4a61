"""The power rule, which depends on what is known of the exponent.

    exponent n, an integer       n * a ** (n - 1)             an integer power stays one
    exponent 0.5                 0.5 / y
    exponent c < 0               c * y / a                    y is at hand, one power less
    exponent c > 0               c * a ** (c - 1)             right at a == 0, where y / a is not
    0 < c < 0.5                  c * y / a, c / y at 0, 1, inf   where c - 1 is rounded: half a unit times log(a)
    a variable                   b * a ** (b - 1), and 0 where b == 0

With respect to the exponent it is y * log(a): nan where a < 0, for there a ** b has no derivative in b, and taken as 0
where a == 0, where it is 0 for b > 0.
"""
from __future__ import annotations

from collections.abc import Mapping
from math import isfinite

from s2sad import tree
from s2sad.rules.rule import elementwise, number, template
from s2sad.tree import AST

# where b is 0 so is the partial, but 0.0 * a ** -1.0 is nan at a == 0
_BASE = "numpy.where(b == 0, 0.0, b * a ** (b - 1))"
_EXPONENT = "y * numpy.log(numpy.where(a == 0, 1.0, a))"
_NAMES = ("numpy.power", "numpy.pow", "numpy.float_power", "math.pow", "builtins.pow")
POWERS = frozenset(["a ** b", *_NAMES])


def _value(exponent: AST) -> float | None:
    """The value of a number or of a quotient of numbers, as in `x ** (1 / 3)`."""
    if isinstance(exponent, tree.BinOp) and isinstance(exponent.op, tree.Div):
        above, below = number(exponent.left), number(exponent.right)
        return above / below if above is not None and below else None
    return number(exponent)


def _base_partial(exponent: float | None, spelled: str) -> str | None:
    """The partial with respect to the base for a known exponent, which is spelled so, or None."""
    if exponent is None or not isfinite(exponent):
        return None
    if exponent == int(exponent):
        return _integer_power(exponent)
    if exponent == 0.5:
        return "0.5 / y"
    if exponent < 0:
        return f"{spelled} * y / a"
    if exponent - 1.0 + 1.0 != exponent:
        return f"{spelled} * numpy.where(a == y, 1.0 / y, y / a)"
    return f"{spelled} * a ** {exponent - 1!r}"


def _integer_power(exponent: float) -> str:
    if exponent == 0:
        return "0.0"
    if exponent == 1:
        return "1.0"
    factor = repr(float(exponent))
    return f"{factor} * a" if exponent == 2 else f"{factor} * a ** {exponent - 1!r}"


def refined(parameter: str, arguments: Mapping[str, AST]) -> str | None:
    """The partial for actual operands: shorter than the general one where the exponent is a number."""
    base, exponent = arguments.get("a"), arguments.get("b")
    if parameter == "b":
        return None if base is None or not number(base) else "y * numpy.log(a)"
    if exponent is None:
        return None
    known = _value(exponent)
    return _base_partial(known, "b" if isinstance(exponent, tree.BinOp) else repr(known))


def power_partial(parameter: str, base: AST, exponent: AST, result: AST) -> AST:
    """The partial of `base ** exponent` with respect to "a", the base, or "b", the exponent.

    >>> a, y = tree.name("x"), tree.name("r")
    >>> tree.dump(power_partial("a", a, tree.const(2), y))
    "BinOp(float 2.0, Mult(), Name('x'))"
    """
    operands = {"a": base, "b": exponent}
    text = refined(parameter, operands) or (_BASE if parameter == "a" else _EXPONENT)
    return tree.substitute(template(text), {**operands, "y": result})


elementwise("a ** b", a=_BASE, b=_EXPONENT, also=_NAMES, result="same", refine=refined, singular=("a", "b"),
            plane="holomorphic",
            domain={"a": (0.1, 3.0), "b": (-2.5, 2.5)},
            kink="a ** b with respect to b is taken as 0 where a == 0, and is nan where a < 0")
