"""mgrid: NumPy's grids by slices are those of ranges.

    def f(x, n):
        i, j = np.mgrid[0:n, 0:n]
        return np.sum(x[:n] * i * j)
becomes

    def f(x, n):
        i, j = np.meshgrid(np.arange(0, n, 1), np.arange(0, n, 1), indexing="ij")
        return np.sum(x[:n] * i * j)

Requires resolved names. Establishes that no grid is made by slices; one that is not taken apart at once is an array of
its axes. A step that is an imaginary number is the number of points. All axes have one type: they are floats if one
bound is; where bounds are names, 0 times those of the other axes is added.
"""
from __future__ import annotations

from s2sad.evaluate.scope import KernelScope
from s2sad.infer.signatures.laws import whole_number
from s2sad.tree import (
    AST, Assign, Attribute, BinOp, Constant, Div, FunctionDef, List, Load, Mult, Name, Slice, Subscript, Tuple, USub,
    UnaryOp, add, at, call, call_name, children, const, copy, dump, index, indices, keyword, mult, rebuild, tuple_of,
    walk, with_body,
)

_OPEN, _FULL, _AXES = "numpy.ogrid", "numpy.mgrid", "numpy.meshgrid"


def mgrid(function: FunctionDef, scope: KernelScope) -> FunctionDef:
    """The function without such grids; other ones are refused."""
    apart = {id(n.value) for n in walk(function.body) if isinstance(n, Subscript) and whole_number(n.slice) is not None
             or isinstance(n, Assign) and isinstance(n.targets[0], (Tuple, List))}

    def change(node: AST) -> AST | None:
        if not isinstance(node, Subscript) or not isinstance(node.value, Name) or node.value.id not in (_OPEN, _FULL):
            return None
        made = _grid(node)
        if made is not None and call_name(made) == _AXES and id(node) not in apart:
            made = call("numpy.array", List([index(copy(made), const(k)) for k in range(len(made.args))], Load()))
        if made is None:
            scope.refuse(node, f"a grid by np.{node.value.id[6:]} of other slices than one to three with ends",
                         help="write np.meshgrid(x, y, indexing='ij'), of ranges that have names")
        return None if made is None else at(made, node)
    return with_body(function, [rebuild(statement, change) for statement in function.body])


def _grid(node: Subscript) -> AST | None:
    slices = [s for s in indices(node) if isinstance(s, Slice) and s.upper is not None]
    if len(slices) != len(indices(node)) or not 1 <= len(slices) <= 3:
        return None
    counted = [_point_count(s) for s in slices]
    if any(c is not None and not isinstance(c, int) for c in counted):
        return None
    floats = any(k is not None for k in counted) or any(isinstance(n, Constant) and isinstance(
        n.value, float) for s in slices for n in walk(s))
    axes = [_axis(s, c, floats) if floats else _promoted_axis(s, slices) for s, c in zip(slices, counted)]
    if not isinstance(node.slice, Tuple):
        return axes[0]
    if node.value.id == _OPEN:
        whole = Slice(None, None, None)
        return tuple_of(*(index(a, *[whole if j == k else const(None) for j in range(len(axes))])
                          for k, a in enumerate(axes))) if len(axes) > 1 else None
    if len(axes) == 1:
        return None
    grid = call(_AXES, *axes)
    grid.keywords = [keyword("indexing", const("ij"))]
    return grid


def _point_count(part: Slice) -> int | float | None:
    """The number of points of a slice, its imaginary step; None if the step is real."""
    step = part.step.operand if isinstance(part.step, UnaryOp) and isinstance(part.step.op, USub) else part.step
    value = step.value if isinstance(step, Constant) else None
    if not isinstance(value, complex):
        return None
    return int(value.imag) if value.imag == int(value.imag) and value.real == 0.0 else value.imag


def _promoted_axis(part: AST, slices: list[AST]) -> AST:
    """An axis of bounds that are names: it is of floats if one of another axis is."""
    made, own = _axis(part, None, False), {dump(n) for n in children(part)}
    for bound in (b for other in slices for b in children(other)):
        if dump(bound) not in own and not isinstance(bound, Constant) and not _is_integer(bound):
            own.add(dump(bound))
            made = add(made, mult(const(0), copy(bound)))
    return made


def _is_integer(bound: AST) -> bool:
    """Whether a bound is an integer, as its text shows."""
    if isinstance(bound, BinOp):
        return not isinstance(bound.op, Div) and _is_integer(bound.left) and _is_integer(bound.right)
    if isinstance(bound, UnaryOp):
        return _is_integer(bound.operand)
    shape = bound.value if isinstance(bound, Subscript) else bound
    return call_name(bound) == "builtins.len" or isinstance(shape, Attribute) and shape.attr in (
        "shape", "size") or isinstance(bound, Constant) and isinstance(bound.value, int)


def _axis(part: AST, count: int | float | None, floats: bool) -> AST:
    start, step = part.lower or const(0), part.step or const(1)
    if count is not None:
        return call("numpy.linspace", start, part.upper, const(count))
    made = call("numpy.arange", start, part.upper, step)
    return BinOp(made, Mult(), const(1.0)) if floats else made
