"""Origins: every adjoint block stands under a comment with the statement that it reverses."""
from __future__ import annotations

from functools import partial

from s2sad.diagnostics import Source
from s2sad.differentiate.adjoint import REVERSE
from s2sad.emit.layout import text
from s2sad.simplify.rebuild import with_blocks
from s2sad.tree import AST, Assign, AugAssign, Expr, FunctionDef, Name, Return, comment, copy, is_comment

_WIDTH = 98  # a line, less "# "
_COMPOUND = ("for ", "while ", "while(", "if ", "if(", "elif ", "else:", "break", "continue")


def with_origins(function: FunctionDef, source: Source) -> FunctionDef:
    """The function with comments in its reverse sweep; a forward sweep that is empty is not mentioned."""
    new = copy(function)
    marks = [k for k, s in enumerate(function.body) if is_comment(s) and s.value.value == REVERSE]
    if not marks:
        return new
    start = marks[-1] + 1
    forward = [s for s in function.body[:start - 1] if not is_comment(s)]
    head = [comment("forward sweep: only what the reverse sweep reads"), *forward] if forward else []
    new.body = [*head, comment(REVERSE), *_commented(function.body[start:], source, 4)]
    return new


def _commented(block: list[AST], source: Source, indent: int, last: str = "") -> list[AST]:
    """The block with a comment where another statement begins to be reversed; `last` is the one around it."""
    made: list[AST] = []
    for statement in block:
        if isinstance(statement, (Assign, AugAssign, Expr)) and getattr(statement, "lineno", None):
            origin = text_of(statement, source, _WIDTH - indent)
            if origin != last and not _is_zero(statement) and not _speaks_for_itself(statement, origin):
                made.append(comment(origin))
                last = origin
            made.append(statement)
        else:
            made.append(with_blocks(statement, partial(_commented, source=source, indent=indent + 4, last=last)))
            last = last if isinstance(statement, Return) else ""
    return made


def _is_zero(statement: AST) -> bool:
    """Whether a statement only begins a sum."""
    value = getattr(statement, "value", None)
    return isinstance(statement, Assign) and isinstance(statement.targets[0], Name) and getattr(
        value, "value", None) == 0.0


def _speaks_for_itself(statement: AST, origin: str) -> bool:
    """Whether a comment would repeat the statement, or name the branch or loop around it."""
    return origin.startswith(_COMPOUND) or origin.replace(" ", "") == text(statement).replace(" ", "")


def text_of(statement: AST, source: Source, longest: int) -> str:
    """The source of a statement on one line, cut where it is long; of a loop or branch its first line."""
    first = source.line(statement.lineno).strip()
    last = getattr(statement, "end_lineno", None) or statement.lineno
    lines = [first]
    if not first.startswith(_COMPOUND):
        lines += [source.line(k) for k in range(statement.lineno + 1, last + 1)]
    words = " ".join(line.split("#")[0].strip() if '"' not in line and "'" not in line else line.strip()
                    for line in lines)
    return words if len(words) <= longest else words[:longest - 4] + " ..."
