"""Derivatives that tests give to functions of their own: recorded as calls, and called again before a replay.

Such a function is reached by its dotted path, so that a module of that name stands for the test's in the replay.
"""
from __future__ import annotations

import sys
from collections.abc import Callable, Iterable
from contextlib import ExitStack
from dataclasses import dataclass
from functools import wraps
from types import FunctionType, ModuleType
from typing import Any

import s2sad
from s2sad.live_objects.registry import GIVEN
from tests.ledger.store import is_foreign

Call = tuple[str, tuple[Any, ...], dict[str, Any], Any, dict[str, Any], tuple[str, ...]]
"""The function of the interface, its arguments, what it decorated, what is reached by which paths in modules of tests,
and the paths of all functions to which it gave something."""


@dataclass(frozen=True)
class Registered:
    """The calls that gave derivatives, in order."""
    calls: list[Call]

    def recording(self) -> ExitStack:
        kept = ExitStack()
        for name in ("rule", "nondifferentiable"):
            inner = getattr(s2sad, name)
            setattr(s2sad, name, self._recorded(name, inner))
            kept.callback(setattr, s2sad, name, inner)
        return kept

    def _recorded(self, name: str, inner: Callable[..., Any]) -> Callable[..., Any]:
        @wraps(inner)
        def call(*args: Any, **keywords: Any) -> Any:
            before = dict(GIVEN.by_path)
            made = inner(*args, **keywords)
            if args and args[0] is not None:
                self._add(name, args, keywords, None, before)
                return made

            def decorated(function: Any) -> Any:
                before = dict(GIVEN.by_path)
                found = made(function)
                self._add(name, args, keywords, function, before)
                return found
            return decorated
        return call

    def _add(self, name: str, args: tuple[Any, ...], keywords: dict[str, Any], decorated: Any, before: dict[str, Any]
             ) -> None:
        added = [g for p, g in GIVEN.by_path.items() if before.get(p) is not g]
        paths = {g.path: g.function for made in added for g in (made, *made.reads)}
        given = tuple(paths)
        for value in keywords.values():
            if isinstance(value, FunctionType):
                paths[f"{value.__module__}.{value.__qualname__}"] = value
        paths = {p: f for p, f in paths.items() if is_foreign(p.rpartition(".")[0])}
        self.calls.append((name, args, keywords, decorated, paths, given))

    def reaching(self, paths: Iterable[str]) -> list[Call]:
        """The last calls that gave what is reached by these paths."""
        found = {path: k for k, call in enumerate(self.calls) for path in call[5]}
        return [self.calls[k] for k in sorted({found[p] for p in paths if p in found})]


def paths_of(functions: Iterable[Any]) -> set[str]:
    """The paths of those functions that have a derivative."""
    known = (GIVEN.by_identity.get(id(f)) for f in functions)
    return {g.path for g in known if g is not None}


def register(calls: Iterable[Call]) -> None:
    """Calls again what was recorded; the modules of tests are made of what is reached in them."""
    for name, args, keywords, decorated, paths, _ in calls:
        for path, function in paths.items():
            _reachable(path, function)
        made = getattr(s2sad, name)(*args, **keywords)
        if decorated is not None:
            made(decorated)


def _reachable(path: str, function: Any) -> None:
    module, _, last = path.rpartition(".")
    setattr(sys.modules.setdefault(module, ModuleType(module)), last, function)
