"""inline: a function of the user's that returns an array is inlined where it is called.

    def smooth(u):
        out = np.zeros_like(u)
        for i in range(1, u.size - 1):
            out[i] = 0.5 * (u[i - 1] + u[i + 1])
        return out

is inlined into its caller:

    def f(v: "float64[:]"):     def f(v):
        s = smooth(v)               out = np.zeros_like(v)
        return s[1]                 for i in range(1, v.size - 1):
                                        out[i] = 0.5 * (v[i - 1] + v[i + 1])
                                    s = out
                                    return s[1]

Requires structured form. Establishes it for a kernel whose calls return no array, so that aliases between the names of
callee and caller (an argument that is stored into, a view that is returned) follow from the statements. Inlined, too,
is a function with a loop that keeps snapshots: the halves of its adjoint belong to the two sweeps of one function.
Local names of the callee are renamed where the caller has them; a parameter that is never bound is substituted by its
argument.
Functions that return numbers only, or nothing, stay functions, and so do those that can write their results into
arrays of the caller's (`destination_passing`).
"""
from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import replace

from s2sad.blocks import with_blocks
from s2sad.diagnostics import Report, Source
from s2sad.infer.inference import Typing
from s2sad.infer.types import FLOAT, Type
from s2sad.naming import Names
from s2sad.normalize.calls.destination_passing import (
    DestinationVersion, OwnedResults, destination_passing, filling_call, with_arguments,
)
from s2sad.normalize.context import NormalContext
from s2sad.normalize.live_range_splitting import split_live_ranges
from s2sad.normalize.buffers.argument_rotation import rotated
from s2sad.program import Kernel, Program, SourcePlace, for_types
from s2sad.tree import (
    AST, Assign, Call, Compare, Constant, Eq, Expr, For, FunctionDef, If, Name, Not, NotEq, Return, Store, Tuple,
    UnaryOp, While, assign, at, copy, function, name, names, rebuild, stored_names, tuple_of, user_call,
    walk, walk_statements, with_body,
)

Structured = Callable[[Kernel, Names, Program], FunctionDef]


class Helpers:
    """The functions of a program in structured form, and the types of what they return."""

    def __init__(self, program: Program, structured: Structured):
        self.program, self._structured = program, structured
        self._trees: dict[str, FunctionDef] = {}
        self._results: dict[tuple[str, tuple[Type, ...]], tuple[Type, ...]] = {}
        self._own: dict[tuple[str, tuple[Type, ...]], OwnedResults] = {}
        self._destinations: dict[tuple[str, tuple[Type, ...]], DestinationVersion | None] = {}

    def destination(self, kernel: str, types: tuple[Type, ...]) -> DestinationVersion | None:
        """The function that writes what this one returns, if it stays a function."""
        kernel = for_types(self.program.kernels[kernel], types)
        if (kernel, types) not in self._destinations:
            self._destinations[kernel, types] = destination_passing(
                self.program.kernels[kernel], self.owned_results(kernel, types), self.results(kernel, types),
                self.program)
        return self._destinations[kernel, types]

    def owned_results(self, kernel: str, types: tuple[Type, ...]) -> OwnedResults:
        """What a function returns of its own."""
        if (kernel, types) not in self._own:
            tree = self.tree(kernel, types)
            tree, typing = self.typing(tree, dict(zip((p.id for p in tree.args.args), types)), self.program.kernels[
                kernel].source, Names(n.id for n in walk(tree) if isinstance(n, Name)))
            self._own[kernel, types] = OwnedResults(tree, typing, lambda called: self.shapes(called, typing))
        return self._own[kernel, types]

    def shapes(self, called: Call, typing: Typing) -> list[AST | None]:
        """The shapes of what a call returns, of its arguments."""
        kernel = self.program.kernels[_called(called)]
        if kernel.own is not None:
            return []
        found = self.owned_results(kernel.name, tuple(map(typing.argument, called.args)))
        arguments = dict(zip((p.id for p in found.tree.args.args), called.args))
        return [None if s is None else with_arguments(s, arguments) for s in found.shapes]

    def tree(self, kernel: str, types: tuple[Type, ...] | None = None) -> FunctionDef:
        """A function; of one that stands for a derivative that which is made for these types, or what stands for it."""
        source, key = self.program.kernels[kernel], kernel
        if types is not None and source.nested is not None:
            made = dict(source.nested.made).get(types)
            source = self.program.kernels[made] if made else replace(source, tree=source.nested.standing or source.tree)
            key = made or f"{kernel} stands"
        if key not in self._trees:
            self._trees[key] = self._structured(source, Names(), self.program)
        return self._trees[key]

    def typing(self, tree: FunctionDef, types: Mapping[str, Type], source: Source,
               free: Names) -> tuple[FunctionDef, Typing]:
        """The function with a name for each live range, and the types of its names, as far as they are known; what is
        wrong is said when it is prepared."""
        values = {**self.program.constants, **self.program.arrays}
        tree, table = split_live_ranges(tree, types, self.results, Report(source), values, free)
        return tree, Typing({**table, **types}, self.results, Report(source), values)

    def written(self, kernel: str, types: tuple[Type, ...]) -> FunctionDef:
        """The function that is inlined for arguments of these types."""
        kernel = for_types(self.program.kernels[kernel], types)
        tree, source = self.tree(kernel, types), self.program.kernels[kernel].source
        free = Names(n.id for n in walk(tree) if isinstance(n, Name))
        tree, typing = self.typing(tree, dict(zip((p.id for p in tree.args.args), types)), source, free)
        return rotated(tree, typing, free, within=True)

    def results(self, kernel: str, types: tuple[Type, ...]) -> tuple[Type, ...]:
        """The types of what a function returns for arguments of these types."""
        key = (kernel, types)
        own = self.program.kernels[kernel].own
        if own is not None and "primal" in own.functions:
            return (FLOAT,) * own.returns  # it is not read
        if key not in self._results:
            tree = self.tree(kernel, types)
            parameters = dict(zip((p.id for p in tree.args.args), types))
            tree, typing = self.typing(tree, parameters, self.program.kernels[kernel].source, Names(
                n.id for n in walk(tree) if isinstance(n, Name)))
            self._results[key] = tuple(map(typing.of, returned(tree)))
        return self._results[key]


def inline(tree: FunctionDef, context: NormalContext) -> FunctionDef:
    """The function without calls that return arrays; its source has those of the functions that were inlined."""
    types, free, source, helpers = context.given, context.names, context.kernel.source, context.helpers
    pass_ = _Inline(free, source, helpers, context.callees.checkpoints)
    while any(map(_called, walk(tree.body))):
        tree, pass_.typing = helpers.typing(tree, types, source, free)
        pass_.changed = False
        new = with_body(tree, pass_.block(tree.body))
        if not pass_.changed:
            break
        tree = new
    context.kernel = replace(context.kernel, source=pass_.source)
    context.report = Report(pass_.source)
    return _without_parameter_aliases(tree, pass_.held)


def returned(tree: FunctionDef) -> list[AST]:
    """What a function in structured form returns, in order."""
    last = tree.body[-1] if tree.body else None
    value = last.value if isinstance(last, Return) else None
    return [] if value is None else list(value.elts) if isinstance(value, Tuple) else [value]


def _called(node: AST) -> str:
    """The user's function that a node calls, or ""."""
    return user_call(node) or ""


class _Inline:
    """The statements of one function; `changed` if a call was inlined."""
    typing: Typing

    def __init__(self, free: Names, source: Source, helpers: Helpers, checkpoints: Collection[tuple[str, int, int]]):
        self.free, self.source, self.helpers, self.checkpoints = free, source, helpers, checkpoints
        self.changed = False
        self.held: dict[str, str] = {}          # names of parameters, with the arguments that they are bound to

    def block(self, block: list[AST]) -> list[AST]:
        return [made for statement in block for made in self.statement(statement)]

    def statement(self, statement: AST) -> list[AST]:
        if isinstance(statement, (For, If, While)):
            return [with_blocks(statement, self.block)]
        value = statement.value if isinstance(statement, (Assign, Expr)) else None
        if value is None or not _called(value):
            return [statement]
        keeps = self.keeps_snapshots(_called(value))
        if not keeps and not any(t.is_array for t in self.typing.call_results(value)):
            return [statement]
        if self.helpers.program.kernels[_called(value)].own is not None:
            return [statement]  # its derivative is the user's own, whatever it returns
        self.changed = True
        version = None if keeps else self.helpers.destination(_called(value), tuple(map(
            self.typing.argument, value.args)))
        return self.inlined(statement, value, keeps) if version is None else self.filled(statement, value, version)

    def keeps_snapshots(self, kernel: str) -> bool:
        """Whether a function, or one that it calls, has a loop that keeps snapshots."""
        waiting = [kernel] if self.checkpoints else []
        for title in waiting:
            found = self.helpers.program.kernels[title]
            places = (SourcePlace.of(found.source, s) for s in walk_statements(found.tree.body)
                      if isinstance(s, (For, While)) and getattr(s, "lineno", None))
            if any((p.path, p.line, p.column) in self.checkpoints for p in places):
                return True
            waiting += {_called(n) for n in walk(found.tree.body)} - {"", *waiting}
        return False

    def filled(self, statement: Assign | Expr, called: Call, version: DestinationVersion) -> list[AST]:
        """A call that writes the results, and the allocations of the arrays that it writes them into."""
        parameters = [p.id for p in self.helpers.tree(_called(called)).args.args]
        arguments: dict[str, AST] = {}
        before: list[AST] = []
        for parameter, argument in zip(parameters, called.args):
            arguments[parameter] = argument
            if not isinstance(argument, (Name, Constant)):
                arguments[parameter] = name(held := self.free.numbered(parameter))
                before.append(at(assign(held, argument), statement))
        fresh = self.bound_by(statement, len(version.results), set(names(list(arguments.values())))) or [
            self.free.numbered(result) for result, _ in version.results]
        values = list(map(name, fresh))
        last = at(Return(values[0] if len(values) == 1 else tuple_of(*values)), statement)
        return [*before, *filling_call(statement, called, version, arguments, fresh), *self.results(statement, last)]

    def bound_by(self, statement: Assign | Expr, count: int, read: set[str]) -> list[str]:
        """The names that a call is bound to, if they are no names of its arguments."""
        target = statement.targets[0] if isinstance(statement, Assign) else None
        bound = [t.id for t in getattr(target, "elts", [target]) if isinstance(t, Name)]
        return bound if len(set(bound)) == count and not read & set(bound) else []

    def inlined(self, statement: Assign | Expr, called: Call, apart: bool) -> list[AST]:
        """The function's statements in place of a call of it; with its numbers `apart`, so that what their adjoints sum
        has the order that it has in a function."""
        kernel = _called(called)
        types = tuple(map(self.typing.argument, called.args))
        tree = self.placed(self.helpers.written(kernel, types), self.helpers.program.kernels[kernel].source)
        bound, parameters = set(stored_names(tree.body)), [p.id for p in tree.args.args]
        substitution: dict[str, AST] = {}
        before: list[AST] = []
        for parameter, argument in zip(parameters, called.args):
            separate = apart and self.typing.of(argument).is_inexact and not self.typing.of(argument).is_array
            if parameter not in bound and isinstance(argument, (Name, Constant)) and not separate:
                substitution[parameter] = argument
            else:
                held = self.free.numbered(parameter)
                substitution[parameter] = name(held)
                if isinstance(argument, Name):
                    self.held[held] = argument.id
                before.append(at(assign(held, argument), statement))
        local = [n for n in dict.fromkeys([*bound, *names(tree.body)]) if n not in substitution]
        substitution |= {n: name(self.free.numbered(n)) for n in sorted(local, key=_first_place(tree))}
        body = _without_dead_branches([_renamed(s, substitution) for s in tree.body])
        last = body.pop() if body and isinstance(body[-1], Return) else None
        return [*before, *body, *([] if last is None or last.value is None else self.results(statement, last))]

    def placed(self, tree: FunctionDef, source: Source) -> FunctionDef:
        """A copy whose places are lines of the source of the whole."""
        new = copy(tree)
        self.source, added = self.source.holding(source)
        for node in walk(new):
            if added and getattr(node, "lineno", None) is not None:
                node.lineno += added
                node.end_lineno = node.end_lineno and node.end_lineno + added
        return new

    def results(self, statement: Assign | Expr, last: Return) -> list[AST]:
        """The names that the call is bound to are bound to what is returned, all at once."""
        if isinstance(statement, Expr):
            return []
        target = statement.targets[0]
        bound = list(target.elts) if isinstance(target, Tuple) else [target]
        values = returned(function("_", [], [last])) if isinstance(target, Tuple) else [last.value]
        made: list[AST] = []
        for place, value in enumerate(values):
            if {t.id for t in bound[:place]} & set(names(value)):
                held = [self.free.numbered(t.id) for t in bound]
                made = [assign(h, v) for h, v in zip(held, values)]
                values = [name(h) for h in held]
                break
        # an argument that is handed back under its own name stays what it is
        made += [assign(t, v) for t, v in zip(bound, values) if not _is_same(t, v)]
        return [at(s, last) for s in made]


def _without_parameter_aliases(tree: FunctionDef, held: Mapping[str, str]) -> FunctionDef:
    """The function without the names of parameters that are only bound to an argument, which takes the result: inside
    them nothing else binds the argument."""
    stored = [n.id for n in walk(tree.body) if isinstance(n, Name) and isinstance(n.ctx, Store)]
    moves = [(s.targets[0], s.value.id) for s in walk_statements(tree.body)
             if isinstance(s, Assign) and isinstance(s.value, Name) and s.value.id in held]
    same = {h: name(a) for h, a in held.items() if stored.count(h) == 1 and any(v == h for _, v in moves) and all(
        isinstance(t, Name) and t.id == a for t, v in moves if v == h)}
    if not same:
        return tree

    def without(block: list[AST]) -> list[AST]:
        return [with_blocks(s, without) for s in block if not (
            isinstance(s, Assign) and _is_same(s.targets[0], s.value))]
    return with_body(tree, without([_renamed(s, same) for s in tree.body]))


def _is_same(target: AST, value: AST) -> bool:
    return isinstance(target, Name) and isinstance(value, Name) and target.id == value.id


def _renamed(node: AST, substitution: Mapping[str, AST]) -> AST:
    def change(n: AST) -> AST | None:
        if not isinstance(n, Name) or n.id not in substitution:
            return None
        new = copy(substitution[n.id])
        if isinstance(new, Name):
            new.ctx = n.ctx
        for field in ("lineno", "col_offset", "end_lineno", "end_col_offset"):
            setattr(new, field, getattr(n, field, None))
        return new
    return rebuild(node, change)


def _without_dead_branches(block: list[AST]) -> list[AST]:
    """The block without branches that constant arguments rule out: `"x" == "z"`."""
    made: list[AST] = []
    for statement in block:
        taken = _constant_truth(statement.test) if isinstance(statement, If) else None
        made += [with_blocks(statement, _without_dead_branches)] if taken is None else _without_dead_branches(
            statement.body if taken else statement.orelse)
    return made


def _constant_truth(test: AST) -> bool | None:
    """The value of a test of literals; None if it is none."""
    if isinstance(test, UnaryOp) and isinstance(test.op, Not):
        inner = _constant_truth(test.operand)
        return None if inner is None else not inner
    if not isinstance(test, Compare) or len(test.ops) != 1 or not isinstance(test.ops[0], (Eq, NotEq)):
        return test.value if isinstance(test, Constant) and isinstance(test.value, bool) else None
    sides = (test.left, test.comparators[0])
    if not all(isinstance(s, Constant) for s in sides):
        return None
    return (sides[0].value == sides[1].value) == isinstance(test.ops[0], Eq)


def _first_place(tree: FunctionDef) -> Callable[[str], int]:
    """The order of names in a function's text."""
    order: dict[str, int] = {}
    for node in walk(tree.body):
        if isinstance(node, Name):
            order.setdefault(node.id, len(order))
    return lambda identifier: order.get(identifier, 0)
