"""list_arrays: the array in place of a list, as `normalize/lists/growing.py` leaves it in the tree.

    us = []                     us = list(us_count)             allocated once the sizes of its rows are known
    us.append(v)                us[:us_count + 1][us_count] = v

Where it is not known how long a list becomes, its array doubles where it is full (`RESERVE`).

Rows that are lists or tuples themselves, and no arrays, are marked as such (`MARKS`).
"""
from __future__ import annotations

from collections.abc import Iterable

from s2sad.tree import (
    AST, Assign, Constant, FunctionDef, Name, Slice, Subscript, call_name, const, index, walk, walk_statements,
)

LISTED = "builtins.list"
_FIRST = 16
RESERVE = "builtins.list.reserve"
MARKS = {"builtins.list.copy": "list", "builtins.tuple": "tuple"}


def has_list_arrays(function: FunctionDef) -> bool:
    """Whether there are arrays in place of lists in a function."""
    return any(call_name(n) == LISTED for n in walk(function.body))


def list_arrays(function: FunctionDef) -> dict[str, Assign]:
    """The arrays in place of lists, each with its allocation."""
    return {s.targets[0].id: s for s in walk_statements(function.body) if is_list_allocation(s)}


def is_list_allocation(statement: AST) -> bool:
    """Whether a statement allocates an array in place of a list."""
    return (isinstance(statement, Assign) and isinstance(statement.targets[0], Name)
            and call_name(statement.value) == LISTED)


def growing_capacity(items: int) -> Constant:
    """The first size of an array that doubles when it is full: `list(16, True)`."""
    return const(max(_FIRST, 2 * items))


def grows(allocation: Assign) -> bool:
    """Whether an array in place of a list doubles when it is full."""
    return len(allocation.value.args) > 1 and allocation.value.args[1].value is True


def is_reused(allocation: Assign) -> bool:
    """Whether places of an array in place of a list are filled again, when the list is shorter: `list(n, False, True)`.
    """
    return len(allocation.value.args) > 2


def filled_part(listed: AST, count: AST) -> AST:
    """The part of the array that has elements, of which a store writes the last or an earlier one."""
    return index(listed, Slice(None, count, None))


def stored_list(target: AST, listed: Iterable[str]) -> str:
    """The list that a store appends to, or of which it writes an element; "" for any other."""
    inner = target.value if isinstance(target, Subscript) else None
    inner = inner.value if isinstance(inner, Subscript) and isinstance(inner.slice, Slice) else inner
    return inner.id if isinstance(inner, Name) and inner.id in listed else ""
