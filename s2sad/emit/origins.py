"""Origins: every adjoint block stands under a comment with the statement that it reverses."""
from __future__ import annotations

from s2sad.diagnostics import Source
from s2sad.simplify.rebuild import with_blocks
from s2sad.tree import AST, Assign, AugAssign, Expr, FunctionDef, Return, comment, copy, is_comment

_WIDTH = 98  # a line, less "# "


def with_origins(function: FunctionDef, source: Source) -> FunctionDef:
    """The function with comments in its reverse sweep; a forward sweep that is empty is not mentioned."""
    new = copy(function)
    marks = [k for k, s in enumerate(function.body) if is_comment(s)]
    if not marks:
        return new
    start = marks[-1] + 1
    forward = [s for s in function.body[:start - 1] if not is_comment(s)]
    head = [comment("forward sweep: only what the reverse sweep reads"), *forward] if forward else []
    new.body = [*head, comment("reverse sweep"), *_commented(function.body[start:], source, 4)]
    return new


def _commented(block: list[AST], source: Source, indent: int) -> list[AST]:
    made: list[AST] = []
    last = None
    for statement in block:
        inside = with_blocks(statement, lambda inner: _commented(inner, source, indent + 4))
        if isinstance(statement, (Assign, AugAssign, Expr)) and getattr(statement, "lineno", None):
            place = (statement.lineno, statement.col_offset)
            if place != last and not _is_zero(statement):
                made.append(comment(text_of(statement, source, _WIDTH - indent)))
                last = place
        elif not isinstance(statement, Return):
            last = None
        made.append(inside)
    return made


def _is_zero(statement: AST) -> bool:
    value = getattr(statement, "value", None)
    return isinstance(statement, Assign) and getattr(value, "value", None) == 0.0


def text_of(statement: AST, source: Source, longest: int) -> str:
    """The source of a statement on one line, cut where it is long; of a loop or branch its first line."""
    first = source.line(statement.lineno).strip()
    last = getattr(statement, "end_lineno", None) or statement.lineno
    compound = first.startswith(("for ", "while ", "while(", "if ", "if(", "elif ", "else:"))
    lines = [first] if compound else [first, *(source.line(k) for k in range(statement.lineno + 1, last + 1))]
    text = " ".join(line.split("#")[0].strip() if '"' not in line and "'" not in line else line.strip()
                    for line in lines)
    return text if len(text) <= longest else text[:longest - 4] + " ..."
