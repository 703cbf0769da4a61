"""remove_marks: the marks that one pass leaves for the next go out of the text.

Requires a structured function; establishes that every comment is for a reader.
"""
from __future__ import annotations

from s2sad.blocks import with_blocks
from s2sad.passes import Context
from s2sad.tree import AST, FunctionDef, forgotten, with_body


def remove_marks(function: FunctionDef, context: Context) -> FunctionDef:
    """The function without marks."""
    return with_body(function, _block(function.body))


def _block(block: list[AST]) -> list[AST]:
    return [with_blocks(s, _block) for s in block if not forgotten(s)]
