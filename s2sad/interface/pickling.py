"""What is made of a function, pickled as the function is.

    @differentiate
    def energy(u): ...              the module's `energy` is the differentiated function, the plain one has no name

Pickle writes a function by its name and refuses one that its name does not lead to; cloudpickle writes such a one, and
those of `__main__`, by their content. So that both do with what a decorator made as they do with functions, it is
written as a function that its name leads to, `energy._named`, and that carries what the decorator was given. What is
written by its content has no source in another process: the text goes along.
"""
from __future__ import annotations

import sys
from abc import ABC, abstractmethod
from collections.abc import Iterator
from functools import cached_property, reduce
from types import FunctionType
from typing import Any

from s2sad.live_objects.code_text import carry, codes, text_of
from s2sad.live_objects.unwrap import partial_application, python_function


class Decorated(ABC):
    """What is made of one function, its `__wrapped__`, and pickled with it."""
    __wrapped__: Any

    @abstractmethod
    def decorator_arguments(self) -> tuple[Any, ...]:
        """The arguments of the decorator, which make a copy."""

    @abstractmethod
    def __call__(self, *args: Any, **keywords: Any) -> Any: ...

    def __reduce_ex__(self, protocol: Any) -> Any:
        if _lookup(*_name(self.__wrapped__)) is self:
            return (_restore_decorated, (self._named,)) if protocol >= 4 else _name(self.__wrapped__)[1]
        return rebuild_decorated, (type(self), self.decorator_arguments(), _sources(self.__wrapped__))

    @cached_property
    def _named(self) -> FunctionType:
        named = FunctionType(_restore_decorated.__code__, {}, "_named")
        named.__module__, path = _name(self.__wrapped__)
        named.__qualname__ = f"{path}._named"
        vars(named)["made"] = type(self), self.decorator_arguments(), _sources(self.__wrapped__)
        return named


def rebuild_decorated(kind: type[Decorated], given: tuple[Any, ...], texts: dict[str, str]) -> Decorated:
    """A copy, in a process that may not have its source."""
    carry(texts)
    return kind(*given)


def _restore_decorated(named: FunctionType) -> Any:
    """The decorated function of a pickled name: that under its name, where it was pickled by name; else a new one."""
    owner = _lookup(named.__module__, named.__qualname__.rpartition(".")[0])
    if isinstance(owner, Decorated) and vars(owner).get("_named") is named:
        return owner
    return rebuild_decorated(*vars(named)["made"])


# -- names and texts ------------------------------------------------------------------------------------------------

def _name(function: Any) -> tuple[str, str]:
    return getattr(function, "__module__", None) or "", getattr(function, "__qualname__", "")


def _lookup(module: str, path: str) -> Any:
    """What a path of names in a module leads to; None if to nothing."""
    return reduce(lambda value, name: getattr(value, name, None), path.split("."), sys.modules.get(module))


def _sources(function: Any) -> dict[str, str]:
    """The sources, by path, of a function and of those that it may call, where pickle stores them by content."""
    found: dict[str, str] = {}
    seen, left = set(), [function]
    while left:
        plain = python_function(left.pop())
        if plain is None or id(plain) in seen:
            continue
        seen.add(id(plain))
        plain, bound = partial_application(plain)
        by_name = plain.__module__ != "__main__" and python_function(_lookup(*_name(plain))) is plain
        if by_name and not _is_written_by_content(plain.__module__):
            continue
        path, text = text_of(plain.__code__, plain.__globals__)
        found[path] = text
        names = {name for code in codes(plain.__code__) for name in code.co_names}
        reached = [*bound.values(), *(plain.__globals__[n] for n in names if n in plain.__globals__), *_contents(plain)]
        kinds = [v if isinstance(v, type) else type(v) for v in reached]
        left += [*reached, *(f for kind in kinds if kind.__module__ == "__main__" for f in vars(kind).values())]
    return {path: text for path, text in found.items() if text}


def _is_written_by_content(module: str) -> bool:
    """Whether cloudpickle was told to write what a module, or a package around it, defines by its content."""
    registry = getattr(sys.modules.get("cloudpickle"), "list_registry_pickle_by_value", set)()
    return any(module == name or module.startswith(f"{name}.") for name in registry)


def _contents(function: FunctionType) -> Iterator[Any]:
    for cell in function.__closure__ or ():
        try:
            yield cell.cell_contents
        except ValueError:      # not bound yet
            continue
