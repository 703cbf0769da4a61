"""comprehensions: list comprehensions become lists that grow, and `sum` of a generator a loop.

    y = np.array([x[i] ** 2 for i in range(n)])     items = []
                                                    for i_2 in range(n):
                                                        items.append(x[i_2] ** 2)
                                                    y = np.array(items)
    s = sum(x[i] for i in range(n))                 total = 0
                                                    for i_2 in range(n):
                                                        total += x[i_2]
                                                    s = total

    if any(f(x, i) for i in range(n)): ...          found = False
                                                    for i_2 in range(n):
                                                        if f(x, i_2):
                                                            found = True
                                                            break
                                                    if found: ...

    s = x[0] * sum(f(x) for i in range(n))          held = x[0]                     f writes x
                                                    ...
                                                    s = held * total

Requires resolved names. The loops stand before the statement: what Python reads before them and they write has a name
before them. Where Python would not have run them by then, or would run them more than once, the comprehension is
refused.
"""
from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection

from s2sad.infer.call_types import MARKS
from s2sad.evaluate.expressions.hoist import impure, operands, replace_operands
from s2sad.evaluate.scope import KernelScope, atomic
from s2sad.tree import (
    AST, Add, Assign, Attribute, AugAssign, BinOp, BoolOp, Break, Call, Expr, For, FunctionDef, GeneratorExp, If,
    IfExp, List, ListComp, Name, Not, Starred, Subscript, Tuple, UnaryOp, While, assign, at, augment, call,
    call_name, const, copy, head_copy, name, rename, stored_names, substitute, tuple_of, walk,
    with_body,
)

_LONGEST = 16
Pairs = list[tuple[str, AST]]
_STOPPING = {"builtins.any": True, "builtins.all": False}       # what an item is that answers the question
_ASKED = {"numpy.any": "numpy.any", "numpy.all": "numpy.all", "builtins.max": "numpy.max", "builtins.min": "numpy.min"}
HELP = "allocate an array before and fill it in a for loop"


def comprehensions(function: FunctionDef, scope: KernelScope) -> FunctionDef:
    """The function without comprehensions; those that cannot be loops are reported."""
    return with_body(function, _Comprehensions(function, scope).block(function.body))


def marked(item: AST) -> AST:
    """An item of a list; one that is a list or a tuple has a mark, for `listed_rows`."""
    words = {"tuple": (Tuple,), "list": (List, ListComp)}
    return next((call(m, item) for m, kind in MARKS.items() if isinstance(item, words[kind])), item)


class _Comprehensions:
    """The statements of one function; `before` are the loops of the statement at hand."""

    def __init__(self, function: FunctionDef, scope: KernelScope):
        self.scope = scope
        self.before: list[AST] = []
        self.mentions = Counter(n.id for n in walk(function) if isinstance(n, Name))

    def own_name(self, identifier: str, node: AST) -> str:
        """The name of a comprehension's variable in the loop: its own, where nothing else has it."""
        inside = sum(isinstance(n, Name) and n.id == identifier for n in walk(node))
        return identifier if self.mentions[identifier] == inside else self.scope.fresh(identifier)

    def block(self, block: list[AST]) -> list[AST]:
        return [at(made, s) for s in block for made in self.statement(s)]

    def statement(self, statement: AST) -> list[AST]:
        outer, self.before = self.before, []
        target = statement.targets[0] if isinstance(statement, Assign) and len(statement.targets) == 1 else None
        if isinstance(target, Name) and isinstance(statement.value, ListComp):
            self.refuse_unordered(statement.value, False)
            items = self.written_out(statement.value)
            made = [at(assign(target.id, self.read(List(items, name("_").ctx))), statement)] if items else self.listed(
                statement.value, target.id)
            made, self.before = [*self.before, *made], outer
            return made
        if isinstance(statement, AugAssign) and isinstance(statement.target, Subscript) and _moved(statement.value):
            made, self.before = self.augmented(statement), outer
            return made
        new = head_copy(statement)
        for field in statement._fields:
            inner = getattr(statement, field)
            if field in ("body", "orelse"):
                setattr(new, field, self.block(inner))
            elif isinstance(inner, AST):
                self.refuse_unordered(inner, isinstance(statement, While))
                setattr(new, field, self.read(inner))
        made, self.before = [*self.before, new], outer
        return made

    def augmented(self, node: AugAssign) -> list[AST]:
        """Python reads the element before it evaluates the value, whose loops may change it."""
        self.refuse_unordered(node.value, False)
        parts = operands(node.target)
        *new, value = self.ordered([*parts, node.value])
        target = replace_operands(node.target, parts, new)
        element = Subscript(node.target.value, node.target.slice, name("_").ctx)
        if not self.scope.memory.affected(element, self.scope.memory.written(self.before)):
            return [*self.before, at(AugAssign(target, node.op, value), node)]
        first: list[AST] = []
        old = self.scope.held(element, "held", first)
        if _moved(element) or impure(element):
            self.scope.refuse(node, "an element that a comprehension changes, at a place that is calculated",
                              help="name the place in a statement of its own before")
        return [*first, *self.before, at(assign(target, BinOp(old, node.op, value)), node)]

    def refuse_unordered(self, node: AST, tested: bool) -> None:
        """Refuses a comprehension that would run earlier than Python runs it, or more often."""
        found = [n for n in walk(node) if isinstance(n, (ListComp, GeneratorExp))]
        lazy = {id(n) for c in walk(node) if isinstance(c, (IfExp, BoolOp)) for n in walk(c)}
        for n in found:
            if tested or id(n) in lazy:
                self.scope.refuse(n, "a comprehension in the test of a loop, or in what may not be evaluated",
                                  help="bind it to a name in a statement of its own before")

    def read(self, node: AST) -> AST:
        """The expression without comprehensions, whose loops go before."""
        found = self.change(node)
        if found is not None or not _moved(node):
            return node if found is None else found
        parts = operands(node)
        return replace_operands(node, parts, self.ordered(parts))

    def ordered(self, nodes: list[AST]) -> list[AST]:
        """Expressions that Python evaluates one after the other: one that writes, or that loops of a later one change,
        has a name before them."""
        parts = [self.apart(node) for node in nodes]
        left: list[AST] = []
        for position, (before, value) in enumerate(parts):
            self.before += before
            later = [s for following, _ in parts[position + 1:] for s in following]
            calls = later and self.scope.memory.written([value])
            left.append(self.scope.held(value, "held", self.before) if calls else self.held(
                value, self.scope.memory.written(later)))
        return left

    def apart(self, node: AST) -> tuple[list[AST], AST]:
        """The loops of an expression, and what is left of it."""
        outer, self.before = self.before, []
        new = self.read(node)
        before, self.before = self.before, outer
        return before, new

    def held(self, value: AST, written: set[str]) -> AST:
        if not self.scope.memory.affected(value, written):
            return value
        if isinstance(value, (Tuple, List)):
            return at(type(value)([self.held(item, written) for item in value.elts], value.ctx), value)
        if isinstance(value, Starred):
            return at(Starred(self.held(value.value, written), value.ctx), value)
        return self.scope.held(value, "held", self.before)

    def change(self, node: AST) -> AST | None:
        if call_name(node) == "builtins.sum" and len(node.args) == 1 and isinstance(
                node.args[0], (ListComp, GeneratorExp)):
            total = self.scope.fresh("total")
            self.before.append(at(assign(total, const(0)), node))
            self.before += self.loop(node.args[0], lambda item: augment(total, Add(), item))
            return name(total)
        stop = _STOPPING.get(call_name(node) or "")
        if stop is not None and len(node.args) == 1 and isinstance(node.args[0], GeneratorExp):
            found = self.scope.fresh("found" if stop else "fits")
            self.before.append(at(assign(found, const(not stop)), node))
            self.before += self.loop(node.args[0], lambda item: If(
                item if stop else UnaryOp(Not(), item), [assign(found, const(stop)), Break()], []), name(found) if stop
                else UnaryOp(Not(), name(found)))
            return name(found)
        if call_name(node) in _ASKED and len(node.args) == 1 and not node.keywords and isinstance(
                node.args[0], (ListComp, GeneratorExp)):
            items = self.scope.fresh("items")
            self.before += self.listed(node.args[0], items)
            return at(call(_ASKED[call_name(node) or ""], name(items)), node)
        if isinstance(node, GeneratorExp):
            self.scope.refuse(node, "a generator expression that is not summed", help=HELP)
        if isinstance(node, ListComp) and (items := self.written_out(node)):
            return self.read(at(List(items, name("_").ctx), node))
        if isinstance(node, ListComp):
            made = self.scope.fresh("items")
            self.before += self.listed(node, made)
            return name(made)
        return None

    def written_out(self, node: ListComp) -> list[AST]:
        """The elements of a comprehension through values that are written out, which have names before; none of any
        other."""
        one = node.generators[0]
        rows = written_items(one.iter) if len(node.generators) == 1 and not one.ifs else []
        if not rows or any(pairs(one.target, row) is None for row in rows):
            return []
        leaves = [leaf for row in rows for _, leaf in pairs(one.target, row) or []]
        text = {id(n): k for k, n in enumerate(walk(one.iter))}         # zip has evaluated one of its values whole
        order = sorted(range(len(leaves)), key=lambda k: text.get(id(leaves[k]), 0))
        held = {k: v if atomic(v) and not isinstance(v, Name) else self.scope.held(v, "item", self.before)
                for k, v in zip(order, self.ordered([leaves[k] for k in order]))}
        named = [held[k] for k in range(len(leaves))]
        names = [n for n, _ in pairs(one.target, rows[0]) or []]
        return [substitute(copy(node.elt), dict(zip(names, named[k:]))) for k in range(0, len(named), len(names))]

    def listed(self, node: AST, made: str) -> list[AST]:
        """The statements that make a list under a name."""
        loops = self.loop(node, lambda item: Expr(Call(Attribute(name(made), "append", name("_").ctx), [item], [])))
        return [at(assign(made, List([], name("_").ctx)), node), *loops]

    def loop(self, node: AST, with_item: Callable[[AST], AST], ended: AST | None = None) -> list[AST]:
        """The loops of a comprehension, with names of their own, around one statement; where `ended` holds behind an
        inner one, they all have ended."""
        own = {n: self.own_name(n, node) for g in node.generators for n in stored_names(g.target)}
        item = node.elt
        if isinstance(item, ListComp):
            item = at(marked(item), item)
        for generator in node.generators:
            self.scope.memory.bind([own[n] for n in stored_names(generator.target)], rename(generator.iter, own))
        before, item = self.apart(rename(item, own))
        body = [*before, with_item(item)]
        for number, generator in reversed(list(enumerate(node.generators))):
            for test in reversed(generator.ifs):
                before, asked = self.apart(rename(test, own))
                body = [*before, If(asked, body, [])]
            # the first iterable is evaluated outside of the comprehension's names
            before, iterable = self.apart(generator.iter if number == 0 else rename(generator.iter, own))
            after = [If(copy(ended), [Break()], [])] if ended is not None and number else []
            body = [*before, For(rename(generator.target, own), iterable, body, [], None), *after]
        return [at(s, node) for s in body]


def _moved(node: AST) -> bool:
    """Whether an expression has a comprehension, whose loops go before the statement."""
    return any(isinstance(n, (ListComp, GeneratorExp)) for n in walk(node))


def written_items(iterable: AST, bound: Collection[str] = ()) -> list[AST]:
    """What an iterable gives, where that is written out, also through `zip` and `enumerate`, which are not `bound` to
    anything else; nothing of any other."""
    if isinstance(iterable, (Tuple, List)):
        return list(iterable.elts) if len(iterable.elts) <= _LONGEST else []
    called = (call_name(iterable) or "").removeprefix("builtins.")
    if called not in ("zip", "enumerate") or called in bound or iterable.keywords or not iterable.args:
        return []
    through = [written_items(a, bound) for a in iterable.args]
    if called == "zip":
        left = [n for t in through for item in t[min(map(len, through)):] for n in walk(item)]
        calls = any(isinstance(n, Call) for n in left)      # what is left over is evaluated as well
        return [tuple_of(*row) for row in zip(*through)] if all(through) and not calls else []
    return [tuple_of(const(k), i) for k, i in enumerate(through[0])] if len(through) == 1 else []


def pairs(target: AST, item: AST) -> Pairs | None:
    """The names of a target and what each is bound to."""
    if isinstance(target, Name):
        return [(target.id, item)]
    if not isinstance(target, (Tuple, List)) or not isinstance(item, (Tuple, List)) or len(target.elts) != len(
            item.elts):
        return None
    found = [pairs(t, i) for t, i in zip(target.elts, item.elts)]
    return None if None in found else [pair for row in found if row is not None for pair in row]
