"""module: functions become a whole file: docstring, imports, constants, the functions.

Only what the functions use is imported or defined, and nothing of that shares a name with anything of theirs.
"""
from __future__ import annotations

import textwrap
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from s2sad import tree
from s2sad.emit.operator_spellings import operator_spellings
from s2sad.emit.layout import WIDTH, Layout, text
from s2sad.emit.line_breaking import BREAK, Pieces, broken
from s2sad.emit.literals import docstring, escaped
from s2sad.emit.user_style import user_style
from s2sad.emit.paste import pasted
from s2sad.emit.dotted_names import BUILTINS, SPECIAL, literal, module_spelling
from s2sad.emit.outside_uses import OutsideUses
from s2sad.live_objects.registry import ROOM


@dataclass(frozen=True)
class FunctionLines:
    """Where a function stands in the text of a module: its first line, counted from 0, and the statement that each of
    its lines prints, with its place in the kernel's source where it has one."""
    name: str
    first: int
    statements: tuple[tree.AST | None, ...]


@dataclass(frozen=True)
class ModuleText:
    """The text of a module, and the statement of each of its lines."""
    text: str
    functions: tuple[FunctionLines, ...]


def module_text(functions: list[tree.FunctionDef], *, header: list[str], constants: Mapping[str, Any],
                standalone: bool) -> str:
    """The text of `module`."""
    return module(functions, header=header, constants=constants, standalone=standalone).text


def module(functions: list[tree.FunctionDef], *, header: list[str], constants: Mapping[str, Any],
           standalone: bool) -> ModuleText:
    """A module with these functions, in this order.

    `header` is its docstring, line by line; `constants` has a value for every `const.` name the functions read.
    With `standalone` the functions of `s2sad.runtime` that they call are written out, else imported. A function
    keeps its name unless one that calls it has a local variable of that name; a last `return None` that is the
    only one is left out.

    >>> [limit] = tree.statements("def limit(a): return G")
    >>> limit = tree.rename(limit, {"G": "const.G"})
    >>> print(module([limit], header=["A limit."], constants={"G": 9.81}, standalone=False).text, end="")
    \"""A limit.\"""
    <BLANKLINE>
    G = 9.81
    <BLANKLINE>
    <BLANKLINE>
    def limit(a):
        return G
    """
    functions = list(map(operator_spellings, functions))
    uses = OutsideUses.of(functions)
    values = {key: literal(constants[key]) for key in uses.room("const")}
    pieces = pasted(uses.room("runtime")) if standalone else []
    spelling = module_spelling(uses, values, pieces)
    functions = [_finished(function, spelling.get(f"user.{function.name}", function.name)) for function in functions]

    defined = [text(tree.assign(spelling[f"const.{key}"], value), spelling) for key, value in values.items()]
    imported = [] if standalone else uses.room("runtime")
    top = [_docstring(header), _exceptions(functions, [spelling[f"const.{key}"] for key in values]),
           _imports(spelling, imported), "\n".join(defined)]
    laid_out = [Layout(function, names=spelling) for function in functions]
    parts = ["\n\n".join(filter(None, top)), *(piece.text(spelling) for piece in pieces)]
    parts = [*filter(None, parts), *(each.text for each in laid_out)]
    return ModuleText("\n\n\n".join(parts) + "\n", _functions(parts, functions, laid_out))


def _functions(parts: list[str], functions: list[tree.FunctionDef], laid_out: list[Layout]) -> tuple[FunctionLines,
                                                                                                     ...]:
    """Where the functions stand, which are the last parts of the text."""
    found, line = [], 0
    before = len(parts) - len(functions)
    for position, part in enumerate(parts):
        if position >= before:
            printed = laid_out[position - before]
            found.append(FunctionLines(functions[position - before].name, line, tuple(printed.origins)))
        line += part.count("\n") + 3
    return tuple(found)


def _finished(function: tree.FunctionDef, identifier: str) -> tree.FunctionDef:
    """The function under its final name, without a last `return` that returns nothing."""
    body = function.body
    returns = [node for node in tree.walk(body) if isinstance(node, tree.Return)]
    if body and returns == [body[-1]] and _is_none(returns[0].value):
        body = body[:-1] or [tree.Pass()]
    finished = {**{field: getattr(function, field) for field in function._fields}, "name": identifier, "body": body}
    return tree.FunctionDef(**finished)


def _is_none(value: tree.AST | None) -> bool:
    return value is None or isinstance(value, tree.Constant) and value.value is None


def _docstring(header: list[str]) -> str:
    lines = [line for entry in header for line in _wrapped(entry)]
    if len(lines) < 2:
        return "".join(docstring(line) for line in lines)
    return docstring("\n".join(lines) + "\n")


def _wrapped(entry: str) -> list[str]:
    """The lines of a header's entry, each short enough also when it is escaped and between its quotes."""
    lines = []
    for line in entry.expandtabs(4).splitlines() or [""]:
        room = WIDTH - 6 - (len(escaped(line)) - len(line))
        indent = " " * (len(line) - len(line.lstrip()) + 4)
        if len(line) > room:
            lines += textwrap.wrap(line, max(room, 16), subsequent_indent=indent[:8], break_on_hyphens=False)
        else:
            lines.append(line.rstrip())
    return [line.replace("\xa0", " ") for line in lines]


def _imports(spelling: Mapping[str, str], runtime_names: list[str]) -> str:
    """The import block; `spelling` holds what each library is imported as."""
    own = [_import(library, spelling[key]) for library, key in (("builtins", BUILTINS), ("math", "math"))
           if key in spelling]
    others = [_import("numpy", spelling["numpy"])] if "numpy" in spelling else []
    others += [SPECIAL + _as("special", spelling[SPECIAL])] if SPECIAL in spelling else []
    user_functions = [_import_from(key[len(ROOM):], alias) for key, alias in spelling.items() if key.startswith(ROOM)]
    blocks = ["\n".join(block) for block in (own, others, sorted(user_functions)) if block]
    if runtime_names:
        items: list = []
        for identifier in sorted(runtime_names):
            alias = spelling[f"runtime.{identifier}"]
            items += [",", BREAK] if items else []
            items.append(identifier if alias == identifier else f"{identifier} as {alias}")
        # skipped, for where it belongs depends on whether the file lies beside s2sad's own sources
        pieces = ["from s2sad.runtime import ", Pieces("optional", items), "  # isort: skip"]
        blocks.append("\n".join(broken(pieces, 0, WIDTH)))
    return "\n\n".join(blocks)


def _import(library: str, alias: str) -> str:
    return f"import {library}{_as(library, alias)}"


def _import_from(path: str, alias: str) -> str:
    module, _, last = path.rpartition(".")
    return f"from {module} import {last}{_as(last, alias)}  # isort: skip"


def _as(known: str, alias: str) -> str:
    return "" if alias == known else f" as {alias}"


def _exceptions(functions: list[tree.FunctionDef], constants: list[str]) -> str:
    """The lines for ruff, if the functions need any; RUF100 because not every ruff has every rule on."""
    codes = user_style(functions)
    if {"l", "O", "I"}.intersection(constants) and "E741" not in codes:
        codes = sorted([*codes, "E741"])
    rows = [", ".join([*codes[first:first + 10], "RUF100"]) for first in range(0, len(codes), 10)]
    return "\n".join(f"# ruff: noqa: {row}" for row in rows)
