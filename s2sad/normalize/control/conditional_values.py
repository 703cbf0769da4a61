"""conditional_values: `np.where` of numbers becomes a branch, and so does `or` or `and` that gives a float.

    def f(x: "float64[:]", y: "float64[:]"):                def f(x, y):
        for i in range(x.size):                                 for i in range(x.size):
            y[i] = 2.0 * np.where(x[i] > 0.0, x[i], 0.1)            if x[i] > 0.0:
                                                                        choice = x[i]
                                                                    else:
                                                                        choice = 0.1
                                                                    y[i] = 2.0 * choice

and

    y[i] = x[i] or 1.0      if x[i] != 0.0:
                                y[i] = x[i]
                            else:
                                y[i] = 1.0

Requires structured form and types. Establishes that the `numpy.where` left are of arrays, or in the test of a while
loop. NumPy computes both sides and takes one of them, so only the one that is taken is computed here.
"""
from __future__ import annotations

from functools import reduce

from s2sad.infer.inference import Typing
from s2sad.infer.promotion import promote
from s2sad.naming import Names
from s2sad.normalize.context import NormalContext
from s2sad.normalize.views.views_without_axes import makes_view, viewed
from s2sad.tree import (
    AST, Assign, AugAssign, BoolOp, Expr, For, FunctionDef, If, List, Name, NotEq, Or, Return, Subscript, Tuple, While,
    assign, at, call_name, compare, const, copy, name, rebuild, user_call, walk, walk_statements, with_body,
)

ARRAYS = ("numpy.array", "numpy.asarray", "numpy.copy")       # of a number they have no axes


def conditional_values(function: FunctionDef, context: NormalContext) -> FunctionDef:
    """The function with such branches; new names are declared."""
    typing, names = context.typing, context.names
    return with_body(function, _ConditionalValues(typing, names, _aliased_choices(function)).block(function.body))


def refuse_added_aliases(function: FunctionDef, context: NormalContext) -> None:
    """Refuses a number in an array without axes, `np.array(0.5)`, that is added to in place under two names, or written
    in a view of it with axes."""
    kernels = context.program.kernels
    bound = {s.targets[0].id: s for s in walk_statements(function.body) if isinstance(s, Assign) and isinstance(
        s.targets[0], Name) and context.typing.of(s.value).is_number}
    held = {n: s for n, s in bound.items() if _makes_number_array(s.value) or (
        kernel := kernels.get(user_call(s.value) or "")) and any(map(_makes_number_array, walk(kernel.tree.body)))}
    for n in _aliased(function, set(held)) if held else ():
        context.report.error("S201", "a number in an array without axes has two names, and is added to in place",
                             held[n], help="make it a number: float(a)")
    chosen = {n for n, s in bound.items() if call_name(s.value) == "numpy.where"}
    for call in _written_views(function, chosen | {*held}) if chosen or held else ():
        context.report.error("S201", "a view of a number in an array without axes, and one of them is written", call,
                             help="make the array of the number: np.array([a]), np.full((1, 1), a)")
    for node in walk(function.body) if held else ():
        kernel = kernels.get(user_call(node) or "")
        added = {s.target.id for s in walk_statements(kernel.tree.body) if isinstance(s, AugAssign) and isinstance(
            s.target, Name)} if kernel is not None else set[str]()
        if kernel is not None and any(p.id in added and isinstance(a, Name) and a.id in held
                                      for p, a in zip(kernel.tree.args.args, node.args)):
            context.report.error("S201", "a number in an array without axes is given to a function that adds to it in "
                                 "place", node, help="make it a number: float(a)")


def _makes_number_array(node: AST) -> bool:
    return call_name(node) in ARRAYS and not isinstance(node.args[0], (List, Tuple))


def _aliased_choices(function: FunctionDef) -> set[str]:
    """Names of a choice with an alias that is added to in place: NumPy gives an array without axes there."""
    return _aliased(function, {s.targets[0].id for s in walk_statements(function.body) if isinstance(
        s, Assign) and isinstance(s.targets[0], Name) and call_name(s.value) == "numpy.where"})


def _written_views(function: FunctionDef, held: set[str]) -> list[AST]:
    """The functions that give a view of these names with axes, where that or the number itself is written."""
    bound = [(s.targets[0].id, s.value) for s in walk_statements(function.body)
             if isinstance(s, Assign) and isinstance(s.targets[0], Name)]
    shared: set[str] = set()
    while more := {n for n, value in bound if (of := viewed(value)) in held | shared and of != n} - shared:
        shared |= more
    views = [n for n in walk(function.body) if makes_view(n) and viewed(n) in held | shared]
    places = [t for s in walk_statements(function.body) for t in (
        s.targets if isinstance(s, Assign) else [s.target] if isinstance(s, AugAssign) else [])
        if isinstance(t, Subscript) or isinstance(s, AugAssign) and shared]
    given = [a for n in walk(function.body) if user_call(n) for a in n.args]
    written = any(viewed(n) in held | shared for n in places) or any(
        viewed(a) in shared or any(a is v for v in views) for a in given)
    return views if written else []


def _aliased(function: FunctionDef, held: set[str]) -> set[str]:
    """These names if another name is bound to what they are, and one of them is added to in place."""
    bound = [(s.targets[0].id, s.value) for s in walk_statements(function.body)
             if isinstance(s, Assign) and isinstance(s.targets[0], Name)]
    copies: set[str] = set()
    while True:
        more = {n for n, value in bound if isinstance(value, Name) and value.id in held | copies} - copies
        if not more:
            break
        copies |= more
    added = {s.target.id for s in walk_statements(function.body) if isinstance(s, AugAssign)
             and isinstance(s.target, Name)}
    return held if copies and added & (held | copies) else set()


class _ConditionalValues:
    def __init__(self, typing: Typing, names: Names, kept: set[str]):
        self.typing, self.names, self.kept = typing, names, kept

    def block(self, block: list[AST]) -> list[AST]:
        return [at(made, statement) for statement in block for made in self.statement(statement)]

    def statement(self, statement: AST) -> list[AST]:
        before: list[AST] = []
        if isinstance(statement, If):
            test = self.with_names(statement.test, before)
            return [*before, If(test, self.block(statement.body), self.block(statement.orelse))]
        if isinstance(statement, While):
            return [While(statement.test, self.block(statement.body), [])]
        if isinstance(statement, For):
            bounds = self.with_names(statement.iter, before)
            return [*before, For(statement.target, bounds, self.block(statement.body), [], None)]
        if isinstance(statement, Assign) and self.is_choice(statement.value):
            if isinstance(statement.targets[0], Name) and statement.targets[0].id in self.kept:
                return [statement]
            return self.branch(statement.targets[0], statement.value)
        if isinstance(statement, (Assign, AugAssign, Expr, Return)) and statement.value is not None:
            new = copy(statement)
            new.value = self.with_names(statement.value, before)
            return [*before, new]
        return [statement]

    def is_choice(self, node: AST) -> bool:
        if isinstance(node, BoolOp):
            return self.typing.of(node).is_inexact and all(self.typing.of(v).is_number for v in node.values)
        return call_name(node) == "numpy.where" and len(node.args) == 3 and not node.keywords and all(
            self.typing.of(a).is_number for a in node.args)

    def with_names(self, node: AST, before: list[AST]) -> AST:
        """The expression with names for its choices; the branches that bind them are added to `before`."""
        def change(part: AST) -> AST | None:
            if not self.is_choice(part):
                return None
            sides = part.values if isinstance(part, BoolOp) else part.args[1:]
            made = self.typing.declare(self.names.fresh("choice"), reduce(promote, map(self.typing.of, sides)))
            before.extend(self.branch(name(made), part))
            return at(name(made), part)
        return rebuild(node, change)

    def branch(self, target: AST, node: AST) -> list[AST]:
        """The statements that leave a choice in a name or an element."""
        before: list[AST] = []
        if isinstance(node, BoolOp):
            first, *others = node.values
            rest = BoolOp(node.op, others) if len(others) > 1 else others[0]
            test, sides = compare(copy(first), NotEq(), const(0)), [first, rest]
            sides = sides if isinstance(node.op, Or) else sides[::-1]
        else:
            test, *sides = node.args
        test = self.with_names(test, before)
        return [*before, If(test, *(self.side_of_branch(target, a) for a in sides))]

    def side_of_branch(self, target: AST, value: AST) -> list[AST]:
        if self.is_choice(value):
            return self.branch(target, value)
        before: list[AST] = []
        left = self.with_names(value, before)
        return [*before, assign(copy(target), left)]
