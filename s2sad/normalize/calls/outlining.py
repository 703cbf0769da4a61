"""outlining: a loop that keeps snapshots becomes a function, and its body one that this calls.

    def f(u, n: int, c):                                    def f(u, n, c):
        e = 0.0                                                 e = 0.0
        for k in timesteps(range(n), snapshots=5):              e = f_k_loop(n, u, c, e)
            u[k] = c * u[k]                                     return e
            e = e * 0.5 + u[k]
        return e

`f_k_loop` is the loop over `e = f_k_step(k, u, c, e)`, and `f_k_step` what the loop's body was, with `return e` behind.
Arrays are changed in place, numbers go in and come out, a break is a flag that comes out. What goes in and what comes
out follows from liveness. So the loop is a call like any other to the analyses of its function, and its body to those
of the loop: what a derivative keeps of the loop is a matter of the derivative of `f_k_loop` alone.

Requires resolved views, before numbers are bound once; establishes that no such loop is left in the function.
"""
from __future__ import annotations

from dataclasses import dataclass, replace

from s2sad.blocks import with_blocks
from s2sad.infer.affine import Affine
from s2sad.infer.shapes import least_of, shapes_of
from s2sad.infer.types import BOOL
from s2sad.liveness import Accesses, Liveness, base_name, targets
from s2sad.normalize.context import NormalContext
from s2sad.normalize.loops.hoist_allocations import is_allocation
from s2sad.program import Snapshots, SourcePlace
from s2sad.tree import (
    AST, Assign, Attribute, Break, Call, Eq, Expr, For, FunctionDef, GtE, If, Name, Return, Subscript, While, assign,
    at, attribute, call, call_name, compare, const, copy, dump, function, index, known, name, names, rebuild, replica,
    stored_names, times_bound, tuple_of, user_call, walk, walk_statements, with_body,
)


@dataclass(frozen=True)
class OutlinedLoop:
    """A loop over calls of its body's function: `step` is the call's statement in it, which binds `results` and, where
    the body may leave the loop, `left`; `carried` are the numbers that go from one step to the next, `outputs` those
    that the loop returns; `snapshots` are the states that are kept."""
    loop: AST
    step: AST
    results: tuple[str, ...]
    left: str
    carried: tuple[str, ...]
    outputs: tuple[str, ...]
    snapshots: Snapshots

    @property
    def callee(self) -> str:
        """The title of the body's function."""
        return user_call(self.step.value) or ""

    @property
    def is_counted(self) -> bool:
        """Whether the number of steps is known before the first one."""
        return isinstance(self.loop, For) and not self.left


def outlining(function: FunctionDef, context: NormalContext) -> FunctionDef:
    """The function with calls in place of its loops that keep snapshots."""
    return _Outlining(function, context).outlined(function)


class _Outlining:
    """One function; `live` of all of its statements."""

    def __init__(self, function: FunctionDef, context: NormalContext):
        self.context, self.typing, self.whole = context, context.typing, function
        self.live = Liveness(function, set(), Accesses(), strong=False)
        self.unbound: list[AST] = []
        self.bound = {p.id for p in function.args.args}

    def outlined(self, function: FunctionDef) -> FunctionDef:
        body = self.block(function.body)
        return with_body(function, [*self.unbound, *body])

    def block(self, block: list[AST]) -> list[AST]:
        return [made for statement in block for made in self.statement(statement)]

    def statement(self, statement: AST) -> list[AST]:
        if isinstance(statement, (For, While)):
            snapshots = self.snapshots(statement)
            if snapshots is not None:
                return [at(s, statement) for s in self.loop(statement, snapshots)]
        if isinstance(statement, For):
            self.bound.add(statement.target.id)
        self.bound |= {t.id for t in targets(statement) if isinstance(t, Name)}
        return [with_blocks(statement, self.block)] if isinstance(statement, (For, If, While)) else [statement]

    def snapshots(self, loop: AST) -> Snapshots | None:
        """The snapshots that a loop keeps; None for one that records as others do."""
        wanted = self.context.callees.checkpoints
        if not wanted or getattr(loop, "lineno", None) is None:
            return None
        own = {(s.lineno, s.col_offset) for s in walk_statements(loop.body) if getattr(s, "lineno", None)}
        if own == {(loop.lineno, loop.col_offset)}:     # made of the loop's head, as a copy before its first iteration
            return None
        empty = not _quiet(loop.body)
        at_place = SourcePlace.of(self.context.report.source, loop)
        place = at_place.path, at_place.line, at_place.column
        self.context.callees.outlined_at.add(place)
        return None if empty else wanted.get(place)

    def loop(self, loop: AST, snapshots: Snapshots) -> list[AST]:
        """The call of the loop's function, which is made."""
        self.refuse(loop)
        before: list[AST] = []
        loop = self.with_bounds(loop, before)
        table, entry, after = self.typing.table, self.live.entry[id(loop)], self.live.after[id(loop)]
        head = loop.iter if isinstance(loop, For) else loop.test
        inside = {t.id for s in walk_statements(loop.body) if is_allocation(s) for t in targets(s)}
        counters = {s.target.id for s in walk_statements(loop) if isinstance(s, For)}
        stored = [n for n in stored_names(loop.body) if not table[n].is_array and n not in counters]
        touched = [*names(loop.body), *(base_name(t) for s in walk_statements(loop.body) for t in targets(s)), *stored]
        used = [n for n in dict.fromkeys(touched) if n and n not in inside]
        counter = [loop.target.id] if isinstance(loop, For) and loop.target.id in names(loop.body) else []
        taken = [*counter, *(n for n in used if table[n].is_array),
                 *(n for n in used if not table[n].is_array and n in entry and n not in counters)]
        results = [n for n in stored if n in entry or n in after or n in names(head)]
        for n in taken:
            if n in results and n not in self.bound:    # bound in the loop alone: a step that reads it has bound it
                self.unbound.append(at(assign(n, const(table[n].zero)), loop))
        return [*before, *self.made(loop, taken, results, snapshots)]

    def with_bounds(self, loop: AST, before: list[AST]) -> AST:
        """The loop over a range of names and sizes that its body does not change."""
        if not isinstance(loop, For):
            return loop
        bounds: list[AST] = []
        for bound in loop.iter.args:
            bounds.append(bound)
            if set(names(bound)) & set(stored_names(loop.body)) or any(
                    isinstance(n, Subscript) and isinstance(n.value, Name) for n in walk(bound)):
                held = self.typing.declare(self.context.names.fresh("bound"), self.typing.of(bound))
                before.append(assign(held, bound))
                bounds[-1] = name(held)
        if before:
            made = replica(loop, lambda value, field: value if field == "body" else copy(value))
            made.iter.args = bounds
            for table in (self.live.entry, self.live.after):
                table[id(made)] = table[id(loop)]
            return made
        return loop

    def made(self, loop: AST, taken: list[str], results: list[str], snapshots: Snapshots) -> list[AST]:
        """The functions of a loop whose step takes and gives these, and the call."""
        title = f"{self.context.kernel.name}_{loop.target.id if isinstance(loop, For) else 'while'}"
        breaks = any(isinstance(s, Break) for s in walk_of_loop(loop.body))
        if snapshots.schedule is not None and (breaks or isinstance(loop, While)):
            self.context.report.error("S408", "how many steps this loop runs shows in the end, and a schedule is for a "
                                      "number that is known", loop, help="give a number of snapshots")
            self.context.report.finish()
        left = self.typing.declare(self.context.names.fresh("left"), BOOL) if breaks else ""
        bound = [*results, *([left] if left else [])]
        steps, known_here = self.with_known_sizes(loop, taken)
        step = self.function(f"{title}_step", taken, _leaving(_quiet(steps), left), bound, None, known_here)
        called = at(call_statement(step, taken, bound), loop)
        body = [called, *([at(If(name(left), [Break()], []), loop)] if left else [])]
        head = loop.iter if isinstance(loop, For) else loop.test
        around = replica(loop, lambda value, field: body if field == "body" else copy(value))
        outer = [n for n in names(head) if n not in taken]
        given = [*outer, *(n for n in taken if not isinstance(loop, For) or n != loop.target.id)]
        after = [n for n in results if n in self.live.after[id(loop)]]
        carried = tuple(n for n in taken if n in results)
        whole = self.function(f"{title}_loop", given, [around], after,
                              OutlinedLoop(around, called, tuple(results), left, carried, tuple(after), snapshots))
        self.bound |= {*after}
        return [call_statement(whole, given, after)]

    def with_known_sizes(self, loop: AST, taken: list[str]) -> tuple[list[AST], list[AST]]:
        """The body of a loop, in which sizes of the arrays taken that are known to be equal here are spelled alike, and
        marks of what is known: its function does not see how they were allocated, nor from where counters count."""
        shapes = shapes_of(self.whole, self.typing)
        shapes.enter(loop)
        bound = times_bound(self.whole.body, Assign)
        given = {n for n in taken if n not in stored_names(loop.body)}
        first: dict[Affine, AST] = {}
        alike: dict[str, AST] = {}
        least = {**shapes.counters, **(least_of(loop) if isinstance(loop, For) else {})}
        marks: list[AST] = [known(compare(name(n), GtE(), const(least[n]))) for n in taken if n in least]
        for array in (n for n in taken if self.typing.table[n].is_array and bound[n] <= 1):
            for axis, size in enumerate(shapes.of(name(array))):
                if size is None:
                    continue
                own = index(attribute(name(array), "shape"), const(axis))
                spelled = shapes.expression(size)
                shown = spelled if set(names(spelled)) <= given else own
                alike[dump(own)] = first.setdefault(shapes.reduced(size), shown)
                if dump(alike[dump(own)]) != dump(own):
                    marks.append(known(compare(own, Eq(), copy(alike[dump(own)]))))
        body = rebuild(loop.body, lambda n: copy(alike.get(dump(n), n)) if isinstance(n, Subscript) and isinstance(
            n.value, Attribute) and n.value.attr == "shape" else None)
        return body, [at(mark, loop) for mark in marks]

    def function(self, title: str, parameters: list[str], body: list[AST], results: list[str],
                 outlined: OutlinedLoop | None, marks: list[AST] | None = None) -> str:
        """The title of the unit of a new function, at the start of which the marks hold."""
        if results:
            values = tuple_of(*map(name, results)) if len(results) > 1 else name(results[0])
            body = [*body, at(Return(values), body[-1])]
        made = at(function(title, parameters, body), body[0])
        kernel = replace(self.context.kernel, name=title, tree=made, parameters=tuple(parameters), defaults={},
                         annotations={}, own=None, residual="", results=0, source=self.context.report.source)
        return self.context.callees.outlined(kernel, self.context, outlined, marks or [])

    def refuse(self, loop: AST) -> None:
        """Refuses what the state of a step cannot hold."""
        report, typing = self.context.report, self.typing
        live = self.live.entry[id(loop)] | self.live.after[id(loop)]
        for node in walk(loop.body):
            if isinstance(node, Name) and node.id in live and typing.table[node.id].kind not in ("number", "array"):
                report.error("S201", f"'{self.user_name(node.id)}' is no number and no array, and a step "
                             "of a loop that keeps snapshots reads it", node,
                             help="leave the loop out of 'checkpoint'")
        for statement in walk_statements(loop.body):
            for target in targets(statement):
                read = live & {target.id, f"={target.id}"} if is_allocation(statement) else set()
                if read and typing.table[target.id].is_array:
                    report.error("S201", f"'{self.user_name(target.id)}' is allocated anew in a loop "
                                 "that keeps snapshots, and is read behind the step", statement,
                                 note="a snapshot holds arrays of the sizes that they have before the loop",
                                 help="allocate it before the loop and write it in place, or leave the loop out of "
                                 "'checkpoint'")
            for node in walk(statement.value) if isinstance(statement, (Assign, Expr)) else ():
                if isinstance(node, Call) and self.context.callees.has_state(node):
                    report.error("S201", f"'{user_call(node)}' is called in a loop that keeps snapshots, whose steps "
                                 "run again", node, note="its derivative is your own, and what it keeps may depend on "
                                 "how often it was called", help="leave the loop out of 'checkpoint'")
        report.finish()


    def user_name(self, identifier: str) -> str:
        """What a user calls a name: a buffer goes by that of its variable."""
        variable = self.context.names.user_name(identifier).rstrip("0123456789").rstrip("_")
        return variable if variable in {n.id for n in walk(self.context.kernel.tree) if isinstance(n, Name)
                                        } else identifier


def walk_of_loop(body: list[AST]) -> list[AST]:
    """The statements of a loop's body that belong to no loop in it."""
    found: list[AST] = []
    for statement in body:
        found.append(statement)
        if isinstance(statement, If):
            found += walk_of_loop([*statement.body, *statement.orelse])
    return found


def call_statement(title: str, arguments: list[str], results: list[str]) -> AST:
    """A call that binds its results."""
    called = call(f"user.{title}", *map(name, arguments))
    if not results:
        return Expr(called)
    return assign(tuple_of(*map(name, results)) if len(results) > 1 else results[0], called)


def _quiet(body: list[AST]) -> list[AST]:
    """A copy without prints."""
    return [with_blocks(s, _quiet) for s in copy(body) if not (
        isinstance(s, Expr) and call_name(s.value) == "builtins.print")]


def _leaving(body: list[AST], left: str) -> list[AST]:
    """A loop's body in which a flag stands for a break."""
    if not left:
        return body

    def flagged(block: list[AST]) -> list[AST]:
        return [at(assign(left, const(True)), s) if isinstance(s, Break) else
                with_blocks(s, flagged) if isinstance(s, If) else s for s in block]
    return [at(assign(left, const(False)), body[0]), *flagged(body)]
