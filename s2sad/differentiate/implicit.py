"""implicit: the derivative of a function that solves residual(x, p) = 0 is one linear solve at the solution.

Requires the function (`UserFunction`) and derivatives of the residual; establishes a function that is called with
the state that the function leaves. With R the residual, an adjoint solves (dR/dx)^T s = -x_bar and adds (dR/dp)^T s to
p_bar; a tangent solves (dR/dx) x_dot = -(dR/dp) p_dot. (Griewank and Walther, Evaluating Derivatives, 2008, chap. 15.)

    def newton_adjoint(x, x_bar, p, p_bar):
        seed = dense(newton_transposed, -x_bar, (x, p))
        x_bar[...] = 0.0
        residual = np.zeros(x.shape, x.dtype)
        residual_adjoint(residual, seed, x, p, p_bar)
"""
from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from s2sad.analyze.request import DerivativeRequest
from s2sad.differentiate.derivative import Derivative
from s2sad.analyze.callee_derivatives import CalleeDerivative
from s2sad.differentiate.user_functions import UserFunction, UserFunctionWrapper
from s2sad.infer.types import Type
from s2sad.naming import Names
from s2sad.tree import (
    AST, Call, Div, Eq, Expr, FunctionDef, IfExp, Return, assign, attribute, binary, call, compare, const, function,
    index, name, negate, tuple_of,
)


@dataclass(frozen=True)
class Residual:
    """The residual of an implicit function: its parameters, the types of its results, what it stores to, and how its
    derivatives are made (mode, of which parameters, of what)."""
    title: str
    parameters: tuple[str, ...]
    results: tuple[Type, ...]
    written: frozenset[str]
    derive: Callable[[str, tuple[str, ...], tuple[str, ...]], CalleeDerivative]

    def call(self, callee: CalleeDerivative, arguments: Mapping[str, AST], shadows: Mapping[str, AST],
               *seeds: AST) -> Call:
        """The call of a derivative with these arguments and shadows, by parameter."""
        passed: list[AST] = []
        for position, parameter in enumerate(self.parameters):
            passed.append(arguments.get(parameter, name(parameter)))
            if position in callee.shadows:
                passed.append(shadows[parameter])
        return call(callee.name, *passed, *seeds)


def solution_of(taken: tuple[str, ...], written: frozenset[str]) -> str:
    """The array that an implicit function solves for, or "" if it returns a number; `taken` has the parameters of its
    residual: the number and the others, or the array that it fills, the solution and the others."""
    return taken[1] if len(taken) > 1 and taken[1] in written else ""


def implicit_refusal(owner: UserFunction, residual: Residual, request: DerivativeRequest) -> str:
    """Why a call cannot have a derivative through the residual, in words; empty if it can."""
    solution, where = solution_of(residual.parameters, owner.written), f"a residual, '{residual.title}',"
    others = residual.parameters[2:] if solution else residual.parameters[1:]
    if solution and (residual.written != {residual.parameters[0]} or residual.results):
        return (f"solves for its argument '{solution}' with {where} that must fill '{residual.parameters[0]}', and "
                "write and return nothing else")
    if not solution and (residual.written or len(residual.results) != 1 or not residual.results[0].is_number
                         or not residual.results[0].is_float):
        return f"has {where} that must return a float, or take an array that it writes second"
    if not solution and len(owner.floats) != 1:
        return f"has {where} for one number, and must return one float, beside integers"
    if any(t.is_array for t in owner.results):
        return "returns an array, which no function with a derivative of its own may: write it"
    changed = [p for p in others if p in owner.written]
    if changed:
        return f"overwrites '{changed[0]}', which its residual, '{residual.title}', reads"
    beside = [o for o in request.of if o != solution and not (o.startswith("return ") and not solution)]
    if beside:
        what = "what it returns" if beside[0].startswith("return ") else f"'{beside[0]}'"
        return f"has {where} that gives no derivative of {what}, which is differentiated"
    return ""


class Implicit:
    """The derivatives of one call of an implicit function."""

    def __init__(self, owner: UserFunction, residual: Residual, request: DerivativeRequest, title: str, ending: str,
                 product: str):
        self.owner, self.residual, self.request, self.product = owner, residual, request, product
        self.wrapper = UserFunctionWrapper(owner, request, title, ending)
        self.solution = solution_of(residual.parameters, owner.written)
        self.free: Names = self.wrapper.free
        self.others = residual.parameters[2:] if self.solution else residual.parameters[1:]
        self.active = tuple(p for p in self.others if p in request.wrt)
        self.shadows = {p: name(self.wrapper.shadows[p]) for p in self.active}
        self.filled = residual.parameters[0]

    def solved(self, right: AST) -> AST:
        """The call that solves the linear system."""
        own = self.owner.own
        passed = [name(f"user.{self.product}"), right, tuple_of(*map(name, self.operands))]
        if "solver" in own.functions:
            return call("runtime.solved_by", name(own.name("solver")), *passed)
        return call(f"runtime.{own.solver}", *passed)

    @property
    def operands(self) -> tuple[str, ...]:
        return (self.solution, *self.others)

    def zeros(self) -> AST:
        return call("numpy.zeros", attribute(name(self.solution), "shape"), attribute(name(self.solution), "dtype"))

    def matrix(self, ending: str) -> FunctionDef:
        """The product with the matrix of the linear system, transposed for an adjoint."""
        free = Names([*self.operands, self.filled])
        vector, operands, filled = free.fresh("v"), free.fresh("operands"), free.fresh("residual")
        seed, gain = free.fresh(f"residual_{ending}"), free.fresh(f"{self.solution}_{ending}")
        body: list[AST] = [assign(tuple_of(*map(name, self.operands)), name(operands)), assign(filled, self.zeros())]
        if ending == "bar":
            body += [assign(seed, call("numpy.copy", name(vector))), assign(gain, self.zeros())]
        else:
            body += [assign(seed, self.zeros()), assign(gain, call("numpy.copy", name(vector)))]
        mode = "adjoint" if ending == "bar" else "tangent"
        callee = self.residual.derive(mode, (self.solution,), (self.filled,))
        made = self.residual.call(callee, {self.filled: name(filled)}, {
            self.filled: name(seed), self.solution: name(gain)})
        body += [Expr(made), Return(name(gain if ending == "bar" else seed))]
        return function(self.product, [vector, operands], body)

    # -- adjoint -----------------------------------------------------------------------------------------------------

    def adjoint(self) -> tuple[Derivative, tuple[FunctionDef, ...]]:
        """The adjoint, and what stands beside it."""
        wrapper, owner = self.wrapper, self.owner
        numbers = [n for n in self.request.wrt if n in owner.numbers]
        body: list[AST] = []
        beside: tuple[FunctionDef, ...] = ()
        if self.solution and self.solution in (*self.request.wrt, *self.request.of):
            beside = (self.matrix("bar"),)
            body = self.array_adjoint()
        elif not self.solution and self.request.of:
            body = self.number_adjoint()
        gained = [n for n in numbers if n in self.active and body]
        zeros = [assign(wrapper.shadows[n], const(0.0)) for n in numbers if n not in gained]
        last: list[AST] = [Return(tuple_of(*(name(wrapper.shadows[n]) for n in numbers)))] if numbers else []
        return wrapper.build([*zeros, *body, *last], numbers), beside

    def array_adjoint(self) -> list[AST]:
        bar = name(self.wrapper.shadows[self.solution])
        seed, filled = self.free.fresh("seed"), self.free.fresh("residual")
        body: list[AST] = [assign(seed, self.solved(negate(bar))), assign(index(bar, const(...)), const(0.0))]
        if not self.active:
            return body[1:]
        callee = self.residual.derive("adjoint", self.active, (self.filled,))
        made = self.residual.call(callee, {self.filled: name(filled)}, {**self.shadows, self.filled: name(seed)})
        return [*body, assign(filled, self.zeros()), self.gains(callee, made)]

    def number_adjoint(self) -> list[AST]:
        (result,) = self.owner.floats
        value = self.free.fresh("result")
        self.wrapper.signature.append((value, "value", f"return {result}"))
        self.wrapper.add_seeds()
        if not self.active:
            return []
        bar, slope, seed = self.wrapper.seeds[result], self.free.fresh("slope"), self.free.fresh("seed")
        at = {self.filled: name(value)}
        of_x = self.residual.derive("adjoint", (self.filled,), ("return 0",))
        of_p = self.residual.derive("adjoint", self.active, ("return 0",))
        return [assign(tuple_of(name(slope)), self.residual.call(of_x, at, {}, const(1.0))),
                assign(seed, quotient(name(bar), name(slope))),
                self.gains(of_p, self.residual.call(of_p, at, self.shadows, name(seed)))]

    def gains(self, callee: CalleeDerivative, made: Call) -> AST:
        returned = [name(self.wrapper.shadows[self.residual.parameters[k]]) for k in callee.returns]
        return assign(tuple_of(*returned), made) if returned else Expr(made)

    # -- tangent -----------------------------------------------------------------------------------------------------

    def tangent(self) -> tuple[Derivative, tuple[FunctionDef, ...]]:
        """The tangent, and what stands beside it: the function is run, and then the system solved."""
        results = [self.free.fresh("result") for _ in self.owner.results]
        primal = call(f"user.{self.owner.title}", *map(name, self.owner.types))
        bound = name(results[0]) if len(results) == 1 else tuple_of(*map(name, results))
        body: list[AST] = [assign(bound, primal) if results else Expr(primal)]
        returned = [o for o in self.request.of if o.startswith("return ")]
        dots: list[AST] = []
        beside: tuple[FunctionDef, ...] = ()
        if self.solution and self.solution in (*self.request.wrt, *self.request.of):
            place = index(name(self.wrapper.shadows[self.solution]), const(...))
            if self.active:
                beside = (self.matrix("dot"),)
                body += self.array_tangent(place)
            else:
                body.append(assign(place, const(0.0)))
        elif returned:
            dots = [name(self.free.fresh("result_dot"))]
            body += self.number_tangent(results, dots[0])
        values = [*map(name, results), *dots]
        last: list[AST] = [Return(tuple_of(*values))] if values else []
        return self.wrapper.build([*body, *last], ["result", *returned]), beside

    def array_tangent(self, place: AST) -> list[AST]:
        filled, right = self.free.fresh("residual"), self.free.fresh("residual_dot")
        callee = self.residual.derive("tangent", self.active, (self.filled,))
        made = self.residual.call(callee, {self.filled: name(filled)}, {**self.shadows, self.filled: name(right)})
        return [assign(filled, self.zeros()), assign(right, self.zeros()), Expr(made),
                assign(place, self.solved(negate(name(right))))]

    def number_tangent(self, results: list[str], dot: AST) -> list[AST]:
        if not self.active:
            return [assign(dot, const(0.0))]
        (result,) = self.owner.floats
        at = {self.filled: name(results[result])}
        unread, slope, right = (self.free.fresh(w) for w in ("unread", "slope", "residual_dot"))
        of_x = self.residual.derive("tangent", (self.filled,), ("return 0",))
        of_p = self.residual.derive("tangent", self.active, ("return 0",))
        along = self.residual.call(of_x, at, {self.filled: const(1.0)})
        return [assign(tuple_of(name(unread), name(slope)), along),
                assign(tuple_of(name(unread), name(right)), self.residual.call(of_p, at, self.shadows)),
                assign(dot, quotient(name(right), name(slope)))]


def quotient(seed: AST, slope: AST) -> AST:
    """`-seed / slope`, zero where the seed is, whatever the slope."""
    return IfExp(compare(seed, Eq(), const(0.0)), const(0.0), binary(negate(seed), Div(), slope))
