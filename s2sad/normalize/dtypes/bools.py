"""bools: arithmetic of single bools is refused for NumPy where they may be Python's and come back as NumPy's.

    n = (x[i] > 0.5) + (x[j] > 0.5)         stays: both are NumPy's, of elements
    b, c = c, b                             is refused: what is recorded comes back as NumPy's bool,
    y = x * (b + b)                         of which the sum is a bool, and Python's is 2

Requires structured form and types. Names of bools that are bound once, outside of loops, are never recorded.
"""
from __future__ import annotations

from s2sad.infer.inference import Typing
from s2sad.tree import (
    AST, Add, Assign, BinOp, Compare, For, FunctionDef, Invert, Name, Store, Sub, Subscript, USub, UnaryOp, While,
    call_name, names, stored_names, walk, walk_statements,
)


def bools(function: FunctionDef, typing: Typing) -> None:
    """Refuses such arithmetic, in the report of `typing`."""
    certain = _PythonBools(function, typing)
    for node in walk(function.body):
        parts = [node.left, node.right] if isinstance(node, BinOp) and isinstance(node.op, (Add, Sub)) else [
            node.operand] if isinstance(node, UnaryOp) and isinstance(node.op, (Invert, USub)) else []
        if parts and all(typing.of(p).is_number and typing.of(p).dtype == "bool" for p in parts) and not all(
                map(certain.keeps_type, parts)):
            what = "sum" if isinstance(node, BinOp) and isinstance(node.op, Add) else "difference" if isinstance(
                node, BinOp) else "negative" if isinstance(node.op, USub) else "inverse"
            whose = "a bool" if len(parts) == 1 else "two bools"
            typing.report.error("S201", f"the {what} of {whose}, which is a bool for NumPy's and a number for Python's",
                                node, help="write int(a) + int(b), or a or b" if len(parts) == 2 else "write not a")


class _PythonBools:
    """Which bools of one function are restored from the tape with the type that they had."""

    def __init__(self, function: FunctionDef, typing: Typing):
        self.typing, self.parameters = typing, {p.id for p in function.args.args}
        looped = [s for n in walk_statements(function.body) if isinstance(n, (For, While)) for s in n.body]
        bound = [n.id for n in walk(function.body) if isinstance(n, Name) and isinstance(n.ctx, Store)]
        self.moving = {w for w in set(bound) if bound.count(w) > 1} | set(stored_names(looped))
        self.values: dict[str, list[AST]] = {}
        for node in walk_statements(function.body):
            if isinstance(node, Assign) and isinstance(node.targets[0], Name):
                self.values.setdefault(node.targets[0].id, []).append(node.value)

    def keeps_type(self, node: AST) -> bool:
        """Whether a bool is NumPy's, or is never recorded."""
        if isinstance(node, Name):
            values = self.values.get(node.id, [])
            return node.id not in self.moving or bool(values) and all(
                not isinstance(v, Name) and self.is_numpy_bool(v) for v in values)
        return self.is_numpy_bool(node) or not any(isinstance(n, Subscript) for n in walk(node)) and not set(
            names(node)) & self.moving

    def is_numpy_bool(self, node: AST) -> bool:
        """Whether an expression compares elements of arrays, or picks one of an array that is no list of bools."""
        if isinstance(node, Subscript):
            word = node.value.id if isinstance(node.value, Name) and self.typing.of(node.value).is_array else ""
            made = self.values.get(word, [])
            return bool(word) and (self.typing.of(node).dtype != "bool" or word in self.parameters or bool(
                made) and not any(call_name(v) == "numpy.empty" for v in made))
        return isinstance(node, (Compare, BinOp, UnaryOp)) and any(
            self.is_numpy_bool(n) for n in walk(node) if isinstance(n, Subscript))
