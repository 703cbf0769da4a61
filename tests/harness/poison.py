"""Poison: whatever is allocated and not yet written holds nan, so that what reads it shows.

In generated modules, under every engine, and in the functions of the runtime, every `np.empty` and `np.empty_like` is
filled: floats and complex numbers with nan, integers with a number that is no index, bools with True. So are the stacks
that a compiled adjoint keeps between calls, before each call. `pytest --poison` runs any test so; `poisoned()` is for a
block, of functions of which nothing has been derived before.
"""
from __future__ import annotations

import ast
import importlib
import pkgutil
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from functools import cache
from types import CodeType, FunctionType, ModuleType
from typing import Any
from unittest.mock import patch

import numpy as np

import s2sad.runtime
from s2sad.dispatch import executable
from s2sad.dispatch.memory_reuse import MemoryReuse
from s2sad.run import compiled, module_loader
from tests.harness import engines

HUGE = {8: 100, 16: 30_000, 32: 2_000_000_000, 64: 4_000_000_000_000_000_000}   # by bits: far behind every array's end
NAME = "_poison"


def poison_of(dtype: np.dtype) -> Any:
    """What an unwritten element of a dtype holds."""
    if dtype.kind in "fc":
        return dtype.type(np.nan)
    return dtype.type(True if dtype.kind == "b" else HUGE[8 * dtype.itemsize])


def filled(made: np.ndarray) -> np.ndarray:
    """The array, filled with what shows where it is read.

    >>> filled(np.empty(2)), filled(np.empty(1, dtype=np.int64)) > 2 ** 60
    (array([nan, nan]), array([ True]))
    """
    made.fill(poison_of(made.dtype))
    return made


class _Filling(ast.NodeTransformer):
    """`np.empty(...)` and `np.empty_like(...)` become `_poison(np.empty(...))`."""

    def visit_Call(self, node: ast.Call) -> ast.AST:
        self.generic_visit(node)
        called = node.func
        if not (isinstance(called, ast.Attribute) and called.attr in ("empty", "empty_like")
                and isinstance(called.value, ast.Name)):
            return node
        return ast.copy_location(ast.Call(ast.copy_location(ast.Name(NAME, ast.Load()), node), [node], []), node)


def _with_poison(text: str) -> ast.Module:
    return ast.fix_missing_locations(_Filling().visit(ast.parse(text)))


class _Loader(module_loader._Loader):
    """Loads a generated text with what is allocated in it filled."""

    def exec_module(self, module: ModuleType) -> None:
        setattr(module, NAME, filled)
        super().exec_module(module)

    def get_code(self, fullname: str) -> CodeType:
        tree = module_loader._Raising(self._guards).visit(_with_poison(self._text))
        return compile(tree, self.path, "exec", dont_inherit=True, optimize=0)


class _Keeping(MemoryReuse):
    """Stacks hold nothing of the call before."""

    def __call__(self, *arguments: Any) -> tuple[Any, ...]:
        for stack in (self.kept().arrays or {}).values():
            filled(stack)
        return super().__call__(*arguments)


def _runtime_modules() -> list[ModuleType]:
    return [importlib.import_module(f"s2sad.runtime.{found.name}") for found in pkgutil.iter_modules(
        s2sad.runtime.__path__)]


@contextmanager
def _runtime_filled() -> Iterator[None]:
    """The runtime's functions run code in which what is allocated is filled."""
    codes: list[tuple[FunctionType, CodeType]] = []
    for module in _runtime_modules():
        space: dict[str, Any] = {"__name__": module.__name__}
        text = importlib.import_module("inspect").getsource(module)
        exec(compile(_with_poison(text), str(module.__file__), "exec"), space)
        setattr(module, NAME, filled)
        for name, function in list(vars(module).items()):
            if isinstance(function, FunctionType) and function.__module__ == module.__name__ and name != NAME:
                codes.append((function, function.__code__))
                if not function.__closure__:
                    function.__code__ = space[name].__code__
    try:
        yield
    finally:
        for function, code in codes:
            function.__code__ = code


@cache
def _for_numba() -> None:
    """Tells Numba what `filled` is."""
    extending = importlib.import_module("numba.core.extending")
    numpy_support = importlib.import_module("numba.np.numpy_support")

    def typed(made: Any) -> Callable[[Any], Any]:
        value = poison_of(numpy_support.as_dtype(made.dtype))

        def body(made: Any) -> Any:
            made.fill(value)
            return made
        return body
    extending.overload(filled)(typed)


# the runtime's functions with what is allocated filled: compiled, and as `running` runs them
_runtime, _runtime_in_loops = cache(compiled._runtime.__wrapped__), cache(compiled._runtime.__wrapped__)


@contextmanager
def poisoned() -> Iterator[None]:
    """Whatever is derived, compiled and loaded inside reads nothing that was not written, or has nan."""
    if compiled.available():
        _for_numba()
    key, loaded, jit = compiled._key, module_loader.load, compiled._jit

    def own(text: str, name: str, module_key: str = "", **options: Any) -> ModuleType:
        return loaded(text, name, f"{module_key}-poison", **options)

    def compiled_or_known(function: FunctionType, *arguments: Any, **options: Any) -> Any:
        return function if function is filled else jit(function, *arguments, **options)

    with ExitStack() as changed:
        changed.enter_context(_runtime_filled())
        for where, name, value in ((module_loader, "_Loader", _Loader), (module_loader, "load", own),
                                   (executable, "load", own),
                                   (executable, "MemoryReuse", _Keeping), (compiled, "_jit", compiled_or_known),
                                   (compiled, "_key", lambda bounds: f"{key(bounds)}-poison"),
                                   (compiled, "_runtime", _runtime), (engines, "_runtime", _runtime_in_loops)):
            changed.enter_context(patch.object(where, name, value))
        yield
