"""peel_first_iteration: what a name stands for in the first iteration of a loop alone is left with it: that is peeled.

    acc = 0.0                       acc = 0.0
    for k in range(n):              assert 0 < n, "..."
        acc += w[k] * x             acc = acc + w[0] * x
                                    for k in range(1, n):
                                        acc += w[k] * x

Requires structured form. Tried on names of several types in one live range: those that are bound to a literal number,
and added to before anything else is done with them; and on names that share an array (`peel_shared_array`).
"""
from __future__ import annotations

from s2sad.infer.signatures.laws import whole_number
from s2sad.infer.types import INT
from s2sad.liveness import base_name
from s2sad.naming import Names
from s2sad.normalize.context import NormalContext
from s2sad.normalize.shape_guards import TRIPS, UNSHARED, has_iteration
from s2sad.tree import (
    AST, Assign, AugAssign, Break, Constant, For, FunctionDef, If, Name, Subscript, While, add, assign, at, binary,
    call, call_name, const, copy, name, names, stored_names, substitute, with_body,
)


def peel_first_iteration(function: FunctionDef, conflicting: set[str], free: Names) -> FunctionDef | None:
    """The function in that form; None if it is as it was."""
    made = _FirstIterations(conflicting, free)
    body = made.block(function.body, set())
    return at(FunctionDef(*[body if f == "body" else getattr(function, f) for f in function._fields]),
              function) if made.changed else None


def peel_shared_array(function: FunctionDef, context: NormalContext) -> FunctionDef:
    """The function in which names share an array with another name before a loop, and none behind it; the same one if
    no loop is like that.

        def f(x):                   def f(x):
            u = x                       u = x
            for k in range(3):          u = u * x
                u = u * x               for k in range(1, 3):
            u[0] = 1.0                      u = u * x
            return u[0] * u[1]          u[0] = 1.0
                                        return u[0] * u[1]

    Tried where a store would make a buffer differ from NumPy's array (`Aliases.check`). Requires structured form and
    types; establishes that what each iteration binds anew to a new array is that behind the loop, for it has a trip.
    """
    arrays = {n for n, kind in context.typing.table.items() if kind.is_array}
    made = _SharedAtFirst(arrays, context.names)
    body = made.block(function.body, set())
    for held in made.held:
        context.typing.declare(held, INT)
    return with_body(function, body) if made.changed else function


class _FirstIterations:
    """A walk in the order of execution; `numbers` are the conflicting names that hold a literal number."""
    message = TRIPS

    def __init__(self, conflicting: set[str], free: Names):
        self.conflicting, self.free, self.changed = conflicting, free, False
        self.held: list[str] = []       # new names, of bounds of loops

    def block(self, block: list[AST], numbers: set[str]) -> list[AST]:
        return [at(made, s) for s in block for made in self.statement(s, numbers)]

    def statement(self, statement: AST, numbers: set[str]) -> list[AST]:
        if isinstance(statement, If):
            sides = set(numbers), set(numbers)
            new = If(statement.test, *(self.block(b, s) for b, s in zip((statement.body, statement.orelse), sides)))
            numbers &= sides[0] & sides[1]
            return [new]
        if isinstance(statement, (For, While)):
            return self.loop(statement, numbers)
        new = self.bound(statement, numbers)
        numbers -= set(stored_names(statement))
        target = statement.targets[0] if isinstance(statement, Assign) else None
        if isinstance(target, Name) and target.id in self.conflicting and self.is_one(statement.value):
            numbers.add(target.id)
        return [new]

    def is_one(self, value: AST) -> bool:
        """Whether a name that is bound to this is one of `numbers`."""
        return _is_number(value)

    def begins(self, block: list[AST], word: str) -> bool:
        """Whether an iteration makes another thing of one of `numbers`."""
        return _begins(block, word)

    def bound(self, statement: AST, numbers: set[str]) -> AST:
        """A statement that adds to a number binds its name: a number is never added to in place."""
        if not isinstance(statement, AugAssign) or not isinstance(statement.target, Name) or (
                word := statement.target.id) not in numbers:
            return statement
        self.changed = True
        return assign(word, binary(name(word), statement.op, statement.value))

    def loop(self, loop: For | While, numbers: set[str]) -> list[AST]:
        begun = isinstance(loop, For) and not _is_left(loop.body) and any(self.begins(loop.body, n) for n in numbers)
        bounds = self.bounds(loop) if isinstance(loop, For) and begun else None
        before: list[AST] = []
        if isinstance(loop, For) and bounds is not None:
            self.changed = True
            held, (start, stop, step) = bounds
            known = isinstance(start, Constant) and isinstance(stop, Constant)
            guard = [] if known else [has_iteration(start, stop, step, self.message)]
            first = substitute(loop.body, {loop.target.id: start})   # a counter is bound by its loop alone
            before = [*held, *guard, *self.block(first, numbers)]
            rest = call("builtins.range", add(copy(start), const(step)) if not isinstance(start, Constant) else
                        const(start.value + step), copy(stop), *([const(step)] if step != 1 else []))
            loop = For(loop.target, rest, loop.body, [], None)
        numbers -= set(stored_names([loop]))
        body = self.block(loop.body, set())
        new = For(loop.target, loop.iter, body, [], None) if isinstance(loop, For) else While(loop.test, body, [])
        return [*before, new]

    def bounds(self, loop: For) -> tuple[list[AST], tuple[AST, AST, int]] | None:
        """What holds the bounds while the loop runs, and start, stop and step; None for other loops, or if none is run
        for certain."""
        args = list(loop.iter.args) if call_name(loop.iter) == "builtins.range" else []
        start, stop = [const(0), *args][:2] if len(args) == 1 else [*args, None, None][:2]
        step = whole_number(args[2]) if len(args) > 2 else 1
        if start is None or stop is None or not step or not isinstance(loop.target, Name):
            return None
        first, last = whole_number(start), whole_number(stop)
        if first is not None and last is not None:
            return ([], (const(first), const(last), step)) if range(first, last, step) else None
        changed = stored_names([loop])
        held: list[AST] = []
        stay: list[AST] = []
        for bound, word in ((start, "start"), (stop, "stop")):
            stays = whole_number(bound) is not None or isinstance(bound, Name) and bound.id not in changed
            if not stays:
                self.held.append(self.free.fresh(word))
                held.append(assign(self.held[-1], bound))
            stay.append(bound if stays else name(held[-1].targets[0].id))
        return held, (stay[0], stay[1], step)


class _SharedAtFirst(_FirstIterations):
    """A walk in which `numbers` are names that are bound to an array of another name."""
    message = UNSHARED

    def is_one(self, value: AST) -> bool:
        return isinstance(value, (Name, Subscript)) and base_name(value) in self.conflicting

    def begins(self, block: list[AST], word: str) -> bool:
        return any(isinstance(s, Assign) and isinstance(s.targets[0], Name) and s.targets[0].id == word
                   and not isinstance(s.value, (Name, Subscript)) for s in block)

    def bound(self, statement: AST, numbers: set[str]) -> AST:
        return statement


def _begins(block: list[AST], word: str) -> bool:
    """Whether the first that is done with a name is to add to it, in this block or first in a loop of it."""
    for statement in block:
        if word in names(statement) or word in stored_names(statement):
            if isinstance(statement, For):
                return not _is_left(statement.body) and word not in names(statement.iter) and _begins(
                    statement.body, word)
            target = statement.targets[0] if isinstance(statement, Assign) else getattr(statement, "target", None)
            reads = isinstance(statement, AugAssign) or isinstance(statement, Assign) and word in names(
                statement.value)
            return isinstance(target, Name) and target.id == word and reads
    return False


def _is_left(block: list[AST]) -> bool:
    """Whether a loop with this body is left by a break."""
    return any(isinstance(s, Break) or isinstance(s, If) and _is_left([*s.body, *s.orelse]) for s in block)


def _is_number(node: AST) -> bool:
    return isinstance(node, Constant) and type(node.value) in (int, float, complex)
