"""What names of files mean that are read and not run: classes, functions and constants, evaluated when they are named.
"""
from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import Any

import numpy

from s2sad import tree
from s2sad.diagnostics import S2sadError
from s2sad.evaluate.specialize.classes.class_attributes import AssignedAttribute
from s2sad.evaluate.specialize.classes.class_layout import ClassField
from s2sad.evaluate.specialize.definitions import class_of_definition
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator, operation
from s2sad.evaluate.specialize.signals import Leave, Reached, Unbound, Unevaluated
from s2sad.evaluate.specialize.heap import Object
from s2sad.evaluate.specialize.live_values import load, placed
from s2sad.evaluate.specialize.values import (
    ClassValue, Data, FunctionValue, LibraryValue, ObjectValue, Reference, ScopeValue, TupleValue, Value,
    constant,
)
from s2sad.read.file_definitions import FileClass, FileFunction
from s2sad.read.file_module import FileModule, PackageScope
from s2sad.read.outside_values import (
    Captured, Library, Meaning, NotConstant, Number, StringValue, UserFunctionValue, library_value,
)
from s2sad.tree import AST


@dataclass(frozen=True)
class Origin:
    """Where something of a file is defined: by a class, a function or an expression."""
    module: FileModule
    name: str
    node: AST


@operation
def scope_value(ev: Evaluator, scope: Any, name: str, node: AST, f: Frame) -> Value:
    """What a module, or the names around a function, has under a name."""
    meaning = scope.lookup(name)
    if meaning is None:
        raise ev.refusal(node, f"'{name}' is not defined", code="S202")
    module = scope.module if isinstance(scope, PackageScope) else scope
    if ev.evaluates_module and isinstance(module, FileModule) and name in module.often:
        raise ev.outside_error(node, f"'{name}' is set more than once, and the file is read without being run",
                               "give the second value another name")
    if not isinstance(module, FileModule) or isinstance(meaning, (Library, Number, StringValue)):
        return ev.meaning_value(name, meaning, node, f)
    found = scope.origin(name)
    if found is None or isinstance(meaning, UserFunctionValue) and not meaning.handle.decorators:
        return ev.meaning_value(name, meaning, node, f)
    return file_value(ev, Origin(*found), meaning, node, f)


@operation
def file_function(ev: Evaluator, handle: FileFunction) -> FunctionValue:
    """A function of a file, as its definition says."""
    key = ("file", handle.module.path, handle.definition.lineno)
    return FunctionValue(load(ev, handle), key, None, None, handle=handle)


@operation
def file_class(ev: Evaluator, made: FileClass, node: AST, f: Frame) -> Value:
    """A class of a file."""
    scope = made.module
    return file_value(ev, Origin(scope, made.name, made.definition), scope.meanings[made.name], node, f)  # pyright: ignore


def file_value(ev: Evaluator, origin: Origin, meaning: Meaning, node: AST, f: Frame) -> Value:
    """What a class, a decorated function or an expression of a file is, evaluated once."""
    key = (origin.module.path, origin.name)
    if key in ev.of_files:
        found = ev.of_files[key]
        if found is None:
            raise ev.refusal(node, f"'{origin.name}' is made of itself")
        return found
    if ev.guarded:
        raise Reached(origin.name, _Met(origin, meaning), ev.owning)
    ev.of_files[key] = None
    found = ev.of_files[key] = _evaluated(ev, origin, meaning, node)
    if isinstance(found, (Reference, TupleValue)):
        for use in origin.module.uses(origin.name):
            _unchanged(ev, origin, use, node)
    return found


@dataclass(frozen=True)
class _Met:
    """Something of a file that is evaluated in advance."""
    origin: Origin
    meaning: Meaning


@operation
def met_in_advance(ev: Evaluator, value: Any, node: AST, f: Frame) -> Value | None:
    """What was met in a branch or a loop, evaluated before; None for a live value."""
    if isinstance(value, AssignedAttribute):
        return ev.class_attribute_begins(value, node, f)
    if isinstance(value, _MetDefault):
        return file_default(ev, value.function, value.name, node)
    return file_value(ev, value.origin, value.meaning, node, f) if isinstance(value, _Met) else None


def _evaluated(ev: Evaluator, origin: Origin, meaning: Meaning, node: AST) -> Value:
    def value(frame: Frame) -> Value:
        definition = placed(ev, origin.module.source, origin.node)
        if isinstance(definition, tree.FunctionDef):
            handle = origin.module.lookup(origin.name).handle  # pyright: ignore
            found: Value = file_function(ev, handle)
            for decorator in [placed(ev, origin.module.source, d) for d in reversed(handle.decorators)]:
                found = ev.call(ev.value(decorator, frame), [found], {}, decorator, frame)
            return _from_outside(ev, found, origin.name, node, frame, set())
        if type(definition).__name__ == "ClassDef":
            return _from_outside(ev, class_of_definition(ev, definition, frame), origin.name, node, frame, set())
        return _from_outside(ev, ev.value(definition, frame), origin.name, node, frame, set())
    return _apart(ev, origin, meaning, node, value)


def _apart(ev: Evaluator, origin: Origin, meaning: Meaning, node: AST, value: Callable[[Frame], Value]) -> Value:
    """What is evaluated in a file's module, where nothing is left for the run."""
    before = {*ev.heap.objects}
    what = getattr(meaning, "what", "not constant arithmetic, and the file is read without being run")
    unknown = ev.outside_error(node, f"'{origin.name}' is {what}", getattr(meaning, "help", ""))
    with _at_module_level(ev):
        try:
            found = value(module_frame(ev, origin.module))
        except NotConstant:
            raise unknown from None
        if ev.block:
            raise unknown
    ev.outset |= {n: o for n, o in ev.heap.objects.items() if n not in before}
    return found


@contextmanager
def _at_module_level(ev: Evaluator) -> Iterator[None]:
    """Nothing of the kernel's evaluation is seen or changed inside."""
    kept = (ev.block, ev.pending, ev.loops, ev.owning, ev.label, ev.evaluates_module, ev.depth, ev.effects,
            ev.rebound, ev.guarded)
    ev.block, ev.pending, ev.loops, ev.owning, ev.label, ev.evaluates_module = [], [], [], False, "", True
    ev.rebound, ev.guarded = [], ()
    try:
        yield
    finally:
        (ev.block, ev.pending, ev.loops, ev.owning, ev.label, ev.evaluates_module, ev.depth, ev.effects,
         ev.rebound, ev.guarded) = kept


def _unchanged(ev: Evaluator, origin: Origin, use: Any, node: AST) -> None:
    """Refuses what a call at module level may change."""
    use = placed(ev, origin.module.source, use)
    before = ev.snapshot()
    try:
        with _at_module_level(ev):
            frame = module_frame(ev, origin.module)
            args, keywords = [_argument(ev, a, frame) for a in use.args], {
                k.arg: _argument(ev, k.value, frame) for k in use.keywords}
            ev.call(ev.value(use.func, frame), args, keywords, use, frame)
    except (S2sadError, Unevaluated, Unbound, Leave):
        raise ev.outside_error(node, f"'{origin.name}' is given to a function at module level, which may change it",
                               "pass it to the kernel as an argument") from None
    finally:
        ev.restore(before)


def _argument(ev: Evaluator, node: Any, f: Frame) -> Value:
    """An argument of a call at module level, of which nothing may be known."""
    try:
        return ev.value(node, f)
    except (S2sadError, Unevaluated):
        if any(isinstance(n, tree.Name) and ev.of_files.get((f.captured.source.path, n.id)) is not None
               for n in tree.walk(node)):
            raise
        return Data(tree.at(tree.name(ev.fresh("given")), node))


def module_frame(ev: Evaluator, module: FileModule) -> Frame:
    """The frame of a file's module: its names are looked up in the file."""
    captured = Captured(module.name, module.tree, module.source, module, _no_default)
    if module.path not in ev.modules:
        reference = ev.heap.new(Object("frame", {}))
        ev.outset[reference.number] = ev.heap[reference]
        ev.modules[module.path] = Frame(reference, captured, None, None, False, 0, 0)
        ev.frames[reference.number] = ev.modules[module.path]
    return ev.modules[module.path]


def _no_default(parameter: str, node: AST) -> Any:
    raise KeyError(parameter)


@operation
def file_default(ev: Evaluator, function: FunctionValue, name: str, node: AST) -> Value | None:
    """The default of a parameter of a file's function."""
    args, handle = function.captured.tree.args, function.handle
    positional = [*args.posonlyargs, *args.args]
    pairs = [*zip(positional[len(positional) - len(args.defaults):], args.defaults), *zip(args.kwonlyargs,
                                                                                         args.kw_defaults)]
    found = next((d for a, d in pairs if a.id == name and d is not None), None)
    if found is None:
        return None
    key = (handle.module.path, handle.definition.lineno, name)
    if isinstance(found, tree.Constant):
        f = ev.entry or module_frame(ev, handle.module)
        return _default_outside(ev, constant(found.value), name, node, f, set())
    if key not in ev.of_files:
        origin = Origin(handle.module, name, found)
        if ev.guarded:
            raise Reached(name, _MetDefault(function, name), ev.owning)
        ev.of_files[key] = _apart(ev, origin, Number(name, None), node, lambda frame: _default_outside(
            ev, ev.value(found, frame), name, node, frame, set()))
    return ev.of_files[key]


@dataclass(frozen=True)
class _MetDefault:
    function: FunctionValue
    name: str


# -- arrays of constants ----------------------------------------------------------------------------------------------
_ARRAYS = ("array", "asarray", "zeros", "ones", "full", "arange", "linspace", "eye", "identity")
_LARGEST = 1_000_000        # elements


@operation
def constant_array(ev: Evaluator, path: str, args: Sequence[Value], keywords: Mapping[str, Value]) -> Value | None:
    """An array that a constructor of NumPy's makes of constants; None for anything else."""
    if path.removeprefix("numpy.") not in _ARRAYS:
        return None
    try:
        plain = [_plain(ev, a) for a in args]
        named = {k: _plain(ev, v) for k, v in keywords.items()}
        if max([n for v in (*plain[:3], *named.values()) for n in _integers(v)], default=0) > _LARGEST:
            return None
        made = getattr(numpy, path.removeprefix("numpy."))(*plain, **named)
    except (NotConstant, ValueError, TypeError, ArithmeticError):
        return None
    ev.held.append(made)
    return ObjectValue(made, ("array", id(made)))


def _plain(ev: Evaluator, value: Value) -> Any:
    """A constant, or a sequence of such, as it is; raises NotConstant."""
    if isinstance(value, Data) and value.is_known:
        return value.known
    if isinstance(value, TupleValue):
        return tuple(_plain(ev, v) for v in value.items)
    if isinstance(value, Reference) and ev.heap[value].kind == "list":
        return [_plain(ev, v) for v in ev.heap[value].items.values()]
    if isinstance(value, LibraryValue) and isinstance(library_value(value.path), type):
        return library_value(value.path)
    if isinstance(value, ObjectValue) and isinstance(value.value, numpy.ndarray):
        return value.value
    raise NotConstant


def _integers(value: Any) -> list[int]:
    """What may be a size, and the product of sizes."""
    items = [v for v in value if type(v) is int] if isinstance(value, tuple) else [value] if type(value) is int else []
    return [math.prod(items)]


# -- what is evaluated is from outside ---------------------------------------------------------------------------------
def _from_outside(ev: Evaluator, value: Value, name: str, node: AST, f: Frame, seen: set[int]) -> Value:
    """A value as it is when it comes from outside: numbers go by their names, what is mutable belongs to the module."""
    if isinstance(value, Data):
        if not value.is_known:
            raise NotConstant
        return ev.outside_value(name, value.known, node, f)
    if isinstance(value, TupleValue):
        names = ev.layout_of(value.made).names if value.made is not None else range(len(value.items))
        return replace(value, items=tuple(_from_outside(ev, v, f"{name}_{k}", node, f, seen) for k, v in zip(
            names, value.items)))
    if isinstance(value, FunctionValue):
        def named(pairs: Sequence[tuple[str, Value]], begin: str) -> tuple[tuple[str, Value], ...]:
            return tuple((k, _from_outside(ev, v, f"{begin}{k}", node, f, seen)) for k, v in pairs)
        _closure_outside(ev, value.frame, node, f, seen)
        first = tuple(v for _, v in named([(str(k), v) for k, v in enumerate(value.first)], f"{name}_"))
        defaults = tuple((k, _default_outside(ev, v, k, node, f, seen)) for k, v in value.defaults)
        return replace(value, defaults=defaults, first=first, keywords=named(value.keywords, f"{name}_"))
    if isinstance(value, LibraryValue):
        return replace(value, first=tuple(_from_outside(ev, v, name, node, f, seen) for v in value.first))
    if isinstance(value, ClassValue) and value.number:
        _held_outside(ev, Reference(value.number), value.name, node, f, seen)
        layout = ev.layouts.get(value.number)
        if layout is not None:
            ev.layouts[value.number] = replace(layout, fields=tuple(_field_outside(ev, d) for d in layout.fields))
    if isinstance(value, Reference):
        _held_outside(ev, value, name, node, f, seen)
    if isinstance(value, ObjectValue) and isinstance(value.value, numpy.ndarray):
        return ev.outside_value(name, value.value, node, f)
    if not isinstance(value, (Reference, ClassValue, ObjectValue, ScopeValue)):
        raise ev.outside_error(node, f"'{name}' is {ev.kind_of(value)}", "make it in the kernel")
    return value


def _default_outside(ev: Evaluator, value: Value, name: str, node: AST, f: Frame, seen: set[int]) -> Value:
    """A default of a function from outside: a number is a constant."""
    if isinstance(value, Data) and type(value.known) in (int, float, bool):
        return constant(value.known)
    return _from_outside(ev, value, name, node, f, seen)


def _closure_outside(ev: Evaluator, number: int | None, node: AST, f: Frame, seen: set[int]) -> None:
    """The frames that a function was defined in: what their names hold goes by these."""
    frame = ev.frames.get(number) if number is not None else None
    while frame is not None and frame not in ev.modules.values():
        _held_outside(ev, frame.reference, "", node, f, seen)
        frame = frame.outer


def _field_outside(ev: Evaluator, d: ClassField) -> ClassField:
    """A field whose default, a number, goes by the field's name."""
    inner = d.default

    def default(node: AST, f: Frame) -> Value:
        assert inner is not None
        found = inner(node, f)
        return _from_outside(ev, found, d.name, node, f, set()) if isinstance(found, Data) else found
    return d if inner is None else replace(d, default=default)


def _held_outside(ev: Evaluator, reference: Reference, name: str, node: AST, f: Frame, seen: set[int]) -> None:
    """An object of a module: what it holds is from outside, too, and it is not changed."""
    if reference.number in seen or not ev.heap[reference].is_owned:
        return
    seen.add(reference.number)
    items: dict[Hashable, Value] = {
        k: _from_outside(ev, v, f"{name}_{k}" if name else str(k), node, f, seen)
        for k, v in ev.heap[reference].items.items()}
    ev.heap.objects[reference.number] = replace(ev.heap[reference], items=items, label=name, is_owned=False, site=None)
