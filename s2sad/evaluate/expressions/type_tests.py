"""type_tests: what a kernel asks of the type of a parameter is answered, before the types of branches are joined.

    def f(x, p: float64):               def f(x, p):
        if np.isscalar(p):                  p = np.full(x.size, p)
            p = np.full(x.size, p)          return np.sum(p * x)
        return np.sum(p * x)

*Requires* structured form. *Establishes* that questions are left only where the answer is not known: arguments of other
types are another variant of the kernel. A question after the parameter was bound anew, or whose answer the types here
do not tell (Python's integers and NumPy's are one), is left, to be refused.
"""
from __future__ import annotations

from collections.abc import Mapping

from s2sad.evaluate.scope import KernelScope
from s2sad.infer.types import NONE, Type
from s2sad.tree import (
    AST, And, Attribute, BoolOp, Call, Compare, Constant, Eq, For, FunctionDef, Gt, If, Name, Not, NotEq, Tuple,
    UnaryOp, While, at, call_name, const, rebuild, stored_names, walk, with_body,
)

ASKING = "builtins.isinstance"
QUESTIONS = (ASKING, "numpy.isscalar")
_COMPARED = {Eq: lambda a, b: a == b, NotEq: lambda a, b: a != b, Gt: lambda a, b: a > b}
_CLASSES = ("numpy.ndarray", "builtins.float", "builtins.int", "builtins.complex", "builtins.bool")
_FLOATS = {"float64": True, "float32": False}       # whether numbers of the dtype are Python's floats, too
Types = Mapping[str, Type]


def type_tests(function: FunctionDef, context: KernelScope) -> FunctionDef:
    """The function with such questions answered."""
    types = context.given
    if not any(call_name(n) in (*QUESTIONS, "numpy.ndim") or isinstance(n, Attribute) and n.attr == "ndim"
               for n in walk(function.body)):
        return function
    return with_body(function, _block(function.body, dict(types)))


def undecided(function: FunctionDef, context: KernelScope) -> None:
    """Refuses the questions that are left.

        def f(x, n: int64):
            if isinstance(n, int):
                return x * n
            return x

    refused: the built-in 'isinstance' is not supported in a kernel, but for what an argument is

    *Requires* structured form, after `type_tests`; changes nothing.
    """
    report = context.report
    for node in walk(function.body):
        if call_name(node) == ASKING:
            report.error("S201", "the built-in 'isinstance' is not supported in a kernel, but for what an argument is",
                         node, help="write one kernel for each type")


def _block(block: list[AST], known: dict[str, Type]) -> list[AST]:
    """The statements; the names that they bind are known no more."""
    made: list[AST] = []
    for s in block:
        if isinstance(s, (For, While)):
            for n in stored_names([s]):
                known.pop(n, None)
        if isinstance(s, If) and (answer := _answer(s.test, known)) is not None:
            made += _block(s.body if answer else s.orelse, known)
            continue
        new = rebuild(s, lambda n: None if (found := _answer(n, known)) is None else at(const(found), n))
        if isinstance(s, (If, For, While)):
            after = []
            for field in ("body", "orelse"):
                after.append(dict(known))
                setattr(new, field, _block(getattr(s, field), after[-1]))
        for n in stored_names([s]):
            known.pop(n, None)
        made.append(new)
    return made


def _answer(node: AST, known: Types) -> bool | None:
    """What a question about types is answered by; None where it is not known, or no such question."""
    if isinstance(node, UnaryOp) and isinstance(node.op, Not):
        inner = _answer(node.operand, known)
        return None if inner is None else not inner
    if isinstance(node, BoolOp):
        found = [_answer(v, known) for v in node.values]
        deciding = not isinstance(node.op, And)
        return deciding if found[0] is deciding else None if None in found else (
            deciding if deciding in found else not deciding)
    if isinstance(node, Compare) and len(node.ops) == 1 and type(node.ops[0]) in _COMPARED:
        rank, number = _rank(node.left, known), node.comparators[0]
        whole = isinstance(number, Constant) and type(number.value) is int
        return None if rank is None or not whole else _COMPARED[type(node.ops[0])](rank, number.value)
    if isinstance(node, Call) and node.args and isinstance(node.args[0], Name) and node.args[0].id in known:
        return asked(node, known[node.args[0].id])
    return None


def asked(node: Call, kind: Type) -> bool | None:
    """What a question about a value of a type is answered by; None where it is not known, or no such question."""
    if call_name(node) == "numpy.isscalar" and (kind.is_number or kind.is_array or kind == NONE):
        return kind.is_number
    return _is_one(kind, node.args[1]) if call_name(node) == ASKING and len(node.args) == 2 else None


def _rank(node: AST, known: Types) -> int | None:
    """The number of axes that is asked for: `np.ndim(p)`, `p.ndim`."""
    asked = node.args[0] if call_name(node) == "numpy.ndim" and len(node.args) == 1 else node.value if isinstance(
        node, Attribute) and node.attr == "ndim" else None
    kind = known.get(asked.id) if isinstance(asked, Name) else None
    return kind.rank if kind is not None and (kind.is_array or kind.is_number and isinstance(node, Call)) else None


def _is_one(kind: Type, asked: AST) -> bool | None:
    """Whether values of a type are instances of a class, or of one of several."""
    if isinstance(asked, Tuple):
        found = [_is_one(kind, a) for a in asked.elts]
        return True if True in found else None if None in found else False
    named = asked.id if isinstance(asked, Name) else ""
    if kind == NONE:
        return False if named in _CLASSES else None
    if not (kind.is_array or kind.is_number):
        return None
    if named == "numpy.ndarray":
        return kind.is_array
    if named in _CLASSES and kind.is_array:
        return False
    if named == "builtins.float" and kind.is_number:
        return _FLOATS.get(kind.dtype, False)
    if named == "builtins.int" and kind.is_number:
        return False if kind.is_inexact else None
    return None
