"""remove_marks: the marks that one pass leaves for the next go out of the text.

    def f(x, n):
        s = 0.0
        for i in range(n):
            w = x[:2] * i
            s += w[0] * w[1]
        return s

in its adjoint:

    def f_adjoint(...):                         def f_adjoint(...):
        ...                                         ...
        for i in range(n - 1, -1, -1):              for i in range(n - 1, -1, -1):
            "w"                                         w[...] = x[:2] * i
            w[...] = x[:2] * i                          w_bar[1] += w[0] * s_bar
            w_bar[1] += w[0] * s_bar                    w_bar[0] += w[1] * s_bar
            w_bar[0] += w[1] * s_bar                    x_bar[:2] += i * w_bar
            x_bar[:2] += i * w_bar                      w_bar[...] = 0.0
            w_bar[...] = 0.0

*Requires* a structured function. *Establishes* that every comment is for a reader.
"""
from __future__ import annotations

from s2sad.blocks import with_blocks
from s2sad.passes import Context
from s2sad.tree import AST, FunctionDef, forgotten, is_known, with_body


def remove_marks(function: FunctionDef, context: Context) -> FunctionDef:
    """The function without marks."""
    return with_body(function, _block(function.body))


def _block(block: list[AST]) -> list[AST]:
    return [with_blocks(s, _block) for s in block if not forgotten(s) and not is_known(s)]
