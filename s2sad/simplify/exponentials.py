"""exponentials: exponential and hyperbolic functions in a form that runs in vectors.

    for j in range(n):                          for j in range(n):
        hidden[j] = np.tanh(w[j] + b)               hidden[j] = tanh(w[j] + b)      (of s2sad.runtime)

A function's calls are replaced all or not at all: a number that is computed again has the same digits then, and a
branch that asks for it goes the same way. They are, if every loop around such a call is innermost and runs in vectors:
no branch, no other call than of what a processor has an instruction for, no number carried from one iteration to the
next but by `runtime.added`. Elsewhere a call of the system's library is faster.

Requires finished text for Numba and the types of its names; establishes the same values up to rounding.
"""
from __future__ import annotations

from collections.abc import Iterator, Mapping

from s2sad.infer.types import Type
from s2sad.simplify.bounds import changed, counted, is_straight, shifted_by, stores
from s2sad.tree import (
    AST, Assign, AugAssign, BinOp, Call, Constant, Div, For, FunctionDef, If, Name, Pow, Subscript, While, at, call,
    call_name, children, const, dump, indices, is_comment, names, rebuild, walk, with_body,
)

CHANGES_ROUNDING = True

_FUNCTIONS = {f"{room}.{f}": f"runtime.{f}" for room in ("numpy", "math") for f in ("exp", "expm1", "sinh", "cosh",
                                                                                    "tanh")}
_IN_VECTORS = {"runtime.added", "numpy.sqrt", "math.sqrt", "numpy.abs", "numpy.fabs", "math.fabs", "builtins.abs",
               "builtins.min", "builtins.max", "builtins.float", "builtins.range", "builtins.len"}


def exponentials(function: FunctionDef, types: Mapping[str, Type]) -> FunctionDef:
    """The function with the calls of each such function replaced, if that makes its loops faster."""
    slow: set[str] = set()
    found: set[str] = set()
    for node, loop in _calls(function, None):
        called = call_name(node) or ""
        found |= {called} if loop is not None else set()
        if loop is not None and not _in_vectors(loop) or not all(_is_double(types.get(n)) for n in _operands(node)):
            slow.add(called)
    chosen = {f: _FUNCTIONS[f] for f in found - slow}

    def change(node: AST) -> AST | None:
        if (inner := cosh_of_slope(node)) is not None and call_name(inner) in chosen:
            return at(call("runtime.sech_squared", *(rebuild(a, change) for a in inner.args)), node)
        called = call_name(node)
        if called not in chosen or not isinstance(node, Call):
            return None
        return at(call(chosen[called], *(rebuild(a, change) for a in node.args)), node)
    if not chosen:
        return function
    return with_body(function, rebuild(function.body, change))


def slope_of_tanh(argument: AST) -> AST:
    """The derivative of tanh: `(1.0 / np.cosh(argument)) ** 2`."""
    return BinOp(BinOp(const(1.0), Div(), call("numpy.cosh", argument)), Pow(), const(2))


def cosh_of_slope(node: AST) -> Call | None:
    """The call of cosh in the derivative of tanh; None for anything else."""
    quotient = node.left if isinstance(node, BinOp) and isinstance(node.op, Pow) else None
    if not isinstance(quotient, BinOp) or not isinstance(quotient.op, Div) or dump([quotient.left, node.right]) != dump(
            [const(1.0), const(2)]):
        return None
    return quotient.right if (call_name(quotient.right) or "").endswith(".cosh") else None


def _calls(node: AST, loop: AST | None) -> Iterator[tuple[AST, AST | None]]:
    """The calls of such functions, each with the innermost loop around it."""
    if call_name(node) in _FUNCTIONS:
        yield node, loop
    for child in children(node):
        yield from _calls(child, node if isinstance(node, (For, While)) else loop)


def _operands(node: AST) -> Iterator[str]:
    """The names whose values an expression is made of: not those of its indices."""
    if isinstance(node, Name):
        yield node.id
    inner = [node.value] if isinstance(node, Subscript) else node.args if isinstance(node, Call) else children(node)
    for child in inner:
        yield from _operands(child)


def _is_double(kind: Type | None) -> bool:
    return kind is not None and kind.dtype in ("float64", "int64")


def _in_vectors(loop: AST) -> bool:
    """Whether several iterations of a loop can run as one."""
    bounds = counted(loop)
    if bounds is None or not isinstance(loop, For) or not is_straight(loop.body) or any(
            isinstance(n, (If, For, While)) for n in walk(loop.body)):
        return False
    if any(call_name(n) not in _IN_VECTORS and call_name(n) not in _FUNCTIONS
           for n in walk(loop.body) if isinstance(n, Call)) or any(map(_is_power, walk(loop.body))):
        return False
    moving = {bounds.counter} | changed(loop.body)
    along = all(shifted_by(indices(s)[-1], bounds.counter) is not None and not moving & set(names(indices(s)[:-1]))
                for s in stores(loop.body))
    return along and not _carried(loop)


def _is_power(node: AST) -> bool:
    """Whether a node is a power that is not spelled as products."""
    return isinstance(node, BinOp) and isinstance(node.op, Pow) and not (
        isinstance(node.right, Constant) and isinstance(node.right.value, int))


def _carried(loop: For) -> bool:
    """Whether an iteration reads a name that the one before it bound, other than a sum that is added in any order."""
    bound: set[str] = set()
    waiting = changed(loop.body)
    for statement in loop.body:
        if is_comment(statement):
            continue
        assert isinstance(statement, (Assign, AugAssign))
        target = statement.target if isinstance(statement, AugAssign) else statement.targets[0]
        read = set(names(statement.value)) | (set(names(target)) if not isinstance(target, Name) else set())
        if isinstance(statement, AugAssign):
            read |= set(names(target))
        if call_name(statement.value) == "runtime.added" and isinstance(target, Name):
            read -= {target.id}
        if read & waiting - bound:
            return True
        bound |= {target.id} if isinstance(target, Name) else set()
    return False


__all__ = ["cosh_of_slope", "exponentials", "slope_of_tanh"]
