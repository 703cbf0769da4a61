"""adjoint: a function in normal form becomes its adjoint, statement by statement.

Requires the plan of what is recorded; establishes the grammar "derivative" of `form` and the signature
(`context.derivative`). The forward sweep has all but the stores that nothing reads: `simplify.dead_code` prunes it to
what the reverse sweep reads.

    def f(y, x, a):         def f_adjoint(y, y_bar, x, x_bar, a):
        y[0] = a * x[0]         # forward sweep
                                # reverse sweep
                                a_bar = 0.0
                                seed = y_bar[0]
                                y_bar[0] = 0.0
                                a_bar += x[0] * seed
                                x_bar[0] += a * seed
                                return (a_bar,)
"""
from __future__ import annotations

from s2sad.blocks import returned_values, with_blocks
from s2sad.liveness import base_name, targets
from s2sad.analyze.uses import DerivativeFlow, reads_own_result
from s2sad.differentiate.arithmetic import Term
from s2sad.analyze.callee_derivatives import is_kernel_call
from s2sad.differentiate.trip_counters import TripCounters
from s2sad.differentiate.context import DifferentiationContext
from s2sad.differentiate.derivative import Derivative
from s2sad.differentiate.expression_rules import Pullback
from s2sad.differentiate.split_adjoints import SplitAdjoints
from s2sad.differentiate.reallocation import empty_at_first
from s2sad.differentiate.shadows import Shadows, with_shadows
from s2sad.differentiate.sweeps import Sweeps
from s2sad.differentiate.tape import Tape
from s2sad.differentiate.zero_law import ZeroLaw
from s2sad.infer.shapes import shapes_of
from s2sad.infer.slice_extents import scattered
from s2sad.infer.types import BOOL, Type
from s2sad.normalize.loops.hoist_allocations import is_allocation
from s2sad.program import MISFIT
from s2sad.tree import (
    AST, Add, Assert, Assign, AugAssign, Constant, Eq, Expr, FunctionDef, Name, Return, Sub, Subscript, assign,
    at, attribute, augment, call, comment, compare, const, copy, function, index, indices, name, names, stored_names,
    tuple_of, user_call, walk, walk_statements,
)


REVERSE = "reverse sweep"


def adjoint(function: FunctionDef, context: DifferentiationContext) -> FunctionDef:
    """The adjoint of a function."""
    context.derivative = _Adjoint(context).build(context.title)
    return context.derivative.function


class _Adjoint(Shadows):
    def __init__(self, context: DifferentiationContext):
        assert context.plan is not None
        self.structure, self.typing, self.plan = context.structure, context.typing, context.plan
        self.active, self.bounds = context.activity.active, context.unbounded
        self.request, self.free = context.request, context.names
        self.shadows: dict[str, str] = {}
        self.scopes: dict[int, list[str]] = {}
        self.tape = Tape(self.structure, self.typing, self.free, self.plan.rerun,
                         TripCounters(self.structure, self.plan, self.free), self.plan.dtypes)
        self.shapes = shapes_of(self.structure.function, self.typing)
        self.halves = SplitAdjoints(self.structure, self.active, self.free, context.derive, self.bounds,
                                    self.plan.halves)
        self.sweeps = Sweeps(self.structure, self.plan, self.tape, self.free, self.statement, self.zeros, self.shapes,
                             context.family, self.halves.forward_call)
        self.pullback = Pullback(DerivativeFlow(self.typing, self.active, context.choices), self.bind, self.shapes,
                                 ZeroLaw(self.bounds, self.flag(context)))
        self.parameters = [p.id for p in self.structure.function.args.args]
        self.written = {base_name(t) for s in walk_statements(self.structure.function.body)
                        if isinstance(s, (Assign, AugAssign))
                        for t in targets(s) if isinstance(t, Subscript)}

    def bind(self, base: str, like: AST) -> str:
        made = self.typing.declare(self.free.fresh(base), self.typing.of(like))
        self.shapes.arrays[made] = self.shapes.of(like)
        return made

    def flag(self, context: DifferentiationContext) -> str:
        """The name of the flag that a seed is infinite; none for loops, where a partial is asked at no cost."""
        filled = {base_name(t) for s in walk(self.structure.function.body) for t in targets(s)}
        arrays = any(self.typing.table[n].is_array for n in filled & context.unbounded.seeds)
        local = arrays and not context.in_loops and context.unbounded.has_steep_roots_alone
        return self.typing.declare(self.free.fresh("steep"), BOOL) if local else ""

    def with_flag(self, reverse: list[AST]) -> list[AST]:
        """The reverse sweep with its flag, where that is read."""
        law = self.pullback.zero_law
        if law.flagged:
            return [assign(law.flag, const(False)), *reverse]

        def unset(block: list[AST]) -> list[AST]:
            return [with_blocks(s, unset) for s in block
                    if not isinstance(s, Assign) or base_name(s.targets[0]) != law.flag]
        return unset(reverse) if law.flag else reverse

    # -- the function ------------------------------------------------------------------------------------------------

    def build(self, title: str) -> Derivative:
        signature, seeds = self.signature()
        self.seeds = seeds
        self.find_scopes()
        added = self.private_shadows()
        self.sweeps.prints = self.request.split or self.request.halves
        forward = [*empty_at_first(self.structure), *self.sweeps.forward(self.structure.function.body)]
        self.sweeps.prints = False
        reverse = self.with_flag(self.sweeps.reverse(self.structure.function.body))
        last = [augment(index(name(p), const(...)), Add(), name(s)) for p, s in added]
        returned = [p for p in self.request.wrt if self.typing.table[p].is_number]
        values: list[AST] = [name(self.shadow(p)) for p in returned]
        closing: list[AST] = [Return(tuple_of(*values))] if values else []
        held: list[AST] = []
        if self.request.with_primal:
            result = self.primal_result()
            if touched(reverse) & set(names(result)):   # an iteration that runs again in the reverse sweep adds again
                held = [assign(self.bind("value", result), result)]
                result = name(held[0].targets[0].id)
            closing = [Return(tuple_of(result, *values))]
        zeros = [assign(self.shadow(p), const(0.0)) for p in returned
                 if p not in self.active and not self.request.accumulates]
        # which seeds fit is asked before a shadow changes: by the function that has them
        fit, late = (([], self.seeds_fit()) if self.request.split else (self.seeds_fit(), []))
        body = [comment("forward sweep"), *self.halves.stacks(), *forward, *held, *fit, comment(REVERSE), *late,
                *zeros, *reverse, *last, *closing]
        made = function(title, [n for n, _, _ in signature], body)
        return Derivative(made, self.shadows, signature, (["result"] if self.request.with_primal else []) + returned,
                          self.tape, self.halves.lists())

    def primal_result(self) -> AST:
        last = self.structure.function.body[-1]
        return const(None) if not isinstance(last, Return) or last.value is None else copy(last.value)

    def signature(self) -> tuple[list[tuple[str, str, str]], dict[int, str]]:
        """The parameters, and the seeds by the number of the result."""
        signature: list[tuple[str, str, str]] = []
        for parameter in self.parameters:
            signature.append((parameter, "primal", parameter))
            kind = self.typing.table[parameter]
            shown = {*self.request.wrt, *self.request.of} if kind.is_array or self.request.accumulates else ()
            if kind.is_inexact and parameter in shown:
                signature.append((self.shadow(parameter), "shadow", parameter))
        results = [o for o in self.request.of if o.startswith("return ")]
        single = self.results_count() == 1
        seeds: dict[int, str] = {}
        for result in results:
            number = int(result.split()[1])
            seed = self.free.fresh("result_bar" if single else f"result_{number}_bar")
            seeds[number] = self.typing.declare(seed, self.result_type(number))
            self.shapes.arrays[seeds[number]] = self.shapes.of(self.results()[number])
            signature.append((seeds[number], "seed", result))
        return signature, seeds

    def seeds_fit(self) -> list[AST]:
        """Guards that the seeds of arrays have their shapes, before a store to a shadow."""
        return [Assert(compare(attribute(copy(self.results()[number]), "shape"), Eq(), attribute(name(seed), "shape")),
                       const(f"{seed}{MISFIT}")) for number, seed in self.seeds.items()
                if self.typing.table[seed].is_array]

    def results(self) -> list[AST]:
        return returned_values(self.structure.function.body)

    def results_count(self) -> int:
        return sum(self.typing.of(r).is_inexact for r in self.results())

    def result_type(self, number: int) -> Type:
        return self.typing.of(self.results()[number])

    # -- statements --------------------------------------------------------------------------------------------------

    def place(self, leaf: AST) -> AST:
        """The shadow's cell, row or whole of a reference."""
        if isinstance(leaf, Subscript):
            return Subscript(name(self.shadow(base_name(leaf))), copy(leaf.slice), leaf.ctx)
        assert isinstance(leaf, Name)
        shadow = name(self.shadow(leaf.id))
        return index(shadow, const(...)) if self.typing.of(leaf).is_array else shadow

    def value(self, leaf: AST) -> AST:
        place = self.place(leaf)
        whole = isinstance(place, Subscript) and isinstance(place.slice, Constant) and place.slice.value is Ellipsis
        return place.value if whole else place

    def increments(self, node: AST, seed: Term, result: AST | None = None, region: AST | None = None) -> list[AST]:
        gains = self.pullback.increments(node, seed, result, region)
        return [*gains.before, *(self.increment(leaf, term) for leaf, term in gains.sums())]

    def increment(self, leaf: AST, term: Term) -> AST:
        """The statement that adds to the shadow of a leaf; an element that is picked twice gains twice."""
        op = Sub() if term.negative else Add()
        if not isinstance(leaf, Subscript) or not scattered(leaf, self.typing):
            return augment(self.place(leaf), op, term.tree)
        shadow = name(self.shadow(base_name(leaf)))
        places = index(name("numpy.s_"), *map(copy, indices(leaf)))
        return augment(index(shadow, const(...)), op, call("runtime.scattered", term.tree, attribute(
            copy(shadow), "shape"), places))

    def statement(self, statement: AST) -> list[AST]:
        """The adjoint of a statement that is no loop and no branch."""
        self.shapes.enter(statement)
        if is_kernel_call(statement):
            return [at(s, statement) for s in self.call(statement)]
        if isinstance(statement, Return):
            self.pullback.zero_law.enter("")
            return [s for number, seed in self.seeds.items()
                    for s in self.increments(self.results()[number], Term(name(seed)))]
        if is_allocation(statement):
            return self.allocation(statement)
        if not isinstance(statement, (Assign, AugAssign)):
            return []
        target = targets(statement)[0]
        if base_name(target) not in self.active or not self.typing.of(target).is_inexact:
            return []
        self.pullback.zero_law.enter(base_name(target))
        if isinstance(target, Name):
            return self.number(target, statement)
        return self.store(target, statement)

    def allocation(self, statement: Assign) -> list[AST]:
        """The shadow of the array that the name had before: nothing has been read of it yet."""
        array, home = statement.targets[0].id, self.structure.place(statement).block
        if id(statement) not in self.plan.reallocated or array not in self.active or array in self.scopes.get(home, []):
            return []
        return [assign(self.shadow(array), call("numpy.zeros_like", name(array)))]

    def number(self, target: Name, statement: AST) -> list[AST]:
        seed = name(self.shadow(target.id))
        if isinstance(statement, AugAssign):
            return self.increments(statement.value, Term(seed, isinstance(statement.op, Sub)))
        made = self.increments(statement.value, Term(seed), name(target.id))
        if len(self.structure.bindings[target.id]) > 1:
            made.append(assign(seed, const(0.0)))
        return made

    def store(self, target: Subscript, statement: AST) -> list[AST]:
        cell = self.value(target)
        whole = self.typing.of(target).is_array
        region = (name(target.value.id) if isinstance(cell, Name) else copy(target)) if whole else None
        leaves = self.pullback.leaves(statement.value)
        made: list[AST] = []
        seed: AST = cell
        inside = any(isinstance(n, Name) and self.reads(n.id, base_name(target)) for n in walk(statement.value))
        adds = isinstance(statement, AugAssign)
        if leaves and (not adds or leaves > 1 or inside):
            held = self.bind("seed", cell)
            made.append(assign(held, call("numpy.copy", cell) if whole and (inside or not adds) else cell))
            seed = name(held)
        if not adds:
            made.append(assign(copy(self.place(target)), const(0.0)))
        negative = adds and isinstance(statement.op, Sub)
        result = copy(self.load(target)) if reads_own_result(statement) else None
        return made + self.increments(statement.value, Term(copy(seed), negative), result, region)

    def reads(self, identifier: str, array: str) -> bool:
        """Whether a name is an array, or a number that was read from it, whose gain goes there as well."""
        return identifier == array or any(isinstance(s, Assign) and base_name(s.value) == array
                                          for s in self.structure.bindings.get(identifier, ()))

    def load(self, target: Subscript) -> AST:
        """A place as an expression."""
        whole = isinstance(target.slice, Constant) and target.slice.value is Ellipsis
        return target.value if whole else target

    def call(self, statement: AST) -> list[AST]:
        callee = self.halves.adjoint(statement)
        if callee is None:
            return []
        args = with_shadows(statement.value, callee, self.value)
        bound = [base_name(t) for t in targets(statement)]
        args += [name(bound[k]) for k in callee.values]
        args += [name(self.shadow(bound[k])) for k in callee.seeds]
        made: list[AST] = []
        if callee.forward:
            made += self.halves.pop(statement)
            args.append(name(self.halves.saved_state(statement).value))
        returned = [base_name(self.place(statement.value.args[position])) if position in callee.shadows else
                    self.typing.declare(self.free.fresh("gain"), self.typing.of(statement.value.args[position]))
                    for position in callee.returns]
        called = call(callee.name, *args)
        made.append(assign(tuple_of(*map(name, returned)), called) if returned else Expr(called))
        made += [assign(self.shadow(b), const(0.0)) for b in bound
                 if b in self.active and len(self.structure.bindings[b]) > 1]
        for held, position in zip(returned, callee.returns):
            if position not in callee.shadows:
                made.append(augment(self.place(statement.value.args[position]), Add(), name(held)))
        return made


def touched(block: list[AST]) -> set[str]:
    """The names that statements bind, and the arrays that they may write."""
    found = set(stored_names(block))
    for node in walk(block):
        if isinstance(node, (Assign, AugAssign)):
            found |= {base_name(t) for t in targets(node)}
        elif user_call(node):
            found |= set(map(base_name, node.args))
    return found
