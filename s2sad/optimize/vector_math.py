"""vector_math: exponential and hyperbolic functions become those of the runtime, which vectorize.

    def f(x: float64[:], y: float64[:]):
        for i in range(y.size):
            y[i] = np.exp(x[i])

in its adjoint:

    def f_adjoint(...):
        for i in range(y.size):
            ...
            x_bar[i] += np.exp(x[i]) * seed if seed != 0.0 else 0.0

becomes

    def f_adjoint(...):
        for i in range(y.size):
            ...
            x_bar[i] += exp(x[i]) * seed if seed != 0.0 else 0.0

*Requires* finished text for Numba and the types of its names. *Establishes* the same values up to rounding. All calls
of a function are replaced or none, those in `system_math` never: a recomputed number then has the same digits, and a
branch on it goes the same way.
They are, if every loop around such a call is innermost and vectorizable: no branch, no call that is not an instruction
of the processor, no scalar carried from one iteration to the next but by `runtime.added`. Elsewhere a call of the
system's library is faster.
"""
from __future__ import annotations

from collections.abc import Iterator

from s2sad.infer.types import Type
from s2sad.optimize.loop_bounds import bound_names, counted_loop, is_along, is_loop_free, stored_elements
from s2sad.simplify.context import DerivativeContext
from s2sad.tree import (
    AST, Assign, AugAssign, BinOp, Call, Constant, Div, For, FunctionDef, If, Name, Pow, Subscript, While, at, call,
    call_name, children, const, dump, indices, is_comment, names, rebuild, walk, walk_statements, with_body,
)

CHANGES_ROUNDING = True

_FUNCTIONS = {f"{library}.{f}": f"runtime.{f}" for library in ("numpy", "math")
              for f in ("exp", "expm1", "sinh", "cosh", "tanh")}
_VECTOR_INSTRUCTIONS = {"runtime.added", "numpy.sqrt", "math.sqrt", "numpy.abs", "numpy.fabs", "math.fabs",
                        "builtins.abs",
               "builtins.min", "builtins.max", "builtins.float", "builtins.range", "builtins.len"}


def vector_math(function: FunctionDef, context: DerivativeContext) -> FunctionDef:
    """The function with the calls of each such function replaced, if that makes its loops faster."""
    types = context.types
    slow: set[str] = set()
    found: set[str] = set()
    for node, loop in _calls_in_loops(function, None):
        called = call_name(node) or ""
        found |= {called} if loop is not None else set()
        double = all(_is_double(types.get(n)) for n in _operands(node)) and not any(
            isinstance(n, Constant) and isinstance(n.value, complex) for n in walk(node))
        if loop is not None and not _is_vectorizable(loop) or not double:
            slow.add(called)
    chosen = {f: _FUNCTIONS[f] for f in found - slow - context.system_math}
    context.called_math = {call_name(n) or "": call_name(n) in chosen for n, _ in _calls_in_loops(function, None)}

    def change(node: AST) -> AST | None:
        if (inner := cosh_of_tanh_derivative(node)) is not None and call_name(inner) in chosen:
            return at(call("runtime.sech_squared", *(rebuild(a, change) for a in inner.args)), node)
        called = call_name(node)
        if called not in chosen or not isinstance(node, Call):
            return None
        return at(call(chosen[called], *(rebuild(a, change) for a in node.args)), node)
    if not chosen:
        return function
    return with_body(function, rebuild(function.body, change))


def tanh_derivative(argument: AST) -> AST:
    """The derivative of tanh: `(1.0 / np.cosh(argument)) ** 2`."""
    return BinOp(BinOp(const(1.0), Div(), call("numpy.cosh", argument)), Pow(), const(2))


def cosh_of_tanh_derivative(node: AST) -> Call | None:
    """The call of cosh in the derivative of tanh; None for anything else."""
    quotient = node.left if isinstance(node, BinOp) and isinstance(node.op, Pow) else None
    if not isinstance(quotient, BinOp) or not isinstance(quotient.op, Div) or dump([quotient.left, node.right]) != dump(
            [const(1.0), const(2)]):
        return None
    return quotient.right if (call_name(quotient.right) or "").endswith(".cosh") else None


def _calls_in_loops(node: AST, loop: AST | None) -> Iterator[tuple[AST, AST | None]]:
    """The calls of such functions, each with the innermost loop around it."""
    if call_name(node) in _FUNCTIONS:
        yield node, loop
    for child in children(node):
        yield from _calls_in_loops(child, node if isinstance(node, (For, While)) else loop)


def _operands(node: AST) -> Iterator[str]:
    """The names whose values an expression reads, those in its subscripts aside."""
    if isinstance(node, Name):
        yield node.id
    inner = [node.value] if isinstance(node, Subscript) else node.args if isinstance(node, Call) else children(node)
    for child in inner:
        yield from _operands(child)


def _is_double(kind: Type | None) -> bool:
    return kind is not None and kind.dtype in ("float64", "int64")


def _is_vectorizable(loop: AST) -> bool:
    """Whether several iterations of a loop can run as one."""
    bounds = counted_loop(loop)
    if bounds is None or not isinstance(loop, For) or not is_loop_free(loop.body) or any(
            isinstance(n, (If, For, While)) for n in walk_statements(loop.body)):
        return False
    if any(call_name(n) not in _VECTOR_INSTRUCTIONS and call_name(n) not in _FUNCTIONS
           for n in walk(loop.body) if isinstance(n, Call)) or any(map(_is_power, walk(loop.body))):
        return False
    moving = {bounds.counter} | bound_names(loop.body)
    along = all(is_along(indices(s)[-1], bounds.counter, moving) and not moving & set(names(indices(s)[:-1]))
                for s in stored_elements(loop.body))
    return along and not _has_carried_name(loop)


def _is_power(node: AST) -> bool:
    """Whether a node is a power that is not expanded into products."""
    return isinstance(node, BinOp) and isinstance(node.op, Pow) and not (
        isinstance(node.right, Constant) and isinstance(node.right.value, int))


def _has_carried_name(loop: For) -> bool:
    """Whether an iteration reads a name that the one before it bound, other than a sum in free order."""
    bound: set[str] = set()
    waiting = bound_names(loop.body)
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


__all__ = ["cosh_of_tanh_derivative", "vector_math", "tanh_derivative"]
