"""expand: functions of whole arrays that are made of others are written out in them.

Requires functions that stand alone on operands with names; establishes that none of those in `rules/composed` is left,
and no `np.broadcast_to` of the kernel's.
What each is made of stands in `normalize/library/expansions/rearrangement`, `pieces_of_joins`, `pieces_of_sums`,
`pieces_of_differences`, `pieces_of_places`, `pieces_of_selections`, `pieces_of_statistics`, `pieces_of_exponentials`,
`pieces_of_transforms`, `pieces_of_matrices`, `pieces_of_forms`, and for stacks of matrices in `pieces_of_stacks`.

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
from s2sad.normalize.library.expansions.differences import DIFFERENCES
from s2sad.normalize.library.expansions.logsumexp import EXPONENTIALS
from s2sad.normalize.library.expansions.structured_matrices import FORMS
from s2sad.normalize.library.expansions.concatenation import JOINS
from s2sad.normalize.library.expansions.norms_and_products import MATRICES
from s2sad.normalize.library.expansions.indexing_and_sorting import PLACES
from s2sad.normalize.library.expansions.selections import SELECTIONS
from s2sad.normalize.library.expansions.rearrangement import SHAPES
from s2sad.normalize.library.expansions.batched_matrices import of_stack
from s2sad.normalize.library.expansions.statistics import STATISTICS
from s2sad.normalize.library.expansions.reductions import SUMS
from s2sad.normalize.library.expansions.fft import TRANSFORMS
from s2sad.rules.composed import WRITING
from s2sad.rules.rule import resolved
from s2sad.tree import (
    AST, Assign, Call, Constant, Expr, For, FunctionDef, If, List, Name, Slice, Store, Subscript, Tuple, UnaryOp, While,
    assign, at, call_name, copy, indices, name, names, rebuild, statements, stored_names, walk, walk_statements,
)

_PIECES = {**JOINS, **SHAPES, **SUMS, **DIFFERENCES, **PLACES, **EXPONENTIALS, **SELECTIONS, **STATISTICS,
           **TRANSFORMS, **MATRICES, **FORMS}
RESULT = "result"
_BUILTINS = ("int", "len", "max", "min", "range")


def expand(function: FunctionDef, context: NormalContext) -> FunctionDef:
    """The function with its pieces."""
    return expanded(function, context.typing, context.names, context.report)


def expanded(function: FunctionDef, typing: Typing, free: Names, report: Report) -> FunctionDef:
    """The function with its pieces; the table of `typing` gains their names."""
    while any(_is_made(s, typing) for s in walk_statements(function.body) if isinstance(s, Assign)):
        new = copy(function)
        new.body = _Expand(typing, free).block(function.body)
        function = named_arrays(new, typing, free)
    for statement in walk_statements(function.body):
        if isinstance(statement, (Assign, Expr)) and any(is_piece(n, typing) for n in walk(statement)):
            report.error("S301", "no derivative rule for this function here", statement,
                         help="bind its result to a name")
    return function


def _piece(node: AST, typing: Typing) -> Callable[[CallArguments], str] | None:
    """What gives the text of a call, None if it is none of such a function."""
    rule = rules.find_array(call_name(node))
    if rule is not None and rule.value:
        return lambda _: f"result = {rule.value}"
    return _PIECES.get(call_name(node) or "") or (of_stack(node, typing) if isinstance(node, Call) else None)


def is_piece(node: AST, typing: Typing) -> bool:
    """Whether a call is one of a function that is written out."""
    return _piece(node, typing) is not None


def _is_made(statement: Assign, typing: Typing) -> bool:
    return isinstance(statement.targets[0], (Name, Subscript)) and is_piece(statement.value, typing)


class _Expand:
    def __init__(self, typing: Typing, free: Names):
        self.typing, self.free = typing, free

    def block(self, block: list[AST]) -> list[AST]:
        return [at(made, s) for s in block for made in self.statement(s)]

    def statement(self, statement: AST) -> list[AST]:
        if isinstance(statement, (For, If, While)):
            return [with_blocks(statement, self.block)]
        if isinstance(statement, Assign) and _is_made(statement, self.typing):
            return self.written(statement)
        return [statement]

    def written(self, statement: Assign) -> list[AST]:
        """The statements in place of one; what they read more than once has a name."""
        target, value = statement.targets[0], statement.value
        rule = rules.find_array(call_name(value))
        piece = _piece(value, self.typing)
        assert rule is not None and piece is not None
        asked = CallArguments(rule.arguments(value), self.typing)
        text = piece(asked)
        before = [made for key, node in asked.arguments.items() for made in self.held(asked, key, node)]
        body = [resolved(s) for s in statements(text)]
        direct = isinstance(target, Name) and target.id not in names([value, *asked.arguments.values()])
        made = {n: self.free.fresh(n) for n in stored_names(body) if n != RESULT or not direct}
        if direct:
            made[RESULT] = target.id
        body = [at(_filled(s, made, asked.arguments), statement) for s in body]
        if rule.value:
            body = [rebuild(s, _without_defaults) for s in body]
        known = self.typing.extended(body).table
        for new in known.keys() - self.typing.table.keys():
            self.typing.declare(new, known[new])
        if rule.name in WRITING:  # on the first argument, which is what is stored into
            return [*before, *body]
        return [*before, *body, *([] if direct else [assign(target, name(made[RESULT]))])]

    def held(self, asked: CallArguments, key: str, node: AST) -> list[AST]:
        """A name for an argument that is an expression."""
        kind = self.typing.of(node)
        part = isinstance(node, Subscript) and kind.is_array and not any(
            self.typing.of(s).is_array for s in indices(node) if not isinstance(s, Slice))
        written = isinstance(node, UnaryOp) and isinstance(node.operand, Constant)
        if isinstance(node, (Name, Constant, Tuple, List)) or part or written or kind.kind not in ("array", "number"):
            return []
        held = self.typing.declare(self.free.fresh("operand"), kind)
        asked.arguments[key] = name(held)
        return [assign(held, node)]


def _without_defaults(node: AST) -> AST | None:
    """A call of a function of whole arrays without the options that have their default."""
    rule = rules.find_array(call_name(node))
    plain = rules.bound(rule, node) if rule is not None and isinstance(node, Call) else None
    return plain and Call(plain.func, [rebuild(a, _without_defaults) for a in plain.args], plain.keywords)


def _filled(statement: AST, made: dict[str, str], arguments: dict[str, AST]) -> AST:
    """A statement of a piece with its own names in place, and the arguments of the call."""
    def change(n: AST) -> AST | None:
        if not isinstance(n, Name):
            return None
        if n.id in made:
            return Name(made[n.id], n.ctx, None, None)
        if n.id in _BUILTINS:
            return name(f"builtins.{n.id}")
        return copy(arguments[n.id]) if n.id in arguments and not isinstance(n.ctx, Store) else None
    return rebuild(statement, change)
