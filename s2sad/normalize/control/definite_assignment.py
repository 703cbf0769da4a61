"""Where a name may be read before it is bound the kernel asks, and raises as Python does: compiled code takes 0.

    def f(x: float64[:], n: int64):
        for i in range(n):
            q = x[i] ** 2
        if x[0] > 1.0:
            y = x[1]
        return y * q

becomes

    def f(x, n):
        y_bound = False
        q_bound = 0 < n
        for i in range(n):
            q = x[i] ** 2
        if x[0] > 1.0:
            y = x[1]
            y_bound = True
        if not y_bound:
            raise UnboundLocalError("f: 'y' is read before it is bound, at `return y * q`")
        if not q_bound:
            raise UnboundLocalError("f: 'q' is read before it is bound, at `return y * q`")
        return y * q

*Requires* what `single_target` establishes. What all ways bind is known by definite assignment (The Java Language
Specification, chapter 16). A loop that binds a name in each iteration binds it if it has one, and what an iteration
reads of the one before it is there in all but the first.
"""
from __future__ import annotations

from collections.abc import Iterable, Iterator, Set
from dataclasses import dataclass, field

from s2sad.blocks import heads
from s2sad.evaluate.completion import endless
from s2sad.evaluate.effects import parameters
from s2sad.evaluate.scope import KernelScope
from s2sad.normalize.control.first_iterations import first_iteration, is_behind_first, runs
from s2sad.program import Kernel
from s2sad.tree import (
    AST, And, Assert, AugAssign, BoolOp, Break, Constant, Continue, For, FunctionDef, GeneratorExp, If, IfExp, ListComp,
    Name, Not, Or, Raise, Return, Store, UnaryOp, While, assign, at, call, children, const, copy, function, name,
    stored_names, walk_statements,
)

Bound = frozenset[str]
_LONG = 50      # characters of a statement that a message quotes


def definite_assignment(tree: FunctionDef, scope: KernelScope) -> FunctionDef:
    asked = {*stored_names(tree.body)} if scope.kernel.unsure is None else {*scope.kernel.unsure}
    ways = _Ways(asked)
    ways.block(tree.body, frozenset(parameters(tree)))
    if not ways.missing:
        return tree
    flagged = {m.name for found in ways.missing.values() for m in found if m.first is None}
    flags = {n: scope.fresh(f"{n}_bound") for n in stored_names(tree.body) if n in flagged}
    body = _Guards(ways, flags, scope.kernel).function_body(tree.body)
    return at(function(tree.name, parameters(tree), body), tree)


@dataclass(frozen=True)
class _Missing:
    """A name that a statement reads where these tests hold, and that may not be bound there: in the first iteration of
    the loop `first`, or as a flag says."""
    name: str
    tests: tuple[AST, ...] = ()
    first: For | None = None


@dataclass
class _Loop:
    """A loop on the way: what is bound where it is left and where an iteration ends, and what its body lacks, each with
    the statement, the tests that hold there, and whether nothing can have bound it when the loop begins."""
    facts: int
    breaks: list[Bound] = field(default_factory=list)
    ends: list[Bound] = field(default_factory=list)
    lacking: list[tuple[AST, _Missing, list[AST], bool]] = field(default_factory=list)


class _Ways:
    """What is bound on all ways to each place. By statement: `missing` is what it reads that is not, `late` what it
    binds that was not, `whole` what a loop binds if it has an iteration."""

    def __init__(self, asked: Set[str]):
        self._asked, self._somewhere = asked, set[str]()     # the latter: bound by what stands above
        self._loops, self._facts = list[_Loop](), list[AST]()
        self.missing: dict[int, list[_Missing]] = {}
        self.late: dict[int, Bound] = {}
        self.whole: dict[int, Bound] = {}

    def block(self, statements: list[AST], bound: Bound | None) -> Bound | None:
        for statement in statements:
            if bound is None:
                return None
            bound = self._statement(statement, self._read(statement, bound))
        return bound

    def _statement(self, node: AST, bound: Bound) -> Bound | None:
        if isinstance(node, If):
            taken = self._branch(node.body, node.test, bound)
            return _met([taken, self._branch(node.orelse, UnaryOp(Not(), node.test), bound)])
        if isinstance(node, (For, While)):
            return self._loop(node, bound)
        if isinstance(node, (Break, Continue)):
            (self._loops[-1].breaks if isinstance(node, Break) else self._loops[-1].ends).append(bound)
        if isinstance(node, (Break, Continue, Return, Raise)):
            return None
        return bound | self._bind(node, _targets(node), bound)

    def _bind(self, node: AST, targets: Iterable[str], bound: Bound) -> Bound:
        found = frozenset(targets)
        self.late[id(node)] = found - bound
        self._somewhere |= found
        return found

    def _branch(self, block: list[AST], test: AST, bound: Bound) -> Bound | None:
        self._facts.append(test)
        after = self.block(block, bound)
        self._facts.pop()
        return after

    def _loop(self, node: For | While, bound: Bound) -> Bound | None:
        loop = _Loop(len(self._facts))
        self._loops.append(loop)
        counts = self._bind(node, stored_names(node.target), bound) if isinstance(node, For) else frozenset[str]()
        end = self.block(node.body, bound | counts)
        self._loops.pop()
        again = _met([*loop.ends, end])
        for statement, missing, facts, is_new in loop.lacking:
            self._lacks(node, statement, missing, facts, is_new, (again or frozenset()) - bound)
        once = _met([again, *loop.breaks])
        ran = False
        if isinstance(node, For) and once is not None:
            self.whole[id(node)], ran = once - bound, runs(node) is True
        ended = None if endless(node) else again if ran else bound
        return _met([None if ended is None else self.block(node.orelse, ended), *loop.breaks])

    def _lacks(self, loop: For | While, statement: AST, missing: _Missing, facts: list[AST], is_new: bool,
               again: Bound) -> None:
        """Decides how what an iteration lacks is asked for."""
        if isinstance(loop, For) and missing.name in again and first_iteration(loop) is not None:
            if is_behind_first(loop, facts):
                return
            if is_new and not self._loops:
                missing = _Missing(missing.name, missing.tests, loop)
        self.missing.setdefault(id(statement), []).append(missing)

    def _read(self, node: AST, bound: Bound) -> Bound:
        sure = set[str]()
        for found, tests in _reads(node):
            if found not in self._asked or found in bound or found in sure:
                continue
            sure |= {found} if not tests else set()
            if self._loops:
                loop = self._loops[-1]
                loop.lacking.append((node, _Missing(found, tests), [*self._facts[loop.facts:], *tests],
                                     found not in self._somewhere))
            else:
                self.missing.setdefault(id(node), []).append(_Missing(found, tests))
        return bound | sure


def _met(ways: Iterable[Bound | None]) -> Bound | None:
    """What all ways bind that go on; None if none does."""
    going = [w for w in ways if w is not None]
    return frozenset.intersection(*going) if going else None


def _targets(node: AST) -> list[str]:
    """The names that a statement without blocks binds; those of a comprehension are its own."""
    return [n.id for t in getattr(node, "targets", None) or [getattr(node, "target", None)] if t is not None
            for n in (t, *getattr(t, "elts", ())) if isinstance(n, Name) and isinstance(n.ctx, Store)]


def _reads(node: AST) -> Iterator[tuple[str, tuple[AST, ...]]]:
    """The names that a statement's own expressions read, each with the tests behind which it is read."""
    if isinstance(node, AugAssign) and isinstance(node.target, Name):
        yield node.target.id, ()
    for head in [node.test] if isinstance(node, Assert) else heads(node):
        yield from _read_in(head, ())


def _read_in(node: AST, tests: tuple[AST, ...]) -> Iterator[tuple[str, tuple[AST, ...]]]:
    if isinstance(node, Name):
        if not isinstance(node.ctx, Store) and "." not in node.id:
            yield node.id, tests
    elif isinstance(node, BoolOp):
        for value in node.values:
            yield from _read_in(value, tests)
            tests = (*tests, value if isinstance(node.op, And) else UnaryOp(Not(), value))
    elif isinstance(node, IfExp):
        yield from _read_in(node.test, tests)
        yield from _read_in(node.body, (*tests, node.test))
        yield from _read_in(node.orelse, (*tests, UnaryOp(Not(), node.test)))
    else:
        own = {*stored_names(node)} if isinstance(node, (ListComp, GeneratorExp)) else ()
        for part in children(node):
            yield from ((n, t) for n, t in _read_in(part, tests) if n not in own)


class _Guards:
    """The statements of one function with the flags of names set, and asked where a name is missing."""

    def __init__(self, ways: _Ways, flags: dict[str, str], kernel: Kernel):
        self._ways, self._flags, self._kernel = ways, flags, kernel
        self._depth = 0
        self._whole = set[str]()        # the names whose flags are set where a loop began
        self._begun = dict[str, bool]()     # the names whose flags are set already: whether each way does so

    def function_body(self, body: list[AST]) -> list[AST]:
        new = [s for node in body for s in self._statement(node)]
        return [*(at(assign(f, const(False)), body[0]) for n, f in self._flags.items() if not self._begun.get(n)), *new]

    def _block(self, statements: list[AST]) -> list[AST]:
        self._depth += 1
        new = [s for node in statements for s in self._statement(node)]
        self._depth -= 1
        return new

    def _statement(self, node: AST) -> Iterator[AST]:
        for missing in self._ways.missing.get(id(node), ()):
            yield at(self._guard(missing, node), node)
        late = sorted(n for n in self._ways.late.get(id(node), ()) if n in self._flags and n not in self._whole)
        if isinstance(node, If):
            yield at(If(node.test, self._block(node.body), self._block(node.orelse)), node)
        elif isinstance(node, For):
            yield from (at(s, node) for s in self._for(node, late))
        elif isinstance(node, While):
            yield at(While(node.test, self._block(node.body), self._block(node.orelse)), node)
        else:
            yield node
            yield from (at(self._set(n, const(True)), node) for n in late)

    def _for(self, node: For, late: list[str]) -> Iterator[AST]:
        """A loop: what each iteration binds, and no one asks for in it, is said before it."""
        outer, test = self._whole, runs(node)
        asked = {m.name for s in walk_statements(node.body) for m in self._ways.missing.get(id(s), ())}
        whole = {n for n in self._ways.whole.get(id(node), ()) if n in self._flags} - asked - outer
        whole = whole if test is not None and test is not False else set[str]()
        yield from (self._set(n, const(test) if isinstance(test, bool) else copy(test)) for n in sorted(whole))
        self._whole = outer | whole
        body = [*(at(self._set(n, const(True)), node) for n in late if n not in whole), *self._block(node.body)]
        self._whole = outer
        yield For(node.target, node.iter, body, self._block(node.orelse), None)

    def _set(self, bound: str, test: AST) -> AST:
        """What says that a name is bound from here on if a test holds."""
        flag, begins = self._flags[bound], bound not in self._begun
        self._begun.setdefault(bound, not self._depth)
        plain = isinstance(test, Constant) or begins and not self._depth
        return assign(flag, test if plain else BoolOp(Or(), [name(flag), test]))

    def _guard(self, missing: _Missing, node: AST) -> If:
        quoted = self._kernel.source.line(node.lineno).strip()
        quoted = quoted if len(quoted) <= _LONG else f"{quoted[:_LONG - 3]}..."
        text = f"{self._kernel.name}: '{missing.name}' is read before it is bound, at `{quoted}`"
        asked = UnaryOp(Not(), name(self._flags[missing.name])) if missing.first is None else first_iteration(
            missing.first)
        assert asked is not None
        tests = [*map(copy, missing.tests), asked]
        error = Raise(call("builtins.UnboundLocalError", const(text)), None)
        return If(tests[0] if len(tests) == 1 else BoolOp(And(), tests), [at(error, node)], [])
