"""complex_support: operations on complex numbers have a derivative that is known to hold for them.

    def f(z: "complex128[:]"):
        return np.max(z).real

refused: no derivative rule for numpy.max of complex values

Requires structured form and types; changes nothing. Establishes that a complex operand stands only in operations whose
rule holds for it, and that no complex value is stored where its imaginary part would be lost: `z > w`, `math.exp(z)`,
`x[:] = z` for an `x` of floats are refused, too, and complex arguments of a function whose derivative is the user's.
"""
from __future__ import annotations

from s2sad import rules
from s2sad.liveness import targets
from s2sad.diagnostics import Report
from s2sad.infer.inference import Typing
from s2sad.infer.types import Type
from s2sad.normalize.context import NormalContext
from s2sad.program import Kernel
from s2sad.read.linker import header_of
from s2sad.rules.complexes import KNOWN, OTHER
from s2sad.tree import (
    AST, Add, Assert, Assign, AugAssign, BinOp, BoolOp, Call, Compare, Constant, Div, Expr, FunctionDef, If, IfExp,
    Mult, Pow, Raise, Slice, Sub, Subscript, UnaryOp, UAdd, USub, While, call_name, children, indices,
)

_PARTS = "take np.abs(z), z.real or z.imag of it"
_POWERS = ("numpy.power", "numpy.pow", "numpy.float_power", "builtins.pow")
_LIKES = ("numpy.empty_like", "numpy.zeros_like", "numpy.ones_like")
_HELP = {
    "numpy.linalg.norm": "write np.sqrt(np.sum(np.abs(z) ** 2))",
    "numpy.linalg.det": "write it out, or compute with the real and the imaginary part",
    "builtins.sum": "write np.sum",
    "builtins.float": "write z.real", "builtins.int": "write z.real", "builtins.complex": "write a + 1j * b",
    "numpy.sign": "write z / np.abs(z)", "numpy.hypot": "write np.sqrt(a * a + b * b)",
    "numpy.var": "write it with np.mean", "numpy.std": "write it with np.mean",
    **{f"numpy.{f}": _PARTS for f in ("max", "min", "amax", "amin", "maximum", "minimum", "clip", "floor", "ceil",
                                      "sort", "argsort", "argmax", "argmin", "median", "searchsorted", "round")},
    "builtins.max": _PARTS, "builtins.min": _PARTS, "builtins.round": _PARTS}
_OTHERS = "write it with +, -, *, /, functions such as np.exp, np.abs, np.conj, or with z.real and z.imag"


def complex_support(function: FunctionDef, context: NormalContext) -> None:
    """Puts one diagnostic into the report for each use of complex numbers that is not known to be right."""
    typing, report = context.typing, context.report
    if any(t.is_complex for t in typing.table.values()) or _mentions(function):
        for statement in function.body:
            _visit(statement, typing, report)
    refuse_own_derivative(context.kernel, tuple(context.given.values()), report)


def refuse_own_derivative(kernel: Kernel, types: tuple[Type, ...], report: Report) -> None:
    """Refuses complex arguments of a function whose derivative is the user's own."""
    if kernel.own is not None and any(t.is_complex for t in types):
        report.error("S301", f"'{kernel.own.title}' has a derivative of its own, which is not for complex values",
                     header_of(kernel.tree), help="give it the real and the imaginary part")


def _mentions(node: AST) -> bool:
    """Whether a text makes complex numbers of others."""
    said = node.value if isinstance(node, Constant) else getattr(node, "id", "")
    return isinstance(said, complex) or isinstance(said, str) and ("complex" in said or ".fft." in said) or any(
        map(_mentions, children(node)))


def _visit(node: AST, typing: Typing, report: Report) -> None:
    if isinstance(node, (Assert, Raise)) or isinstance(node, Expr) and call_name(node.value) == "builtins.print":
        return
    before = len(report.found)
    for child in children(node):
        _visit(child, typing, report)
    if len(report.found) > before:
        return  # what is refused inside explains it
    if isinstance(node, (Assign, AugAssign)):
        _store(node, typing, report)
    elif isinstance(node, (Call, BinOp)) and typing.of(node).dtype == "complex64":
        report.error("S201", "a value of complex64", node, help="use complex128, and no float32 beside it")
    wrong = _wrong(node, lambda n: _holds_complex(typing.of(n)), typing)
    if wrong:
        report.error(wrong[0], wrong[1], node, help=wrong[2])


def _holds_complex(kind: Type) -> bool:
    return kind.is_complex or any(map(_holds_complex, kind.items))


def _store(node: Assign | AugAssign, typing: Typing, report: Report) -> None:
    target = targets(node)[0]
    kind = typing.of(target)
    placed = isinstance(target, Subscript) or isinstance(node, AugAssign) and kind.is_array
    part = call_name(target.value) if isinstance(target, Subscript) else ""
    if part in ("numpy.real", "numpy.imag"):
        report.error("S201", f"a store into .{part.rpartition('.')[2]} of an array", node,
                     help="store both parts: z[...] = a + 1j * b")
    if placed and _holds_complex(typing.of(node.value)) and kind.dtype and not kind.is_complex:
        report.error("S201", f"a complex value is stored in {kind.dtype}, where its imaginary part is lost", node,
                     help="store its real part: .real")


def _wrong(node: AST, is_complex, typing: Typing) -> tuple[str, str, str] | None:
    """The code, the message and the help for a node that is not known to hold for its complex operands."""
    if isinstance(node, Compare) and any(map(is_complex, [node.left, *node.comparators])):
        return "S201", "a comparison of complex values", "compare np.abs(z), z.real or z.imag"
    if isinstance(node, (If, While, IfExp)) and is_complex(node.test) or isinstance(node, BoolOp) and any(
            map(is_complex, node.values)):
        return "S201", "a complex value as a condition", "compare np.abs(z), z.real or z.imag"
    if isinstance(node, UnaryOp) and is_complex(node.operand) and not isinstance(node.op, (USub, UAdd)):
        return "S201", "an operator that is not defined for complex values", _PARTS
    if isinstance(node, AugAssign):
        return _operator(node.op, targets(node)[0], node.value, is_complex)
    if isinstance(node, BinOp):
        return _operator(node.op, node.left, node.right, is_complex)
    if isinstance(node, Subscript) and any(map(is_complex, (s for s in indices(node) if not isinstance(s, Slice)))):
        return "S201", "a complex value as a subscript", "subscripts are integers"
    if isinstance(node, Call) and any(map(is_complex, (*node.args, *(k.value for k in node.keywords)))):
        return _call(node, is_complex, typing)
    return None


def _operator(op: AST, left: AST, right: AST, is_complex) -> tuple[str, str, str] | None:
    if not (is_complex(left) or is_complex(right)) or isinstance(op, (Add, Sub, Mult, Div)):
        return None
    if not isinstance(op, Pow):
        return "S201", "an operator that is not defined for complex values", _PARTS
    return None if _is_power(left, is_complex) else (
        "S301", "no derivative rule for a complex power of a number that may be negative",
        "write (a + 0j) ** b")


def _is_power(base: AST, is_complex) -> bool:
    """Whether the base is complex, or a number above 0: the logarithm of another real base may be complex."""
    positive = isinstance(base, Constant) and isinstance(base.value, (int, float)) and base.value > 0
    return positive or is_complex(base) or getattr(base, "id", "") in ("math.e", "numpy.e")


def _call(node: Call, is_complex, typing: Typing) -> tuple[str, str, str] | None:
    name = call_name(node)
    if name is None or name.startswith("user.") or name == "builtins.range" and not any(map(is_complex, node.args)):
        return None
    rule, made = rules.find(name), typing.of(node)
    if name in _POWERS and len(node.args) == 2:
        return _operator(Pow(), node.args[0], node.args[1], is_complex)
    known = rule is not None and rule.plane is not None and not name.startswith("math.")
    if name == "numpy.where" and node.args and is_complex(node.args[0]):
        known = False
    if name in ("numpy.astype", *OTHER - {*_LIKES}) and made.is_float:
        return "S201", f"a complex value becomes {made.dtype}, where its imaginary part is lost", "write z.real"
    if known and len(node.args) != len(rule.parameters) if rule else False:
        known = False
    if known or name in KNOWN:
        return None
    return "S301", f"no derivative rule for {name} of complex values", _HELP.get(name, _OTHERS)
