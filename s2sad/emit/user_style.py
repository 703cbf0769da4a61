"""user_style: the rules of a linter that generated code breaks because the kernel does.

>>> from s2sad import tree
>>> user_style(tree.statements("def f(l):\\n    while l == None:\\n        pass"))
['E711', 'E741']
"""
from __future__ import annotations

from collections.abc import Iterator

from s2sad import tree

_AMBIGUOUS = {"l", "O", "I"}
_CONSTANT_BUILTINS = ("builtins.float", "builtins.int", "builtins.bool")


def user_style(functions: list[tree.FunctionDef]) -> list[str]:
    """The codes of ruff's rules about style that these functions may break, sorted; a few too many do no harm."""
    codes: set[str] = set()
    for function in functions:
        parameters = {parameter.id for parameter in function.args.args}
        if function.name in _AMBIGUOUS:
            codes.add("E743")
        for node in tree.walk(function):
            if isinstance(node, tree.Name) and node.id in _AMBIGUOUS:
                codes.add("E741")
            codes.update(_of_statement(node, parameters))
            codes.update(_of_expression(node))
        codes.update(_of_unpacking(function))
    return sorted(codes)


def _of_statement(node: tree.AST, parameters: set[str]) -> Iterator[str]:
    if isinstance(node, tree.If):
        yield from _of_branch(node)
    elif isinstance(node, tree.For):
        if set(tree.stored_names(node.target)) & parameters:
            yield "PLR1704"
        if any(isinstance(inner, tree.AugAssign) and isinstance(inner.value, tree.Constant) for inner in node.body):
            yield "SIM113"
    elif isinstance(node, tree.Assign) and tree.equal(node.targets[0], node.value):
        yield "PLW0127"


def _of_branch(node: tree.If) -> Iterator[str]:
    first, last = (node.body or [None])[0], (node.orelse or [None])[0]
    if len(node.body) == 1 and isinstance(first, tree.If):
        yield "SIM102"
    if isinstance(last, tree.If) and tree.dump(node.body) == tree.dump(last.body):
        yield "SIM114"
    if isinstance(first, tree.Return) and isinstance(getattr(first.value, "value", None), bool):
        yield "SIM103"
    if isinstance(node.test, tree.Compare) and isinstance(first, tree.Assign):
        yield "PLR1730"


def _of_expression(node: tree.AST) -> Iterator[str]:
    if isinstance(node, tree.Compare):
        yield from _of_comparison(node)
    elif isinstance(node, tree.UnaryOp) and isinstance(node.op, tree.Not):
        negated = node.operand.ops if isinstance(node.operand, tree.Compare) else []
        codes = {tree.In: "E713", tree.Is: "E714", tree.Eq: "SIM201", tree.NotEq: "SIM202"}
        yield from (codes[type(op)] for op in negated if type(op) in codes)
        if isinstance(node.operand, tree.UnaryOp):
            yield "SIM208"
    elif isinstance(node, tree.BoolOp):
        yield from _of_condition(node)
    elif isinstance(node, tree.IfExp):
        if isinstance(node.test, tree.Compare):
            yield "FURB136"
        if tree.equal(node.body, node.orelse):
            yield "RUF034"
        if isinstance(node.body, tree.Constant) and isinstance(node.orelse, tree.Constant):
            yield from ("SIM210", "SIM211")
    elif isinstance(node, tree.Call):
        yield from _of_call(node)


def _of_comparison(node: tree.Compare) -> Iterator[str]:
    sides = [node.left, *node.comparators]
    for op, left, right in zip(node.ops, sides, sides[1:]):
        values = [side.value for side in (left, right) if isinstance(side, tree.Constant)]
        if isinstance(op, (tree.Eq, tree.NotEq)):
            yield from ("E711" if value is None else "E712" for value in values
                        if value is None or isinstance(value, bool))
        elif isinstance(op, (tree.Is, tree.IsNot)):
            yield from ("F632" for value in values if type(value) in (str, int, float))
        if len(values) == 2:
            yield "PLR0133"
        if tree.equal(left, right):
            yield "PLR0124"


def _of_condition(node: tree.BoolOp) -> Iterator[str]:
    if sum(isinstance(value, tree.Compare) for value in node.values) > 1:
        yield "PLR1716"
    plain = [value.operand if isinstance(value, tree.UnaryOp) else value for value in node.values]
    if len({tree.dump(value) for value in plain}) < len(plain) or any(isinstance(v, tree.Constant) for v in plain):
        yield from ("SIM220", "SIM221", "SIM222", "SIM223")


def _of_call(node: tree.Call) -> Iterator[str]:
    callee, args = tree.call_name(node), node.args
    if callee == "builtins.range" and len(args) == 2 and tree.equal(args[0], tree.const(0)):
        yield "PIE808"
    elif callee in _CONSTANT_BUILTINS and args and isinstance(args[0], (tree.Constant, tree.UnaryOp)):
        yield "UP018"
    elif callee == "builtins.int" and args and isinstance(args[0], tree.Call):
        yield "RUF046"


def _of_unpacking(function: tree.FunctionDef) -> Iterator[str]:
    unpacked: list[tree.AST] = [target for node in tree.walk(function) if isinstance(node, tree.Assign)
                                for target in node.targets if isinstance(target, tree.Tuple)]
    if unpacked and not set(tree.stored_names(unpacked)) <= set(tree.names(function.body)):
        yield "RUF059"
