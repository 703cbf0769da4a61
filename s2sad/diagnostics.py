"""What is said to the user: where, what, why, what to do.

A pass collects diagnostics in a `Report` and raises `S2sadError` once, with all of them.
"""
from __future__ import annotations

import os
import sys
import warnings
from dataclasses import dataclass, field, replace
from functools import cache, lru_cache
from typing import Any

HOME = os.path.join(os.path.dirname(os.path.abspath(__file__)), "")

CODES = {
    # S1: reading
    "S101": "the source cannot be had",
    "S102": "not Python",
    "S103": "no such function in the file",
    "S104": "the source has changed since the function was defined",
    # S2: the language
    "S201": "a construct outside the supported language",
    "S202": "a name that is not known",
    "S203": "types that contradict each other or cannot be inferred",
    "S204": "recursion",
    "S205": "an active value takes a way that cannot be differentiated",
    # S3: rules
    "S301": "no derivative rule",
    "S302": "a rule that cannot be",
    # S4: what is asked for
    "S401": "wrt or of names something that cannot be differentiated",
    "S402": "an annotation that does not fit its argument",
    "S403": "a shadow or a seed that does not fit its primal",
    "S404": "arguments that overlap in memory",
    "S405": "an argument that does not fit its parameter",
    "S406": "an active value is stored where no derivative is kept",
    "S407": "what was asked for cannot be written",
    "S408": "checkpoint names what is no loop, or one that cannot keep snapshots",
    "S409": "a tape that cannot be used",
    "S410": "a derivative takes more memory than there is, or than it may",
    "S411": "a derivative for one direction at a time",
    # S5: while the kernel runs
    "S501": "values that do not fit each other, as sizes of arrays",
    "S502": "an integration that fails",
    # S9: ourselves
    "S901": "internal error",
}

APART = 10_000_000                      # more lines than a file has


@lru_cache(maxsize=64)
def _lines(text: str) -> list[str]:
    return text.splitlines()


@dataclass(frozen=True)
class Source:
    """A text with its path as the user knows it; `first` is the number of its first line in the file.

    A kernel into which functions of other files were inlined knows these, too: the lines of the k-th follow from line
    k * APART on. `renamed` pairs names that variables of inner scopes were given with those that they have in the text.
    `call` is the place in the kernel's file from which a function of another file was first called.
    """
    path: str
    text: str
    first: int = 1
    others: tuple[Source, ...] = ()
    renamed: tuple[tuple[str, str], ...] = ()
    call: str = ""

    def home(self, number: int) -> tuple[Source, int]:
        """The source of a line, and its number there."""
        place, row = divmod(number, APART)
        return (self.others[place - 1], row) if 0 < place <= len(self.others) else (self, number)

    def line(self, number: int) -> str:
        source, number = self.home(number)
        lines = _lines(source.text)
        row = number - source.first
        return lines[row] if 0 <= row < len(lines) else ""

    def holding(self, other: Source) -> tuple[Source, int]:
        """This source with the lines of another one, and what is to be added to their numbers."""
        if (other.path, other.text, other.first) == (self.path, self.text, self.first):
            return self, 0
        others = self.others if other in self.others else (*self.others, other)
        return replace(self, others=others), APART * (others.index(other) + 1)


@dataclass(frozen=True)
class Span:
    """A place: lines as in the file, columns in characters from 0, the end column exclusive."""
    source: Source
    line: int
    column: int
    end_line: int
    end_column: int

    @classmethod
    def of(cls, source: Source, node: Any) -> Span:
        """The place of a node; gast columns count bytes of UTF-8, these count characters."""
        source, line = source.home(node.lineno)
        end_line = line + (getattr(node, "end_lineno", None) or node.lineno) - node.lineno
        end = getattr(node, "end_col_offset", None)
        column = _characters(source.line(line), node.col_offset)
        return cls(source, line, column, end_line,
                   column + 1 if end is None else _characters(source.line(end_line), end))


def _characters(line: str, offset: int) -> int:
    return len(line.encode()[:offset].decode(errors="ignore"))


@dataclass(frozen=True)
class Diagnostic:
    """One message; `note` says why (beside the caret), `help` what to do."""
    code: str
    message: str
    span: Span | None = None
    note: str = ""
    help: str = ""
    severity: str = "error"

    def __str__(self) -> str:
        head = f"{self.severity}[{self.code}]: {self.message}"
        lines = [head]
        if self.span is not None:
            span = self.span
            text = span.source.line(span.line)
            end = span.end_column if span.end_line == span.line else len(text)
            gutter = f"  {span.line} | "
            caret = " " * (len(gutter) - 2) + "| " + " " * span.column + "^" * max(1, end - span.column)
            lines = [f"{span.source.path}:{span.line}:{span.column + 1}: {head}", gutter + text,
                     (caret + " " + self.note).rstrip()]
            if span.source.call:
                lines.append(f"  note: called from {span.source.call}")
        elif self.note:
            lines.append(f"  note: {self.note}")
        if self.help:
            lines.append(f"  help: {self.help}")
        return "\n".join(lines)


class S2sadError(Exception):
    """Raised with everything that a pass had to say; `diagnostics` holds the parts."""

    def __init__(self, *diagnostics: Diagnostic):
        self.diagnostics = diagnostics
        super().__init__("\n".join(map(str, diagnostics)))


class WaitingForFacts(S2sadError):
    """Raised with what is said of a program that can be evaluated where more is known of its arguments: the call that
    raises it is made again, and asks them."""


class S2sadValueError(S2sadError, ValueError):
    """Raised while the kernel runs: what NumPy, or the kernel itself, would raise ValueError for as well."""


class S2sadIndexError(S2sadError, IndexError):
    """Raised where the kernel would ask for an element that is not there, before anything is written."""


class S2sadWarning(UserWarning):
    """Something that is correct and probably not meant."""


def warn(message: object) -> None:
    """Warns where the user's own code called."""
    depth, frame = 2, sys._getframe(1)
    while frame.f_back is not None and frame.f_code.co_filename.startswith(HOME):
        depth, frame = depth + 1, frame.f_back
    warnings.warn(str(message), S2sadWarning, stacklevel=depth)


@cache
def warn_once(message: str) -> None:
    """Warns of what stays as it is, for the first time."""
    warn(message)


@dataclass
class Report:
    """Collects the diagnostics of one pass over one source."""
    source: Source
    found: list[Diagnostic] = field(default_factory=list)

    def error(self, code: str, message: str, node: Any = None, note: str = "", help: str = "") -> None:
        place = Span.of(self.source, node) if node is not None and getattr(node, "lineno", None) else None
        for made, plain in self.source.renamed:
            message, note, help = (t.replace(f"'{made}'", f"'{plain}'") for t in (message, note, help))
        new = Diagnostic(code, message, place, note, help)
        if new not in self.found:
            self.found.append(new)

    def finish(self) -> None:
        """Raises S2sadError if anything was found."""
        if self.found:
            raise S2sadError(*self.found)
