"""What loops over structures go through, while structures are taken apart: the items of a list or a dictionary are read
when their rounds come, those of a part of a list, or of a tuple that is written in the loop, before the first round.

    for v in us:             ->   for v in (builtins.next(us_0), builtins.next(us_1)):      (each_round)
        us[1] *= 2.0                  us_1[0] *= 2.0
        if v > 9.0: break             if v > 9.0: break
"""
from __future__ import annotations

from collections.abc import Iterable, Mapping

from s2sad.evaluate.argument_binding import user_call
from s2sad.evaluate.loops.late_reads import THROUGH, in_its_round, root
from s2sad.evaluate.structures.groups import StructureValue, Leaf, Plain, flat
from s2sad.tree import (
    AST, Assign, Attribute, AugAssign, Call, List, Name, Slice, Store, Subscript, Tuple, at, call_name, copy, names,
    rebuild, walk,
)

def written_leaves(nodes: Iterable[AST], env: Mapping[str, object]) -> set[str]:
    """The flat names of the structures of which statements may write parts."""
    found: set[str] = set()
    for node in walk(list(nodes)):
        if isinstance(node, (Subscript, Attribute)) and isinstance(node.ctx, Store):
            found.add(root(node))
        elif isinstance(node, AugAssign):
            found.add(root(node.target))
        elif isinstance(node, Assign) and isinstance(node.value, (Name, Attribute, Subscript)):
            found.add(root(node.value))                 # under another name it may be written, too
        elif isinstance(node, Call) and (user_call(node) is not None or isinstance(node.func, Attribute)):
            found |= set(names(node))
    groups = [v for n in found if isinstance(v := env.get(n), StructureValue)]
    return {leaf.name for group in groups for leaf in flat(group) if isinstance(leaf, Leaf)}


def is_of_its_own(iterable: AST) -> bool:
    """Whether what a loop goes through is made before the loop: a tuple or list that is written there, or a part."""
    return isinstance(iterable, (Tuple, List)) or isinstance(iterable, Subscript) and isinstance(iterable.slice, Slice)


def reads(value: Leaf | Plain, written: set[str]) -> bool:
    """Whether an item reads one of these flat names."""
    return bool(written & set(names(value.node) if isinstance(value, Plain) else [value.name]))


def late(node: AST, written: set[str]) -> AST:
    """An expression that reads these flat names when its round comes."""
    def change(n: AST) -> AST | None:
        cell = n.value if isinstance(n, Subscript) else n
        return in_its_round(n) if isinstance(cell, Name) and cell.id in written else None
    return rebuild(node, change)


def late_comprehension(node: AST, env: Mapping[str, object], plain) -> AST:
    """A comprehension that calls functions which may write what it goes through."""
    written = written_leaves([node.elt, *(i for g in node.generators for i in g.ifs)], env)

    def gone_through(iterable: AST) -> AST:
        if call_name(iterable) not in THROUGH:
            new = plain(iterable)
            return new if is_of_its_own(iterable) else late(new, written)
        new = copy(iterable)
        new.args = [gone_through(a) for a in iterable.args]
        return new
    new = copy(node)
    new.elt, new.generators = plain(node.elt), []
    for given in node.generators:
        made = copy(given)
        made.iter, made.ifs = at(gone_through(given.iter), given.iter), [plain(i) for i in given.ifs]
        made.target = plain(given.target)
        new.generators.append(made)
    return new
