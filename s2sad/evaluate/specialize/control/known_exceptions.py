"""try: the handlers of exceptions that show before the run.

    try: c = table[name]            name = "heat", and there is no such key          c = 0.5
    except KeyError: c = 0.5

Keys and attributes are known: whether they are there, and what the text raises by itself on a way that every run takes,
shows here. What only the run would raise is refused.
"""
from __future__ import annotations

import builtins
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, NoReturn

from s2sad import tree
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator, operation, statement
from s2sad.evaluate.specialize.signals import Raised, Unevaluated
from s2sad.evaluate.specialize.values import NONE, ClassValue, Conflict, LibraryValue, TupleValue, Value
from s2sad.tree import AST

# what the residual program never raises: it has neither dictionaries nor attributes, and imports nothing
_SHOWN = (KeyError, AttributeError, ImportError, NameError, NotImplementedError)


@dataclass(frozen=True, eq=False)
class Handlers:
    """What the handlers of a `try` catch, the block of the residual program that its body is in, what may be not
    evaluated there (`guarded`), and how far the evaluation was."""
    kinds: tuple[type[BaseException], ...]
    block: list[AST]
    guarded: tuple[Any, ...]
    pending: int
    loops: int
    depth: int


@statement("Try")
def try_statement(ev: Evaluator, s: Any, f: Frame) -> None:
    if s.finalbody:
        inner = [tree.replica(s, lambda value, name: [] if name == "finalbody" else value)] if s.handlers else s.body
        ending(ev, inner if s.handlers else [*inner, *s.orelse], lambda: ev.statements(s.finalbody, f), f)
        return
    end = return_at_the_end(ev, s.body)
    caught = [_caught(ev, h, f) for h in s.handlers]
    kinds = tuple(k for found in caught for k in found)
    one = Handlers(kinds, ev.block, ev.guarded, len(ev.pending), len(ev.loops), ev.depth)
    emitted = ev.emitted
    ev.handlers.append(one)
    try:
        ev.statements(s.body[:-1] if end is not None else s.body, f)
        value = ev.atoms(ev.value(end.value, f), "result", end) if end is not None and end.value is not None else NONE
    except Raised as raised:
        if raised.handlers is not one:
            raise
        del ev.pending[one.pending:], ev.loops[one.loops:], ev.handlers[ev.handlers.index(one):]
        ev.depth = one.depth
        handler = next(h for h, found in zip(s.handlers, caught) if issubclass(raised.kind, found))
        _handle(ev, handler, f)
        return
    finally:
        if one in ev.handlers:
            ev.handlers.remove(one)
    if ev.emitted != emitted and not all(k in _SHOWN or _is_own(k) for k in kinds):
        raise ev.refusal(s, "try around what may raise is not supported in a kernel",
                         help="test for the bad case with an if before it happens")
    if end is not None:
        ev.leave_function(end, value, f)
    ev.statements(s.orelse, f)


def _is_own(kind: type[BaseException]) -> bool:
    """Whether an exception is a class of the user's: only the text itself raises it."""
    return bool(kind.__flags__ & (1 << 9)) and kind.__module__.partition(".")[0] not in ("numpy", "scipy", "numba")


def _handle(ev: Evaluator, handler: Any, f: Frame) -> None:
    if handler.name is not None:
        target = handler.name if isinstance(handler.name, tree.AST) else tree.at(tree.name(handler.name), handler)
        ev.heap.put(f.reference, target.id, Conflict("an exception that shows before the run, and what it says"))
    ev.statements(handler.body, f)


def _caught(ev: Evaluator, handler: Any, f: Frame) -> tuple[type[BaseException], ...]:
    """The classes that a handler catches."""
    if handler.type is None:
        return (BaseException,)
    value = ev.value(handler.type, f)
    found = [exception_class(v) for v in (value.items if isinstance(value, TupleValue) else (value,))]
    known = tuple(k for k in found if k is not None)
    if len(known) < len(found):
        raise ev.refusal(handler, "try with a handler of this is not supported in a kernel",
                         help="test for the bad case with an if before it happens")
    return known


def exception_class(value: Value | None) -> type[BaseException] | None:
    """The class of exceptions that a value is."""
    path = value.path.partition(".") if isinstance(value, LibraryValue) else ("", "", "")
    live = value.live if isinstance(value, ClassValue) else getattr(builtins, path[2], None) if (
        path[0] == "builtins") else None
    return live if isinstance(live, type) and issubclass(live, BaseException) else None


@operation
def throws(ev: Evaluator, kind: type[BaseException], node: AST) -> None:
    """Goes to the handler around that catches what is raised here; goes on where there is none."""
    for one in reversed(ev.handlers):
        if issubclass(kind, one.kinds):
            if ev.block is not one.block or ev.guarded != one.guarded:
                _refuse(ev, kind, node)
            raise Raised(one, kind)


@operation
def raised_in_runs(ev: Evaluator, name: str, node: AST) -> None:
    """Refuses what some runs raise where a handler is around that catches it."""
    kind = getattr(builtins, name.rpartition(".")[2])
    if any(issubclass(kind, one.kinds) for one in ev.handlers):
        _refuse(ev, kind, node)


def _refuse(ev: Evaluator, kind: type[BaseException], node: AST) -> NoReturn:
    refused = ev.refusal(node, f"only the run knows whether this raises {kind.__name__}, inside of a try",
                         help="test for the bad case with an if before it happens")
    raise Unevaluated(refused, frozenset().union(*ev.guarded))      # which may tell


# -- what is done whichever way statements are left ------------------------------------------------------------------
def ending(ev: Evaluator, body: list[AST], last: Callable[[], None], f: Frame) -> None:
    """Statements, and what is done whichever way they are left."""
    end = return_at_the_end(ev, body)
    body = body[:-1] if end is not None else body

    def behind() -> None:
        value = ev.atoms(ev.value(end.value, f), "result", end) if end is not None and end.value is not None else NONE
        last()
        if end is not None:
            ev.leave_function(end, value, f)
    ev.later(behind)
    try:
        ev.statements(body, f)
    except Raised:
        last()
        raise
    finally:
        del ev.pending[-1]
    behind()


def return_at_the_end(ev: Evaluator, body: Sequence[Any]) -> Any:
    """The return that a block ends with; refuses other jumps out of it."""
    end = body[-1] if body and type(body[-1]).__name__ == "Return" else None
    jump = next(_jumps(body[:-1] if end is not None else body), None)
    if jump is not None:
        raise ev.refusal(jump, "a jump out of 'with' or 'try' is not supported in a kernel",
                         help="keep the result under a name, and return it behind the block")
    return end


def _jumps(body: Sequence[Any], inside: bool = False) -> Iterator[AST]:
    """What leaves statements; `inside` one of their loops only a return does."""
    for s in body:
        kind = type(s).__name__
        if kind == "Return" or kind in ("Break", "Continue") and not inside:
            yield s
        if kind not in ("FunctionDef", "ClassDef"):
            for name in ("body", "finalbody", "handlers", "cases"):
                yield from _jumps(getattr(s, name, ()), inside or kind in ("For", "While"))
            yield from _jumps(getattr(s, "orelse", ()), inside)
