"""weak_types: which numbers have a dtype for NumPy, and which are weak: Python's own, which take that of arrays.

    s = a + p[0]        `p[0]` of an array of float64 is an np.float64: with a float32 array it gives float64
    s = a + 0.5         a Python float: the sum has the dtype of `a`

Requires structured form and types. Arguments are weak, unless `parameters` has a dtype for them. Establishes the dtype
of each number, "" for a weak one.
"""
from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from s2sad import rules
from s2sad.infer.inference import Typing
from s2sad.infer.promotion import CASTS, RANKS
from s2sad.tree import (
    AST, Assign, AugAssign, BinOp, BoolOp, Call, Div, FunctionDef, IfExp, List, Name, Not, Subscript, Tuple,
    UnaryOp, call_name, walk,
)

Results = Callable[[Call, list[str]], "tuple[str, ...]"]    # of a kernel's call, for what its numbers are
WEAK = ""
_OF_PYTHON = ("builtins.float", "builtins.int", "builtins.bool", "builtins.len", "numpy.size", "numpy.ndim",
              "numpy.shape", "numpy.count_nonzero")
_ONE_OF = ("builtins.abs", "builtins.max", "builtins.min", "builtins.round")


def promoted_dtype(dtypes: list[str]) -> str:
    """NumPy's promotion of the dtypes that are not weak."""
    known = [d for d in dtypes if d in RANKS]
    return np.result_type(*known).name if known else WEAK


class StrongDtypes:
    """The dtypes of the numbers of one function, "" for Python's own."""

    def __init__(self, function: FunctionDef, typing: Typing, results: Results,
                 parameters: Mapping[str, str] | None = None):
        self.typing, self.results = typing, results
        self.table: dict[str, str] = dict(parameters or {})
        before: dict[str, str] | None = None
        while before != self.table:
            before = dict(self.table)
            for node in walk(function.body):
                self.note_bindings(node)

    def note_bindings(self, node: AST) -> None:
        """Enters what a statement binds; of several bindings one with a dtype decides."""
        target = node.targets[0] if isinstance(node, Assign) else node.target if isinstance(node, AugAssign) else None
        if isinstance(target, Name) and self.typing.of(target).is_number:
            value = BinOp(target, node.op, node.value) if isinstance(node, AugAssign) else node.value
            self.bind(target, self.of(value))
        elif isinstance(target, Tuple) and isinstance(node.value, Call):
            for item, dtype in zip(target.elts, self.of_call(node.value)):
                self.bind(item, dtype)

    def bind(self, target: AST, dtype: str) -> None:
        if isinstance(target, Name) and (both := promoted_dtype([self.table.get(target.id, WEAK), dtype])):
            self.table[target.id] = both

    def of(self, node: AST) -> str:
        """The dtype of an expression for NumPy, "" for a weak number."""
        kind = self.typing.of(node)
        if kind.is_array:
            return kind.dtype
        if isinstance(node, Name):
            room, _, rest = node.id.partition(".")
            held = self.typing.constants.get(rest) if room == "const" else None
            return held.dtype.name if isinstance(held, np.generic) else self.table.get(node.id, WEAK)
        if isinstance(node, Subscript):
            return kind.dtype if self.typing.of(node.value).is_array else WEAK
        if isinstance(node, UnaryOp):
            return WEAK if isinstance(node.op, Not) else self.of(node.operand)
        if isinstance(node, BinOp):
            return self.of_operands([node.left, node.right], isinstance(node.op, Div))
        if isinstance(node, (IfExp, BoolOp)):
            values = [node.body, node.orelse] if isinstance(node, IfExp) else node.values
            return promoted_dtype(list(map(self.of, values)))
        return self.of_number(node) if isinstance(node, Call) else WEAK

    def of_operands(self, nodes: list[AST], floats: bool = False) -> str:
        """The dtype of a result of these operands: a weak float makes floats of strong integers."""
        found = promoted_dtype(list(map(self.of, nodes)))
        weak = any(self.typing.of(n).is_float and not self.of(n) for n in nodes)
        return "float64" if found.startswith(("int", "uint", "bool")) and (weak or floats) else found

    def of_number(self, node: Call) -> str:
        """The dtype of a call whose result is a number."""
        called, kind = call_name(node) or "", self.typing.of(node)
        if called.startswith("user."):
            return next(iter(self.of_call(node)), WEAK)
        rounded = called == "builtins.round" and len(node.args) == 1
        if called in _OF_PYTHON or rounded or called.startswith(("math.", "given.")):
            return WEAK
        if called in CASTS:
            return CASTS[called]
        if called in _ONE_OF:
            return promoted_dtype(list(map(self.of, node.args)))
        strong = self.of_operands(node.args) if not any(self.typing.of(a).is_array for a in node.args) else WEAK
        same = rules.result_kind(called) in ("same", "float") and strong.startswith("float")
        return strong if same else kind.dtype

    def of_call(self, node: Call) -> tuple[str, ...]:
        return self.results(node, list(map(self.of, node.args)))

    def item(self, node: AST) -> str:
        """The dtype of an item of an array display: Python's numbers have one there, too."""
        if isinstance(node, (Tuple, List)):
            return promoted_dtype(list(map(self.item, node.elts)))
        return self.of(node) or self.typing.of(node).dtype


