"""Python's own functions over what is known.
"""
from __future__ import annotations

from dataclasses import replace
from typing import Any

from s2sad import tree
from s2sad.evaluate.specialize.classes.class_lookup import NONE_TYPE
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator
from s2sad.evaluate.specialize.signals import Unevaluated
from s2sad.evaluate.specialize.functions.library_calls import Args, Options, function
from s2sad.evaluate.specialize.heap import Object
from s2sad.evaluate.specialize.sequences.known_shapes import broadcast, origins, shape
from s2sad.evaluate.specialize.sequences.residual_lists import whole_list
from s2sad.evaluate.specialize.values import (
    FACTORY, NONE, ClassValue, Data, FunctionValue, Iteration, LibraryValue, MethodValue, ObjectValue, Reference,
    ResidualObject, SliceValue, SuperValue, TupleValue, Value, constant,
)
from s2sad.tree import AST


_SHORT = 64     # items of an array, in a list or a tuple


# -- Python's own ----------------------------------------------------------------------------------------------------
@function("builtins.len")
def _len(ev: Evaluator, args: Args, _: Options, node: AST, f: Frame) -> Value:
    return ev.length(args[0], node, f)


@function("builtins.range")
def _range(ev: Evaluator, args: Args, _: Options, node: AST, f: Frame) -> Value:
    return Iteration("range", tuple(args))


@function("builtins.zip")
def _zip(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Value:
    if "strict" in options and ev.known(options["strict"], node, "strict="):
        args = [ev.atoms(a, "items", node) for a in args]
        lengths = [ev.length(a, node, f) for a in args]
        for other in lengths[1:]:
            _same_length(ev, lengths[0], other, node)
    return ev.iterator("zip", *args)


def _same_length(ev: Evaluator, one: Any, other: Any, node: AST) -> None:
    """The check of zip(strict=True), before the first item is read."""
    message = "zip(strict=True) of sequences of other lengths"
    if not (one.is_known and other.is_known):
        test = tree.compare(ev.spelled(one, node), tree.NotEq(), ev.spelled(other, node))
        raising = [tree.const(message)]
        ev.branch(Data(tree.at(test, node), demands=one.demands | other.demands), (
            lambda: ev.raises("builtins.ValueError", raising, node), lambda: None), node)
    elif one.known != other.known:
        ev.throws(ValueError, node)
        if not ev.is_sure():
            ev.raises("builtins.ValueError", [tree.const(message)], node)
        raise ev.refusal(node, f"zip(strict=True) of {one.known} and {other.known} items", code="S203")


@function("builtins.enumerate")
def _enumerate(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Value:
    return ev.iterator("enumerate", args[0], *args[1:], *options.values())


@function("builtins.reversed")
def _reversed(ev: Evaluator, args: Args, _: Options, node: AST, f: Frame) -> Value:
    if isinstance(args[0], Iteration) and args[0].kind not in ("range", "keys", "values", "items"):
        given = node.args[0] if isinstance(node, tree.Call) and node.args else node
        raise ev.refusal(given, "reversed() of this", help="reverse a range or an array")
    held = ev.heap[args[0]] if isinstance(args[0], Reference) else None
    return ev.iterator("reversed", args[0], more=len(held.items) if held is not None and held.kind == "list" else None)


@function("builtins.map")
def _map(ev: Evaluator, args: Args, _: Options, node: AST, f: Frame) -> Value:
    return ev.iterator("map", *args)


@function("builtins.filter")
def _filter(ev: Evaluator, args: Args, _: Options, node: AST, f: Frame) -> Value:
    return ev.iterator("filter", *args)


@function("numpy.nditer")
def _nditer(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Value:
    raise ev.refusal(node, "np.nditer, which goes through an array as its elements lie in memory",
                     help="write for v in x.flat: to read them, for i in np.ndindex(x.shape): to write x[i]")


@function("numpy.ndindex", "numpy.ndenumerate")
def _indices(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Value | None:
    return None if options else ev.iterator(f"numpy.{ev.called}", *args)


@function("builtins.divmod")
def _divmod(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Value | None:
    if options or len(args) != 2:
        return None
    a, b = (ev.atoms(v, "operand", node) for v in args)
    return TupleValue((ev.binary(tree.FloorDiv(), a, b, node, f), ev.binary(tree.Mod(), a, b, node, f)))


@function("builtins.slice")
def _slice(ev: Evaluator, args: Args, _: Options, node: AST, f: Frame) -> Value:
    parts = [NONE, *args] if len(args) == 1 else args
    return SliceValue(tuple([*parts, NONE][:3]))


@function("builtins.list")
def _list(ev: Evaluator, args: Args, _: Options, node: AST, f: Frame) -> Value | None:
    if args and isinstance(args[0], Data) and not isinstance(args[0].known, (str, tuple)) and not _is_short(
            ev, args[0], node, f):
        count = ev.length(args[0], node, f)
        if count.demands and not args[0].is_list:
            raise ev.unknown(node, "how many items a list has must be known before the run", count)
        return whole_list(args[0], node) if args[0].rows is not None else None
    return ev.listed(args[0], node, f) if args else ev.list_of([], node)


def _is_short(ev: Evaluator, value: Data, node: AST, f: Frame) -> bool:
    """Whether so many items of an array are known as may be written out."""
    count = ev.length(value, node, f).known
    return type(count) is int and count <= _SHORT


@function("collections.deque")
def _deque(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Value:
    most = [ev.known(a, node, "the length of a deque") for a in (*args[1:], *options.values())]
    items = ev.items_of(args[0], node, f) if args else []
    if not most or most[0] is None:
        return ev.list_of(items, node)
    if id(node) in ev.sites:
        ev.limit_items(node, most[0])
        return ev.list_of(items[max(len(items) - most[0], 0):], node)
    ev.limited.append(node)
    made = ev.heap.new(Object("list", {}, most=most[0]))
    ev.replace_items(made, items, node)
    return made


@function("builtins.tuple")
def _tuple(ev: Evaluator, args: Args, _: Options, node: AST, f: Frame) -> Value | None:
    if args and isinstance(args[0], Data) and not isinstance(args[0].known, (str, tuple)) and not _is_short(
            ev, args[0], node, f):
        return replace(ev.residual_call(tree.at(tree.name(ev.library("builtins.tuple")), node), args, {}, node),
                       origins=origins(args[0]))
    return TupleValue(tuple(ev.items_of(args[0], node, f)) if args else ())


@function("builtins.dict", "collections.OrderedDict")
def _dict(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Value:
    return ev.new_dict({**(ev.dict_items(args[0], node, f) if args else {}), **options}, node)


@function("collections.defaultdict")
def _defaultdict(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Value:
    made = ev.new_dict({**(ev.dict_items(args[1], node, f) if args[1:] else {}), **options}, node)
    ev.heap.put(made, FACTORY, args[0])
    return made


@function("builtins.set", "builtins.frozenset")
def _set(ev: Evaluator, args: Args, _: Options, node: AST, f: Frame) -> Value:
    return ev.new_set(ev.items_of(args[0], node, f) if args else [], node)


@function("builtins.isinstance")
def _isinstance(ev: Evaluator, args: Args, _: Options, node: AST, f: Frame) -> Value:
    found = ev.is_instance(args[0], args[1], node)
    if found is None:
        raise ev.refusal(node, "isinstance asks for the type of a number or an array that is computed",
                         help="ask for the class first: isinstance(other, Vector), or in one kernel for each type")
    return constant(found)


@function("numpy.isscalar")
def _isscalar(ev: Evaluator, args: Args, _: Options, node: AST, f: Frame) -> Value | None:
    value = args[0]
    if not isinstance(value, Data):
        return constant(False)
    if value.is_known:
        return constant(value.known is not None and not isinstance(value.known, tuple))
    if value.shape is None and value.demands:
        raise ev.unknown(node, "what an argument is must be known before the run", value)
    return None if value.shape is None else constant(value.shape == ())


@function("numpy.ndim")
def _ndim(ev: Evaluator, args: Args, _: Options, node: AST, f: Frame) -> Value | None:
    if not isinstance(args[0], Data):
        return None
    if args[0].is_known or args[0].shape is not None:
        return constant(len(shape(args[0]) or ()))
    return ev.attribute_of(args[0], "ndim", node, f) if args[0].demands else None


@function("builtins.issubclass")
def _issubclass(ev: Evaluator, args: Args, _: Options, node: AST, f: Frame) -> Value | None:
    if not all(isinstance(a, ClassValue) for a in args):
        raise ev.refusal(node, "issubclass of this is not supported in a kernel")
    return constant(args[1] in ev.mro(args[0]))  # pyright: ignore


@function("builtins.type")
def _type(ev: Evaluator, args: Args, _: Options, node: AST, f: Frame) -> Value:
    made = ev.class_of(args[0])
    if isinstance(args[0], Data) and (args[0].is_known and args[0].known is None or args[0].shape):
        return LibraryValue("numpy.ndarray" if args[0].shape else NONE_TYPE)
    if made is None:
        raise ev.refusal(node, "type of an array or a number is not supported in a kernel", help="write isinstance")
    return made


@function("builtins.callable")
def _callable(ev: Evaluator, args: Args, _: Options, node: AST, f: Frame) -> Value:
    value = args[0]
    if isinstance(value, ResidualObject) or isinstance(value, Reference) and ev.heap[value].kind == "record":
        return constant(ev.class_of(value) is not None and ev.has_attribute(value, "__call__", node, f))
    return constant(isinstance(value, (FunctionValue, LibraryValue, ClassValue, MethodValue)))


@function("builtins.getattr")
def _getattr(ev: Evaluator, args: Args, _: Options, node: AST, f: Frame) -> Value:
    name = ev.known(args[1], node, "the name of an attribute")
    if args[2:] and not ev.has_attribute(args[0], name, node, f):
        return args[2]
    return ev.attribute_of(args[0], name, node, f)


@function("builtins.hasattr")
def _hasattr(ev: Evaluator, args: Args, _: Options, node: AST, f: Frame) -> Value:
    return constant(ev.has_attribute(args[0], ev.known(args[1], node, "the name of an attribute"), node, f))


@function("builtins.setattr")
def _setattr(ev: Evaluator, args: Args, _: Options, node: AST, f: Frame) -> Value:
    ev.assign_to(args[0], str(ev.known(args[1], node, "the name of an attribute")), args[2], node, f)
    return NONE


@function("builtins.super")
def _super(ev: Evaluator, args: Args, _: Options, node: AST, f: Frame) -> Value:
    if len(args) != 2 or not isinstance(args[0], ClassValue):
        raise ev.refusal(node, "super is given a class and an object")
    return SuperValue(args[0], args[1])


@function("builtins.object.__init__")
def _object_init(ev: Evaluator, args: Args, _: Options, node: AST, f: Frame) -> Value:
    return NONE


@function("builtins.id")
def _id(ev: Evaluator, args: Args, _: Options, node: AST, f: Frame) -> Value:
    if isinstance(args[0], (Reference, FunctionValue, ObjectValue)):
        return ObjectValue(args[0], args[0])
    raise ev.refusal(node, "id of an array or a number is not supported in a kernel")


@function("sys.exit", "builtins.exit", "builtins.quit", "os._exit")
def _exit(ev: Evaluator, args: Args, _: Options, node: AST, f: Frame) -> Value:
    text = [tree.const(args[0].known)] if args and isinstance(args[0], Data) and isinstance(args[0].known, str) else []
    if not ev.is_sure():
        ev.raises("builtins.RuntimeError", text, node)
    raise ev.refusal(node, "the kernel ends here whenever it runs")


@function("builtins.sum")
def _sum(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Value | None:
    if isinstance(args[0], Data) and args[0].count is None or isinstance(
            args[0], Iteration) and args[0].kind == "range":
        return None
    start = [*args[1:], *options.values()]
    before = ev.snapshot()
    try:
        items = ev.items_of(args[0], node, f)
    except Unevaluated:
        if not isinstance(args[0], Iteration) or args[0].kind != "generator":
            raise
        ev.restore(before)
        return ev.total_of(args[0], start[0] if start else constant(0), node)
    if items and all(isinstance(v, Data) and not v.is_list for v in (*items, *start)) and not all(
            isinstance(v, Data) and v.is_known for v in (*items, *start)):
        for v in (*items, *start):
            ev.refuse_no_number(v, node)
        function = tree.at(tree.name(ev.library("builtins.sum")), node)
        made = ev.residual_call(function, [TupleValue(tuple(items)), *start], {}, node)
        return replace(made, shape=broadcast(*items, *start), origins=origins(*items, *start))
    total = start[0] if start else constant(0)
    for item in items:
        total = ev.binary(tree.Add(), total, item, node, f)
    return total


@function("builtins.any", "builtins.all")
def _any(ev: Evaluator, args: Args, _: Options, node: Any, f: Frame) -> Value | None:
    """Items are asked one after the other, until one decides."""
    if isinstance(args[0], Data):
        return None
    stops = ev.called == "any"
    before = ev.snapshot()
    try:
        tests = ev.tests_of(args[0], stops, node, f)
    except Unevaluated:
        if not isinstance(args[0], Iteration):
            raise
        tests = None
    if tests is None:
        ev.restore(before)
        end = tree.Return(tree.const(not stops))
        return ev.first_item(args[0], node, f, lambda item: tree.If(
            item if stops else tree.UnaryOp(tree.Not(), item), [tree.Return(tree.const(stops))], []), end)
    left = [ev.spelled(t, node) for t in tests if isinstance(t, Data)]
    if stops in tests or not left:
        return constant(stops if stops in tests else not stops)
    op = tree.Or() if stops else tree.And()
    return Data(tree.at(left[0] if len(left) == 1 else tree.BoolOp(op, left), node))
