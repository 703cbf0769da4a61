"""overflow: where Python's integers grow and those of 64 bits overflow, the runtime checks; for Numba.

    def f(x: "float64[:]", level: int):     def f(x, level):
        h = 2 ** -level                         h = float(2) ** -level
        n = 1                                   n = 1
        for i in range(level):                  for i in range(level):
            n *= 2                                  n = whole_product(n, 2)
        return h * x[n]                         return h * x[n]

and

    scale = 2 ** level          scale = whole_power(2, level)       raises where the power is no integer of 64 bits
    mask + other                mask | other                        of arrays of bools, as NumPy has it
    np.fmod(i, n)               np.sign(i) * (np.abs(i) % np.abs(n))    Numba computes Python's %

Requires structured form and types. Establishes that integers of the compiled kernel are those of Python, or that it
raises. Sums of two single bools, and arithmetic of integers of less than 64 bits, which wraps around in NumPy, are
refused. For NumPy nothing changes, and sums of bools that may be Python's are refused (`bools`).
"""
from __future__ import annotations

from typing import Any

from s2sad.infer.bounded_arithmetic import operation
from s2sad.infer.inference import Typing, is_inverted
from s2sad.infer.signatures.laws import whole_number
from s2sad.normalize.context import NormalContext
from s2sad.normalize.dtypes.bools import bools
from s2sad.tree import (
    AST, Add, Assign, AugAssign, BinOp, BitAnd, BitOr, Constant, For, FunctionDef, If, Mod, Mult, Name, Pow, Sub, USub,
    UnaryOp, While, assign, at, call, call_name, children, copy, mult, name, names, rebuild, stored_names, times_bound,
    walk_statements,
)

_LARGE = object()
_NARROW = ("int8", "int16", "uint8", "uint16", "uint32", "uint64")


def overflow(function: FunctionDef, context: NormalContext) -> FunctionDef:
    """The function with such calls; what is refused is in the report of `typing`."""
    typing, compiled = context.typing, context.in_loops
    if not compiled:
        bools(function, typing)
        return function
    new, stored = copy(function), stored_names(function.body)
    parameters = {p.id for p in function.args.args if p.id not in stored and typing.of(p).is_number}
    made, stores = _Overflow(typing, parameters), times_bound(function.body)
    for node in walk_statements(function.body):
        if isinstance(node, Assign) and isinstance(node.targets[0], Name) and stores[node.targets[0].id] == 1:
            made.bound[node.targets[0].id] = made.known(node.value)
    new.body = made.block(new.body, False)
    return new


class _Overflow:
    """The pass over one function; `parameters` are its parameters that are numbers and never bound: Python's own."""

    def __init__(self, typing: Typing, parameters: set[str]):
        self.typing, self.parameters = typing, parameters
        self.bound: dict[str, int | object | None] = {}
        self.seen: dict[int, tuple[AST, int | object | None]] = {}     # by the id of a node, which is kept with it

    def block(self, block: list[AST], looped: bool) -> list[AST]:
        return [self.statement(s, looped) for s in block]

    def statement(self, node: AST, looped: bool) -> AST:
        if isinstance(node, For):
            return at(For(node.target, self.rewritten(node.iter), self.block(node.body, True), [], None), node)
        if isinstance(node, While):
            return at(While(self.rewritten(node.test), self.block(node.body, True), []), node)
        if isinstance(node, If):
            sides = self.block(node.body, looped), self.block(node.orelse, looped)
            return at(If(self.rewritten(node.test), *sides), node)
        target = node.target if isinstance(node, AugAssign) else node.targets[0] if isinstance(node, Assign) else None
        if isinstance(target, Name) and self.is_integer(target):
            word = target.id
            if isinstance(node, AugAssign) and isinstance(node.op, (Mult, Pow)):
                node = at(assign(word, BinOp(name(word), node.op, node.value)), node)
            if isinstance(node, Assign) and looped and word in names(node.value):
                node = at(assign(word, self.products(node.value)), node)
        return self.rewritten(node)

    def is_integer(self, node: AST) -> bool:
        kind = self.typing.of(node)
        return kind.is_number and kind.is_integer

    def are_integers(self, nodes: list[AST]) -> bool:
        """Whether the operands of a function of two are integers, or arrays of them."""
        return len(nodes) == 2 and all(self.typing.of(n).dtype.startswith(("int", "uint", "bool")) for n in nodes)

    def is_mask(self, node: AST) -> bool:
        kind = self.typing.of(node)
        return kind.is_array and kind.dtype == "bool"

    def rewritten(self, node: AST) -> AST:
        """An expression, or a simple statement, with calls for its powers, and masks joined as NumPy joins them."""
        def change(part: AST) -> AST | None:
            self.refuse_overflow(part)
            if call_name(part) == "builtins.float" and part.args and self.typing.of(part.args[0]).dtype == "bool":
                return at(call("builtins.float", call("builtins.int", rebuild(part.args[0], change))), part)
            if call_name(part) in ("math.fmod", "numpy.fmod") and self.are_integers(part.args):
                return at(_truncated(call_name(part) or "", [rebuild(a, change) for a in part.args]), part)
            if not isinstance(part, BinOp):
                return None
            whole = self.is_integer(part.left) and self.is_integer(part.right)
            if isinstance(part.op, (Add, Mult)) and self.is_mask(part.left) and self.is_mask(part.right):
                op = BitOr() if isinstance(part.op, Add) else BitAnd()
                return at(BinOp(rebuild(part.left, change), op, rebuild(part.right, change)), part)
            if not isinstance(part.op, Pow) or not whole:
                return None
            left, right = (rebuild(p, change) for p in (part.left, part.right))
            if is_inverted(part.right):
                return at(BinOp(call("builtins.float", left), Pow(), right), part)
            known = whole_number(part.right)
            return None if known is not None and 0 <= known <= 2 else at(call("runtime.whole_power", left, right), part)
        return rebuild(node, change)

    def products(self, node: AST) -> AST:
        def change(part: AST) -> AST | None:
            if not isinstance(part, BinOp) or not isinstance(part.op, Mult) or not self.is_integer(part):
                return None
            return at(call("runtime.whole_product", *(rebuild(p, change) for p in (part.left, part.right))), part)
        return rebuild(node, change)

    def known(self, node: AST) -> int | object | None:
        """The integer of 64 bits that an expression of constants is, `_LARGE` if it is another; None if it is no such
        expression."""
        if id(node) not in self.seen:
            self.seen[id(node)] = node, self._known(node)
        return self.seen[id(node)][1]

    def _known(self, node: AST) -> int | object | None:
        value: Any = None
        if isinstance(node, Constant):
            value = node.value
        elif isinstance(node, Name):
            value = self.typing.constants.get(node.id.removeprefix("const.")) if node.id.startswith(
                "const.") else self.bound.get(node.id)
        elif isinstance(node, (BinOp, UnaryOp)):
            parts = [self.known(p) for p in ([node.left, node.right] if isinstance(node, BinOp) else [node.operand])]
            try:
                value = operation(type(node.op).__name__, *parts) if all(type(p) is int for p in parts) else None
            except OverflowError:
                return _LARGE
            except (ArithmeticError, ValueError, KeyError):
                return None     # raised when it runs
        if value is _LARGE or type(value) is int and not -2 ** 63 <= value < 2 ** 63:
            return _LARGE
        return value if type(value) is int else None

    def refuse_overflow(self, node: AST) -> None:
        """Refuses what Numba computes otherwise."""
        if self.known(node) is _LARGE and not any(self.known(c) is _LARGE for c in children(node)):
            self.typing.report.error("S201", "an integer that does not fit 64 bits", node,
                                     help="write it as a float: 1e20")
        parts = [node.left, node.right] if isinstance(node, BinOp) and isinstance(node.op, (Add, Sub, Mult)) else [
            node.operand] if isinstance(node, UnaryOp) and isinstance(node.op, USub) else []
        kinds = [self.typing.of(p) for p in parts]
        narrow = next((k.dtype for k in kinds if k.dtype in _NARROW), "")
        if narrow and all(k.is_integer or k.is_array and not k.is_inexact for k in kinds):
            self.typing.report.error("S201", f"arithmetic of {narrow}, which wraps around", node,
                                     help="convert first: k.astype(np.int64), or int(k[i])")
        bools = len(kinds) == 2 and all(k.is_number and k.dtype == "bool" for k in kinds)
        if bools and isinstance(node.op, Add) and not set(names(node)) <= self.parameters:
            self.typing.report.error("S201", "the sum of two bools, which is a bool for NumPy's and a number for "
                                     "Python's", node, help="write int(a) + int(b), or a or b")


def _truncated(function: str, operands: list[AST]) -> AST:
    """The remainder of two integers that has the first one's sign."""
    a, b = operands
    if function == "math.fmod":
        return call(function, call("builtins.float", a), b)
    return mult(call("numpy.sign", a), BinOp(call("numpy.abs", copy(a)), Mod(), call("numpy.abs", b)))
