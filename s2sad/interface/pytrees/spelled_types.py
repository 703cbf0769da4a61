"""Structures that are spelled in a text, for functions of files that are not run.

    --types "state: {u: float64[:], t: float}, layers: ((float64[:, :], float64[:]),), mask: None, order: 2"

Braces mean a structure whose items are read as fields or by key, an object of a class where its name stands before
them, as in `grid: Grid{n: 16, u: float64[:]}`; parentheses a tuple or a list; a number or a text in quotes says what an
argument is, and sizes what shape it has, where the program depends on it.
"""
from __future__ import annotations

import ast
import re
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from s2sad.infer.assumed_types import parsed_type
from s2sad.infer.types import NONE, of_value
from s2sad.program import Fact
from s2sad.pytree import Form, PyTree, step

_NAMED = re.compile(r"([^\W\d]\w*)\s*\{")
_SIZES = re.compile(r"\[\s*(\d+(?:\s*,\s*\d+)*)\s*\]$")


def parse_form(text: str, path: str = "", facts: dict[Fact, Any] | None = None) -> Form | None:
    """What a text spells, or None; the values that it says go into `facts`, by their paths.

    >>> parse_form("{u: float64[:], t: float}").keys, str(parse_form("(int, float)")), parse_form("{u}")
    (('u', 't'), 'a tuple', None)
    >>> facts = {}
    >>> str(parse_form("{n: 3, u: float64[4]}", "p", facts)), facts
    ('a structure', {('p.n', 'value'): 3, ('p.u', 'shape'): (4,)})
    """
    text, facts = text.strip(), {} if facts is None else facts
    named = _NAMED.match(text)
    if named is not None:
        inner = parse_form(text[named.end() - 1:], path, facts)
        return replace(inner, made=named[1]) if isinstance(inner, PyTree) else None
    if text == "None":
        return NONE
    if text[:1] + text[-1:] not in ("{}", "()"):
        return _leaf(text, path, facts)
    parts = [part.partition(":") if text[0] == "{" else ("0", ":", part) for part in split_list(text[1:-1])]
    keys = [key.strip().strip("'\"") for key, _, _ in parts]
    empty = PyTree("either" if text[0] == "{" else "tuple", (), ())
    paths = [step(empty, path, k if text[0] == "{" else n) for n, k in enumerate(keys)]
    items = [parse_form(rest, inner, facts) for (_, colon, rest), inner in zip(parts, paths) if colon]
    if any(i is None for i in items) or len(items) < len(parts) or text[0] == "{" and len(set(keys)) < len(keys):
        return None
    known = tuple(i for i in items if i is not None)
    if text[0] == "{":
        return PyTree("either", tuple(keys), known)
    return PyTree("tuple", tuple(range(len(known))), known)


def _leaf(text: str, path: str, facts: dict[Fact, Any]) -> Form | None:
    """The type that a text spells, or that of the value."""
    sizes = _SIZES.search(text)
    if sizes is not None:
        shape = tuple(int(n) for n in sizes[1].split(","))
        found = parsed_type(f"{text[:sizes.start()]}[{', '.join(':' for _ in shape)}]")
        facts |= {} if found is None else {(path, "shape"): shape}
        return found
    found = parsed_type(text)
    if found is not None:
        return found
    try:
        value = ast.literal_eval(text)
    except (ValueError, SyntaxError):
        return None
    if type(value) not in (bool, int, str):
        return None
    facts[path, "value"] = value
    return of_value(value)


def split_list(text: str) -> list[str]:
    """A list with commas, those in brackets aside."""
    parts, depth = [""], 0
    for letter in text:
        depth += (letter in "[{(") - (letter in "]})")
        if letter == "," and not depth:
            parts.append("")
        else:
            parts[-1] += letter
    return [p for p in parts if p.strip()]


def flat_names(names: tuple[str, ...] | None, paths: Mapping[str, str]) -> tuple[str, ...] | None:
    """The flat names of what names mean: parameters, or parts of them."""
    if names is None:
        return None
    found: list[str] = []
    for name in names:
        path = name.replace('"', "'")
        inside = [n for n, p in paths.items() if p == path or p.startswith((f"{path}.", f"{path}["))]
        found += inside or [name]
    return tuple(found)
