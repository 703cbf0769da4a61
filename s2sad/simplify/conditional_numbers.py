"""conditional_numbers: every `np.where` of numbers and elements is a choice.

    def f(x: float64[:], y: float64[:]):
        y[:] = np.where(x > 0.0, x, y)

in its tangent:

    def f_tangent(...):                                     def f_tangent(...):
        ...                                                     ...
        for i in range(y.shape[0]):                             for i in range(y.shape[0]):
            ...                                                     ...
            y[i] = np.where(x[i] > 0.0, x[i], y_here)               y[i] = x[i] if x[i] > 0.0 else y_here

*Requires* whole-array statements as loops, and types. *Establishes* that `np.where` is left of arrays alone, in what is
returned.
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
