"""views_without_axes: numbers that are views of an array's element in NumPy, which follow what is stored there.

    c = x[0, ...]       np.squeeze(x[:1])       np.reshape(x[:1], ())

`x[0]` is a number of its own, and so is each of these here: `view_aliases` refuses stores that would show it.
"""
from __future__ import annotations

from collections.abc import Iterable, Mapping

from s2sad.infer.inference import Typing
from s2sad.infer.signatures.laws import whole_number
from s2sad.liveness import targets
from s2sad.normalize.context import NormalContext
from s2sad.tree import (
    AST, Assign, AugAssign, BoolOp, Call, Constant, FunctionDef, IfExp, List, Name, Return, Subscript, Tuple, call_name,
    indices, user_call, walk, walk_statements,
)

_VIEW_FUNCTIONS = {f"numpy.{f}" for f in (
    "transpose", "reshape", "ravel", "flip", "fliplr", "flipud", "rot90", "asarray", "ascontiguousarray", "squeeze",
    "swapaxes", "moveaxis", "expand_dims", "atleast_1d", "atleast_2d", "atleast_3d", "broadcast_to", "diagonal", "diag",
    "split", "array_split", "hsplit", "vsplit", "real", "imag", "lib.stride_tricks.sliding_window_view")}
WITHOUT_AXES = "a view without axes, x[0, ...] or np.squeeze(x[:1])"
ELEMENT = "take the element, x[0], or a number: float(...)"


def makes_view(node: AST) -> bool:
    """Whether a call may give a view of its first argument, or that itself, as the first power of a matrix is (a
    constant one is spelled so)."""
    power = call_name(node) == "numpy.linalg.matrix_power" and whole_number(node.args[1]) is None
    return isinstance(node, Call) and bool(node.args) and (call_name(node) in _VIEW_FUNCTIONS or power)


def views_without_axes(function: FunctionDef, typing: Typing) -> dict[str, set[str]]:
    """The names that may be such a view, or a view of one with axes, and the names that each may be one of."""
    found: dict[str, set[str]] = {}
    same: dict[str, set[str]] = {}
    for statement in walk(function.body):
        if not isinstance(statement, Assign) or not isinstance(statement.targets[0], Name):
            continue
        bound = statement.targets[0].id
        for value in (_without_axes(v, typing) for v in _alternatives(statement.value)):
            if views_element(value, typing):
                found.setdefault(bound, set()).add(viewed(value))
            elif isinstance(value, Name) and typing.of(value).is_number:
                same.setdefault(value.id, set()).add(bound)
    waiting = [n for n in found if n in same]
    while waiting:
        for other in same.pop(n := waiting.pop(), ()):
            found.setdefault(other, set()).add(n)
            waiting.append(other)
    return found


def refuse_listed(function: FunctionDef, context: NormalContext, views: Mapping[str, set[str]]) -> None:
    """Refuses such a view in a display of an array where what it is a view of may be written: a list that is sorted has
    become such a display, and holds the view itself in Python; `views` are the names that are views, with of what."""
    stored = {viewed(t) for s in walk_statements(function.body) for t in targets(s)
              if isinstance(t, Subscript) or isinstance(s, AugAssign)}
    stored |= {viewed(a) for n in walk(function.body) if user_call(n) for a in n.args}
    for node in walk(function.body):
        if call_name(node) == "numpy.array" and isinstance(node.args[0], (List, Tuple)):
            for item in node.args[0].elts:
                above, more = set[str](), {viewed(item)} if views_element(item, context.typing) or isinstance(
                    item, Name) and item.id in views else set()
                while more - above:
                    above |= more
                    more = {m for n in more for m in views.get(n, ())}
                if above & stored:
                    context.report.error("S201", f"{WITHOUT_AXES}, and it or its array is written", item, help=ELEMENT)


def refuse_elsewhere(function: FunctionDef, context: NormalContext, links: Mapping[str, Iterable[str]]) -> None:
    """Refuses such a view where another function may write it or its array: given to one that adds to it in place, or
    of an argument and returned to one; `links` are the names that each may be a view of."""
    typing, kernels = context.typing, context.program.kernels
    names, arguments = views_without_axes(function, typing), {p.id for p in function.args.args}

    def is_view(node: AST) -> bool:
        return isinstance(node, Name) and node.id in names or views_element(node, typing)

    def outlives(node: AST) -> bool:
        return is_view(node) and not arguments.isdisjoint({viewed(node), *links.get(viewed(node), ())})
    for node in walk(function.body):
        kernel = kernels.get(user_call(node) or "")
        if kernel is not None and isinstance(node, Call):
            added = {s.target.id for s in walk_statements(kernel.tree.body)
                     if isinstance(s, AugAssign) and isinstance(s.target, Name)}
            if any(p.id in added and is_view(a) for p, a in zip(kernel.tree.args.args, node.args)):
                context.report.error("S201", f"{WITHOUT_AXES}, is given to a function that adds to it in place", node,
                                     help=ELEMENT)
        if isinstance(node, Return) and node.value is not None and context.kernel.name != context.program.entry:
            parts = node.value.elts if isinstance(node.value, Tuple) else [node.value]
            if any(outlives(a) for part in parts for a in _alternatives(part)):
                context.report.error("S201", f"{WITHOUT_AXES}, is returned to another function", node, help=ELEMENT)


def _alternatives(value: AST) -> list[AST]:
    """The expressions of which a value is one: those that it chooses from, itself if it chooses from none."""
    if call_name(value) in ("builtins.max", "builtins.min"):
        parts = [n for a in value.args for n in (a.elts if isinstance(a, (List, Tuple)) else [a])]
    elif not isinstance(value, (IfExp, BoolOp)):
        return [value]
    else:
        parts = [value.body, value.orelse] if isinstance(value, IfExp) else value.values
    return [n for part in parts for n in _alternatives(part)]


def _without_axes(node: AST, typing: Typing) -> AST:
    """What a view is one of that has no axes; else what is below all functions."""
    while makes_view(node) and not views_element(node, typing):
        node = node.args[0]
    return node


def views_element(node: AST, typing: Typing) -> bool:
    """Whether an expression is such a view."""
    open_ended = isinstance(node, Subscript) and any(
        isinstance(s, Constant) and s.value is Ellipsis for s in indices(node))
    viewed = node.value if open_ended else node.args[0] if makes_view(node) else None
    return viewed is not None and typing.of(node).is_number and (
        typing.of(viewed).is_array or views_element(viewed, typing))


def viewed(node: AST) -> str:
    """The name that a value is a part or a view of; "" for what is none."""
    while isinstance(node, Subscript) or makes_view(node):
        node = node.value if isinstance(node, Subscript) else node.args[0]
    return node.id if isinstance(node, Name) else ""
