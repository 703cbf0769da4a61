"""statement_order: whether a nest of loops may run behind a statement that follows it.

    for i in range(n):              y = a.T @ v
        x[i] = v[i]                 for i in range(n):
    y = a.T @ v                         x[i] = v[i]

*Requires* that names stand for different memory. A statement is crossed if it neither writes what the nest mentions nor
reads what the nest writes, does nothing else, and all that it mentions are numbers and arrays of memory of their own.
"""
from __future__ import annotations

from collections.abc import Mapping, Set

from s2sad.infer.types import Type
from s2sad.liveness import base_name, read_names, touched
from s2sad.optimize.loop_bounds import bound_names, stored_elements
from s2sad.optimize.loop_nests import Nest
from s2sad.tree import (
    AST, Assert, Assign, Attribute, AugAssign, Call, For, If, Name, call_name, is_comment, walk, walk_statements,
)

_PURE = ("numpy.", "math.", "builtins.")


def may_move_behind(nest: Nest, statement: AST | Nest, own: Set[str], types: Mapping[str, Type]) -> bool:
    """Whether a nest may move behind a statement, or behind another nest; `own` are the arrays that have memory of
    their own."""
    crossed = statement.with_body(statement.body) if isinstance(statement, Nest) else statement
    if is_comment(crossed):
        return True
    stored = {base_name(t) for t in stored_elements(nest.body)}
    bound = bound_names(nest.body)
    if isinstance(crossed, Assert):
        sizes = {id(n.value) for n in walk(crossed) if isinstance(n, Attribute)}
        return not {n.id for n in walk(crossed) if isinstance(n, Name) and id(n) not in sizes} & (bound | stored)
    counters = {s.target.id for s in walk_statements(crossed) if isinstance(s, For)}     # no loop leaves them behind
    written, read = touched(crossed) - counters, read_names(crossed) - counters
    mentioned = {n.lstrip("=") for n in read_names(nest.with_body(nest.body))} - {*nest.counters} | stored | bound
    return (_is_plain(crossed) and not written & mentioned and not read & (stored | bound)
            and not (written | read) & {*nest.counters} and not counters & (mentioned | bound)
            and all(_is_known(n.lstrip("="), own, types) for n in written | read))


def _is_plain(statement: AST) -> bool:
    """Whether a statement only binds and stores: what it calls has no other effects."""
    kinds = (Assign, AugAssign, For, If)
    return all(isinstance(s, kinds) or is_comment(s) for s in walk_statements(statement)) and all(
        (call_name(n) or "").startswith(_PURE) and not n.keywords for n in walk(statement) if isinstance(n, Call))


def _is_known(identifier: str, own: Set[str], types: Mapping[str, Type]) -> bool:
    """Whether a name is that of an array of its own, or of a number."""
    return identifier in own or identifier in types and types[identifier].is_number


__all__ = ["may_move_behind"]
