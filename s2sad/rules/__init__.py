"""Derivative rules: a table of contents.

    rule          what a rule is, how it is registered
    elementwise   functions that work number by number: arithmetic, exp, sin, hypot, maximum, ...
    power         a ** b, by what is known of the exponent
    array         what a rule of a function of whole arrays is
    reductions    sums, means, extremes along axes
    shaping       functions that move elements about
    linalg        products, solves, functions of matrices
    transforms    Fourier transforms
    complexes     what holds for complex numbers
    sparse        products and solves with sparse matrices
    composed      functions of whole arrays that are expanded into others
    constant      functions whose derivative is zero: floor, comparisons, argmax, ...

A name is a resolved one ("numpy.exp", "math.exp", "builtins.abs") or an operator ("a + b", "a ** b", "-a"). A
function with neither a rule nor an entry in `constant` cannot be differentiated.
"""
from __future__ import annotations

from s2sad.rules import composed, constant, elementwise, linalg, reductions, shaping, sparse, transforms
from s2sad.rules.array import ArrayRule, bound, find_array
from s2sad.live_objects.registry import ROOM
from s2sad.rules.power import power_partial
from s2sad.rules.rule import TABLE, Rule

__all__ = ["ArrayRule", "Rule", "bound", "composed", "constant", "constant_result", "elementwise", "find", "find_array",
           "linalg", "names", "power_partial", "reductions", "result_kind", "shaping", "sparse", "transforms"]


def find(name: str) -> Rule | None:
    """The rule of a function or an operator, or None.

    >>> find("math.exp").uses("x"), find("a ** b").parameters, find("numpy.linalg.det")
    (frozenset({'y'}), ('a', 'b'), None)
    """
    return TABLE.rules.get(name)


def constant_result(name: str) -> str | None:
    """For a function whose derivative is zero the kind of its result: "float", "int", "bool" or "same"; else None.

    >>> constant_result("numpy.floor"), constant_result("math.floor"), constant_result("numpy.exp")
    ('same', 'int', None)
    """
    return TABLE.constants.get(name)


def result_kind(name: str) -> str | None:
    """The kind of result of any function known here; "same" is the common type of the arguments.

    >>> result_kind("numpy.exp"), result_kind("numpy.maximum"), result_kind("numpy.isnan"), result_kind("os.getcwd")
    ('float', 'same', 'bool', None)
    """
    rule = TABLE.rules.get(name)
    return rule.result if rule else TABLE.constants.get(name)


def names() -> tuple[str, ...]:
    """Every name with a rule, in the order of registration; without those of the user."""
    return tuple(n for n in TABLE.rules if not n.startswith(ROOM))
