"""inlining: a function of numbers that computes transcendental values is written where loops call it.

    def gain(x):
        return x * np.exp(-x)

    def f(x: float64[:], y: float64[:]):
        for i in range(x.size):
            y[i] = gain(x[i])

in its adjoint:

    def f_adjoint(...):
        for i in range(x.size):
            ...
            (gain,) = gain_adjoint(x[i], gain_value_bar)
            x_bar[i] += gain

becomes

    def f_adjoint(...):
        for i in range(x.size):
            ...
            gain_x = x[i]
            gain_exp_value = np.exp(-gain_x)
            gain_x_bar = gain_exp_value * gain_value_bar
            gain_exp_value_bar = gain_x * gain_value_bar
            gain_x_bar -= gain_exp_value * gain_exp_value_bar if gain_exp_value_bar != 0.0 else 0.0
            gain = gain_x_bar
            x_bar[i] += gain

*Requires* finished text for Numba; the functions to be inlined, finished, too, which neither write arrays nor branch.
*Establishes* the same values: `vector_math` sees what the function computes, and what it and its derivative both
compute is computed once. Other functions of numbers are left to LLVM. (Allen, Kennedy, Optimizing Compilers for Modern
Architectures, 2001.)
"""
from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from s2sad.blocks import returned_values, with_blocks
from s2sad.infer.types import Type
from s2sad.liveness import targets
from s2sad.naming import Names
from s2sad.optimize.expensive_values import is_expensive
from s2sad.simplify.context import DerivativeContext, InlinedFunction
from s2sad.tree import (
    AST, Assign, AugAssign, BoolOp, Call, For, FunctionDef, If, IfExp, Name, Return, Tuple, While, assign,
    at, call_name, copy, is_comment, name, rebuild, stored_names, user_call, walk,
)

CHANGES_ROUNDING = False
_LONGEST = 32       # statements, with those of the functions that it calls


def inlining(function: FunctionDef, context: DerivativeContext) -> FunctionDef:
    """The function without calls of `context.inlined` in its loops."""
    if not any(user_call(n) in context.inlined for n in walk(function.body)):
        return function
    new, inlined = copy(function), _Inlining(function, context)
    new.body = [with_blocks(s, inlined.block) if isinstance(s, (For, While)) else s for s in function.body]
    context.types = {**context.types, **inlined.types}
    return new


def inlined_functions(functions: Iterable[FunctionDef], types: Mapping[str, Mapping[str, Type]]
                      ) -> dict[str, InlinedFunction]:
    """Those of the functions, callees first, that are to be inlined, by their names."""
    found: dict[str, InlinedFunction] = {}
    lengths: dict[str, int] = {}
    for f in functions:
        inside = [c for n in walk(f.body) if (c := user_call(n)) in found]
        length = sum(not is_comment(s) for s in f.body) + sum(lengths[c] for c in inside)
        if f.name in types and length <= _LONGEST and _is_straight(f, types) and (
                inside or any(map(is_expensive, walk(f.body)))):
            found[f.name], lengths[f.name] = InlinedFunction(f, types[f.name]), length
    return found


def _is_straight(function: FunctionDef, types: Mapping[str, Mapping[str, Type]]) -> bool:
    """Whether a function binds numbers, one after the other, and returns some."""
    *body, last = function.body
    own = types[function.name]
    if not isinstance(last, Return) or last.value is None or not all(
            isinstance(s, (Assign, AugAssign)) and all(isinstance(t, Name) for t in targets(s))
            for s in body if not is_comment(s)):
        return False
    return all(p.id in own and own[p.id].is_number for p in function.args.args) and not any(
        n.id in own and own[n.id].is_array for n in walk(function.body) if isinstance(n, Name))


class _Inlining:
    """One function; `types` are those of the names that it gets."""

    def __init__(self, function: FunctionDef, context: DerivativeContext):
        self.inlined, self.given, self.writing = context.inlined, context.types, context.writing
        self.free = Names({n.id for n in walk(function) if isinstance(n, Name)} | set(context.types))
        self.types: dict[str, Type] = {}

    def block(self, block: list[AST]) -> list[AST]:
        made: list[AST] = []
        for statement in block:
            if isinstance(statement, (For, While, If)):
                made.append(with_blocks(statement, self.block))
            else:
                made += self.statement(statement)
        return made

    def statement(self, statement: AST) -> list[AST]:
        """A statement behind what it called."""
        before: list[AST] = []
        while isinstance(statement, (Assign, AugAssign)) and (found := next(self.calls(statement), None)) is not None:
            body, values = self.body(found)
            before += [at(s, statement) for made in body for s in self.statement(made)]
            if found is statement.value and isinstance(statement, Assign) and isinstance(
                    target := statement.targets[0], Tuple):
                return [*before, *(at(s, statement) for s in self.bound(target.elts, values))]
            [value], call = values, found
            statement = rebuild(statement, lambda n, v=value, c=call: v if n is c else None)
        return [*before, statement]

    def bound(self, targets: list[AST], values: list[AST]) -> list[AST]:
        """What binds several names at once."""
        if len(targets) == 1:
            return [Assign(targets, values[0], None)]
        held = [self.free.fresh(t.id if isinstance(t, Name) else "value") for t in targets]
        self.types |= {h: self.given[t.id] for h, t in zip(held, targets) if isinstance(t, Name) and t.id in self.given}
        return [*map(assign, held, values), *(Assign([t], name(h), None) for t, h in zip(targets, held))]

    def calls(self, statement: AST) -> Iterator[Call]:
        """The calls to inline of a statement that are always made, inner ones first."""
        if any(call_name(n) in self.writing for n in walk(statement)):     # which arguments read, on either side
            return
        chosen = {id(n) for c in walk(statement) if isinstance(c, (BoolOp, IfExp)) for n in walk(c)}
        single = not (isinstance(statement, Assign) and isinstance(statement.targets[0], Tuple))
        for n in reversed(list(walk(statement.value))):
            if isinstance(n, Call) and (called := user_call(n)) in self.inlined and id(n) not in chosen and (
                    not single or len(returned_values(self.inlined[str(called)].function.body)) == 1):
                yield n

    def body(self, node: Call) -> tuple[list[AST], list[AST]]:
        """The statements of a call under names of their own, and what it returns."""
        function, types = self.inlined[str(user_call(node))].function, self.inlined[str(user_call(node))].types
        *body, _ = function.body
        names: dict[str, str] = {}
        made: list[AST] = []
        bound = set(stored_names(body))
        for parameter, given in zip(function.args.args, node.args):
            if isinstance(given, Name) and parameter.id not in bound:
                names[parameter.id] = given.id
                continue
            names[parameter.id] = self.fresh(function, parameter.id, types)
            made.append(assign(names[parameter.id], copy(given)))
        names |= {n: self.fresh(function, n, types) for n in sorted(bound - names.keys())}
        made += [_renamed(s, names) for s in body if not is_comment(s)]
        return made, [_renamed(v, names) for v in returned_values(function.body)]

    def fresh(self, function: FunctionDef, wanted: str, types: Mapping[str, Type]) -> str:
        """A new name for one of a function's, of the type that it has there."""
        made = self.free.fresh(f"{function.name.removesuffix('_adjoint')}_{wanted}")
        if wanted in types:
            self.types[made] = types[wanted]
        return made


def _renamed(node: AST, names: Mapping[str, str]) -> AST:
    """A copy under other names, which has no place of its own: that is the call's."""
    new = copy(node)
    for n in walk(new):
        if isinstance(n, Name) and n.id in names:
            n.id = names[n.id]
        n.__dict__.pop("lineno", None)
    return new


__all__ = ["inlined_functions", "inlining"]
