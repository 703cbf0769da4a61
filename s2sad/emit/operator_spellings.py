"""operator_spellings: the usual spelling, as `a @ b` for np.matmul(a, b), `x.T` for np.transpose(x), `kept.pop()`."""
from __future__ import annotations

from s2sad.differentiate.split_adjoints import POP, PUSH
from s2sad.tree import AST, BinOp, Call, FunctionDef, MatMult, attribute, call_name, rebuild, with_body


def operator_spellings(function: FunctionDef) -> FunctionDef:
    """The function with operators and attributes where NumPy has them."""
    return with_body(function, [rebuild(statement, _idiom) for statement in function.body])


def _idiom(node: AST) -> AST | None:
    called = call_name(node)
    if called == "numpy.matmul" and len(node.args) == 2 and not node.keywords:
        left, right = (rebuild(a, _idiom) for a in node.args)
        return BinOp(left, MatMult(), right)
    if called == "numpy.transpose" and len(node.args) == 1 and not node.keywords:
        return attribute(rebuild(node.args[0], _idiom), "T")
    if called in (PUSH, POP):
        return Call(attribute(node.args[0], called.rpartition(".")[2]), node.args[1:], [])
    return None
