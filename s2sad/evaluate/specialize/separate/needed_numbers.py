"""needed_numbers: the numbers that a function does more with than to compute.

    def f(u, k, p):
        return k * u ** p           ->      p, by which derivatives are simpler

A size, an option, an index, an end of a slice, an exponent, what an integer is compared with, and a test of nothing
but such numbers are part of the function's text.
"""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from s2sad import tree
from s2sad.evaluate.specialize.separate.returned_parts import is_separate
from s2sad.read.outside_values import library_value
from s2sad.tree import AST

_COMPUTED = (tree.Add, tree.Sub, tree.Mult, tree.Div)


def needed_numbers(body: Sequence[AST], numbers: Mapping[str, Any], picks: bool = False) -> set[str]:
    """Those of some names that statements use in such places; `numbers` are their values. Where it `picks`, an index is
    no such place, and neither is a target."""
    found: set[str] = set()
    if numbers:
        for s in body:
            _statement(tree.rebuild(s, _picked) if picks else s, numbers, found)
    return found


def _picked(node: AST) -> AST | None:
    """What is picked by numbers, or bound, without these."""
    if isinstance(node, tree.Subscript) and not any(isinstance(n, (tree.Slice, tree.Call)) for n in tree.walk(
            node.slice)):
        return tree.Subscript(tree.rebuild(node.value, _picked), tree.const(0), node.ctx)
    return tree.name("") if isinstance(node, tree.Name) and isinstance(node.ctx, tree.Store) else None


def _statement(s: Any, numbers: Mapping[str, Any], found: set[str]) -> None:
    for name, value in vars(s).items():
        for child in value if isinstance(value, list) else [value]:
            if not isinstance(child, AST):
                continue
            if isinstance(child, tree.stmt):
                _statement(child, numbers, found)
            elif name == "iter" and isinstance(child, tree.Call) and getattr(child.func, "id", "") == "range":
                for a in child.args:
                    _expression(a, True, numbers, found)
            else:
                _expression(child, name == "value", numbers, found)


def _expression(node: Any, computes: bool, numbers: Mapping[str, Any], found: set[str]) -> None:
    if isinstance(node, tree.Name):
        if node.id in numbers and not computes:
            found.add(node.id)
        return
    if isinstance(node, tree.BinOp):
        _expression(node.left, computes and isinstance(node.op, (*_COMPUTED, tree.Pow)), numbers, found)
        _expression(node.right, computes and isinstance(node.op, _COMPUTED), numbers, found)
    elif isinstance(node, tree.Compare):
        operands = [node.left, *node.comparators]
        own = {n.id for o in operands for n in tree.walk(o) if isinstance(n, tree.Name)}
        is_open = not own <= numbers.keys()
        found |= {n for n in own if type(numbers.get(n)) is int}
        for o in operands:
            _expression(o, is_open, numbers, found)
    elif isinstance(node, tree.IfExp):
        _expression(node.test, False, numbers, found)
        for branch in (node.body, node.orelse):
            _expression(branch, computes, numbers, found)
    elif isinstance(node, tree.Call):
        elementwise = is_separate(node) or _is_elementwise(node)
        for a in node.args:
            _expression(a, computes and elementwise, numbers, found)
        for k in node.keywords:
            _expression(k.value, False, numbers, found)
        if not isinstance(node.func, tree.Name):
            _expression(node.func, False, numbers, found)
    elif isinstance(node, tree.Subscript):
        _expression(node.value, computes, numbers, found)
        _expression(node.slice, False, numbers, found)
    else:
        keeps = isinstance(node, (tree.UnaryOp, tree.Tuple))
        for child in tree.children(node):
            _expression(child, computes and keeps, numbers, found)


def _is_elementwise(call: AST) -> bool:
    path = tree.call_name(call) or ""
    return path.startswith("math.") or path.startswith("numpy.") and getattr(library_value(path), "nin", 0) > 0
