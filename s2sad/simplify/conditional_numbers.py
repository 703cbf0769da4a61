"""conditional_numbers: every `np.where` of numbers and elements is a choice.

    y[i] = np.where(c, a, b[i])         y[i] = a if c else b[i]

Requires whole-array statements as loops, and types; one of arrays may be left in what is returned.
"""
from __future__ import annotations

from s2sad.differentiate.arithmetic import scalar_choices
from s2sad.passes import Context
from s2sad.tree import FunctionDef, copy


def conditional_numbers(function: FunctionDef, context: Context) -> FunctionDef:
    """The function with such choices."""
    new, typing = copy(function), context.typing
    new.body = [scalar_choices(s, lambda n: not typing.of(n).is_array) for s in new.body]
    return new
