"""How many lines of a kernel have to change for a tool, counted on the texts."""
from __future__ import annotations

import ast
import difflib
import inspect
import sys
from collections.abc import Callable
from types import FunctionType
from typing import Any


def changed(kernel: Callable[..., Any], version: Callable[..., Any]) -> tuple[int, int]:
    """How many lines of a version are not the kernel's, and how many lines the kernel has.

    Both with the functions of their module that they call; docstrings, comments and empty lines do not count, nor does
    indentation.
    """
    old, new = text(kernel), text(version)
    same = sum(block.size for block in difflib.SequenceMatcher(a=old, b=new, autojunk=False).get_matching_blocks())
    return len(new) - same, len(old)


def text(function: Callable[..., Any]) -> list[str]:
    """The lines of a function and of those of its module that it calls, as Python writes them."""
    lines: list[str] = []
    for one in _with_helpers(function):
        tree = ast.parse(inspect.cleandoc("\n" + inspect.getsource(one)))
        for node in ast.walk(tree):
            if isinstance(node, ast.FunctionDef) and ast.get_docstring(node) is not None and len(node.body) > 1:
                del node.body[0]
        lines += [line.strip() for line in ast.unparse(tree).splitlines() if line.strip()]
    return lines


def _with_helpers(function: Callable[..., Any]) -> list[FunctionType]:
    """The function and those that it names, each once, in the order of their text."""
    assert isinstance(function, FunctionType)
    module, found, waiting = sys.modules[function.__module__], [], [function]
    while waiting:
        one = waiting.pop()
        if one in found:
            continue
        found.append(one)
        named = {n.id for n in ast.walk(ast.parse(inspect.cleandoc("\n" + inspect.getsource(one))))
                 if isinstance(n, ast.Name)}
        waiting += [f for n in named if isinstance(f := vars(module).get(n), FunctionType)
                    and f.__module__ == module.__name__]
    return sorted(found, key=lambda f: f.__code__.co_firstlineno)
