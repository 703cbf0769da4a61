"""kinks: the places where a function is not differentiable, with what its derivative does there."""
from __future__ import annotations

from collections.abc import Iterator

from s2sad import rules
from s2sad.analyze.activity import Activity
from s2sad.analyze.uses import sources
from s2sad.infer.inference import Typing
from s2sad.rules.operation import operation
from s2sad.rules.power import POWERS
from s2sad.rules.rule import number
from s2sad.tree import AST, BinOp, Call, Compare, FloorDiv, For, If, While, call_name, children, walk
from s2sad.units import Unit


def kinks(unit: Unit, activity: Activity) -> list[tuple[AST, str]]:
    """Pairs (statement, what happens there), in the order of the text, each once."""
    found: dict[tuple[int, int, str], tuple[AST, str]] = {}
    for statement in walk(unit.function.body):
        if getattr(statement, "lineno", None) is None:
            continue
        for what in _of_statement(statement, unit.typing, activity):
            found.setdefault((statement.lineno, statement.col_offset, what), (statement, what))
    return [found[key] for key in sorted(found, key=lambda k: k[:2])]


def _of_statement(statement: AST, typing: Typing, activity: Activity) -> Iterator[str]:
    """The kinks in a statement itself, without its blocks."""
    if isinstance(statement, (If, While)):
        heads: list[AST] = [statement.test]
    elif isinstance(statement, For):
        heads = [statement.iter]
    elif type(statement).__name__ in ("Assign", "AugAssign", "Return", "Expr"):
        heads = children(statement)
    else:
        heads = []
    for node in walk(heads):
        what = _of_node(node, typing, activity)
        if what and isinstance(statement, While):
            what += "; the number of trips hangs on it"
        if what:
            yield what


def _of_node(node: AST, typing: Typing, activity: Activity) -> str:
    def is_active(part: AST) -> bool:
        return bool(activity.active.intersection(sources(part, typing)))

    if isinstance(node, Compare):
        sides = [node.left, *node.comparators]
        return "an active value is compared: a jump or a kink where the sides are equal, each side is " \
            "differentiated as it is taken" if any(map(is_active, sides)) else ""
    found = operation(node)
    if found:
        rule, operands = found
        active = {p for p, operand in operands.items() if is_active(operand)}
        if rule.name in POWERS and active:
            return _power(operands, active)
        return rule.kink if rule.kink and active else ""
    stairs = isinstance(node, BinOp) and isinstance(node.op, FloorDiv)
    called = call_name(node) or ""
    if stairs or isinstance(node, Call) and rules.constant_result(called) in ("same", "int"):
        operands = [node.left, node.right] if stairs else node.args
        what = "//" if stairs else called.rpartition(".")[2]
        numbers = [o for o in operands if typing.of(o).is_number]
        return f"{what} of an active value jumps: its derivative is taken as 0" if any(map(is_active, numbers)) else ""
    return ""


def _power(operands: dict[str, AST], active: set[str]) -> str:
    exponent = number(operands["b"])
    if "b" in active:
        return "a power with an active exponent: with respect to it the derivative is taken as 0 where the base is <= 0"
    if exponent is None:
        return "a power with a variable exponent: at a base of 0 its derivative may be infinite"
    if exponent % 1 == 0:
        return ""
    return f"a power with the exponent {exponent!r}: not differentiable at a base of 0"
