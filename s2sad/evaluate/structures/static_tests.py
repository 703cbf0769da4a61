"""What tests of one kernel are known to be while structures are taken apart.

    x if m is None else m * x  ->   m * x               (an argument that is not None)
    p.kind == "linear"         ->   True
    isinstance(m, np.ndarray)  ->   False               (an argument that is None)
"""
from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any

from s2sad.infer.types import NONE
from s2sad.evaluate.expressions.type_tests import QUESTIONS, asked
from s2sad.evaluate.structures.items import ItemValues, spoken
from s2sad.evaluate.structures.groups import StructureValue, Plain, Value, nothing
from s2sad.pytree import own_method
from s2sad.tree import (
    AST, And, Attribute, BoolOp, Call, Compare, Constant, Eq, Gt, GtE, IfExp, In, Is, IsNot, Lt, LtE, Name, Not, NotEq,
    NotIn, Subscript, UnaryOp, at, call_name, const,
)

NO = "is not supported in a kernel"
_ORDER: dict[type, Callable[[Any, Any], bool]] = {
    Eq: operator.eq, NotEq: operator.ne, Lt: operator.lt, LtE: operator.le, Gt: operator.gt, GtE: operator.ge}


class Decisions(ItemValues):
    """Tests that are decided by what the arguments are made of."""

    def decide(self, node: AST) -> bool | None:
        """What a test is that is known from what the arguments are made of; None if it is not."""
        if isinstance(node, Compare):
            return self._compared(node)
        if isinstance(node, UnaryOp) and isinstance(node.op, Not):
            inner = self.decide(node.operand)
            return None if inner is None else not inner
        if isinstance(node, BoolOp):
            return self._joined(node)
        if isinstance(node, Call):
            of_none = node.args and isinstance(node.args[0], (Name, Attribute, Subscript)) and call_name(
                node) in QUESTIONS and nothing(self.structural(node.args[0]))
            return asked(node, NONE) if of_none else None
        if isinstance(node, (Name, Attribute, Subscript)):
            found = self.structural(node)
            if isinstance(found, StructureValue):
                if own_method(found.form.made, "__bool__") or own_method(found.form.made, "__len__"):
                    self.refuse(node, f"the truth of {spoken(found)}, which its class defines",
                                "write out what is asked")
                return bool(found.items) or found.form.kind == "record"
            return False if found is not None and nothing(found) else None
        return None

    def _joined(self, node: BoolOp) -> bool | None:
        found = [self.decide(node.values[0])]
        stop = not isinstance(node.op, And)          # what decides an `or` is a True, an `and` a False
        for value in node.values[1:]:
            if found[-1] is None or found[-1] is stop:
                break
            found.append(self.decide(value))
        return None if None in found else stop if stop in found else not stop

    def _compared(self, node: Compare) -> bool | None:
        op, left, right = node.ops[0], node.left, node.comparators[0]
        if len(node.ops) == 1 and type(op) in _ORDER:
            one, other = self.key(left), self.key(right)
            return bool(_ORDER[type(op)](one, other)) if type(one) is type(other) and one is not None else None
        if len(node.ops) > 1 or not isinstance(op, (Is, IsNot, In, NotIn)):
            return None
        if isinstance(op, (In, NotIn)):
            group, key = self.structural(right), self.key(left)
            if isinstance(group, StructureValue) and group.form.kind in ("dict", "either") and key is not None:
                return (key in group.form.keys) is isinstance(op, In)
            self.refuse(node, f"'{'in' if isinstance(op, In) else 'not in'}' {NO}",
                        "write the comparisons out: " + ("x == a or x == b" if isinstance(op, In) else
                                                         "x != a and x != b"))
            return None
        operand = left if _is_none(right) else right
        if _is_none(operand):
            return isinstance(op, Is)
        return nothing(self.value(operand)) is isinstance(op, Is)

    def _test(self, node: AST) -> Value | None:
        """A comparison, a `not`, or an `and` or `or` some part of which is decided."""
        decided = self.decide(node)
        if decided is not None:
            return Plain(at(const(decided), node))
        if not isinstance(node, BoolOp):
            return None
        stop = not isinstance(node.op, And)
        kept: list[Value] = []
        for value in node.values:
            found = self.decide(value)
            if found is not None and found is not stop and (kept or value is not node.values[-1]):
                continue
            kept.append(self.value(value) if found is None else Plain(at(const(found), value)))
            if found is not None and found is stop:
                break
        if len(kept) == 1:
            return kept[0]
        parts = [self.plainly(v, n) for v, n in zip(kept, node.values)]
        return Plain(at(BoolOp(node.op, parts), node))

    def _choice(self, node: IfExp) -> Value | None:
        decided = self.decide(node.test)
        if decided is not None:
            return self.value(node.body if decided else node.orelse)
        arms = [self.structural(node.body), self.structural(node.orelse)]
        if any(isinstance(a, StructureValue) or a is not None and nothing(a) for a in arms):
            if arms[0] == arms[1]:
                return arms[0]
            self.refuse(node, "a structure or None is chosen by a test that is known only when the kernel runs",
                        "write an if with the whole work in each branch")
        return None


def _is_none(node: AST) -> bool:
    return isinstance(node, Constant) and node.value is None
