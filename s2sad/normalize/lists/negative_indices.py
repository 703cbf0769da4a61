"""negative_indices: a place in a list that may be a negative number, which counts from the list's end.

    us[builtins.place(f_value, us_count)]       ->      us[f_value + us_count * (f_value < 0)]

`lists` writes the left form where finding the place is a call or a choice: it must run once, and where Python runs it.
`desugar` has run it before, under a name, and establishes the right form.
"""
from __future__ import annotations

from s2sad.tree import AST, BinOp, Call, Lt, Mult, add, at, call, call_name, compare, const, copy, rebuild

_PLACE = "builtins.place"


def place(found: AST, count: AST) -> Call:
    """A place in a list of so many elements that is found once."""
    return call(_PLACE, found, count)


def negative_indices(found: AST, count: AST) -> AST:
    """The place from the start, of a place whose text may stand twice."""
    return add(found, BinOp(count, Mult(), compare(copy(found), Lt(), const(0))))


def places_counted(tree: AST) -> AST:
    """The tree in which every such place is written out."""
    def change(node: AST) -> AST | None:
        if not isinstance(node, Call) or call_name(node) != _PLACE:
            return None
        found, count = (places_counted(a) for a in node.args)
        return at(negative_indices(found, count), node)
    return rebuild(tree, change)
