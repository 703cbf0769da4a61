"""Generated text becomes a module, and a file of the same content in the user's cache, named by it.

The file is for people, editors and debuggers: what runs is the text itself, which the module's loader gives to
tracebacks, too, where there can be no file.
"""
from __future__ import annotations

import ast
import hashlib
import importlib.machinery
import importlib.util
import itertools
import linecache
import sys
import weakref
from collections import Counter
from collections.abc import Callable, Collection
from types import CodeType, ModuleType
from typing import Any

from s2sad.run.compiler_lock import COMPILER_LOCK
from s2sad.run import store

Change = Callable[[ast.Module], ast.Module]
_OWN = itertools.count(1)
_OWNERS: Counter[str] = Counter()       # by the names of modules


class _Loader(importlib.machinery.SourceFileLoader):
    """Compiles the text that was verified, whatever its file holds, and leaves no bytecode."""

    def __init__(self, name: str, path: str, text: str, guards: Collection[int], change: Change | None):
        super().__init__(name, path)
        self._text, self._guards, self._change = text, guards, change

    def get_code(self, fullname: str) -> CodeType:
        made: Any = _Raising(self._guards).visit(ast.parse(self._text)) if self._guards else self._text
        if self._change is not None:
            made = self._change(made if self._guards else ast.parse(self._text))
        # the guards are assertions: they stay under python -O
        return compile(made, self.path, "exec", dont_inherit=True, optimize=0)

    def get_source(self, fullname: str) -> str:
        return self._text


class _Raising(ast.NodeTransformer):
    """Guards that raise with their line and what they compared: Numba takes no message that is computed, but arguments.

        assert u.shape == v.shape, "..."    if not u.shape == v.shape: raise AssertionError("...", 12, u.shape, v.shape)
    """

    def __init__(self, lines: Collection[int]):
        self._lines = lines

    def visit_Assert(self, node: ast.Assert) -> ast.AST:
        if node.lineno not in self._lines or node.msg is None:
            return node
        test = node.test
        compared = [test.left, *test.comparators] if isinstance(test, ast.Compare) and len(test.ops) == 1 else []
        error = ast.Call(ast.Name("AssertionError", ast.Load()), [node.msg, ast.Constant(node.lineno), *compared], [])
        made = ast.If(ast.UnaryOp(ast.Not(), test), [ast.Raise(error)], [])
        return ast.fix_missing_locations(ast.copy_location(made, node))


def load(text: str, name: str, key: str = "", own: bool = False, guards: Collection[int] = (),
         change: Change | None = None) -> ModuleType:
    """The module of a generated text; the same text, name, key and guards give the same module.

    The assertions in the lines of `guards` raise AssertionError with their message, their line and what they compared.

    `key` has what else the compiled form depends on (engine, flags, versions, a `change` of the tree, which leaves the
    lines): another key is another module.
    With `own` the module is a new one each time: it imports functions that may have changed.
    """
    digest = hashlib.sha256(f"{key}\0{name}\0{text}\0{sorted(guards)}".encode()).hexdigest()[:20]
    identifier = f"s2sad_{name}_{digest}"
    with COMPILER_LOCK:
        if own:
            identifier += f"_{next(_OWN)}"
        module = sys.modules.get(identifier)
        if module is not None:
            return module
        path = store.keep(f"{name}_{digest}.py", text) or f"generated/{name}_{digest}.py"
        loader = _Loader(identifier, str(path), text, guards, change)
        spec = importlib.util.spec_from_file_location(identifier, path, loader=loader)
        assert spec is not None  # a loader was given
        module = importlib.util.module_from_spec(spec)
        sys.modules[identifier] = module
        try:
            loader.exec_module(module)
        except BaseException:
            del sys.modules[identifier]
            raise
        return module


def keep_loaded(module: ModuleType, owner: Any) -> ModuleType:
    """The module, which is among the loaded ones for as long as one of its owners lives, as those who unpickle machine
    code and those who look for a text by a module's name want it."""
    _OWNERS[module.__name__] += 1
    sys.modules.setdefault(module.__name__, module)
    weakref.finalize(owner, _left, module).atexit = False
    return module


def _left(module: ModuleType) -> None:
    """An owner is gone: with the last one nothing leads to the module any more but functions of it that are in use."""
    name = module.__name__
    _OWNERS[name] -= 1
    if _OWNERS[name] <= 0:
        del _OWNERS[name]
        if sys.modules.get(name) is module:
            del sys.modules[name]
        linecache.cache.pop(module.__file__ or "", None)
