"""Structures that are spelled in a text, for functions of files that are not run.

    --types "state: {u: float64[:], t: float}, layers: ((float64[:, :], float64[:]),), mask: None"

Braces mean a structure whose items are read as fields or by key; parentheses a tuple or a list.
"""
from __future__ import annotations

from collections.abc import Mapping

from s2sad.diagnostics import Report
from s2sad.infer.assumed_types import parsed_type
from s2sad.infer.types import NONE, UNKNOWN, Type, array
from s2sad.evaluate.structures.fields import asks, fields
from s2sad.program import Kernel, Program
from s2sad.pytree import Form, PyTree, form_of, is_held, leaves
from s2sad.tree import AST, Attribute, Constant, Name, Subscript, walk

_OF_ARRAYS = ("shape", "size", "ndim", "dtype", "T", "copy", "fill", "sum", "mean", "min", "max", "dot", "reshape",
              "ravel", "flatten", "transpose", "astype", "prod", "std", "var", "real", "item", "argmax", "argmin",
              "cumsum", "clip", "sort", "any", "all", "nonzero", "squeeze", "swapaxes", "repeat", "take", "tolist")


def parse_form(text: str) -> Form | None:
    """What a text spells, or None.

    >>> parse_form("{u: float64[:], t: float}").keys, str(parse_form("(int, float)")), parse_form("{u}")
    (('u', 't'), 'a tuple', None)
    """
    text = text.strip()
    if text == "None":
        return NONE
    if text[:1] + text[-1:] not in ("{}", "()"):
        return parsed_type(text)
    parts = [part.partition(":") if text[0] == "{" else ("0", ":", part) for part in split_list(text[1:-1])]
    keys = [key.strip().strip("'\"") for key, _, _ in parts]
    items = [parse_form(rest) for _, colon, rest in parts if colon]
    if any(i is None for i in items) or len(items) < len(parts) or text[0] == "{" and len(set(keys)) < len(keys):
        return None
    known = tuple(i for i in items if i is not None)
    if text[0] == "{":
        return PyTree("either", tuple(keys), known)
    return PyTree("tuple", tuple(range(len(known))), known)


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


def flat_spelled(program: Program, types: Mapping[str, Form]) -> tuple[Program, dict[str, Type], dict[str, str]]:
    """The program without structures, the types by flat names, and the flat names' paths; raises
    S2sadError where a parameter has parts that are unknown."""
    kernel = program.kernels[program.entry]
    defaults = {p: NONE if d is None else form_of(d, p) for p, d in kernel.defaults.items()
                if d is None or isinstance(d, tuple)}
    forms = {p: types.get(p, defaults.get(p, UNKNOWN)) for p in kernel.parameters}
    _known(kernel, forms)
    if not asks(program) and not any(isinstance(f, PyTree) for f in forms.values()):
        return program, {p: f for p, f in types.items() if isinstance(f, Type)}, {}
    flat = fields(program, tuple(forms.values()))
    kinds = {path: kind for p, form in forms.items() for path, kind in leaves(form, p) if is_held(kind)}
    types = {name: array(kinds[path].dtype, 1) if name in flat.cells else kinds[path]
             for name, path in flat.paths.items() if kinds[path] != UNKNOWN}
    return flat.program, types, flat.paths


def _known(kernel: Kernel, forms: Mapping[str, Form]) -> None:
    """Refuses a parameter that is read by field or key and has no type."""
    report, parts = Report(kernel.source), {}
    for node in walk(kernel.tree.body):
        if isinstance(node, (Attribute, Subscript)) and isinstance(node.value, Name) and forms.get(
                node.value.id) == UNKNOWN and _part(node):
            parts.setdefault(node.value.id, []).append(node)
    for name, nodes in parts.items():
        found = ", ".join(f"{k}: float64" for k in dict.fromkeys(map(_part, nodes)))
        report.error("S203", f"'{name}' has parts, whose types are not known", nodes[0],
                     help=f'say what it is made of, as --types "{name}: {{{found}}}"')
    report.finish()


def _part(node: AST) -> str:
    """The field or key that a part is read by; empty if it is an attribute or an element of an array."""
    if isinstance(node, Attribute):
        return "" if node.attr in _OF_ARRAYS else node.attr
    key = node.slice.value if isinstance(node.slice, Constant) else None
    return key if isinstance(key, str) else ""


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

