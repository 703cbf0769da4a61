"""What decorators and bases of Python's library make of classes: dataclasses, named tuples, enumerations.

A live class has been made so already; one that is defined in what is evaluated is made so here.
"""
from __future__ import annotations

import dataclasses
import enum
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from s2sad import tree
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator, operation
from s2sad.evaluate.specialize.values import (
    ClassValue, Data, FunctionValue, LibraryValue, Reference, Value,
)
from s2sad.live_objects.guards import taken
from s2sad.pytree import named_defaults
from s2sad.tree import AST

Default = Callable[[AST, Frame], Value]
ENUMERATIONS = {f"enum.{k.__name__}": k for k in (enum.Enum, enum.IntEnum)}
_NO_FIELDS = ("ClassVar", "InitVar", "KW_ONLY")


@dataclass(frozen=True)
class ClassField:
    """A field of a dataclass or a named tuple; `default` gives what an object has that is not given it."""
    name: str
    default: Default | None = None
    is_given: bool = True           # when an object is made
    by_name: bool = False           # and by name only
    is_compared: bool = True


@dataclass(frozen=True)
class Layout:
    """What a class is: "dataclass" or "named"; objects of equal fields are equal, none is assigned if `is_frozen`."""
    kind: str
    fields: tuple[ClassField, ...]
    is_equal: bool = True
    is_frozen: bool = False

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(d.name for d in self.fields)


@operation
def layout_of(ev: Evaluator, made: ClassValue | None) -> Layout | None:
    """The layout that a class has, of its own or from a base; None for a plain class."""
    for c in ev.mro(made) if made is not None else ():
        if c.number in ev.layouts:
            return ev.layouts[c.number]
        if c.live is not None and issubclass(c.live, tuple) and hasattr(c.live, "_fields"):
            return _named(ev, c.live)
        if c.live is not None and dataclasses.is_dataclass(c.live):
            return _dataclass(ev, c.live)
    return None


@operation
def declares_layout(ev: Evaluator, made: ClassValue) -> bool:
    """Whether a class is a dataclass itself, and not by a base."""
    return made.number in ev.layouts or made.live is not None and "__dataclass_params__" in vars(made.live)


def _named(ev: Evaluator, live: Any) -> Layout:
    defaults = named_defaults(live)
    return Layout("named", tuple(ClassField(k, _outside(ev, k, defaults[k]) if k in defaults else None)
                                 for k in taken(live, "attribute", "_fields")))


def _dataclass(ev: Evaluator, live: Any) -> Layout:
    found = []
    for name in taken(live, "fields"):
        value, factory, is_given, by_name, is_compared = taken(live, "field", name)
        default = None if value is dataclasses.MISSING else _outside(ev, name, value)
        if default is None and factory is not dataclasses.MISSING:
            default = _made_by(ev, _outside(ev, name, factory))
        found.append(ClassField(name, default, is_given, by_name, is_compared))
    params = taken(live, "attribute", "__dataclass_params__")
    return Layout("dataclass", tuple(found), taken(params, "attribute", "eq"), taken(params, "attribute", "frozen"))


def _outside(ev: Evaluator, name: str, value: Any) -> Default:
    return lambda node, f: ev.outside_value(name, value, node, f)


def _made_by(ev: Evaluator, factory: Default) -> Default:
    return lambda node, f: ev.call(factory(node, f), [], {}, node, f)


# -- classes that are defined in what is evaluated ---------------------------------------------------------------------
@operation
def lay_out(ev: Evaluator, made: ClassValue, kind: str, options: Mapping[str, Value], node: AST) -> None:
    """Makes a class that was just defined a dataclass or a named tuple, by the annotations in its body."""
    known = {k: ev.known(v, node, f"{k}=") for k, v in options.items()}
    if unknown := {*known} - {"eq", "frozen", "kw_only", "slots", "repr", "init", "order", "match_args", "unsafe_hash"}:
        raise ev.refusal(node, f"a {kind} with {', '.join(sorted(unknown))}=")
    if known.get("init") is False or known.get("order"):
        raise ev.refusal(node, "a dataclass with init=False or order=True", help="write its methods out")
    found: dict[str, ClassField] = {}
    for c in reversed(ev.mro(made)[1:]):
        inherited = ev.layout_of(c)
        found |= {d.name: d for d in inherited.fields} if inherited is not None and kind == "dataclass" else {}
    for name, annotation in ev.annotated.get(made.number, {}).items():
        said = " ".join(n.id if isinstance(n, tree.Name) else n.attr if isinstance(n, tree.Attribute) else str(
            getattr(n, "value", "")) for n in tree.walk(annotation))
        if any(word in said for word in _NO_FIELDS):
            if "ClassVar" in said:
                continue
            raise ev.refusal(annotation, "a field that is given and not kept, or a mark between fields")
        found[name] = _field(ev, made, name, bool(known.get("kw_only")), annotation)
    ev.layouts[made.number] = Layout(kind, tuple(found.values()), known.get("eq", True), known.get("frozen", False))


def _field(ev: Evaluator, made: ClassValue, name: str, by_name: bool, node: AST) -> ClassField:
    """A field by what the class's body assigns it: a default, or `field(...)`."""
    items = dict(ev.heap.objects[made.number].items)
    value = items.get(name)
    if not isinstance(value, LibraryValue) or value.path != "dataclasses.field":
        return ClassField(name, None if value is None else always(value), by_name=by_name)
    options = dict(value.keywords)
    del items[name]
    if "default" in options:
        items[name] = options["default"]
    ev.heap.set_items(Reference(made.number), items)

    def flag(word: str, usual: bool) -> bool:
        return usual if word not in options else bool(ev.known(options[word], node, f"{word}="))
    default = always(options["default"]) if "default" in options else _made_by(
        ev, always(options["default_factory"])) if "default_factory" in options else None
    return ClassField(name, default, flag("init", True), flag("kw_only", by_name), flag("compare", True))


def always(value: Value) -> Default:
    """The default that is one value."""
    return lambda node, f: value


@operation
def enumeration(ev: Evaluator, name: str, path: str, items: Mapping[Any, Value], node: AST) -> ClassValue:
    """An enumeration of members that are known: a class of Python's own."""
    members: dict[str, Any] = {}
    for k, v in items.items():
        if isinstance(v, (FunctionValue, LibraryValue)) and not (isinstance(v, LibraryValue) and v.path == "enum.auto"):
            raise ev.refusal(node, f"the enumeration '{name}' has methods, and is not run",
                             help="write them as functions of the member")
        if isinstance(v, Data) or not isinstance(v, LibraryValue):
            if not str(k).startswith("__"):
                members[str(k)] = ev.known(v, node, "the value of a member of an enumeration")
        else:
            members[str(k)] = enum.auto()
    live = ENUMERATIONS[path](name, members)  # pyright: ignore
    ev.held.append(live)
    return ClassValue(name, live)
