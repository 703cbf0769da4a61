"""single_assignment: every binding of a number gets a name of its own; where paths meet, copies say so.

Requires resolved views; establishes that a number's name is bound once, or only by copies at the ends of the branches
and loops whose paths meet in it, or, as an accumulator, is only added to inside a loop.

    def f(x, n, a):                 def f(x, n, a):
        a = a / n                       a_1 = a / n
        g = a                           g = a_1
        for i in range(n):              g_1 = g
            g = np.sin(g) * x[i]        for i in range(n):
        return g * a                        g_2 = np.sin(g_1) * x[i]
                                            g_1 = g_2
                                        return g_1 * a_1

`simplify.copy_coalescing` takes the copies out again where one name can serve.
"""
from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from s2sad.liveness import Accesses, Liveness
from s2sad.infer.types import Type
from s2sad.naming import Names
from s2sad.normalize.context import NormalContext
from s2sad.tree import (
    AST, Add, Assign, AugAssign, BinOp, Break, For, FunctionDef, If, Name, Sub, Subscript, Tuple, While, assign, at,
    augment, const, name, names, stored_names, substitute, walk, walk_statements, with_body,
)


@dataclass(frozen=True)
class SingleAssignment:
    """The function, and of every new name the user's variable that it is a version of."""
    function: FunctionDef
    family: dict[str, str] = field(default_factory=dict)


def single_assignment(function: FunctionDef, context: NormalContext) -> FunctionDef:
    """The function with one name a binding; the context has the families of names."""
    types, free = context.typing.table, context.names
    live = Liveness(function, set(), Accesses(), strong=False)
    pass_ = _SingleAssignment(types, free, live)
    env = {p.id: p.id for p in function.args.args if not types[p.id].is_array}
    pass_.family.update(env)
    body, _ = pass_.block(function.body, env, None)
    context.family = pass_.family
    return with_body(function, body)


class _SingleAssignment:
    def __init__(self, types: Mapping[str, Type], free: Names, live: Liveness):
        self.types, self.free, self.live = types, free, live
        self.family: dict[str, str] = {}
        self.sums: set[str] = set()
        self.used: set[str] = set()

    def is_number(self, identifier: str) -> bool:
        return identifier in self.types and not self.types[identifier].is_array

    def version(self, variable: str) -> str:
        """A new name for a variable, the variable's own the first time."""
        first = variable not in self.used and variable not in self.family
        self.used.add(variable)
        made = variable if first else self.free.fresh(
            f"{variable}_{sum(f == variable for f in self.family.values())}")
        self.family[made] = variable
        return made

    def block(self, block: list[AST], env: dict[str, str], tail: list[tuple[str, str]] | None
              ) -> tuple[list[AST], dict[str, str]]:
        """The block and the versions at its end; `tail` are the loop's (phi, variable) to copy where it ends."""
        new: list[AST] = []
        for position, statement in enumerate(block):
            if isinstance(statement, Break):
                return [*new, *copies(tail or [], env, statement), statement], env
            if tail is not None and position == len(block) - 1 and isinstance(statement, If) and breaks(statement):
                made = If(self.read(statement.test, env), self.block(statement.body, dict(env), tail)[0],
                          self.block(statement.orelse, dict(env), tail)[0])
                return [*new, at(made, statement)], env
            new.extend(at(s, statement) for s in self.statement(statement, env))
        return [*new, *copies(tail or [], env, block[-1] if block else None)], env

    def read(self, node: AST, env: dict[str, str]) -> AST:
        return substitute(node, {v: name(env[v]) for v in names(node) if v in env and env[v] != v})

    def statement(self, statement: AST, env: dict[str, str]) -> list[AST]:
        if isinstance(statement, Assign):
            return self.assignment(statement, env)
        if isinstance(statement, AugAssign):
            value = self.read(statement.value, env)
            if isinstance(statement.target, Subscript):
                return [augment(self.read(statement.target, env), statement.op, value)]
            variable = statement.target.id
            if variable in self.sums:
                return [augment(env[variable], statement.op, value)]
            value = BinOp(self.read(name(variable), env), statement.op, value)
            env[variable] = self.version(variable)
            return [assign(env[variable], value)]
        if isinstance(statement, If):
            return self.branch(statement, env)
        if isinstance(statement, (For, While)):
            return self.loop(statement, env)
        return [self.read(statement, env)]

    def assignment(self, statement: Assign, env: dict[str, str]) -> list[AST]:
        value, target = self.read(statement.value, env), statement.targets[0]
        if isinstance(target, Subscript):
            return [assign(self.read(target, env), value)]
        if isinstance(target, Tuple):
            made = [name(self.bind(item.id, env)) for item in target.elts]
            return [assign(Tuple(made, target.ctx), value)]
        return [assign(self.bind(target.id, env), value)]

    def bind(self, variable: str, env: dict[str, str]) -> str:
        if not self.is_number(variable):
            return variable
        env[variable] = self.version(variable)
        return env[variable]

    def branch(self, statement: If, env: dict[str, str]) -> list[AST]:
        test = self.read(statement.test, env)
        body, body_env = self.block(statement.body, dict(env), None)
        orelse, orelse_env = self.block(statement.orelse, dict(env), None)
        after = self.live.after[id(statement)]
        for variable in dict.fromkeys([*body_env, *orelse_env]):
            if body_env.get(variable) == orelse_env.get(variable) or variable not in after:
                continue
            merged = self.version(variable)
            body += copies([(merged, variable)], body_env, statement, self.zero(variable))
            orelse += copies([(merged, variable)], orelse_env, statement, self.zero(variable))
            env[variable] = merged
        return [If(test, body, orelse)]

    def zero(self, variable: str) -> AST:
        """The value of a variable that is not bound on this path, and so not read on it."""
        return const(self.types[variable].zero)

    def loop(self, statement: AST, env: dict[str, str]) -> list[AST]:
        inside = [v for v in stored_names(statement.body) if self.is_number(v)]
        counters = {n.target.id for n in walk_statements(statement) if isinstance(n, For)}
        around = self.live.entry.get(id(statement), set()) | self.live.after[id(statement)]
        around |= set(names(statement.test)) if isinstance(statement, While) else set()
        carried = [v for v in inside if v in around and v not in counters]
        added = [v for v in carried if v not in self.sums and _only_added(statement, v)]
        before: list[AST] = []
        tail: list[tuple[str, str]] = []
        for variable in carried:
            if variable in self.sums:
                continue
            phi = self.version(variable)
            before += copies([(phi, variable)], env, statement, self.zero(variable))
            env[variable] = phi
            if variable not in added:
                tail.append((phi, variable))
        self.sums |= set(added)
        inner = dict(env)
        if isinstance(statement, For):
            head = statement.iter
            bounds = substitute(head, {v: name(e) for v, e in self.outer(env, before).items()})
            inner[statement.target.id] = statement.target.id
            made: AST = For(statement.target, bounds, self.block(statement.body, inner, tail)[0], [], None)
        else:
            made = While(self.read(statement.test, env), self.block(statement.body, inner, tail)[0], [])
        self.sums -= set(added)
        return [*before, made]

    def outer(self, env: dict[str, str], before: list[AST]) -> dict[str, str]:
        """The versions that a loop's bounds see: those from before its copies (a phi still has that value)."""
        return {v: e for v, e in env.items() if v != e}


def copies(pairs: list[tuple[str, str]], env: Mapping[str, str], origin: AST | None,
           missing: AST | None = None) -> list[AST]:
    """`phi = version` for each pair (phi, variable)."""
    made: list[AST] = []
    for phi, variable in pairs:
        value = name(env[variable]) if variable in env else missing
        if value is not None and not (isinstance(value, Name) and value.id == phi):
            made.append(at(assign(phi, value), origin) if origin is not None else assign(phi, value))
    return made


def breaks(statement: AST) -> bool:
    """Whether a statement holds a break of the loop around it."""
    if isinstance(statement, Break):
        return True
    return isinstance(statement, If) and any(breaks(s) for s in [*statement.body, *statement.orelse])


def _only_added(loop: AST, variable: str) -> bool:
    """Whether all that a loop does with a variable is to add to it or to subtract from it."""
    adding = [s for s in walk_statements(loop) if isinstance(s, AugAssign) and isinstance(s.target, Name)
              and s.target.id == variable and isinstance(s.op, (Add, Sub)) and variable not in names(s.value)]
    uses = sum(isinstance(n, Name) and n.id == variable for n in walk(loop))
    return bool(adding) and uses == len(adding)
