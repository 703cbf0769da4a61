"""Functions and classes that are defined in what is evaluated; imports, del.
"""
from __future__ import annotations

from dataclasses import replace
from typing import Any

from s2sad import tree
from s2sad.evaluate.specialize.classes.class_layout import ENUMERATIONS
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator, operation, statement
from s2sad.evaluate.specialize.frames import local_names
from s2sad.evaluate.specialize.heap import Object
from s2sad.evaluate.specialize.subscripts import attribute_name
from s2sad.evaluate.specialize.values import (
    ClassValue, Data, FunctionValue, LibraryValue, MethodValue, Reference, SliceValue, Value,
)
from s2sad.read.outside_values import Captured, Namespace, Unusable
from s2sad.tree import AST


# -- functions of the user's -----------------------------------------------------------------------------------------
@operation
def defined(ev: Evaluator, node: Any, f: Frame, owner: ClassValue | None = None) -> FunctionValue:
    """A function that is defined in what is evaluated: its defaults are evaluated now."""
    args = node.args
    positional = [*args.posonlyargs, *args.args]
    pairs = [*zip(positional[len(positional) - len(args.defaults):], args.defaults),
             *((a, d) for a, d in zip(args.kwonlyargs, args.kw_defaults) if d is not None)]
    defaults = tuple((a.id, ev.atoms(ev.value(d, f), a.id, d)) for a, d in pairs)
    name = getattr(node, "name", "function")
    captured = Captured(name, node, f.captured.source, f.captured.scope, f.captured.default)
    ev.frames[f.reference.number] = f
    ev.held.append(node)
    key = ("defined", id(node), f.reference.number, len(ev.held))
    return FunctionValue(captured, key, f.reference.number, owner, defaults=defaults)


@statement("FunctionDef")
def function_definition(ev: Evaluator, s: Any, f: Frame) -> None:
    value: Value = defined(ev, s, f)
    for decorator in reversed(s.decorator_list):
        value = ev.call(ev.value(decorator, f), [value], {}, decorator, f)
    ev.bind(f, s.name, value, s)


@statement("ClassDef")
def class_definition(ev: Evaluator, s: Any, f: Frame) -> None:
    ev.bind(f, s.name, class_of_definition(ev, s, f), s)


def class_of_definition(ev: Evaluator, s: Any, f: Frame) -> Value:
    """The class that a definition makes: its body is evaluated in a namespace, then the decorators are called."""
    bases = [ev.value(b, f) for b in s.bases]
    kinds = {b.path for b in bases if isinstance(b, LibraryValue)} - _NO_BASES
    own = [b for b in bases if isinstance(b, ClassValue)]
    is_abstract = all(k.arg == "metaclass" and _path(ev.value(k.value, f)) == "abc.ABCMeta" for k in s.keywords)
    if len(kinds) > 1 or kinds - {*ENUMERATIONS, "typing.NamedTuple"} or kinds and own or not is_abstract or len(
            own) + sum(isinstance(b, LibraryValue) for b in bases) < len(bases):
        raise ev.refusal(s, f"a base of '{s.name}' is no class of the user's" if is_abstract else
                         f"'{s.name}' is made by a class of its own")
    reference = ev.heap.new(Object("class", {}, label=s.name))
    made = ClassValue(s.name, None, reference.number, tuple(own))
    _namespace(ev, s, made, reference, f)
    if kinds == {"typing.NamedTuple"}:
        ev.lay_out(made, "named", {}, s)
    elif kinds:
        made = ev.enumeration(s.name, kinds.pop(), ev.heap[reference].items, s)
    found: Value = made
    for decorator in reversed(s.decorator_list):
        found = ev.call(ev.value(decorator, f), [found], {}, decorator, f)
    return found


_NO_BASES = {"builtins.object", "abc.ABC", "typing.Protocol", "typing.Generic"}


def _path(value: Value) -> str:
    return value.path if isinstance(value, LibraryValue) else ""


def _namespace(ev: Evaluator, s: Any, made: ClassValue, reference: Reference, f: Frame) -> None:
    """The names that a class's body binds, and its annotations."""
    body = replace(f, reference=reference, outer=f, owner=made, local=local_names(s.body)[0], is_entry=False)
    ev.annotated[made.number] = {p.target.id: p.annotation for p in s.body if isinstance(p, tree.AnnAssign)
                                 and isinstance(p.target, tree.Name)}
    for part in s.body:
        if isinstance(part, tree.FunctionDef):
            value: Value = defined(ev, part, f, made)
            for decorator in reversed(part.decorator_list):
                value = _decorated(ev, value, decorator, body)
            ev.heap.put(reference, part.name, value)
        elif isinstance(part, tree.Expr) and isinstance(part.value, tree.Constant):
            continue        # its documentation
        else:
            ev.statements([part], body)
    ev.heap.set_items(reference, {attribute_name(str(k), body): v for k, v in ev.heap[reference].items.items()})


def _decorated(ev: Evaluator, value: Value, decorator: AST, f: Frame) -> Value:
    """A function of a class as property, staticmethod or classmethod make it."""
    meant = ev.value(decorator, f)
    if isinstance(meant, LibraryValue) and meant.path == "builtins.property.setter":
        return LibraryValue("builtins.property", (meant.first[0], value))
    if isinstance(meant, LibraryValue) and meant.path in ("builtins.property", "builtins.staticmethod",
                                                          "builtins.classmethod", "functools.cached_property"):
        return LibraryValue(meant.path, (value,))
    return ev.call(meant, [value], {}, decorator, f)


@statement("Import", "ImportFrom")
def import_statement(ev: Evaluator, s: Any, f: Frame) -> None:
    for n in s.names:
        if type(s).__name__ == "Import":
            name = n.asname or n.name.partition(".")[0]
            meaning = f.captured.scope.imported(n.name if n.asname else name, 0, None)
        else:
            name = n.asname or n.name
            meaning = f.captured.scope.imported(s.module or "", s.level or 0, n.name)
            if isinstance(meaning, (Namespace, Unusable)) and not meaning.what.startswith("imported"):
                module = f.captured.scope.imported(s.module or "", s.level or 0, None)
                whole = ev.meaning_value(s.module or ".", module, s, f)
                ev.heap.put(f.reference, name, ev.attribute_of(whole, n.name, s, f))
                continue
        ev.heap.put(f.reference, name, ev.meaning_value(name, meaning, s, f))


@statement("Delete")
def delete(ev: Evaluator, s: Any, f: Frame) -> None:
    for target in s.targets:
        if isinstance(target, tree.Name):
            items = dict(ev.heap[f.reference].items)
            items.pop(target.id, None)
            ev.heap.set_items(f.reference, items)
        elif isinstance(target, tree.Subscript):
            base, place = ev.values([target.value, target.slice], f)
            if isinstance(base, Data) and base.is_list and not isinstance(place, SliceValue):
                ev.call(MethodValue(base, "pop"), [place], {}, target, f)
                continue
            if not isinstance(base, Reference) or ev.heap[base].kind not in ("list", "dict"):
                raise ev.refusal(s, "del of this is not supported in a kernel")
            held = ev.change(base, target)
            if held.kind == "dict":
                items, key = dict(held.items), ev.key_of(place, target)
                if key not in items:
                    raise ev.refusal(s, f"the dict has no key {key!r}")
                del items[key]
                ev.heap.set_items(base, items)
            else:
                listed, k = list(held.items.values()), ev.known_place(place, target)
                if isinstance(k, int) and not -len(listed) <= k < len(listed):
                    raise ev.no_item(f"{ev.subject(base, target)} has {len(listed)} items, and no item {k}", target)
                del listed[k]
                ev.heap.set_items(base, dict(enumerate(listed)))
        else:
            raise ev.refusal(s, "an attribute is deleted", help="assign None to it")
