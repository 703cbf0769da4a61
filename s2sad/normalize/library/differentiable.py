"""differentiable: whatever computes with numbers or arrays has a derivative rule, or a derivative that is zero.

    def f(u: "float64[:]"):
        v = np.partition(u, 2)
        return v[0]

refused: no derivative rule for numpy.partition

Requires structured form and types; changes nothing. Establishes that no float passes through an operation without a
rule: what the analyses find no rule for is inactive.
"""
from __future__ import annotations

from s2sad import rules
from s2sad.liveness import targets
from s2sad.diagnostics import Report
from s2sad.infer.inference import Typing
from s2sad.infer.list_arrays import RESERVE
from s2sad.normalize.context import NormalContext
from s2sad.normalize.dtypes.operand_types import OperandTypes
from s2sad.normalize.library.expansions.stacked_products import product_expansion
from s2sad.live_objects.registry import ROOM
from s2sad.rules.operation import operation
from s2sad.rules.composed import LAW as COMPOSED
from s2sad.tree import (
    AST, Assert, Assign, Attribute, AugAssign, Call, Constant, Expr, FunctionDef, Raise, Subscript, UnaryOp, USub,
    call_name, children, walk,
)

_COPIES = frozenset({"numpy.copy", "numpy.asarray", "numpy.ascontiguousarray", "numpy.array"})
# allocations, properties, and what is no computation at all
_ALLOCATING = frozenset({
    "numpy.empty", "numpy.zeros", "numpy.ones", "numpy.full", "numpy.empty_like", "numpy.zeros_like", "numpy.ones_like",
    "numpy.full_like", "numpy.shape", "builtins.range"}) | _COPIES
# functions of whole arrays whose derivative is zero, or that `expand` expands; others without an adjoint are for the
# text of derivatives
_ZERO_DERIVATIVE = frozenset({"numpy.argsort", "runtime.det_sign", "runtime.extreme_mask", "numpy.broadcast_to",
                   "runtime.sparse_rows", "runtime.sparse_span", "runtime.sparse_joined"})
_SUMS = ("numpy.sum",)
_OPTIONS = {**dict.fromkeys(("numpy.empty", "numpy.zeros", "numpy.ones"), ("shape", "dtype", "order")),
            **dict.fromkeys(("numpy.empty_like", "numpy.zeros_like", "numpy.ones_like"), ("dtype", "order")),
            "numpy.full": ("shape", "fill_value", "dtype", "order"),
            "numpy.full_like": ("fill_value", "dtype", "order"), **dict.fromkeys(_COPIES, ("dtype", "order"))}
_REDUCED = ("numpy.argmax", "numpy.argmin", "numpy.count_nonzero", "numpy.any", "numpy.all")
_HELP = {
    "numpy.squeeze": "name the axis: np.squeeze(x, axis=0), or write x[0]",
    "numpy.histogram": "give numbers with one axis, and a number of bins or an array of edges",
    "numpy.compress": "give a condition with one axis",
    "numpy.partition": "write np.sort(x), whose order is determined",
    "scipy.linalg.qr.triangular": "of a stack write np.linalg.qr(a, mode='r'): SciPy gives it without a tuple",
    "numpy.setdiff1d": "give two arrays of integers, without assume_unique=",
    "numpy.delete": "leave out the elements at an integer, a list or an array of integers, or a mask",
    "numpy.insert": "insert at one place, into floats: a number, or along an axis a row",
    "numpy.ix_": "write x[rows][:, columns]",
    "numpy.linalg.solve": "give both the same leading axes: stacks of as many matrices, or one matrix of two axes",
    "numpy.linalg.cond": "divide the largest of np.linalg.svd(a, compute_uv=False) by the smallest",
    "numpy.linalg.svd": "write full_matrices=False: the vectors beyond the smaller size are not determined",
    "numpy.linalg.qr": "write q, r = np.linalg.qr(a), in the reduced mode",
    "numpy.linalg.eig": "write np.linalg.eigh for a symmetric matrix: other ones have complex eigenvalues",
    "numpy.linalg.eigvals": "write np.linalg.eigvalsh for a symmetric matrix: other ones have complex eigenvalues",
    "scipy.special.logsumexp": "without b= and return_sign=: write s + np.log(np.sum(b * np.exp(a - s))) with "
    "s = np.max(a)",
    "numpy.nanmean": "write np.mean(x[~np.isnan(x)])", "numpy.split": "bind each section to a name: a, b = np.split(x, "
    "2)", "numpy.array_split": "bind each section to a name: a, b = np.array_split(x, 2)",
}
_TYPES = "entries and operands are arrays of floats, rows and columns arrays of integers"
_SPARSE = {
    **dict.fromkeys(("runtime.sparse_product", "runtime.sparse_left_product"),
                    ("the product of a sparse matrix with an operand of this type", _TYPES)),
    "runtime.sparse_solve": ("solving with a sparse matrix of this type", _TYPES),
    **dict.fromkeys(("runtime.sparse_dense", "runtime.sparse_diagonal"), ("a sparse matrix of this type", _TYPES))}
_LOOP = "write it as a loop over the elements"
_OTHERS = "write it with functions that have a rule, or give it one: s2sad.rule, s2sad.nondifferentiable"

_PROPERTIES = ("shape", "size", "ndim", "dtype", "T")


def differentiable(function: FunctionDef, context: NormalContext) -> None:
    """Refuses each operation without a rule, with one diagnostic."""
    typing, report = context.typing, context.report
    counted = OperandTypes(function, typing, report)
    for statement in function.body:
        _visit(statement, typing, report, counted)


def _visit(node: AST, typing: Typing, report: Report, counted: OperandTypes) -> None:
    if isinstance(node, (Assert, Raise)) or isinstance(node, Expr) and call_name(node.value) in (
            "builtins.print", RESERVE):
        return
    before = len(report.found)
    method = node.func.value if isinstance(node, Call) and isinstance(node.func, Attribute) else None
    for child in children(node):
        _visit(child if method is None or child is not node.func else method, typing, report, counted)
    if len(report.found) > before:
        return  # what is refused inside explains it
    if isinstance(node, Attribute) and node.attr not in _PROPERTIES and typing.of(node.value).is_array:
        report.error("S201", f"the attribute '{node.attr}' of an array", node, help="write it with the array itself: "
                     "x[i, j], x[...], x.shape, x.size")
    if isinstance(node, UnaryOp) and isinstance(node.op, USub) and typing.of(node.operand).dtype.startswith("uint"):
        report.error("S201", f"the negative of {typing.of(node.operand).dtype}, which wraps around", node,
                     help="convert first: k.astype(np.int64), or int(k[i])")
    counted.check_node(node)
    if len(report.found) > before:
        return
    if isinstance(node, (Assign, AugAssign)) and any(
            isinstance(t, Subscript) and typing.of(t.value).kind == "tuple" for t in targets(node)):
        report.error("S201", "an element of a list is written", node, help="make it an array: np.zeros(n), or "
                     "np.array([...])")
    if isinstance(node, (Assign, AugAssign)) and isinstance(targets(node)[0], Subscript) and (
            typing.of(targets(node)[0]).is_number and typing.of(node.value).is_array):
        report.error("S203", f"{typing.of(node.value)} is stored in an element", node,
                     help="the types are taken from the arguments: check their ranks; of one element, write x[0]")
    if isinstance(node, (Assign, AugAssign)) and typing.of(targets(node)[0]).is_array or typing.of(node).is_array:
        _refuse_elementwise_use(node, typing, report)
    if isinstance(node, Call):
        _call(node, typing, report)


def _refuse_elementwise_use(node: AST, typing: Typing, report: Report) -> None:
    """Refuses a user's function of whole arrays where elements are computed: it takes the arrays."""
    for part in walk(node):
        name = call_name(part) or ""
        if isinstance(part, Call) and name.startswith(ROOM) and rules.constant_result(name) and any(
                typing.of(a).is_array for a in part.args):
            report.error("S201", "a function that is held fixed is not called with an array in a whole-array "
                         "expression", part, help="give what it returns a name, in a statement of its own")


def _unknown_option(name: str, node: Call) -> str:
    """An option, of an allocation or of a function without a derivative, that would be ignored."""
    given = [k.arg or "**" for k in node.keywords]
    known = _OPTIONS.get(name)
    copied = [k for k in node.keywords if k.arg == "copy" and getattr(k.value, "value", None) is True]
    if name == "numpy.array" and copied:
        given.remove("copy")    # that is what it does
    refused = ("out", "where", "casting", "subok", "signature") if known is None and rules.constant_result(name) else ()
    if name == "numpy.nan_to_num" and not all(isinstance(c, Constant) for c in [
            *node.args[1:2], *(k.value for k in node.keywords if k.arg == "copy")]):
        return "copy= that is not written out"
    if name.endswith(".solve_triangular") and any(k.arg == "trans" and getattr(k.value, "value", None) not in (0, 1)
                                                  for k in node.keywords):
        return "a trans that is not written out"
    return next((f"{k}=" for k in given if known is not None and k not in known or k in refused), "")


def _call(node: Call, typing: Typing, report: Report) -> None:
    name = call_name(node)
    other = _unknown_option(name or "", node)
    if other:
        report.error("S301", f"no derivative rule for {name} with {other}", node, help=_LOOP)
        return
    if name in _REDUCED and len(node.args) + len(node.keywords) != 1:
        report.error("S301", f"no derivative rule for {name} with more than the array", node, help=_LOOP)
        return
    if name in _COPIES and node.args and typing.of(node.args[0]).is_number:
        report.error("S201", f"{name} of a number, an array without axes", node, help="leave it out")
        return
    if name == "numpy.searchsorted" and len(node.args) > 1 and typing.of(node.args[1]).is_array:
        report.error("S301", f"no derivative rule for {name} of an array with these options", node, help=_LOOP)
        return
    rule = rules.find_array(name)
    without = rule is not None and not rule.adjoints and rule.law != COMPOSED and name not in _ZERO_DERIVATIVE
    if without and product_expansion(node, typing) is None:
        report.error("S301", f"no derivative rule for {name}", node, help=_OTHERS)
        return
    if name in _SPARSE and typing.of(node).kind == "unknown":
        message, help = _SPARSE[name]
        report.error("S301", f"no derivative rule for {message}", node, help=help)
        return
    if name is None or name.startswith(("user.", "runtime.")) or name in _ALLOCATING or rules.constant_result(name):
        return
    if rule is not None and typing.of(node).kind != "unknown":
        return
    if name in _SUMS:
        if node.keywords or len(node.args) != 1:
            report.error("S301", f"no derivative rule for {name} with more than the array", node,
                         help="write a loop that adds the elements")
        elif not typing.of(node.args[0]).is_array:
            report.error("S301", f"no derivative rule for {name} of {typing.of(node.args[0])}", node,
                         help="write a loop that adds the elements")
    elif name == "numpy.where" and all(typing.of(a).is_number for a in node.args):
        report.error("S301", "no derivative rule for numpy.where of numbers here", node,
                     help="write it with if and else")
    elif operation(node) is None:
        known = rules.find(name)
        other = [f"{k.arg}=" for k in node.keywords if rule is not None and k.arg not in rule.options]
        given = f" with {len(node.args) + len(node.keywords)} arguments" if known else (
            f" with {', '.join(other)}" if other else "")
        name = name.removeprefix(ROOM)
        note = f"there is one for {name}({', '.join(known.parameters)})" if known else ""
        loop = any(typing.of(a).is_array for a in node.args) and not name.startswith("scipy.linalg.")
        report.error("S301", f"no derivative rule for {name}{given}", node, note, _HELP.get(name) or (
                     _LOOP if loop else _OTHERS))
