"""The fence around the supported language: every construct outside it, found and said, with what to write instead.

    fence.check(captured, report)    before names are resolved; puts one S201 per construct into the report

Nothing is looked at inside a construct that is refused (`opaque`): one message for it is enough.
"""
from __future__ import annotations

from collections.abc import Callable

from s2sad import tree
from s2sad.infer.bounded_arithmetic import BITS, is_bounded
from s2sad.diagnostics import Report
from s2sad.tree import AST

_NOT = "is not supported in a kernel"
_COMPREHENSION = "allocate an array before and fill it in a for loop"
_STRINGS = "write a plain string; print takes several values: print('step', i)"
_IMPORT = "move the import to the top of the function or of the module"
_ASYNC = "write a plain function with plain loops"

# construct: (what it is called, what to write instead)
_REFUSED = {
    "Try": ("try", "test for the bad case with an if before it happens; errors that are raised pass through"),
    "TryStar": ("try", "test for the bad case with an if before it happens; errors that are raised pass through"),
    "With": ("with", "open and lock outside the kernel, and give it the arrays as arguments"),
    "AsyncWith": ("async with", _ASYNC),
    "AsyncFor": ("async for", _ASYNC),
    "AsyncFunctionDef": ("async def", _ASYNC),
    "Await": ("await", _ASYNC),
    "Yield": ("yield", "write the values to an array argument, one element for each yield"),
    "YieldFrom": ("yield from", "write the values to an array argument, one element for each yield"),
    "Lambda": ("lambda", "give it a name and call it by that, give it to a call of a function, or write one with def"),
    "FunctionDef": ("a nested function", "define it once, outside of loops and branches, and call it or give it to a "
                    + "call; or write it at module level"),
    "ClassDef": ("a class", "pass what it would hold as arguments, numbers and arrays"),
    "Global": ("global", "return the new value, or keep it in an element of an array argument"),
    "Nonlocal": ("nonlocal", "return the new value, or keep it in an element of an array argument"),
    "Delete": ("del", "leave the line out: local arrays are freed when the kernel returns"),
    "Import": ("an import in a branch or loop, or of a name that is bound twice", _IMPORT),
    "ImportFrom": ("an import in a branch or loop, or of a name that is bound twice", _IMPORT),
    "Match": ("match", "write if, elif and else"),
    "TypeAlias": ("type", "move it to module level"),
    "SetComp": ("a set comprehension", _COMPREHENSION),
    "DictComp": ("a dict comprehension", _COMPREHENSION),
    "Dict": ("a dict", "use one name, or one array element, for each value"),
    "Set": ("a set", "use an array, or compare with each value in turn"),
    "JoinedStr": ("an f-string", _STRINGS),
    "TemplateStr": ("a t-string", _STRINGS),
    "NamedExpr": ("an assignment inside an expression (:=)", "write the assignment as a statement of its own before"),
    "Starred": ("a starred expression", "write the elements out, one by one"),
}


def opaque(node: AST) -> bool:
    """Whether the fence refuses the node as a whole, whatever is inside."""
    return type(node).__name__ in _REFUSED and not is_record(node)


def is_record(node: AST) -> bool:
    """Whether an expression is a dict whose keys are strings that are written out."""
    return type(node).__name__ == "Dict" and all(k is not None and _is_string(k) for k in node.keys)


def check(function: AST, report: Report) -> None:
    """Reports every construct of a function's parameters and body that is outside the supported language."""
    if type(function).__name__ == "AsyncFunctionDef":
        _refuse(function, report)
        return
    for star, starred in (("*", function.args.vararg), ("**", function.args.kwarg)):
        if starred is not None:
            report.error("S201", f"{star}{starred.id} {_NOT}", starred,
                         help="give each argument a parameter of its own")
    for statement in function.body:
        _visit(statement, report)


def _refuse(node: AST, report: Report) -> None:
    what, help = _REFUSED[type(node).__name__]
    if isinstance(node, tree.Starred) and isinstance(node.ctx, tree.Store):
        what, help = "a target with a star", "bind the others one by one, and take the rest by a slice: rest = x[1:]"
    report.error("S201", f"{what} {_NOT}", node, help=help)


def _visit(node: AST, report: Report) -> None:
    if opaque(node):
        _refuse(node, report)
        return
    seen = _CHECKS.get(type(node).__name__, lambda *_: None)(node, report)
    for child in tree.children(node) if seen is None else seen:
        _visit(child, report)


# -- checks: each may report, and may say which children are left to look at (None: all) ------------------------------

def _attribute(node: AST, report: Report) -> list[AST] | None:
    if isinstance(node.ctx, tree.Store) and _may_be_a_field(node):
        return None
    if isinstance(node.ctx, tree.Store):
        if node.attr == "shape":
            help = "bind the new shape to a new name: y = x.reshape(...)"
        else:
            help = "return the value, or write it to an element of an array argument"
        report.error("S201", f"an assignment to the attribute .{node.attr} {_NOT}", node, help=help)
        return []
    if _is_string(node.value):
        report.error("S201", f"a method of a string {_NOT}", node, help=_STRINGS)
        return []
    return None


def _may_be_a_field(node: AST) -> bool:
    """Whether an attribute that is assigned may be a field of a structure, which the evaluator knows."""
    base = node.value
    while isinstance(base, (tree.Attribute, tree.Subscript)):
        base = base.value
    return node.attr != "shape" and isinstance(base, tree.Name)


def _annotated(node: AST, report: Report) -> list[AST] | None:
    return [child for child in (node.target, node.value) if child is not None]


def _binary(node: AST, report: Report) -> list[AST] | None:
    if _is_string(node.left) or _is_string(node.right):
        report.error("S201", f"arithmetic on strings {_NOT}", node, help=_STRINGS)
        return []
    return None


def _is_string(node: AST) -> bool:
    return isinstance(node, tree.Constant) and isinstance(node.value, str)


def _call(node: AST, report: Report) -> list[AST] | None:
    for given in node.keywords:
        if given.arg is None:
            report.error("S201", f"** in a call {_NOT}", given.value, help="write the keyword arguments out")
    whole = isinstance(node.func, tree.Attribute) and node.func.attr == "ndindex" and len(node.args) == 1
    args = [a.value if whole and isinstance(a, tree.Starred) else a for a in node.args]     # np.ndindex(*x.shape)
    return [node.func, *args, *(given.value for given in node.keywords if given.arg is not None)]


def _comparison(node: AST, report: Report) -> list[AST] | None:
    for op, right in zip(node.ops, node.comparators):
        if isinstance(op, (tree.Is, tree.IsNot)) and not (len(node.ops) == 1 and _is_none(node.left, right)):
            word = "is not" if isinstance(op, tree.IsNot) else "is"
            report.error("S201", f"'{word}' {_NOT}", node,
                         help=f"compare values: {'!=' if word == 'is not' else '=='}")
        if isinstance(op, (tree.In, tree.NotIn)) and not (len(node.ops) == 1 and _is_string(node.left)):
            word = "not in" if isinstance(op, tree.NotIn) else "in"
            report.error("S201", f"'{word}' {_NOT}", node, help="write the comparisons out: x != a and x != b"
                         if word == "not in" else "write the comparisons out: x == a or x == b")
    return None


def _is_none(*nodes: AST) -> bool:
    return any(isinstance(n, tree.Constant) and n.value is None for n in nodes)


def _constant(node: AST, report: Report) -> list[AST] | None:
    if isinstance(node.value, bytes):
        report.error("S201", f"a bytes string {_NOT}", node, help="use an array of integers")
    elif not is_bounded(node.value):
        report.error("S201", f"an integer of more than {BITS} bits {_NOT}", node, help="write it as a float: 1e20")
    elif node.value is Ellipsis:
        report.error("S201", f"... {_NOT} except as x[...]", node, help="write x[...] for the whole array, or a loop")
    return None


def _assignment(node: AST, report: Report) -> list[AST] | None:
    if _is_range(node.value):
        report.error("S201", f"a name for a range {_NOT} where the range may change", node.value,
                     help="write the range where the loop is: for i in range(...)")
        return []
    return None


def _augmented(node: AST, report: Report) -> list[AST] | None:
    if isinstance(node.op, tree.MatMult):
        report.error("S201", f"'@=' of what a variable picks, or of a call, {_NOT}", node,
                     help="write into the array itself: a[k][...] = a[k] @ b")
        return []
    return None


def _is_range(node: AST | None) -> bool:
    if isinstance(node, tree.IfExp):
        return _is_range(node.body) or _is_range(node.orelse)
    return isinstance(node, tree.Call) and isinstance(node.func, tree.Name) and node.func.id == "range"


def _subscript(node: AST, report: Report) -> list[AST] | None:
    if _is_range(node.value):
        report.error("S201", f"a part of a range that depends on its length, or an item of a range, {_NOT}", node,
                     help="write its bounds: range(a, b, step)")
        return []
    if _is_string(node.value):
        report.error("S201", f"a subscript of a string {_NOT}", node, help=_STRINGS)
        return []
    return [node.value, *(part for item in tree.indices(node) for part in _parts(item))]


def _parts(item: AST) -> list[AST]:
    """What a subscript is made of: the bounds of a slice, nothing of `...` and of a new axis."""
    if isinstance(item, tree.Slice):
        return [part for part in (item.lower, item.upper, item.step) if part is not None]
    return [] if isinstance(item, tree.Constant) and item.value in (None, Ellipsis) else [item]


def _tuple(node: AST, report: Report) -> list[AST] | None:
    """A tuple may take in others: (*x.shape, 2)."""
    return [i.value if isinstance(i, tree.Starred) and isinstance(node.ctx, tree.Load) else i for i in node.elts]


_CHECKS: dict[str, Callable[[AST, Report], list[AST] | None]] = {
    "AnnAssign": _annotated, "Assign": _assignment, "AugAssign": _augmented, "Attribute": _attribute, "BinOp": _binary,
    "Call": _call, "Compare": _comparison, "Constant": _constant, "Subscript": _subscript, "Tuple": _tuple,
}
