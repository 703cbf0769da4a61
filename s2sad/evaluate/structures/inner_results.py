"""Structures that calls give inside an expression have names of their own before the statement.

    return (v * 0.5)[0] ** 2     ->   inner = v * 0.5
                                      return inner[0] ** 2
    A = diags([np.ones(n), v])   ->   diagonal = np.ones(n)
                                      A = diags([diagonal, v])

Only where the call is evaluated whenever the statement is, and where it could as well come first: the function stores
nothing but in names, and nothing that may was called before it. Any other is refused where it stands.
"""
from __future__ import annotations

from collections.abc import Iterable

from s2sad.evaluate.argument_binding import user_call
from s2sad.evaluate.structures.bindings import Bindings
from s2sad.evaluate.structures.literal_arguments import arguments
from s2sad.evaluate.structures.evaluation_order import in_order, is_turned, may_write, stores
from s2sad.evaluate.structures.call_values import plain_tuple
from s2sad.evaluate.structures.groups import StructureValue
from s2sad.evaluate.effects import own_lists
from s2sad.pytree import record_fields
from s2sad.tree import (
    AST, Assert, Assign, Attribute, AugAssign, BinOp, BoolOp, Call, Expr, For, If, IfExp, Load, Name,
    Return, Store, Subscript, UnaryOp, While, at, call_name, children, expr, name, rebuild, walk,
)

_PARTS = {Assign: "value", AugAssign: "value", Expr: "value", Return: "value", If: "test", For: "iter", Assert: "test"}
_LATER = ("Lambda", "ListComp", "GeneratorExp", "SetComp", "DictComp")
_STORING = ("fill", "sort", "partition", "put", "resize", "itemset", "setfield", "append", "extend", "insert", "pop",
            "update", "clear", "reverse", "remove")


class Inner(Bindings):
    """Calls inside expressions that give structures."""

    def assign(self, node: Assign) -> list[AST]:
        """What becomes of an assignment."""
        raise AssertionError

    def named_first(self, node: AST) -> tuple[list[AST], AST]:
        """The statements before a statement, and the statement with names in the place of structures."""
        field = _PARTS.get(type(node))
        value = getattr(node, field) if field else None
        if isinstance(node, While):
            self.refuse_unordered(node.test)
        if value is None or not any(isinstance(n, (BinOp, UnaryOp, Call)) for n in walk(value)):
            return [], node
        before: list[AST] = []
        if isinstance(value, Call) and any(isinstance(n, Call) and self.out_of_order(n) for n in walk(value)):
            before, value = in_order(value, self.fresh, self._assigned_first)
        stored = isinstance(node, AugAssign) and not isinstance(node.target, Name)      # read before the value
        new = _Names(self, before).whole(value, not stored)
        self.refuse_unordered(new)
        if not before:
            return [], node
        made = type(node)(*[new if f == field else getattr(node, f) for f in node._fields])
        return before, at(made, node)

    def _assigned_first(self, node: Assign) -> list[AST]:
        before, left = self.named_first(node)
        return [*before, *self.assign(left if isinstance(left, Assign) else node)]

    def out_of_order(self, node: Call) -> bool:
        """Whether a structure is made of values that would be computed in another order than Python's, with one that
        may store in it."""
        title = (call_name(node) or "").partition("record.")[2]
        if title:
            fields: Iterable[str | int] = (record_fields(self.program.records[title]) or ("", {}))[1]
            moved = is_turned(node, fields)
        elif isinstance(node.func, Attribute) and node.func.attr in ("_replace", "__replace__") and node.keywords:
            mark = len(self.report.found)
            base = self.structural(node.func.value)
            del self.report.found[mark:]
            fields = base.form.keys if isinstance(base, StructureValue) else ()
            moved = isinstance(node.func.value, Call) or is_turned(node, fields)
        else:
            return False
        return moved and any(stores(k.value, self.may_store) for k in node.keywords)

    def refuse_unordered(self, node: AST) -> None:
        """Refuses such a structure inside an expression."""
        for n in walk(node):
            if isinstance(n, Call) and self.out_of_order(n):
                self.refuse(n, "a structure is made by name, in another order than that of its fields, of what a call "
                            "may change", "bind it to a name in a statement of its own before")

    def may_store(self, called: Call) -> bool:
        """Whether the function that is called may store in anything but its names."""
        kernels, waiting, seen = self.program.kernels, [user_call(called) or ""], set()
        methods = {f.__name__: title for f, title in self.program.methods.items()}
        while waiting:
            title = waiting.pop()
            if title in seen:
                continue
            seen.add(title)
            nodes = list(walk(kernels[title].tree.body))
            lists = own_lists(kernels[title].tree)
            if kernels[title].own is not None or any(_stores(n, lists) for n in nodes):
                return True
            waiting += [c for n in nodes if (c := user_call(n)) is not None]
            waiting += [methods[n.attr] for n in nodes if isinstance(n, Attribute) and n.attr in methods]
        return False


class _Names:
    """One expression's walk, as Python evaluates it."""

    def __init__(self, of: Inner, before: list[AST]):
        self.of, self.before, self.stopped = of, before, False
        self.given: set[int] = set()            # what functions are given
        self.first: set[int] = set()            # what is evaluated before anything else

    def whole(self, node: AST, first: bool) -> AST:
        """A statement's expression, whose own call stays; `first` if it is evaluated before anything else."""
        self.given |= set(map(id, arguments(node)))
        part: AST | None = node if first else None
        while part is not None:
            self.first.add(id(part))
            part = next((n for n in children(part) if isinstance(n, expr) and not (
                isinstance(part, Call) and n is part.func and isinstance(n, Name))), None)
        return self.within(node)

    def within(self, node: AST) -> AST:
        """The expression with names in the place of what is inside it."""
        if type(node).__name__ in _LATER:
            self.stopped = self.stopped or any(isinstance(n, Call) for n in walk(node))
            return node
        if isinstance(node, (BoolOp, IfExp)):
            return self._first(node)
        return rebuild(node, lambda n: self.change(n) if n is not node and isinstance(n, expr) else None)

    def _held(self, value: AST, wanted: str) -> AST:
        """A name for a value, which is bound before the statement."""
        held = self.of.fresh(wanted)
        target = Name(held, Store(), None, None)
        self.before += [at(s, value) for s in self.of.assign(at(Assign([target], value, None), value))]
        return at(name(held), value)

    def _first(self, node: BoolOp | IfExp) -> AST:
        """What comes after the first part need not run."""
        if isinstance(node, IfExp):
            made = IfExp(self.change(node.test), node.body, node.orelse)
        else:
            made = BoolOp(node.op, [self.change(node.values[0]), *node.values[1:]])
        self.stopped = True
        return at(made, node)

    def change(self, node: AST) -> AST:
        self.given |= set(map(id, arguments(node)))
        new = self.within(node)
        if not isinstance(new, (BinOp, UnaryOp, Call, Subscript)):
            return new
        mark = len(self.of.report.found)
        called = self.of.as_call(new)
        said = self.of.report.found[mark:]
        del self.of.report.found[mark:]         # said again where the statement is taken apart, unless that is here
        if called is None:
            self.stopped = self.stopped or isinstance(new, Call) and may_write(new)
            return new
        callee = self.of.call(called)[0]
        given = None if callee is None else callee.result
        quiet = id(node) in self.first or not self.of.may_store(called)
        if given is None or plain_tuple(given) and id(node) not in self.given or self.stopped or not quiet:
            self.stopped = self.stopped or not quiet
            return new
        self.of.report.found += said
        return self._held(at(called, node), "inner")


def _stores(node: AST, lists: set[str]) -> bool:
    """Whether a part of a function may store in anything but its names and items of its own lists."""
    if isinstance(node, Subscript) and isinstance(node.value, Name) and node.value.id in lists:
        return False
    if isinstance(node, (Attribute, Subscript)) and not isinstance(node.ctx, Load) or isinstance(node, AugAssign):
        return True
    return isinstance(node, Call) and any(k.arg == "out" for k in node.keywords) or isinstance(
        node, Attribute) and node.attr in _STORING
