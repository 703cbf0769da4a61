"""Functions and classes that are defined in what is evaluated; imports, del.
"""
from __future__ import annotations

from dataclasses import replace
from typing import Any

from s2sad import tree
from s2sad.evaluate.specialize.evaluator import Evaluator, Frame, operation, statement
from s2sad.evaluate.specialize.frames import local_names
from s2sad.evaluate.specialize.heap import Object
from s2sad.evaluate.specialize.values import ClassValue, FunctionValue, LibraryValue, Reference, Value
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
    if s.decorator_list or s.keywords:
        raise ev.refusal(s, "a class with decorators or keywords inside a kernel", help="define it outside")
    bases = [ev.value(b, f) for b in s.bases]
    bases = [b for b in bases if not (isinstance(b, LibraryValue) and b.path == "builtins.object")]
    if not all(isinstance(b, ClassValue) for b in bases):
        raise ev.refusal(s, f"a base of '{s.name}' is no class of the user's")
    reference = ev.heap.new(Object("class", {}, label=s.name))
    made = ClassValue(s.name, None, reference.number, tuple(bases))  # pyright: ignore
    body = replace(f, reference=reference, outer=f, owner=made, local=local_names(s.body)[0], is_entry=False)
    for part in s.body:
        if isinstance(part, tree.FunctionDef):
            value: Value = defined(ev, part, f, made)
            for decorator in reversed(part.decorator_list):
                value = _decorated(ev, value, decorator, body)
            ev.heap.put(reference, part.name, value)
        else:
            ev.statements([part], body)
    ev.bind(f, s.name, made, s)


def _decorated(ev: Evaluator, value: Value, decorator: AST, f: Frame) -> Value:
    """A function of a class as property, staticmethod or classmethod make it."""
    meant = ev.value(decorator, f)
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
                listed = list(held.items.values())
                del listed[ev.known_place(place, target)]
                ev.heap.set_items(base, dict(enumerate(listed)))
        else:
            raise ev.refusal(s, "an attribute is deleted", help="assign None to it")
