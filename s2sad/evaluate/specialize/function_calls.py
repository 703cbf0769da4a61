"""Calls: a function of the user's stays one where it can (`separate`), else it is evaluated in a frame of its own,
where it is called.
"""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from s2sad import tree
from s2sad.diagnostics import Diagnostic, S2sadError, Span
from s2sad.evaluate.effects import is_writing_call
from s2sad.evaluate.library import is_of_library
from s2sad.evaluate.mutating_calls import stored_out
from s2sad.evaluate.specialize.control.choice_joins import are_functions
from s2sad.evaluate.specialize.control.choices import chosen
from s2sad.evaluate.specialize.displays import flat
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator, expression, operation
from s2sad.evaluate.specialize.functions.known_options import with_known_options
from s2sad.evaluate.specialize.signals import Leave, Unevaluated
from s2sad.evaluate.specialize.sequences.generators import is_generator
from s2sad.evaluate.specialize.sequences.known_shapes import of_method, origins
from s2sad.evaluate.specialize.sequences.residual_lists import COUNTED
from s2sad.evaluate.specialize.sparse.matrix_values import is_sparse
from s2sad.evaluate.specialize.values import (
    NONE, Choice, ClassValue, Data, FunctionValue, LibraryValue, MethodValue, Reference, ResidualObject, ScopeValue,
    SuperValue, TupleValue, Value, constant,
)
from s2sad.live_objects.registry import GIVEN
from s2sad.read.outside_values import library_value
from s2sad.tree import AST

DEEPEST = 60        # calls within calls: beyond, recursion does not end for what is known


@expression("Call")
def call_expression(ev: Evaluator, node: Any, f: Frame) -> Value:
    if isinstance(node.func, tree.Name) and node.func.id == "super" and not node.args:
        return _super(ev, node, f)
    targets, ev.targets = ev.targets, ()
    function, *values = ev.values([node.func, *node.args, *(k.value for k in node.keywords)], f, carries=True,
                                  taken=lambda called: _items_taken(ev, called, node, f))
    if not _takes_choices(ev, function):
        for n, v in zip((node.func, *node.args, *node.keywords), (function, *values)):
            ev.one(v, n)
    args = flat(node.args, values)
    keywords: dict[str, Value] = {}
    for k, v in zip(node.keywords, values[len(node.args):]):
        keywords |= {k.arg: v} if k.arg else {str(key): i for key, i in ev.dict_items(v, node, f).items()}
    ev.targets = targets if isinstance(function, FunctionValue) else ()
    return call(ev, function, args, keywords, node, f)


def _items_taken(ev: Evaluator, function: Value, node: Any, f: Frame) -> int | None:
    """How many items the one starred argument of a call has: what the other arguments leave of the parameters."""
    if sum(isinstance(a, tree.Starred) for a in node.args) != 1 or not all(k.arg for k in node.keywords):
        return None
    count = _parameter_count(ev, function, node, f)
    return None if count is None else max(count - (len(node.args) - 1) - len(node.keywords), 0)


def _parameter_count(ev: Evaluator, function: Value, node: AST, f: Frame) -> int | None:
    """How many arguments what is called must be given; None where that is left open."""
    if isinstance(function, LibraryValue) and not function.first and not function.keywords:
        return getattr(library_value(function.path), "nin", None)
    if isinstance(function, ClassValue):
        layout, own = ev.layout_of(function), ev.class_item(function, "__init__", node, f)
        if own is None:
            return len(layout.fields) if layout and all(d.default is None and d.is_given for d in layout.fields
                                                        ) else None
        count = _parameter_count(ev, own[1], node, f)
        return None if count is None else count - 1
    if not isinstance(function, FunctionValue) or function.captured is None or function.keywords:
        return None
    spelled = function.captured.tree.args
    open_ended = spelled.defaults or spelled.vararg or spelled.kwonlyargs
    return None if open_ended else len(spelled.args) - len(function.first)


def _takes_choices(ev: Evaluator, function: Value) -> bool:
    """Whether what is called carries its arguments along: functions of the user's, classes, containers."""
    if isinstance(function, Choice):
        return are_functions(function.values)
    if isinstance(function, MethodValue):
        return not isinstance(function.base, Data)
    return isinstance(function, ClassValue) or isinstance(function, FunctionValue) and not is_given(function)


def _super(ev: Evaluator, node: AST, f: Frame) -> Value:
    frame: Frame | None = f
    while frame is not None and frame.owner is None:
        frame = frame.outer
    if frame is None or frame.owner is None or not frame.first:
        raise ev.refusal(node, "super() outside of a method")
    return SuperValue(frame.owner, ev.heap[frame.reference].items[frame.first])


@operation
def call(ev: Evaluator, function: Value, args: Sequence[Value], keywords: Mapping[str, Value], node: AST, f: Frame
         ) -> Value:
    """What a call gives."""
    if isinstance(function, FunctionValue):
        return _function(ev, function, args, keywords, node, f)
    if isinstance(function, LibraryValue):
        return ev.library_call(function.path, [*function.first, *args], {**dict(function.keywords), **keywords}, node,
                            f)
    if isinstance(function, ClassValue):
        return ev.constructed(function, args, keywords, node, f)
    if isinstance(function, Choice):
        return _one_of(ev, function, args, keywords, node, f)
    if isinstance(function, MethodValue):
        if isinstance(function.base, Data) and not isinstance(function.base.known, str):
            found = ev.residual_list_method(function.base, function.name, args, keywords, node, f) if (
                function.base.is_list) else None
            if found is not None:
                return found
            if function.name == "append" and isinstance(function.base.node, tree.Subscript):
                raise ev.unknown(
                    node, "a list is appended to that is an item of a list whose length only the run knows",
                    help=f"make the outer list of a length that is known before the run, or {COUNTED}")
            written = ev.written_function(f"numpy.{function.name}", [function.base, *args], keywords, node, f)
            if written is not None:
                return written
            args, keywords = with_known_options(ev, f"numpy.{function.name}", args, keywords, node, is_method=True)
            if function.base.is_list:
                args = [Data(ev.spelled_item(a, node, f)) if isinstance(a, (Reference, TupleValue)) else a
                        for a in args]
            made = residual_call(ev, tree.attribute(spelled_base(ev, function.base, node), function.name), args,
                                 keywords, node)
            return replace(made, shape=of_method(function.base, function.name, args, keywords),
                           origins=origins(function.base, *args),
                           is_list=function.base.is_list and function.name == "copy", rows=function.base.rows)
        return ev.container_method(function.base, function.name, list(args), dict(keywords), node, f)
    if is_sparse(function, ev.heap):
        return ev.called_factors(function, list(args), dict(keywords), node)
    if isinstance(function, ResidualObject) or isinstance(function, Reference) and (
            ev.heap[function].kind == "record"):
        return call(ev, ev.attribute_of(function, "__call__", node, f), args, keywords, node, f)
    if isinstance(function, Data) and not function.is_known:
        return residual_call(ev, function.node, args, keywords, node)
    if isinstance(function, ScopeValue):
        raise ev.refusal(node, f"'{function.name}' is not a function that s2sad knows or can read",
                         help="write out what it does")
    raise ev.refusal(node, f"{ev.kind_of(function)} is called")


def _one_of(ev: Evaluator, choice: Choice, args: Sequence[Value], keywords: Mapping[str, Value], node: AST, f: Frame
            ) -> Value:
    """What the chosen function gives; the number is asked for one after the other, from the last on."""
    *others, last = choice.values
    if not others:
        return call(ev, last, args, keywords, node, f)
    test = tree.compare(ev.spelled(choice.number, node), tree.Eq(), tree.const(choice.numbers[-1]))
    rest = replace(choice, values=(*others,), numbers=choice.numbers[:-1])
    return chosen(ev, Data(tree.at(test, node)), (lambda: call(ev, last, args, keywords, node, f),
                                                  lambda: _one_of(ev, rest, args, keywords, node, f)), node, f)


def spelled_base(ev: Evaluator, value: Data, node: AST) -> AST:
    return ev.spelled(value, node)


# what gives a tuple or a list of arrays
_SEVERAL = frozenset(f"numpy.{n}" for n in (
    "nonzero", "where", "modf", "frexp", "divmod", "unravel_index", "histogram", "meshgrid", "broadcast_arrays", "ix_",
    "split", "array_split", "hsplit", "vsplit", "dsplit", "gradient", "unique", "linalg.slogdet", "linalg.qr",
    "linalg.eig", "linalg.eigh", "linalg.svd", "linalg.lstsq")) | {"builtins.divmod", "math.modf", "math.frexp"}


@operation
def residual_call(ev: Evaluator, function: AST, args: Sequence[Value], keywords: Mapping[str, Value], node: AST
                  ) -> Data:
    """A call that the residual program makes; one that writes an array is a statement, which gives what it wrote."""
    ev.refuse_objects([*args, *keywords.values()], node)
    made = tree.at(tree.Call(function, [ev.spelled(a, node) for a in args],
                             [tree.keyword(k, ev.spelled(v, node)) for k, v in keywords.items()]), node)
    if not is_writing_call(made):
        return Data(made, may_be_row=(tree.call_name(made) or "") in _SEVERAL)
    filled = stored_out(made)
    if filled is not None and not isinstance(filled[0].value, (tree.Name, tree.Subscript)):
        return ev.named(Data(made), "filled", node)
    ev.emit(tree.Expr(made), node, True)
    return constant(None) if filled is None else Data(tree.copy(filled[0].value))


def _function(ev: Evaluator, function: FunctionValue, args: Sequence[Value], keywords: Mapping[str, Value], node: AST,
              f: Frame) -> Value:
    if function.captured is None or is_given(function):
        return residual_call(ev, tree.at(tree.name(ev.residual_function(function, node)), node),
                             [*function.first, *args], {**dict(function.keywords), **keywords}, node)
    args, keywords = [*function.first, *args], {**dict(function.keywords), **keywords}
    if is_of_library(function.captured.source.path):
        return as_written(ev, function, args, keywords, node, f)
    if ev.handlers:         # which catch what it raises
        return inlined(ev, function, args, keywords, node, f)
    found = ev.separate_call(function, args, keywords, node, f)
    return inlined(ev, function, args, keywords, node, f) if found is None else found


def is_given(function: FunctionValue) -> bool:
    """Whether a function has a derivative of the user's own."""
    return function.handle is not None and GIVEN.own(function.handle) is not None


def as_written(ev: Evaluator, function: FunctionValue, args: Sequence[Value], keywords: Mapping[str, Value], node: AST,
               f: Frame) -> Value:
    """What a function gives that says what a library's does: its body is where it is called, as if it stood in the
    user's text."""
    first = len(ev.block)
    try:
        found = inlined(ev, function, args, keywords, node, f)
    except Unevaluated as reason:
        reason.error = _of_the_call(ev, reason.error, node)
        raise
    except S2sadError as error:
        raise _of_the_call(ev, error, node) from None
    made = [*ev.block[first:], *([found.node] if isinstance(found, Data) else [])]
    for inner in (n for m in made for n in tree.walk(m)):
        inner.__dict__.pop("lineno", None)
    for statement in made:
        tree.at(statement, node)
    return found


def _of_the_call(ev: Evaluator, error: S2sadError, node: AST) -> S2sadError:
    """What is refused in a function that stands for NumPy's, at its call; beside it what is raised there."""
    def moved(said: Diagnostic) -> Diagnostic:
        span = said.span
        if span is None or not is_of_library(span.source.path):
            return said
        line = span.source.line(span.line).strip()
        return replace(said, span=Span.of(ev.source, node), note=said.note or line * line.startswith("raise "))
    return type(error)(*map(moved, error.diagnostics)) if getattr(node, "lineno", None) else error


def inlined(ev: Evaluator, function: FunctionValue, args: Sequence[Value], keywords: Mapping[str, Value], node: AST,
            f: Frame) -> Value:
    """The body where the call is, in a frame of its own."""
    if ev.depth > DEEPEST:      # it may end where the tests around are decided
        refused = ev.refusal(node, f"'{function.captured.name}' calls itself more than {DEEPEST} deep",
                             help="recursion must end for what is known before the run", code="S204")
        raise Unevaluated(refused, frozenset().union(*ev.guarded), endless=True)
    definition = function.captured.tree
    if type(definition).__name__ not in ("FunctionDef", "Lambda"):
        raise ev.refusal(node, f"'{function.captured.name}' is a coroutine")
    frame = ev.frame_of(function, definition)
    ev.bind_arguments(function, definition, args, keywords, node, frame)
    if is_generator(definition):
        return ev.iterator("yields", more=(frame, definition))
    depth, pending = ev.depth, len(ev.pending)
    ev.depth += 1
    ev.pending.append(None)
    try:
        if type(definition).__name__ == "Lambda":
            return ev.value(definition.body, frame)
        ev.statements(definition.body, frame)
        return NONE
    except Leave as leave:
        if leave.mark != frame.mark:
            raise
        return NONE if leave.value is None else leave.value
    finally:
        ev.depth = depth
        del ev.pending[pending:]
        del ev.loops[frame.loops:]
        if frame.reference.number not in ev.frames:
            ev.heap.objects.pop(frame.reference.number, None)

