"""integers: what Python's integers do and those of 64 bits do not is asked of the runtime, for Numba.

    scale = 2 ** level          scale = whole_power(2, level)       raises where the power is no integer of 64 bits
    h = 2 ** -level             h = float(2) ** -level
    fact *= n                   fact = whole_product(fact, n)       in a loop: raises where it does not fit
    mask + other                mask | other                        of arrays of bools, as NumPy has it

Requires structured form and types. Sums of two single bools, and arithmetic of integers of few bits, which wraps around
in NumPy, are refused.
"""
from __future__ import annotations

from s2sad.infer.infer import Typing, is_inverted
from s2sad.infer.laws import whole_number
from s2sad.tree import (
    AST, Add, Assign, AugAssign, BinOp, BitAnd, BitOr, Constant, For, FunctionDef, If, Mult, Name, Pow, Sub, UnaryOp,
    USub, While, assign, at, call, copy, name, names, rebuild,
)

_NARROW = ("int8", "int16", "uint8", "uint16", "uint32", "uint64")


def integers(function: FunctionDef, typing: Typing) -> FunctionDef:
    """The function with such calls."""
    new = copy(function)
    new.body = _block(new.body, typing, False)
    return new


def _block(block: list[AST], typing: Typing, looped: bool) -> list[AST]:
    return [_statement(s, typing, looped) for s in block]


def _statement(node: AST, typing: Typing, looped: bool) -> AST:
    if isinstance(node, For):
        return at(For(node.target, _changed(node.iter, typing), _block(node.body, typing, True), [], None), node)
    if isinstance(node, While):
        return at(While(_changed(node.test, typing), _block(node.body, typing, True), []), node)
    if isinstance(node, If):
        return at(If(_changed(node.test, typing), *(_block(b, typing, looped) for b in (node.body, node.orelse))), node)
    target = node.target if isinstance(node, AugAssign) else node.targets[0] if isinstance(node, Assign) else None
    if isinstance(target, Name) and _is_whole(target, typing):
        word = target.id
        if isinstance(node, AugAssign) and isinstance(node.op, (Mult, Pow)):
            node = at(assign(word, BinOp(name(word), node.op, node.value)), node)
        if isinstance(node, Assign) and looped and word in names(node.value):
            node = at(assign(word, _products(node.value, typing)), node)
    return _changed(node, typing)


def _is_whole(node: AST, typing: Typing) -> bool:
    kind = typing.of(node)
    return kind.is_number and kind.is_integer


def _changed(node: AST, typing: Typing) -> AST:
    def change(part: AST) -> AST | None:
        _refuse(part, typing)
        if isinstance(part, BinOp) and isinstance(part.op, (Add, Mult)) and all(
                typing.of(p).is_array and typing.of(p).dtype == "bool" for p in (part.left, part.right)):
            op = BitOr() if isinstance(part.op, Add) else BitAnd()
            return at(BinOp(rebuild(part.left, change), op, rebuild(part.right, change)), part)
        if not isinstance(part, BinOp) or not isinstance(part.op, Pow) or not (
                _is_whole(part.left, typing) and _is_whole(part.right, typing)):
            return None
        left, right = (rebuild(p, change) for p in (part.left, part.right))
        if is_inverted(part.right):
            return at(BinOp(call("builtins.float", left), Pow(), right), part)
        known = whole_number(part.right)
        return None if known is not None and known >= 0 else at(call("runtime.whole_power", left, right), part)
    return rebuild(node, change)


def _refuse(node: AST, typing: Typing) -> None:
    """Puts what Numba computes otherwise into the report."""
    word = node.id if isinstance(node, Name) else ""
    value = typing.constants.get(word.removeprefix("const.")) if word.startswith("const.") else getattr(
        node, "value", None) if isinstance(node, Constant) else None
    if type(value) is int and not -2 ** 63 <= value < 2 ** 63:
        typing.report.error("S201", "an integer that does not fit 64 bits", node, help="write it as a float: 1e20")
    parts = [node.left, node.right] if isinstance(node, BinOp) and isinstance(node.op, (Add, Sub, Mult)) else [
        node.operand] if isinstance(node, UnaryOp) and isinstance(node.op, USub) else []
    kinds = [typing.of(p) for p in parts]
    narrow = next((k.dtype for k in kinds if k.dtype in _NARROW), "")
    if narrow and all(k.is_integer for k in kinds):
        typing.report.error("S201", f"arithmetic of {narrow}, which wraps around", node,
                            help="convert first: k.astype(np.int64), or int(k[i])")
    if len(kinds) == 2 and isinstance(node.op, Add) and all(k.is_number and k.dtype == "bool" for k in kinds):
        typing.report.error("S201", "the sum of two bools, which is a bool for NumPy's and a number for Python's", node,
                            help="write int(a) + int(b), or a or b")


def _products(node: AST, typing: Typing) -> AST:
    def change(part: AST) -> AST | None:
        if not isinstance(part, BinOp) or not isinstance(part.op, Mult) or not _is_whole(part, typing):
            return None
        return at(call("runtime.whole_product", *(rebuild(p, change) for p in (part.left, part.right))), part)
    return rebuild(node, change)
