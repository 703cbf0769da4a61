"""assert, raise, and statements that do nothing.
"""
from __future__ import annotations

from typing import Any

from s2sad import tree
from s2sad.evaluate.specialize.control.known_exceptions import exception_class
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator, statement
from s2sad.evaluate.specialize.signals import Unevaluated
from s2sad.evaluate.specialize.values import Data, LibraryValue
from s2sad.tree import AST


@statement("Expr")
def expression_statement(ev: Evaluator, s: Any, f: Frame) -> None:
    if isinstance(s.value, tree.Constant):
        return
    value = ev.value(s.value, f)
    if isinstance(value, Data) and not value.is_known and isinstance(value.node, tree.Call):
        ev.emit(tree.Expr(value.node), s, True)


@statement("Pass", "Global")
def nothing(ev: Evaluator, s: Any, f: Frame) -> None:
    if type(s).__name__ == "Global":
        raise ev.refusal(s, "global is not supported in a kernel",
                         help="return the new value, or keep it in an object that the kernel is given")


@statement("Nonlocal")
def nonlocal_statement(ev: Evaluator, s: Any, f: Frame) -> None:
    del ev, s, f


@statement("Assert")
def assert_statement(ev: Evaluator, s: Any, f: Frame) -> None:
    before = ev.snapshot()
    test = ev.test_of(s.test, f)
    if isinstance(test, Data):
        ev.emit(tree.Assert(test.node, _message(ev, s.msg, f)), s)
    elif not test:
        ev.restore(before)
        raise ev.refusal(s, "this assertion fails whenever the kernel runs")


def _message(ev: Evaluator, node: AST | None, f: Frame) -> AST | None:
    """The text of an error: of what is not known what stands in the source."""
    if node is None:
        return None
    before = ev.snapshot()
    try:
        value = ev.value(node, f)
        if isinstance(value, Data) and isinstance(value.known, str):
            return tree.at(tree.const(value.known), node)
    except Exception as error:
        from s2sad.diagnostics import S2sadError
        if not isinstance(error, (S2sadError, Unevaluated)):
            raise
    ev.restore(before)
    return tree.at(tree.const(tree.written(node)), node)


@statement("Raise")
def raise_statement(ev: Evaluator, s: Any, f: Frame) -> None:
    exc = s.exc
    called = exc.func if isinstance(exc, tree.Call) else exc
    meant = ev.value(called, f) if called is not None else None
    kind = exception_class(meant)
    if kind is not None:
        ev.throws(kind, s)
    if not (isinstance(meant, LibraryValue) and meant.path.startswith("builtins.")):
        name = "builtins.RuntimeError"
    else:
        name = meant.path
    text = [_message(ev, exc.args[0], f)] if isinstance(exc, tree.Call) and exc.args else []
    if not ev.is_sure():
        ev.raises(name, [t for t in text if t is not None], s)
    raise ev.refusal(s, "this is raised whenever the kernel runs so far")
