"""Functions with a derivative of the user's own: each is reached by the name under which it can be imported.

In trees such a function is `given.<module>.<name>`; a generated file imports it from that module. A function is known
by its identity, so that another one of the same name is never taken for it.
"""
from __future__ import annotations

import importlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

ROOM = "given."


@dataclass(frozen=True, eq=False)
class RegisteredRule:
    """A function with the dotted path that it is imported by; `reads` are the functions that its partials call.

    `plain` is the Python function behind a compiled one, else the function itself; `ruled`: whether it has
    partials or is held fixed, so that it is called as it is. A function with a derivative of its `own` is read.
    """
    path: str
    function: Any
    plain: Any
    ruled: bool
    reads: tuple[RegisteredRule, ...] = ()
    own: RegisteredDerivative | None = None

    def reachable(self) -> bool:
        """Whether the path leads to this function, now."""
        found = imported(self.path)
        return found is not None and (found is self.function or getattr(found, "py_func", found) is self.plain)


@dataclass(frozen=True)
class RuleText:
    """The text of a user's derivative: the names that it mentions (None if the text is not known), those
    whose elements it stores to, how many values each return has (-1 where that cannot be seen), and which names it
    returns."""
    mentions: frozenset[str] | None = None
    stores: frozenset[str] = frozenset()
    counts: tuple[int, ...] = ()
    named: frozenset[str] = frozenset()

    def returns(self, count: int) -> bool:
        """Whether every return may have so many values; a single one also as a tuple."""
        return self.mentions is None or (not count and not any(self.counts)) or bool(self.counts) and all(
            c in (count, -1) for c in self.counts)

    def packs(self) -> bool:
        """Whether a single value is returned in a tuple."""
        return 1 in self.counts


@dataclass(frozen=True, eq=False)
class RegisteredDerivative:
    """A user's own derivative of the function `title`: `functions` of the user's by what they do ("adjoint", "tangent",
    "forward", "reverse", "solver"), or the `residual` that the function makes zero, with the name of the `solver` of
    the linear system. A function that is called as it is, and not read, is among them as "primal"; it `writes` these
    arguments and `returns` so many floats. It is `repeatable` if it does the same each time that its arguments are.

    `roles` says of each parameter of a function what it is: ("primal", its name), ("shadow", its primal's name),
    ("seed", its own name) or ("kept", ""); `texts` has what the text of each says, where it is known.
    """
    title: str
    functions: Mapping[str, RegisteredRule]
    roles: Mapping[str, tuple[tuple[str, str], ...]]
    texts: Mapping[str, RuleText]
    residual: Any = None
    solver: str = ""
    writes: tuple[str, ...] = ()
    returns: int = 0
    repeatable: bool = False

    def name(self, what: str) -> str:
        """The name in trees of one of the functions."""
        return ROOM + self.functions[what].path


def is_of_package(path: str) -> bool:
    """Whether a function is registered by this package, which changes nothing that was read before."""
    return path.startswith("s2sad.")


class Registry:
    """All registered functions, by path and by identity; `edition` grows with each registration of the user's."""

    def __init__(self) -> None:
        self.by_path: dict[str, RegisteredRule] = {}
        self.by_identity: dict[int, RegisteredRule] = {}  # holds the functions, so that no other gets their identity
        self.edition = 0

    def add(self, registered: RegisteredRule) -> RegisteredRule:
        self.edition += not is_of_package(registered.path)
        self.by_path[registered.path] = registered
        for value in (registered.function, registered.plain):
            self.by_identity[id(value)] = registered
        return registered

    def of(self, value: Any) -> RegisteredRule | None:
        """The registered function that a value is, if it has a derivative."""
        found = None if value is None else self.by_identity.get(id(value))
        return found if found is not None and found.ruled else None

    def own(self, value: Any) -> RegisteredDerivative | None:
        """The derivative of its own that a function has, if it is read."""
        found = None if value is None else self.by_identity.get(id(value))
        return None if found is None else found.own

    def named(self, path: str) -> RegisteredRule | None:
        """The registered function of a dotted path, if it has a derivative."""
        found = self.by_path.get(path)
        return found if found is not None and found.ruled else None

    def closure(self, paths: Iterable[str]) -> list[RegisteredRule]:
        """The registered functions of these paths and those that their partials call."""
        found: dict[str, RegisteredRule] = {}
        waiting = [self.by_path[p] for p in paths if p in self.by_path]
        while waiting:
            registered = waiting.pop()
            if registered.path not in found:
                found[registered.path] = registered
                waiting += registered.reads
        return list(found.values())


def imported(path: str) -> Any:
    """What `from module import name` gives for "module.name"; None if that fails."""
    module, _, last = path.rpartition(".")
    try:
        return getattr(importlib.import_module(module), last, None) if module else None
    except ImportError:
        return None


GIVEN = Registry()
