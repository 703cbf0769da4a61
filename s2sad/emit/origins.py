"""origins: every adjoint block stands under a comment with the statement that it reverses."""
from __future__ import annotations

import io
from functools import lru_cache, partial
from tokenize import COMMENT, DEDENT, ENDMARKER, INDENT, NEWLINE, NL, TokenError, generate_tokens

from s2sad.diagnostics import Source, Span
from s2sad.differentiate.adjoint import REVERSE
from s2sad.emit.layout import text
from s2sad.blocks import with_blocks
from s2sad.tree import AST, Assign, AugAssign, Expr, FunctionDef, Name, Return, at, comment, copy, is_comment

_WIDTH = 98  # a line, less "# "
_CUT = " ..."
_COMPOUND = ("for ", "while ", "while(", "if ", "if(", "elif ", "else:", "break", "continue")
_NO_WORDS = (COMMENT, DEDENT, ENDMARKER, INDENT, NEWLINE, NL)
_OPENING, _CLOSING = ("(", "[", "{"), (")", "]", "}")


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
            if origin != last and not _is_zero(statement) and not _is_redundant(statement, origin):
                made.append(at(comment(origin), statement))
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


def _is_redundant(statement: AST, origin: str) -> bool:
    """Whether a comment would repeat the statement, or name the branch or loop around it."""
    return origin.startswith(_COMPOUND) or origin.replace(" ", "") == text(statement).replace(" ", "")


def text_of(statement: AST, source: Source, longest: int) -> str:
    """The source of a statement on one line, cut after a word where it is long; of a loop or branch its first line."""
    words = joined(_lines(statement, source))
    if len(words) <= longest:
        return words
    room = longest - len(_CUT)
    end = words.rfind(" ", 0, room + 1)
    return words[:end if end > room // 2 else room].rstrip() + _CUT


def _lines(statement: AST, source: Source) -> list[str]:
    """The lines of a statement, of a loop or branch the first one; without its neighbours on the same line."""
    span = Span.of(source, statement)
    source = span.source
    first = source.line(span.line)
    before = first[:span.column].rstrip()
    own = before[-1:] in ("", ":", ";")  # else it is a part of a statement
    if first.strip().startswith(_COMPOUND) and not (own and before):
        return [first]
    lines = [first, *(source.line(k) for k in range(span.line + 1, span.end_line + 1))]
    if own:
        lines[-1] = lines[-1][:span.end_column]
        lines[0] = lines[0][span.column:]
    return lines


def joined(lines: list[str]) -> str:
    """The lines of a statement as one, its comments left out, one space where there were several.

    >>> joined(["total = (a +  # the first", "         # and the rest", "         f('#  ', b))"])
    "total = (a + f('#  ', b))"
    """
    return _joined("\n".join(line.strip() for line in lines) + "\n")


@lru_cache(maxsize=256)     # many statements of an adjoint have one origin
def _joined(lines: str) -> str:
    words, row, column = "", 1, 0
    try:
        for token in generate_tokens(io.StringIO(lines).readline):
            if token.type in _NO_WORDS or not token.string:
                continue
            apart = token.start != (row, column) and words[-1:] not in _OPENING and (
                token.start[0] == row or token.string[0] not in _CLOSING)
            words += " " * (apart and bool(words)) + token.string.strip()
            row, column = token.end
    except (TokenError, SyntaxError):  # a part of a statement: the head of a loop over several lines
        pass
    return " ".join(words.splitlines())
