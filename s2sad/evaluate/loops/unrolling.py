"""unrolling: whether a loop over written numbers may stay one, over an array for each column, or is written out.

    for i, j, w in ((0, 1, 0.5), (1, 2, 0.7), ...):     for index in range(7):
        e += w * (x[i] - x[j]) ** 2                         i, j, w = i_items[index], j_items[index], w_items[index]
                                                            e += w * (x[i] - x[j]) ** 2

It may where no number is needed as it is written: as an axis, a size, the bound of a slice, the place of an item of a
tuple, the shift of an index that a counter is moved by, or where the places that are written tell that two parts of an
array are apart. What is asked for holds for every statement: what is not known to be fine is written out.
"""
from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy

from s2sad.infer.call_types import LISTED
from s2sad.evaluate.scope import KernelScope
from s2sad.read.outside_values import library_value
from s2sad.tree import (
    AST, Assert, Assign, Attribute, AugAssign, BinOp, BoolOp, Break, Call, Compare, Constant, Continue, Expr, For,
    FunctionDef, If, IfExp, List, Name, Pass, Pow, Return, Slice, Subscript, Tuple, UnaryOp, While, call_name, children,
    indices, names, stored_names, walk, walk_statements,
)

_ARITHMETIC = (BinOp, UnaryOp, Compare, BoolOp, IfExp)
_SCALAR = frozenset(f"builtins.{f}" for f in "abs min max float int range".split())
_LARGEST = 8            # as an exponent: powers of integers that are larger may not fit 64 bits
_MOST = 2 ** 20         # as a factor


class Rounds:
    """The statements of a loop in a function; `whole` are the integers that its targets go through, by their names."""

    def __init__(self, block: list[AST], whole: Mapping[str, list[Any]], function: FunctionDef, scope: KernelScope):
        self.block, self.whole, self.function, self.scope = block, whole, function, scope
        self.spelled = _spelled(function)
        self.static = self._counted(set(whole))
        self.parts = self._parts()

    def stay(self) -> bool:
        """Whether nothing needs the numbers as they are written."""
        large = any(abs(v) > _MOST for c in self.whole.values() for v in c)
        if large or set(stored_names(self.block)) & set(self.whole):
            return False
        return all(map(self._statement, self.block)) and all(map(self._rebound, carried(self.block)))

    def computed(self, target: str) -> bool:
        """Whether arithmetic is done with a number other than within an index."""
        within = {id(n) for s in walk(self.block) if isinstance(s, Subscript) for n in walk(s.slice)}
        return any(isinstance(n, Name) and n.id == target and id(n) not in within for n in walk(self.block))

    def _counted(self, found: set[str]) -> set[str]:
        """The names that stand for numbers that are computed from the integers."""
        while True:
            more = {n for s in walk_statements(self.block) if isinstance(s, (Assign, AugAssign))
                    and bare(s.value, found)
                    for t in (s.targets if isinstance(s, Assign) else [s.target]) if isinstance(t, Name)
                    for n in [t.id]} - found
            if not more:
                return found
            found = found | more

    def _parts(self) -> dict[str, AST]:
        """The names that may stand for parts of arrays, with what they were bound to."""
        found: dict[str, AST] = {}
        for s in walk(self.block):
            bound = s.targets[0] if isinstance(s, Assign) else None
            if isinstance(bound, Name) and (isinstance(s.value, Subscript) and self._told(s.value) or isinstance(
                    s.value, (Name, Subscript)) and set(names(s.value)) & set(found)):
                found[bound.id] = s.value
        return found

    def _told(self, node: AST) -> bool:
        return any(n in self.static for n in names(node))

    def _rebound(self, word: str) -> bool:
        """Whether what a round leaves for the next one is a number, or an array of one size; what begins as a number
        may become an array."""
        values = [s.value for s in walk_statements(self.block) if isinstance(s, Assign)
                  and word in stored_names(s.targets)]
        begun = any(isinstance(s, Assign) and isinstance(s.value, Constant) and word in stored_names(s.targets)
                    for s in walk_statements(self.function.body))
        known = {word, *self.whole}
        return all(isinstance(v, (*_ARITHMETIC, Constant)) or _is_elementwise(call_name(v)) for v in values) and not (
            begun and any(isinstance(n, Subscript) or isinstance(n, Name) and n.id not in known and "." not in n.id
                          for v in values for n in walk(v)))

    # -- statements --------------------------------------------------------------------------------------------------

    def _statement(self, node: AST) -> bool:
        if isinstance(node, (Assign, AugAssign)):
            targets = node.targets if isinstance(node, Assign) else [node.target]
            return self._expression(node.value) and all(self._target(t, node) for t in targets)
        if isinstance(node, (If, While)):
            return self._expression(node.test) and all(map(self._statement, [*node.body, *node.orelse]))
        if isinstance(node, For):
            return self._expression(node.iter) and all(map(self._statement, node.body))
        if isinstance(node, (Expr, Return)):
            return node.value is None or self._expression(node.value)
        return isinstance(node, (Break, Continue, Pass, Assert)) and not self._told(node)

    def _target(self, target: AST, statement: AST) -> bool:
        if isinstance(target, Name):
            return not (isinstance(statement, AugAssign) and target.id in self.parts)
        if not isinstance(target, Subscript) or set(names(target.value)) & {*self.parts, *self.spelled}:
            return False
        written = self.scope.memory.written([statement])
        return self._expression(target) and not any(
            self.scope.memory.affected(p, written) for p in self.parts.values() if isinstance(p, Subscript))

    # -- expressions -------------------------------------------------------------------------------------------------

    def _expression(self, node: AST) -> bool:
        called = call_name(node) or ""
        if called.startswith("user."):
            return self._call(node, called.removeprefix("user."))
        if isinstance(node, Subscript):
            return self._expression(node.value) and self._picked(node)
        if isinstance(node, _ARITHMETIC) or isinstance(node, Call) and (_is_elementwise(called) or called in _SCALAR):
            return self._power(node) and all(map(self._expression, _operands(node)))
        if isinstance(node, Name):
            return True
        return all(not (isinstance(c, _ARITHMETIC) and bare(c, self.static)) and not (
            isinstance(c, Name) and c.id in self.static) and self._expression(c) for c in children(node))

    def _power(self, node: AST) -> bool:
        if not isinstance(node, BinOp) or not isinstance(node.op, Pow) or not bare(node.right, self.static):
            return True
        values = [v for n in names(node.right) for v in self.whole.get(n, [_LARGEST + 1] if n in self.static else [])]
        return all(0 <= v <= _LARGEST for v in values)

    def _picked(self, node: Subscript) -> bool:
        """Whether an element is picked by the numbers alone, of an array."""
        told = [i for i in indices(node) if self._told(i)]
        base = node.value
        while isinstance(base, Subscript):
            base = base.value
        if told and (not isinstance(base, Name) or base.id in self.spelled):
            return False
        return all(self._place(i) for i in told)

    def _place(self, node: AST) -> bool:
        if isinstance(node, Subscript):
            return self._expression(node)
        if isinstance(node, (BinOp, UnaryOp)):
            return all(self._place(c) for c in _operands(node))
        return isinstance(node, Constant) or isinstance(node, Name) and (node.id in self.static or "." in node.id)

    def _call(self, node: Call, kernel: str) -> bool:
        given = [*node.args, *(k.value for k in node.keywords)]
        if not any(self._told(g) or set(names(g)) & set(self.parts) for g in given):
            return True
        if self.scope.memory.writes(kernel) or node.keywords or not all(map(self._expression, given)):
            return False
        callee = self.scope.program.kernels[kernel]
        taken = {p for p, g in zip(callee.parameters, node.args) if bare(g, self.static)}
        unknown = {p: [_LARGEST + 1] for p in taken}
        return not taken or Rounds(callee.tree.body, unknown, callee.tree, self.scope).stay()


def bare(node: AST, words: set[str]) -> bool:
    """Whether an expression has one of these names other than within an index."""
    if isinstance(node, Subscript):
        return bare(node.value, words)
    if isinstance(node, Name):
        return node.id in words
    return any(bare(c, words) for c in children(node))


def _spelled(function: FunctionDef) -> set[str]:
    """The names that stand for tuples and lists, as far as the text shows it."""
    found: set[str] = set()
    for s in walk_statements(function.body):
        if isinstance(s, Assign) and (isinstance(s.value, (Tuple, List)) or call_name(s.value) == LISTED):
            found |= set(stored_names(s.targets))
    return found


def carried(block: list[AST]) -> set[str]:
    """The names that are bound in a loop and may be read in a round before they are bound there."""
    bound = {n for s in walk_statements(block) if isinstance(s, Assign) for t in s.targets if isinstance(t, Name)
             for n in [t.id]}
    certain: set[str] = set()
    found: set[str] = set()
    for s in block:
        simple = isinstance(s, Assign)
        read = names(s.value) if simple else names(s)
        found |= (set(read) & bound) - certain
        certain |= {t.id for t in s.targets if isinstance(t, Name)} if simple else set()
    return found


def _operands(node: AST) -> list[AST]:
    if isinstance(node, Call):
        return [*node.args, *(k.value for k in node.keywords)]
    return [c for c in children(node) if isinstance(c, (Name, Constant, Subscript, Call, Attribute, Tuple, List, Slice,
                                                        *_ARITHMETIC))]


def _is_elementwise(called: str | None) -> bool:
    return (called or "").startswith(("math.", "scipy.special.")) or (called or "").startswith("numpy.") and isinstance(
        library_value(called or ""), numpy.ufunc)
