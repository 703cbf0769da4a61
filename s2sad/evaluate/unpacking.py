"""unpacking: the guard that an array or a list has as many items as there are targets.

    a, b = x        assert len(x) == 2, "..."
                    a = x[0]
                    b = x[1]
"""
from __future__ import annotations

from s2sad.tree import GUARD, AST, Assert, Constant, Eq, call, compare, const, copy

ITEMS = "unpacked into another number of names than it has items"


def item_count(value: AST, count: int) -> Assert:
    """The guard for a value that may be written several times."""
    return Assert(compare(call("builtins.len", copy(value)), Eq(), const(count)), Constant(ITEMS, GUARD))
