"""literals: the text of constants: numbers, strings, formatted strings, docstrings."""
from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from s2sad import tree

_PART = 60
_PYTHONS_OWN: tuple[type[np.generic], ...] = (np.float64, np.int64, np.bool_, np.complex128)


def number(value: Any) -> str:
    """The literal of a constant that is no string; a NumPy number that Python's own types hold is one of those.

    >>> number(1e-05), number(np.float64(2.0)), number(True), number(Ellipsis)
    ('1e-05', '2.0', 'True', '...')
    """
    if value is Ellipsis:
        return "..."
    if isinstance(value, _PYTHONS_OWN):
        return repr(value.item())
    return repr(value)


def needs_numpy(value: object) -> bool:
    """Whether the literal of a constant has a NumPy name, as `np.inf` and `np.float32(0.5)` are."""
    if isinstance(value, tuple):
        return any(map(needs_numpy, value))
    if isinstance(value, float):
        return not np.isfinite(value)
    return isinstance(value, np.generic) and not isinstance(value, _PYTHONS_OWN)


def quoted(words: str) -> str:
    """A string literal, in double quotes unless others need fewer escapes.

    >>> print(quoted("n > 0"), quoted('say "n"'))
    "n > 0" 'say "n"'
    """
    plain = repr(words)
    return f'"{plain[1:-1]}"' if plain[0] == "'" and '"' not in words else plain


def text_parts(words: str) -> list:
    """The literal of a long string in parts that Python joins, with `None` (where a line may end) between them."""
    parts: list = []
    rest = words
    while rest:
        end = len(rest) if len(rest) <= _PART else rest.rfind(" ", 0, _PART) + 1 or _PART
        parts += ([None] if parts else []) + [quoted(rest[:end])]
        rest = rest[end:]
    return parts


def docstring(words: str) -> str:
    """The text as a literal in three double quotes, its lines kept.

    >>> print(docstring('a "b" and \\\\ c'))
    \"""a "b" and \\\\ c\"""
    """
    inner = escaped(words[:-1]) + '\\"' if words.endswith('"') else escaped(words)
    return f'"""{inner}"""'


def escaped(words: str) -> str:
    """The text as it may stand between three double quotes."""
    doubled = words.replace("\\", "\\\\").replace('"""', '\\"\\"\\"')
    return "".join(c if c == "\n" or c.isprintable() else repr(c)[1:-1] for c in doubled)


def formatted_string(node: Any, expression: Callable[[tree.AST], str]) -> str:
    """An f-string; its quotes are ones that none of its expressions use, as Python before 3.12 wants it."""
    codes = [expression(part.value) for part in tree.walk(node) if type(part).__name__ == "FormattedValue"]
    quote = next(q for q in ('"', "'", '"""', "'''") if not any(q in code for code in codes))
    return f"f{quote}{_formatted_parts(node, expression, quote)}{quote}"


def _formatted_parts(node: Any, expression: Callable[[tree.AST], str], quote: str) -> str:
    parts = []
    for part in node.values:
        if isinstance(part, tree.Constant):
            plain = repr(part.value + '"')[1:-2]  # the added quote makes repr leave both kinds to us
            plain = plain.replace("\\'", "'").replace(quote[0], "\\" + quote[0])
            parts.append(plain.replace("{", "{{").replace("}", "}}"))
            continue
        code = expression(part.value)
        conversion = "" if part.conversion == -1 else f"!{chr(part.conversion)}"
        spec = "" if part.format_spec is None else ":" + _formatted_parts(part.format_spec, expression, quote)
        parts.append("{" + (" " if code.startswith("{") else "") + code + conversion + spec + "}")
    return "".join(parts)
