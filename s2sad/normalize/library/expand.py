"""expand: functions of whole arrays that are compositions of others are expanded.

Requires functions that stand alone on operands with names; establishes that none of those in `rules/composed` is left,
and no `np.broadcast_to` of the kernel's. The expansions are texts, in `normalize/library/expansions`.

    def f(x):                                   def f(x):
        return np.sum(np.diff(x[:]) ** 2)           diff_value = x[:][1:] - x[:][:-1]
                                                    return np.sum(diff_value ** 2)
"""
from __future__ import annotations

from collections.abc import Callable

from s2sad import rules
from s2sad.blocks import with_blocks
from s2sad.diagnostics import Report
from s2sad.infer.inference import Typing
from s2sad.naming import Names
from s2sad.normalize.context import NormalContext
from s2sad.normalize.library.expansions.templates import CallArguments
from s2sad.normalize.array_anf import named_arrays
from s2sad.normalize.library.expansions import (
    batched_matrices, concatenation, differences, fft, indexing_and_sorting, logsumexp, norms_and_products,
    rearrangement, reductions, selections, stacked_products, statistics, structured_matrices,
)
from s2sad.rules.composed import WRITING
from s2sad.rules.rule import resolved
from s2sad.tree import (
    AST, Assign, Call, Constant, Expr, For, FunctionDef, If, List, Name, Slice, Store, Subscript, Tuple, UnaryOp, While,
    assign, at, call_name, copy, indices, name, names, rebuild, statements, stored_names, walk, walk_statements,
    with_body,
)

_MODULES = (concatenation, rearrangement, reductions, differences, indexing_and_sorting, logsumexp, selections,
            statistics, fft, norms_and_products, structured_matrices)
_EXPANSIONS = {name: expansion for module in _MODULES for name, expansion in module.EXPANSIONS.items()}
RESULT = "result"
_BUILTINS = ("int", "len", "max", "min", "range")


def expand(function: FunctionDef, context: NormalContext) -> FunctionDef:
    """The function with such calls expanded."""
    return expanded(function, context.typing, context.names, context.report)


def expanded(function: FunctionDef, typing: Typing, free: Names, report: Report) -> FunctionDef:
    """The function with such calls expanded; new names are declared in `typing`."""
    while any(_binds_composed(s, typing) for s in walk_statements(function.body) if isinstance(s, Assign)):
        new = with_body(function, _Expand(typing, free).block(function.body))
        function = named_arrays(new, typing, free)
    for statement in walk_statements(function.body):
        if isinstance(statement, (Assign, Expr)) and any(is_composed(n, typing) for n in walk(statement)):
            report.error("S301", "no derivative rule for this function here", statement,
                         help="bind its result to a name")
    return function


def _expansion(node: AST, typing: Typing) -> Callable[[CallArguments], str] | None:
    """What gives the text of a call, None for a function that is no composition."""
    rule = rules.find_array(call_name(node))
    if rule is not None and rule.value:
        return lambda _: f"result = {rule.value}"
    if not isinstance(node, Call):
        return None
    return _EXPANSIONS.get(call_name(node) or "") or batched_matrices.batched_expansion(
        node, typing) or stacked_products.product_expansion(node, typing)


def is_composed(node: AST, typing: Typing) -> bool:
    """Whether a call is one of a function that is expanded."""
    return _expansion(node, typing) is not None


def _binds_composed(statement: Assign, typing: Typing) -> bool:
    return isinstance(statement.targets[0], (Name, Subscript)) and is_composed(statement.value, typing)


class _Expand:
    def __init__(self, typing: Typing, free: Names):
        self.typing, self.free = typing, free

    def block(self, block: list[AST]) -> list[AST]:
        return [at(made, s) for s in block for made in self.statement(s)]

    def statement(self, statement: AST) -> list[AST]:
        if isinstance(statement, (For, If, While)):
            return [with_blocks(statement, self.block)]
        if isinstance(statement, Assign) and _binds_composed(statement, self.typing):
            return self.expansion(statement)
        return [statement]

    def expansion(self, statement: Assign) -> list[AST]:
        """The statements in place of one; operands that are read more than once have names."""
        target, value = statement.targets[0], statement.value
        rule = rules.find_array(call_name(value))
        expansion = _expansion(value, self.typing)
        assert rule is not None and expansion is not None
        args = CallArguments(rule.arguments(value), self.typing)
        text = expansion(args)
        before = [made for key, node in args.arguments.items() for made in self.operand(args, key, node)]
        body = [resolved(s) for s in statements(text)]
        direct = isinstance(target, Name) and target.id not in names([value, *args.arguments.values()])
        made = {n: self.free.fresh(n) for n in stored_names(body) if n != RESULT or not direct}
        if direct:
            made[RESULT] = target.id
        body = [at(_instantiated(s, made, args.arguments), statement) for s in body]
        if rule.value:
            body = [rebuild(s, _without_defaults) for s in body]
        known = self.typing.extended(body).table
        for new in known.keys() - self.typing.table.keys():
            self.typing.declare(new, known[new])
        if rule.name in WRITING:  # on the first argument, which is what is stored into
            return [*before, *body]
        return [*before, *body, *([] if direct else [assign(target, name(made[RESULT]))])]

    def operand(self, args: CallArguments, key: str, node: AST) -> list[AST]:
        """A name for an argument that is an expression."""
        kind = self.typing.of(node)
        part = isinstance(node, Subscript) and kind.is_array and not any(
            self.typing.of(s).is_array for s in indices(node) if not isinstance(s, Slice))
        literal = isinstance(node, UnaryOp) and isinstance(node.operand, Constant)
        if isinstance(node, (Name, Constant, Tuple, List)) or part or literal or kind.kind not in ("array", "number"):
            return []
        held = self.typing.declare(self.free.fresh("operand"), kind)
        args.arguments[key] = name(held)
        return [assign(held, node)]


def _without_defaults(node: AST) -> AST | None:
    """A call of a function of whole arrays without the options that have their default."""
    rule = rules.find_array(call_name(node))
    plain = rules.bound(rule, node) if rule is not None and isinstance(node, Call) else None
    return plain and Call(plain.func, [rebuild(a, _without_defaults) for a in plain.args], plain.keywords)


def _instantiated(statement: AST, made: dict[str, str], arguments: dict[str, AST]) -> AST:
    """A statement of an expansion with new names, and the arguments of the call for the parameters."""
    def change(n: AST) -> AST | None:
        if not isinstance(n, Name):
            return None
        if n.id in made:
            return Name(made[n.id], n.ctx, None, None)
        if n.id in _BUILTINS:
            return name(f"builtins.{n.id}")
        return copy(arguments[n.id]) if n.id in arguments and not isinstance(n.ctx, Store) else None
    return rebuild(statement, change)
