"""Functions of Python's that ask an object: of its class, its attributes, its fields, its next item.
"""
from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

from s2sad import tree
from s2sad.evaluate.specialize.classes.class_layout import ClassField, Layout, always
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator, operation
from s2sad.evaluate.specialize.functions.library_calls import FUNCTIONS, Args, Known, Options, function
from s2sad.evaluate.specialize.functions.standard_library import copied
from s2sad.evaluate.specialize.heap import Object
from s2sad.evaluate.specialize.sequences.endless import ENDLESS
from s2sad.evaluate.specialize.sequences.iterator_use import BEGUN, DEFAULT, STARTED
from s2sad.evaluate.specialize.values import (
    FACTORY, NONE, ClassValue, Conflict, Data, Iteration, LibraryValue, ObjectValue, Reference, OpaqueValue,
    SliceValue, TupleValue, Value, constant, demands_of,
)
from s2sad.tree import AST


# -- methods by Python's names for them --------------------------------------------------------------------------------
_ZEROS = {"__float__": 0.0, "__int__": 0}      # what they give without an argument


def _by_method(name: str, known: Known | None) -> Known:
    def called(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Value | None:
        method = ev.special_method(args[0], name, node, f) if args else None
        if method is not None:
            return ev.call(method, args[1:], options, node, f)
        if not args and name in _ZEROS:
            return constant(_ZEROS[name])
        return None if known is None else known(ev, args, options, node, f)
    return called


for _name in ("abs", "float", "int", "round", "complex"):
    FUNCTIONS[f"builtins.{_name}"] = _by_method(f"__{_name}__", FUNCTIONS.get(f"builtins.{_name}"))


@function("builtins.bool")
def _bool(ev: Evaluator, args: Args, _: Options, node: AST, f: Frame) -> Value | None:
    if not args or isinstance(args[0], Data):
        return None
    found = ev.truth(args[0], node, f)
    return found if isinstance(found, Data) else constant(found)


@function("builtins.str", "builtins.repr", "builtins.format")
def _text(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Value | None:
    for name in ("__str__", "__repr__") if ev.called == "str" else (f"__{ev.called}__",):
        method = ev.special_method(args[0], name, node, f) if args else None
        if method is not None:
            return ev.call(method, args[1:], options, node, f)
    known = all(isinstance(a, Data) and a.is_known for a in args)
    return None if known else OpaqueValue(demands=demands_of(*args))


# -- attributes and fields ---------------------------------------------------------------------------------------------
@function("builtins.vars")
def _vars(ev: Evaluator, args: Args, _: Options, node: AST, f: Frame) -> Value:
    return ev.attribute_dictionary(args[0] if args else NONE, node)


def _fields(ev: Evaluator, value: Value, node: AST, f: Frame) -> dict[str, Value]:
    layout = ev.layout_of(ev.class_of(value))
    if layout is None or layout.kind != "dataclass":
        raise ev.refusal(node, f"{ev.kind_of(value)} is no object of a dataclass")
    return {d.name: ev.attribute_of(value, d.name, node, f) for d in layout.fields}


@function("dataclasses.replace")
def _replace(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Value:
    made = ev.class_of(args[0])
    held = _fields(ev, args[0], node, f)
    assert made is not None
    init = {d.name for d in ev.layout_of(made).fields if d.is_given}
    return ev.constructed(made, [], {**{k: v for k, v in held.items() if k in init}, **options}, node, f)


@function("dataclasses.asdict", "dataclasses.astuple")
def _asdict(ev: Evaluator, args: Args, _: Options, node: AST, f: Frame) -> Value:
    return _unbuilt(ev, args[0], ev.called == "asdict", node, f)


def _unbuilt(ev: Evaluator, value: Value, by_name: bool, node: AST, f: Frame) -> Value:
    """Objects of dataclasses as dicts of their fields, or tuples, at any depth; all else is copied, arrays, too."""
    layout = ev.layout_of(ev.class_of(value)) if isinstance(value, Reference) else None
    if layout is not None and layout.kind == "dataclass":
        held = {k: _unbuilt(ev, v, by_name, node, f) for k, v in _fields(ev, value, node, f).items()}
        return ev.new_dict(held, node) if by_name else TupleValue(tuple(held.values()))
    if isinstance(value, Reference) and ev.heap[value].kind in ("list", "dict") and ev.heap[value].most is None:
        items = {k: v if k is FACTORY else _unbuilt(ev, v, by_name, node, f) for k, v in ev.heap[value].items.items()}
        return ev.list_of(list(items.values()), node) if ev.heap[value].kind == "list" else ev.new_dict(items, node)
    if isinstance(value, TupleValue):
        return replace(value, items=tuple(_unbuilt(ev, v, by_name, node, f) for v in value.items))
    return copied(ev, value, True, node, {})


@function("dataclasses.fields")
def _names(ev: Evaluator, args: Args, _: Options, node: AST, f: Frame) -> Value:
    made = args[0] if not isinstance(args[0], (Reference, TupleValue)) else ev.class_of(args[0])
    layout = ev.layout_of(made) if isinstance(made, ClassValue) else None
    if layout is None or layout.kind != "dataclass":
        raise ev.refusal(node, "fields of what is no dataclass")
    return TupleValue(tuple(ObjectValue(SimpleNamespace(name=n), ("field", n)) for n in layout.names))


@function("dataclasses.dataclass")
def _dataclass(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Value:
    if not args:
        return LibraryValue("dataclasses.dataclass", (), tuple(options.items()))
    if not isinstance(args[0], ClassValue) or args[0].live is not None:
        raise ev.refusal(node, f"{ev.kind_of(args[0])} is made a dataclass")
    ev.lay_out(args[0], "dataclass", options, node)
    return args[0]


@function("dataclasses.field")
def _field(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Value:
    return LibraryValue("dataclasses.field", (), tuple((k, ev.atoms(v, k, node)) for k, v in options.items()))


@function("collections.namedtuple")
def _named_tuple(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Value:
    title = ev.known(args[0], node, "the name of a named tuple")
    said = ev.known(args[1], node, "the fields of a named tuple") if isinstance(args[1], Data) else [
        ev.known(i, node, "the fields of a named tuple") for i in ev.items_of(args[1], node, f)]
    names = said.replace(",", " ").split() if isinstance(said, str) else said
    defaults = ev.items_of(options.pop("defaults"), node, f) if "defaults" in options else []
    if options or args[2:]:
        raise ev.refusal(node, "a named tuple with options", help="write it as a class")
    made = ClassValue(title, None, ev.heap.new(Object("class", {}, label=title)).number)
    given = dict(zip(reversed(names), reversed(defaults)))
    ev.layouts[made.number] = Layout("named", tuple(
        ClassField(n, always(given[n]) if n in given else None) for n in names))
    return made


@function("enum.auto")
def _auto(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Value:
    return LibraryValue("enum.auto")


@function("builtins.dict.fromkeys")
def _from_keys(ev: Evaluator, args: Args, _: Options, node: AST, f: Frame) -> Value:
    value = ev.atoms(args[1], "value", node) if args[1:] else NONE
    return ev.new_dict({ev.key_of(k, node): value for k in ev.items_of(args[0], node, f)}, node)


# -- iterators ---------------------------------------------------------------------------------------------------------
@function("builtins.iter")
def _iter(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Value:
    base = args[0]
    if f.label == "__iter__" and isinstance(base, (Reference, TupleValue)) or ev.is_iterator(base):
        return base      # what asks for it goes through it once
    own = ev.special_method(base, "__iter__", node, f)
    if own is not None:
        through = ev.call(own, [], {}, node, f)
        if through != base:
            return ev.library_call("builtins.iter", [through], options, node, f)
    if not isinstance(base, Data) and not ev.is_read_in_place(base):
        base = TupleValue(tuple(ev.atoms(i, "item", node) for i in ev.items_of(base, node, f)))
    return ev.heap.new(Object("iterator", {"base": ev.atoms(base, "items", node), "k": constant(0)}, site=node))


@operation
def rest_of(ev: Evaluator, iterator: Reference, node: AST, f: Frame) -> Value:
    """What an iterator has not given yet, to something that goes through it; nothing else may ask it from then on."""
    base, k = _position(ev, iterator, node)
    ev.heap.put(iterator, "base", Conflict("an iterator that something has gone through"))
    if not k or isinstance(base, TupleValue):
        return TupleValue(base.items[k:]) if isinstance(base, TupleValue) else base
    return ev.item_of(base, SliceValue((constant(k), NONE, NONE)), node, f) if isinstance(base, Data) else Iteration(
        "behind", (base, constant(k)))


def _position(ev: Evaluator, iterator: Reference, node: AST) -> tuple[Value, int]:
    """What an iterator goes through, and how many items it has given."""
    held = ev.heap[iterator]
    if isinstance(held.items["base"], Conflict):
        raise ev.refusal(node, "an iterator is asked that something has gone through", help="make it a list: list(...)")
    return held.items["base"], ev.known(held.items["k"], node, "how many items were taken")


def _first(ev: Evaluator, args: Args, node: AST, f: Frame) -> Value:
    """The first item of a generator, with which nothing else goes on."""
    end = tree.Return(tree.name(DEFAULT)) if args[1:] else tree.Raise(tree.name("StopIteration"), None)
    found = ev.first_item(args[0], node, f, tree.Return, end, *[ev.atoms(a, "item", node) for a in args[1:]])
    if isinstance(args[0], Iteration) and args[0].once is not None:
        ev.heap.put(args[0].once, STARTED, constant(BEGUN))
    return found


@function("builtins.next")
def _next(ev: Evaluator, args: Args, _: Options, node: AST, f: Frame) -> Value:
    if isinstance(args[0], Iteration) and args[0].kind in ENDLESS:
        return ev.next_endless(args[0], node, f)
    held = ev.heap[args[0]] if isinstance(args[0], Reference) else None
    if held is None or held.kind != "iterator":
        return _first(ev, args, node, f)
    base, k = _position(ev, args[0], node)  # pyright: ignore[reportArgumentType]
    if args[1:] and isinstance(base, Data):
        raise ev.refusal(node, "next() with a default, of an array", help="test its length")
    found = [ev.item_of(base, constant(k), node, f)] if isinstance(base, Data) else ev.item_behind(base, k, node, f)
    if not found and args[1:]:
        return args[1]
    if not found:
        raise ev.refusal(node, "next() behind the last item")
    ev.heap.put(args[0], "k", constant(k + 1))  # pyright: ignore[reportArgumentType]
    return found[0]


# -- what is said on the way, which no derivative says -----------------------------------------------------------------
@function("builtins.print", "warnings.warn", *(f"logging.{n}" for n in (
    "debug", "info", "warning", "warn", "error", "critical", "log", "exception")))
def _silent(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Value:
    return NONE


@function(*(f"time.{n}" for n in ("time", "perf_counter", "process_time", "monotonic", "perf_counter_ns", "time_ns")))
def _clock(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Value:
    return OpaqueValue("a time of the clock")


@function("time.sleep")
def _sleep(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Value:
    return NONE


@function("contextlib.contextmanager")
def _context_manager(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Value:
    return LibraryValue("contextlib.entered", tuple(args))


@function("contextlib.entered")
def _entered(ev: Evaluator, args: Args, options: Options, node: AST, f: Frame) -> Value:
    return ev.call(args[0], args[1:], options, node, f)


@function("logging.getLogger")
def _logger(ev: Evaluator, args: Args, _: Options, node: AST, f: Frame) -> Value:
    return LibraryValue("logging")
