"""Generated text becomes a module, and a file of the same content in the user's cache, named by it.

The file is for people, editors and debuggers: what runs is the text itself, which the module's loader gives to
tracebacks, too, where there can be no file.
"""
from __future__ import annotations

import hashlib
import importlib.machinery
import importlib.util
import itertools
import linecache
import sys
import weakref
from collections import Counter
from types import CodeType, ModuleType
from typing import Any

from s2sad.compiler_lock import COMPILER_LOCK
from s2sad.run import store

_OWN = itertools.count(1)
_OWNERS: Counter[str] = Counter()       # by the names of modules


class _Loader(importlib.machinery.SourceFileLoader):
    """Compiles the text that was verified, whatever its file holds, and leaves no bytecode."""

    def __init__(self, name: str, path: str, text: str):
        super().__init__(name, path)
        self._text = text

    def get_code(self, fullname: str) -> CodeType:
        # the guards are assertions: they stay under python -O
        return compile(self._text, self.path, "exec", dont_inherit=True, optimize=0)

    def get_source(self, fullname: str) -> str:
        return self._text


def load(text: str, name: str, key: str = "", own: bool = False) -> ModuleType:
    """The module of a generated text; the same text, name and key give the same module.

    `key` stands for what else the compiled form depends on (engine, flags, versions): another key is another module.
    With `own` the module is a new one each time: it imports functions that may have changed.
    """
    digest = hashlib.sha256(f"{key}\0{name}\0{text}".encode()).hexdigest()[:20]
    identifier = f"s2sad_{name}_{digest}"
    with COMPILER_LOCK:
        if own:
            identifier += f"_{next(_OWN)}"
        module = sys.modules.get(identifier)
        if module is not None:
            return module
        path = store.keep(f"{name}_{digest}.py", text) or f"generated/{name}_{digest}.py"
        loader = _Loader(identifier, str(path), text)
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


def owned(module: ModuleType, owner: Any) -> ModuleType:
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
