"""Statements with one target and pure expressions.

    def g(x):
        return x * x

is called in an expression and in a test:

    def f(x, y):                        def f(x, y):
        a, b = y[0], x                      a = y[0]
        a, b = b, a                         b = x
        c = g(a) + 1.0                      a_before = a
        d = a if c > b else b               a = b
        while g(d) > 2.0:                   b = a_before
            d = d - 1.0                     g_value = g(a)
        y[0] = d                            c = g_value + 1.0
                                            if c > b:
                                                d = a
                                            else:
                                                d = b
                                            while True:
                                                g_value_2 = g(d)
                                                if g_value_2 > 2.0:
                                                    d = d - 1.0
                                                else:
                                                    break
                                            y[0] = d

*Requires* resolved names. *Establishes*: assignments have one target and pure values, a user's call stands alone (as a
value, a statement or what is returned) with its arguments by position; every statement has the place of the one it
comes from. Docstrings, `pass` and bare annotations are gone. Loops keep their iterables, jumps are where they were.
"""
from __future__ import annotations

from collections.abc import Callable

from s2sad.evaluate.argument_binding import user_call
from s2sad.normalize.control.hoist import bound_call, hoist, hoist_all, impure, operands, replace_operands, stored
from s2sad.evaluate.mutating_calls import UNSUPPORTED, stored_by_call, stored_out
from s2sad.evaluate.scope import KernelScope
from s2sad.normalize.control.unpack import unassignable, unpack
from s2sad.rules.composed import WRITING
from s2sad.tree import (
    GUARD, SAID, AST, And, AnnAssign, Assert, Assign, AugAssign, BinOp, BoolOp, Break, Call, Constant, Continue, Expr,
    For, FunctionDef, If, IfExp, Name, Not, Pass, Raise, Return, Subscript, UnaryOp, While, assign, at, call_name,
    const, copy, function, index, name, walk,
)


def single_target(tree: FunctionDef, scope: KernelScope) -> FunctionDef:
    body = _block(tree.body, scope)
    parameters = [a.id for a in (*tree.args.posonlyargs, *tree.args.args, *tree.args.kwonlyargs)]
    return at(function(tree.name, parameters, body), tree)


def _block(statements: list[AST], scope: KernelScope) -> list[AST]:
    new: list[AST] = []
    for statement in statements:
        step = _STEPS.get(type(statement))
        if step is None:
            scope.refuse(statement, f"the statement {type(statement).__name__.lower()!r}")
            continue
        new += [at(s, statement) for s in step(statement, scope)]
    return new


def _assign(node: Assign, scope: KernelScope) -> list[AST]:
    before, value = stored(node.value, scope) if stored_out(node.value) is not None else ([], node.value)
    return [*before, *unpack(node.targets, value, scope)]


def _annotated(node: AnnAssign, scope: KernelScope) -> list[AST]:
    return [] if node.value is None else _assign(at(Assign([node.target], node.value, None), node), scope)


def _augmented(node: AugAssign, scope: KernelScope) -> list[AST]:
    target, value = node.target, node.value
    simple = isinstance(target, Name) or not (impure(target) or any(user_call(n) for n in walk(value)))
    if isinstance(value, IfExp) and simple:
        before, test = hoist(value.test, scope)
        arms = [_augmented(AugAssign(copy(target), node.op, v), scope) for v in (value.body, value.orelse)]
        return [*before, If(test, *arms)]
    if isinstance(target, Name):
        before, value = hoist(value, scope)
        return [*before, AugAssign(target, node.op, value)]
    if not isinstance(target, Subscript):
        unassignable(target, scope)
        return []
    return _augmented_element(node, scope)


def _augmented_element(node: AugAssign, scope: KernelScope) -> list[AST]:
    """Python reads the element before it evaluates the value, which may change it."""
    parts = operands(node.target)
    before_target, new = hoist_all(parts, scope)
    before, value = hoist(node.value, scope)
    written = scope.memory.written(before)
    new = [scope.held(p, "held", before_target) if scope.memory.affected(p, written) else p for p in new]
    target = replace_operands(node.target, parts, new)
    element = Subscript(target.value, target.slice, name("x").ctx)
    if scope.memory.affected(element, written):
        old = scope.held(element, "held", before_target)
        return [*before_target, *before, assign(copy(target), BinOp(old, node.op, value))]
    return [*before_target, *before, AugAssign(target, node.op, value)]


def _expression(node: Expr, scope: KernelScope) -> list[AST]:
    value = node.value
    if user_call(value) is not None:
        before, bound = bound_call(value, scope)
        return [*before, Expr(bound)]
    if not isinstance(value, Call):
        return hoist(value, scope)[0]
    stored = stored_by_call(value)
    if stored is not None:
        before, (target, filled) = _viewed(value, *stored, scope)
        return [*before, *unpack([target], filled, scope)]
    if call_name(value) == "builtins.print":
        before, left = hoist(value, scope)
        return [*before, Expr(left)]
    scope.refuse(node, "a call whose result is not used", help=UNSUPPORTED.get(
        call_name(value) or "", "only calls of kernels, print and functions that write an argument stand alone"))
    return []


def _viewed(node: Call, target: AST, value: AST, scope: KernelScope) -> tuple[list[AST], tuple[AST, AST]]:
    """A name for the view that a function makes of what another one writes: `np.add.at(u.ravel(), k, v)`."""
    if call_name(node) not in WRITING:
        return [], (target, value)
    base = node.args[0]
    while isinstance(base, Subscript):
        base = base.value
    if isinstance(base, Name):
        return [], (target, value)
    before, place = hoist(node.args[0], scope)
    place = scope.held(place, "filled", before)
    call = at(Call(node.func, [copy(place), *node.args[1:]], node.keywords), node)
    return before, (index(place, const(...)), call)


def _if(node: If, scope: KernelScope) -> list[AST]:
    test = node.test
    if isinstance(test, BoolOp) and isinstance(test.op, And) and not node.orelse and impure(test.values[1:]):
        first = next(k for k, v in enumerate(test.values) if k and impure(v))
        head, tail = (v[0] if len(v) == 1 else BoolOp(And(), v) for v in (test.values[:first], test.values[first:]))
        return _if(If(head, [at(If(tail, node.body, []), node)], []), scope)
    before, test = hoist(test, scope)
    return [*before, If(test, _block(node.body, scope), _block(node.orelse, scope))]


def _while(node: While, scope: KernelScope) -> list[AST]:
    before, test = hoist(node.test, scope)
    body = _block(node.body, scope)
    orelse = _block(node.orelse, scope)
    if not before:
        return [While(test, body, orelse)]
    if not orelse:
        return [While(const(True), [*before, If(test, body, [Break()])], [])]
    ended = scope.fresh("ended")
    last = [assign(ended, const(True)), Break()]
    loop = While(const(True), [*before, If(test, body, last)], [])
    return [assign(ended, const(False)), loop, If(name(ended), orelse, [])]


def _for(node: For, scope: KernelScope) -> list[AST]:
    before, iterable = hoist(node.iter, scope)
    return [*before, For(node.target, iterable, _block(node.body, scope), _block(node.orelse, scope), None)]


def _return(node: Return, scope: KernelScope) -> list[AST]:
    value = node.value
    if isinstance(value, IfExp):
        before, test = hoist(value.test, scope)
        arms = [[at(s, node) for s in _return(Return(v), scope)] for v in (value.body, value.orelse)]
        return [*before, If(test, *arms)]
    if value is None or (isinstance(value, Constant) and value.value is None):
        return [Return(None)]
    if user_call(value) is not None:
        before, bound = bound_call(value, scope)
        return [*before, Return(bound)]
    before, value = hoist(value, scope)
    return [*before, Return(value)]


def _assert(node: Assert, scope: KernelScope) -> list[AST]:
    before, test = hoist(node.test, scope)
    said, message = hoist(node.msg, scope) if node.msg is not None else ([], None)
    if isinstance(message, Constant):
        message = at(Constant(message.value, None if message.kind == GUARD else SAID), node)
    if not said:
        return [*before, Assert(test, message)]
    return [*before, If(UnaryOp(Not(), test), [*said, Assert(const(False), message)], [])]


def _raise(node: Raise, scope: KernelScope) -> list[AST]:
    before, values = hoist_all([v for v in (node.exc, node.cause) if v is not None], scope)
    return [*before, Raise(*[*values, None, None][:2])]


def _kept(node: AST, scope: KernelScope) -> list[AST]:
    return [node]


def _dropped(node: AST, scope: KernelScope) -> list[AST]:
    return []


_STEPS: dict[type, Callable[[AST, KernelScope], list[AST]]] = {
    Assign: _assign, AnnAssign: _annotated, AugAssign: _augmented, Expr: _expression, If: _if, While: _while,
    For: _for, Return: _return, Assert: _assert, Raise: _raise, Break: _kept, Continue: _kept, Pass: _dropped,
}
