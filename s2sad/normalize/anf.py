"""anf: A-normal form: every operand that the adjoint reads by itself has a name.

Requires one name a binding; establishes that in every statement which computes floats
- a load from an array that the function writes is a statement of its own (a copy of the element),
- an operation whose partial reads its own result (a quotient, exp, sqrt, ...) is the root of its statement,
- a sum over an array, a kernel's call and the test of a branch have names, and so has an integer or a bool that is a
  property of a whole array which the function stores into (`np.argmax(a)`).

    def f(a, i, j):                     def f(a, i, j):
        a[i, j] = a[i, j] / a[j, j]         a_here = a[i, j]
                                            a_here_2 = a[j, j]
                                            ratio = a_here / a_here_2
                                            a[i, j] = ratio

`simplify.forward_substitution` takes the names out again where they are not needed.
"""
from __future__ import annotations


from s2sad import rules
from s2sad.liveness import base_name
from s2sad.infer.inference import Typing
from s2sad.infer.types import BOOL, Type
from s2sad.naming import Names
from s2sad.normalize.array_anf import is_function
from s2sad.normalize.context import NormalContext
from s2sad.tree import (
    AST, Assign, Attribute, AugAssign, BinOp, BoolOp, Call, Compare, Constant, Div, Expr, For, FunctionDef, If, Name,
    Pow, Return, Subscript, Tuple, UnaryOp, USub, While, assign, at, augment, call, call_name, copy, dump, index,
    indices, name, names, user_call, walk, with_body,
)


def anf(function: FunctionDef, context: NormalContext) -> FunctionDef:
    """The function with those names; `written` are the arrays that it writes."""
    typing, free, written = context.typing, context.names, context.callees.written_in(function)
    return with_body(function, _Anf(typing, free, written).block(function.body))


def reads_result(node: AST, typing: Typing) -> bool:
    """Whether an operation's partials read its result."""
    if isinstance(node, BinOp):
        if isinstance(node.op, Div):
            return not isinstance(node.right, Constant)
        return isinstance(node.op, Pow) and not _is_integer(node.right)
    rule = rules.find(call_name(node) or "")
    if rule is not None and rule.plane is not None and any(typing.of(a).is_complex for a in node.args):
        rule = rule.plane
    return rule is not None and any("y" in rule.uses(p) for p in rule.parameters)


def _is_integer(node: AST) -> bool:
    if isinstance(node, UnaryOp) and isinstance(node.op, USub):
        return _is_integer(node.operand)
    return isinstance(node, Constant) and isinstance(node.value, int)


class _Anf:
    def __init__(self, typing: Typing, free: Names, written: set[str]):
        self.typing, self.free, self.written = typing, free, written

    def block(self, block: list[AST]) -> list[AST]:
        return [at(made, s) for s in block for made in self.statement(s)]

    def statement(self, statement: AST) -> list[AST]:
        before: list[AST] = []
        if isinstance(statement, For):
            bounds = [self.bound(b, before) for b in statement.iter.args]
            return [*before, For(statement.target, call("builtins.range", *bounds), self.block(statement.body), [],
                                 None)]
        if isinstance(statement, While):
            return [While(statement.test, self.block(statement.body), [])]
        if isinstance(statement, If):
            return self.branch(statement)
        if isinstance(statement, Assign):
            root = self.right_side(statement, before)
            target = self.indexed(statement.targets[0], before)
            return [*before, assign(target, root)]
        if isinstance(statement, AugAssign):
            value = self.operand(statement.value, before) if self.is_float(statement.value) else statement.value
            target = self.indexed(statement.target, before)
            return [*before, augment(target, statement.op, value)]
        if isinstance(statement, Return):
            if statement.value is None:
                return [statement]
            parts = statement.value.elts if isinstance(statement.value, Tuple) else [statement.value]
            new = [self.simple(p, before, "result") for p in parts]
            value = Tuple(new, statement.value.ctx) if isinstance(statement.value, Tuple) else new[0]
            return [*before, Return(value)]
        if isinstance(statement, Expr) and user_call(statement.value):
            made = Expr(self.call(statement.value, before))
            return [*before, made]
        return [statement]

    def bound(self, node: AST, before: list[AST]) -> AST:
        """A bound of a range; one that reads an array which is written gets a name."""
        return name(self.bind("bound", node, before)) if self.reads_written(node) else node

    def branch(self, statement: If) -> list[AST]:
        before: list[AST] = []
        test = statement.test
        if not isinstance(test, Name):
            test = name(self.bind("taken", test, before, BOOL))
        return [*before, If(test, self.block(statement.body), self.block(statement.orelse))]

    def right_side(self, statement: Assign, before: list[AST]) -> AST:
        value, target = statement.value, statement.targets[0]
        if not self.is_float(value) or is_function(value):
            return value
        if isinstance(target, Name):
            if isinstance(value, Subscript) or call_name(value) == "numpy.sum":
                return self.indexed(value, before)
            if user_call(value):
                return self.call(value, before)
            if reads_result(value, self.typing):
                return self.children(value, before)
        elif user_call(value):
            return self.call(value, before)
        return self.operand(value, before)

    def call(self, node: Call, before: list[AST]) -> Call:
        args = [self.simple(a, before, "argument") if self.is_float(a) and not self.typing.of(a).is_array else
                self.named_property(self.indexed(a, before), before) for a in node.args]
        return Call(node.func, args, [])

    def simple(self, node: AST, before: list[AST], wanted: str) -> AST:
        if isinstance(node, (Name, Constant)) or not self.is_float(node):
            return node
        if self.typing.of(node).is_array:
            return node
        return name(self.bind(wanted, self.right_side(assign(name("_"), node), before), before))

    def operand(self, node: AST, before: list[AST]) -> AST:
        """The expression in A-normal form, left to right."""
        kind, node = self.typing.of(node), self.named_property(node, before)
        if isinstance(node, (Compare, BoolOp)) or not (kind.is_inexact or kind.dtype):
            return node
        if isinstance(node, Subscript):
            node = self.indexed(node, before)
        if isinstance(node, Subscript) and base_name(node) in self.written and not kind.is_array:
            return name(self.named_load(node, before))
        if isinstance(node, (Subscript, Name, Constant)) or type(node).__name__ == "Attribute":
            return node
        if call_name(node) == "numpy.sum":
            return name(self.bind("total", node, before))
        new = self.children(node, before)
        if reads_result(node, self.typing) and kind.is_inexact and not kind.is_array:
            return name(self.bind(_wanted(node), new, before))
        return new

    def children(self, node: AST, before: list[AST]) -> AST:
        if isinstance(node, BinOp):
            return BinOp(self.operand(node.left, before), node.op, self.operand(node.right, before))
        if isinstance(node, UnaryOp):
            return UnaryOp(node.op, self.operand(node.operand, before))
        if isinstance(node, Call):
            return Call(node.func, [self.operand(a, before) for a in node.args], node.keywords)
        return node

    def indexed(self, node: AST, before: list[AST]) -> AST:
        """A reference whose subscripts read no array that is written: those that do get names."""
        if not isinstance(node, Subscript) or not any(self.reads_written(s) for s in indices(node)):
            return node
        return index(node.value, *(name(self.name_of("place", s, before)) if self.reads_written(s) else s
                                   for s in indices(node)))

    def reads_written(self, node: AST) -> bool:
        """Whether an expression reads elements of an array that is stored into, or a property of the whole."""
        if self.typing.of(node).is_array:
            return any(isinstance(n, Subscript) and base_name(n) in self.written for n in walk(node))
        shapes = {id(n.value) for n in walk(node) if isinstance(n, Attribute)} | {
            id(n.args[0]) for n in walk(node) if call_name(n) in ("builtins.len", "numpy.size")}
        return any(isinstance(n, Name) and n.id in self.written and id(n) not in shapes for n in walk(node))

    def named_property(self, node: AST, before: list[AST]) -> AST:
        """A name for an integer or a bool that is a property of such an array as a whole; anything else as it is."""
        kind = self.typing.of(node)
        asks = kind.is_number and not kind.is_inexact and not isinstance(node, (Name, Constant)) and any(
            isinstance(n, Call) and any(self.typing.of(a).is_array and self.written & set(names(a)) for a in n.args)
            for n in walk(node))
        return name(self.name_of("asked", node, before)) if asks else node

    def named_load(self, node: Subscript, before: list[AST]) -> str:
        return self.name_of(f"{base_name(node)}_here", node, before)

    def name_of(self, wanted: str, node: AST, before: list[AST]) -> str:
        """A name for an expression, the same one within a statement."""
        for made in before:
            if isinstance(made, Assign) and dump(made.value) == dump(node):
                return made.targets[0].id
        return self.bind(wanted, node, before)

    def bind(self, wanted: str, value: AST, before: list[AST], kind: Type | None = None) -> str:
        made = self.typing.declare(self.free.fresh(wanted), kind or self.typing.of(value))
        before.append(assign(made, copy(value)))
        return made

    def is_float(self, node: AST) -> bool:
        kind = self.typing.of(node)
        return kind.is_inexact or kind.kind == "tuple" and any(i.is_inexact for i in kind.items) or (
            user_call(node) is not None)


def _wanted(node: AST) -> str:
    if isinstance(node, BinOp):
        return "ratio" if isinstance(node.op, Div) else "power"
    return (call_name(node) or "value").rpartition(".")[2] + "_value"


