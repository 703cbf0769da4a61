"""tangent: every statement of a function in normal form, with its tangent beside it.

Requires activity and what can be infinite; establishes the grammar "derivative" of `form` and the signature
(`context.derivative`).

    def f(y, x, a):         def f_tangent(y, y_dot, x, x_dot, a, a_dot):
        y[0] = a * x[0]         y_dot[0] = x[0] * a_dot + a * x_dot[0]
                                y[0] = a * x[0]
"""
from __future__ import annotations

from s2sad.liveness import base_name, targets
from s2sad.analyze.uses import reads_own_result
from s2sad.differentiate.arithmetic import Term, is_plain
from s2sad.differentiate.context import DifferentiationContext
from s2sad.differentiate.derivative import Derivative
from s2sad.differentiate.shadows import with_shadows
from s2sad.analyze.callee_derivatives import is_kernel_call, activity_pattern
from s2sad.differentiate.expression_rules import Pushforward
from s2sad.differentiate.zero_law import ZeroLaw
from s2sad.infer.shapes import shapes_of
from s2sad.normalize.loops.hoist_allocations import is_allocation
from s2sad.tree import (
    AST, Add, Assign, AugAssign, Constant, Expr, For, FunctionDef, If, Name, Return, Sub, Subscript, Tuple, While,
    assign, at, augment, call, call_name, const, copy, function, index, name, tuple_of,
)


def tangent(function: FunctionDef, context: DifferentiationContext) -> FunctionDef:
    """The tangent of a function."""
    context.derivative = _Tangent(context).build(context.title)
    return context.derivative.function


class _Tangent:
    def __init__(self, context: DifferentiationContext):
        self.structure, self.typing, self.active = context.structure, context.typing, context.activity.active
        self.request, self.free, self.derive = context.request, context.names, context.derive
        self.flat, self.bounds = context.flat, context.unbounded
        self.shadows: dict[str, str] = {}
        self.shapes = shapes_of(self.structure.function, self.typing)
        self.pushforward = Pushforward(self.typing, self.active, self.value, self.shapes, ZeroLaw(self.bounds),
                                       self.bind_partial)
        self.before: list[AST] = []
        self.parameters = [p.id for p in self.structure.function.args.args]

    def build(self, title: str) -> Derivative:
        signature: list[tuple[str, str, str]] = []
        for parameter in self.parameters:
            signature.append((parameter, "primal", parameter))
            kind = self.typing.table[parameter]
            if kind.is_inexact and (parameter in self.request.wrt or kind.is_array and parameter in self.request.of):
                signature.append((self.shadow(parameter), "shadow", parameter))
        before = [assign(self.shadow(p), call("numpy.zeros_like", name(p))) for p in self.parameters
                  if p in self.active and self.typing.table[p].is_array and p not in (*self.request.wrt,
                                                                                      *self.request.of)]
        body = before + self.block(self.structure.function.body)
        results = [o for o in self.request.of if o.startswith("return ")]
        made = function(title, [n for n, _, _ in signature], body)
        return Derivative(made, self.shadows, signature, (["result"] if self.request.with_primal else []) + results)

    def shadow(self, primal: str) -> str:
        if primal not in self.shadows:
            self.shadows[primal] = self.typing.declare(self.free.fresh(f"{primal}_dot"), self.typing.table[primal])
            self.shapes.note_same_shape(self.shadows[primal], primal)
        return self.shadows[primal]

    def value(self, leaf: AST) -> AST:
        if isinstance(leaf, Subscript):
            whole = isinstance(leaf.slice, Constant) and leaf.slice.value is Ellipsis
            shadow = name(self.shadow(base_name(leaf)))
            return shadow if whole else Subscript(shadow, copy(leaf.slice), leaf.ctx)
        assert isinstance(leaf, Name)
        return name(self.shadow(leaf.id))

    def bind_partial(self, partial: AST) -> AST:
        """A name for a partial that is read twice, bound before the tangent."""
        if is_plain(partial):
            return partial
        made = self.typing.declare(self.free.fresh("slope"), self.typing.of(partial))
        self.shapes.arrays[made] = self.shapes.of(partial)
        self.before.append(assign(made, partial))
        return name(made)

    def tangent_of(self, node: AST, result: AST | None = None) -> tuple[list[AST], Term | None]:
        """The tangent of an expression, and what is bound before it."""
        outer, self.before = self.before, []
        term = self.pushforward.tangent(node, result)
        before, self.before = self.before, outer
        return before, term

    def block(self, block: list[AST]) -> list[AST]:
        return [at(made, s) for s in block for made in self.statement(s)]

    def statement(self, statement: AST) -> list[AST]:
        self.shapes.enter(statement)
        if isinstance(statement, For):
            return [For(statement.target, copy(statement.iter), self.block(statement.body), [], None)]
        if isinstance(statement, While):
            return [While(copy(statement.test), self.block(statement.body), [])]
        if isinstance(statement, If):
            return [If(copy(statement.test), self.block(statement.body), self.block(statement.orelse))]
        if isinstance(statement, Return):
            return self.returned(statement)
        if is_kernel_call(statement):
            return self.call(statement)
        if isinstance(statement, Expr) and call_name(statement.value) == "builtins.print":
            return []
        if isinstance(statement, (Assign, AugAssign)):
            return self.assignment(statement)
        return [copy(statement)]

    def assignment(self, statement: AST) -> list[AST]:
        target = targets(statement)[0]
        if base_name(target) not in self.active or not self.typing.of(target).is_inexact:
            return [copy(statement)]
        if is_allocation(statement):
            return [copy(statement), assign(self.shadow(target.id), call("numpy.zeros_like", name(target.id)))]
        after = isinstance(target, Name) or reads_own_result(statement)
        held = after and isinstance(statement, Assign)     # the value itself, not a sum with it
        before, term = self.tangent_of(statement.value, self.primal(target) if held else None)
        place = self.value(target)
        if isinstance(target, Subscript) and isinstance(place, Name):
            place = index(place, const(...))
        if isinstance(statement, AugAssign):
            minus = isinstance(statement.op, Sub)
            moved = [] if term is None else [augment(place, Sub() if term.negative != minus else Add(), term.tree)]
        else:
            moved = [assign(place, const(0.0) if term is None else term.expression())]
        moved = [*before, *moved]
        return [copy(statement), *moved] if after else [*moved, copy(statement)]

    def primal(self, target: AST) -> AST:
        """What a statement has bound or filled, as an expression."""
        whole = isinstance(target, Subscript) and isinstance(target.slice, Constant) and target.slice.value is Ellipsis
        return target.value if whole else name(target.id) if isinstance(target, Name) else copy(target)

    def returned(self, statement: Return) -> list[AST]:
        if statement.value is None:
            return [Return(tuple_of(const(None)))] if self.request.with_primal and not self.flat else []
        parts = list(statement.value.elts) if isinstance(statement.value, Tuple) else [statement.value]
        dots: list[AST] = []
        first: list[AST] = []
        for result in (o for o in self.request.of if o.startswith("return ")):
            part = parts[int(result.split()[1])]
            before, term = self.tangent_of(part)
            first += before
            zero = call("numpy.zeros_like", copy(part)) if self.typing.of(part).is_array else const(0.0)
            dots.append(zero if term is None else term.expression())
        if self.request.with_primal:
            primals = map(copy, parts) if self.flat else [copy(statement.value)]
            return [*first, Return(tuple_of(*primals, *dots))]
        return [*first, Return(tuple_of(*dots))] if dots else []

    def call(self, statement: AST) -> list[AST]:
        pattern = activity_pattern(statement, self.typing, self.active, self.bounds.tangent_boundary)
        if not pattern.arguments and not pattern.results:
            return [copy(statement)]
        callee = self.derive(pattern)
        args = with_shadows(statement.value, callee, self.value)
        bound = [base_name(t) for t in targets(statement)]
        called = call(callee.name, *args)
        if not bound:
            return [Expr(called)]
        dots = [self.shadow(bound[k]) for k in callee.seeds]
        return [assign(tuple_of(*map(name, [*bound, *dots])), called)]
