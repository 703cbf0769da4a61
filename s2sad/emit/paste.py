"""The text of runtime functions, for files that must run with NumPy alone."""
from __future__ import annotations

import ast
import builtins
import inspect
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from types import FunctionType, ModuleType

from s2sad import runtime


@dataclass(frozen=True)
class RuntimeFunction:
    """A runtime function: its text, the libraries and builtins it uses and the runtime functions it calls.

    `places` are the (line, column, name as it stands, what it means) of the names to be spelled, last one first;
    a meaning is a key of the spelling, as `numpy` or `runtime.grow`.
    """
    name: str
    source: str
    libraries: frozenset[str]
    builtins: frozenset[str]
    calls: tuple[str, ...]
    places: tuple[tuple[int, int, str, str], ...]

    def text(self, spelling: Mapping[str, str]) -> str:
        """The function's text with outer names as the module spells them."""
        lines = self.source.splitlines()
        for line, column, name, meaning in self.places:
            before, after = lines[line - 1][:column], lines[line - 1][column + len(name):]
            lines[line - 1] = before + spelling.get(meaning, name) + after
        return "\n".join(lines)


def pasted(names: Iterable[str]) -> list[RuntimeFunction]:
    """The runtime functions of these names and those they call, callees first.

    >>> [piece.name for piece in pasted(["grow", "pairwise_sum"])]
    ['grow', 'blocked_sum', 'pairwise_sum']
    """
    found: dict[str, RuntimeFunction] = {}

    def add(name: str) -> None:
        if name not in found:
            piece = _piece(name)
            for callee in piece.calls:
                add(callee)
            found[name] = piece

    for name in names:
        add(name)
    return list(found.values())


@cache
def _piece(name: str) -> RuntimeFunction:
    function = getattr(runtime, name)
    source = inspect.getsource(function)
    definition = ast.parse(source).body[0]
    assert isinstance(definition, ast.FunctionDef)
    places = [(definition.lineno, len("def "), name, f"runtime.{name}")]
    libraries, plain, calls = set(), set(), []
    for node in ast.walk(definition):
        if not isinstance(node, ast.Name):
            continue
        value = function.__globals__.get(node.id)
        if isinstance(value, ModuleType):
            libraries.add(value.__name__)
            meaning = value.__name__
        elif isinstance(value, FunctionType):
            calls += [value.__name__] if value is not function else []
            meaning = f"runtime.{value.__name__}"
        elif hasattr(builtins, node.id):
            plain.add(node.id)
            meaning = f"builtins.{node.id}"
        else:
            continue
        places.append((node.lineno, node.col_offset, node.id, meaning))
    in_order = tuple(sorted(places, reverse=True))
    return RuntimeFunction(name, source.rstrip(), frozenset(libraries), frozenset(plain), tuple(dict.fromkeys(calls)),
                           in_order)
