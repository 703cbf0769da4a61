"""expressions: the printing of expressions: minimal parentheses, and the places where a line may end."""
from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any

import astunparse
import numpy as np

from s2sad import tree
from s2sad.emit.line_breaking import BREAK, Pieces
from s2sad.emit.literals import needs_numpy, number, quoted, text_parts
from s2sad.emit.dotted_names import spell

# What binds loosest first; an operand is put in parentheses where it binds looser than its place asks.
TUPLE, TEST, OR, AND, NOT, COMPARE, BIT_OR, BIT_XOR, BIT_AND, SHIFT, SUM, TERM, SIGN, POWER, ATOM = range(15)
_LEVELS = {
    "Tuple": TUPLE, "IfExp": TEST, "Or": OR, "And": AND, "Not": NOT, "Compare": COMPARE, "BitOr": BIT_OR,
    "BitXor": BIT_XOR, "BitAnd": BIT_AND, "LShift": SHIFT, "RShift": SHIFT, "Add": SUM, "Sub": SUM, "Mult": TERM,
    "MatMult": TERM, "Div": TERM, "Mod": TERM, "FloorDiv": TERM, "Invert": SIGN, "UAdd": SIGN, "USub": SIGN,
    "Pow": POWER,
}


class Expressions(astunparse.Unparser):
    """Prints expressions as pieces of the current line, `items`; dotted names as `names` says."""

    items: list
    names: Mapping[str, str]
    depth = 0

    def write(self, text: str) -> None:
        self.items.append(text)

    @contextmanager
    def group(self, kind: str, opening: str = "", closing: str = "") -> Iterator[None]:
        outer, group = self.items, Pieces(kind, [], opening, closing)
        self.items = group.items
        self.depth += 1
        yield
        self.depth -= 1
        group.close()
        self.items = outer
        outer.append(group if group.items else opening + closing)

    def dispatch(self, tree: Any, level: int = TEST) -> None:
        """Print a node, in parentheses if it binds looser than `level`."""
        if self.level(tree) < level:
            with self.group("brackets", "(", ")"):
                getattr(self, "_" + type(tree).__name__)(tree)
        else:
            getattr(self, "_" + type(tree).__name__)(tree)

    @staticmethod
    def level(node: tree.AST) -> int:
        """How tightly a node binds."""
        if isinstance(node, tree.Constant):
            return SIGN if number(node.value).startswith("-") else ATOM
        if isinstance(node, tree.Tuple):
            return TUPLE if node.elts else ATOM
        operator = getattr(node, "op", None)
        return _LEVELS.get(type(node if operator is None else operator).__name__, ATOM)

    def operand(self, node: tree.AST, level: int) -> None:
        """A part of an expression, kept on one line for as long as the whole can be broken elsewhere."""
        if isinstance(node, (tree.Name, tree.Constant)):
            self.dispatch(node, level)
        else:
            with self.group("plain"):
                self.dispatch(node, level)

    def bare(self, node: tree.AST) -> None:
        """An expression that may be put in parentheses to break it, a tuple without its own."""
        with self.group("optional"):
            if isinstance(node, tree.Tuple) and node.elts:
                self._Tuple(node)
            else:
                self.dispatch(node)

    def listed(self, nodes: list[tree.AST]) -> None:
        for position, node in enumerate(nodes):
            if position:
                self.items += [",", BREAK]
            self.operand(node, TEST)

    def _Name(self, node: tree.Name) -> None:
        self.write(spell(node.id, self.names))

    def _Constant(self, node: tree.Constant) -> None:
        value = node.value
        if isinstance(value, str):
            parts = text_parts(value)
            self.items.append(Pieces("text", parts, quoted(value)) if len(parts) > 1 else quoted(value))
        elif isinstance(value, (float, np.floating)) and not np.isfinite(value):
            self.write("-" if value < 0 else "")
            self.write(spell("numpy.nan" if value != value else "numpy.inf", self.names))
        elif needs_numpy(value):
            assert isinstance(value, np.generic)  # Python's own inf and nan are above
            self.write(f"{spell(f'numpy.{value.dtype.name}', self.names)}({value!s})")
        else:
            self.write(number(value))

    def _BinOp(self, node: tree.BinOp) -> None:
        level = self.level(node)
        if level == POWER:
            chain, first, first_level, right_level = [node], node.left, ATOM, SIGN
        else:
            # a - b + c leans to the left: one row of operands, however long
            chain, first, first_level, right_level = [], node, level, level + 1
            while isinstance(first, tree.BinOp) and self.level(first) == level:
                chain.append(first)
                first = first.left
        self.operand(first, first_level)
        for link in reversed(chain):
            self.items += [f" {self.binop[type(link.op).__name__]}", BREAK]
            self.operand(link.right, right_level)

    def _BoolOp(self, node: tree.BoolOp) -> None:
        word = " and" if isinstance(node.op, tree.And) else " or"
        for position, value in enumerate(node.values):
            if position:
                self.items += [word, BREAK]
            self.operand(value, self.level(node) + 1)

    def _Compare(self, node: tree.Compare) -> None:
        self.operand(node.left, COMPARE + 1)
        for operator, right in zip(node.ops, node.comparators):
            self.items += [f" {self.cmpops[type(operator).__name__]}", BREAK]
            self.operand(right, COMPARE + 1)

    def _UnaryOp(self, node: tree.UnaryOp) -> None:
        if isinstance(node.op, tree.Not):
            self.write("not ")
            self.dispatch(node.operand, NOT)
        else:
            self.write(self.unop[type(node.op).__name__])
            self.dispatch(node.operand, SIGN)

    def _IfExp(self, node: tree.IfExp) -> None:
        self.operand(node.body, OR)
        self.items += [BREAK, "if "]
        self.operand(node.test, OR)
        self.items += [BREAK, "else "]
        self.operand(node.orelse, TEST)

    def _Tuple(self, node: tree.Tuple) -> None:
        self.listed(node.elts)
        if len(node.elts) < 2:
            self.write("," if node.elts else "()")

    def _List(self, node: tree.List) -> None:
        with self.group("brackets", "[", "]"):
            self.listed(node.elts)

    def _Starred(self, node: tree.Starred) -> None:
        self.write("*")
        self.dispatch(node.value, BIT_OR)

    def _Attribute(self, node: tree.Attribute) -> None:
        if isinstance(node.value, tree.Constant) and not isinstance(node.value.value, str):
            with self.group("brackets", "(", ")"):  # 1.real is no attribute
                self.dispatch(node.value)
        else:
            self.dispatch(node.value, ATOM)
        self.write(f".{node.attr}")

    def _Call(self, node: tree.Call) -> None:
        self.dispatch(node.func, ATOM)
        with self.group("brackets", "(", ")"):
            self.listed([*node.args, *node.keywords])

    def _Subscript(self, node: tree.Subscript) -> None:
        self.dispatch(node.value, ATOM)
        index = node.slice
        with self.group("brackets", "[", "]"):
            if isinstance(index, tree.Tuple) and not any(isinstance(item, tree.Starred) for item in index.elts):
                self._Tuple(index)
            else:
                self.dispatch(index)

    def _Slice(self, node: tree.Slice) -> None:
        for position, bound in enumerate((node.lower, node.upper, node.step)):
            if position == 1 or position == 2 and bound is not None:
                self.write(":")
            if bound is not None:
                self.dispatch(bound)
