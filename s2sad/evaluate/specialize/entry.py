"""specialize: a program with structures becomes its residual program, over arrays and numbers.

    class Grid: ...                              def loss(grid_u, grid_width, x):
    def loss(grid, x):                    ->         grid_u[2:18] = x
        grid.u[2:18] = x                             return np.sum(grid_u ** 2) * grid_width
        return grid.norm(grid.u)

Requires a function whose text can be had, and what its arguments are made of; gives one kernel, the functions that have
derivatives of their own apart.
"""
from __future__ import annotations

import inspect
import re
import types
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from typing import Any

from s2sad import tree
from s2sad.deep_stack import deep_stack
from s2sad.diagnostics import Diagnostic, S2sadError
from s2sad.evaluate.specialize.classes.class_lookup import class_value
from s2sad.evaluate.specialize.evaluator import Cell, Evaluator, Frame, Leave, Reached, Unevaluated, operation
from s2sad.evaluate.specialize.heap import Object
from s2sad.evaluate.specialize.separate.separate_functions import title_functions
from s2sad.evaluate.specialize.sparse.matrix_values import given_matrix, is_sparse
from s2sad.evaluate.specialize.sparse.place_writes import settled_places
from s2sad.evaluate.specialize.unread_lists import without_unread_lists
from s2sad.evaluate.specialize.meanings import ResidualScope
from s2sad.evaluate.specialize.values import (
    NONE, ClassValue, Conflict, Data, FunctionValue, Reference, TupleValue, Value, alike, constant,
)
from s2sad.evaluate.specialize.values import UNKNOWN as NOT_KNOWN
from s2sad.infer.types import UNKNOWN
from s2sad.infer.types import NONE as NONE_TYPE
from s2sad.live_objects.registry import GIVEN
from s2sad.live_objects.unwrap import partial_application
from s2sad.program import DemandedFacts, Fact, Kernel, Program, SourcePlace
from s2sad.pytree import SPARSE, Form, PyTree, is_held, step
from s2sad.read.capture import captured_of
from s2sad.read.linker import annotations_said, defaults_said, header_of
from s2sad.read.outside_values import Captured, UserFunctionValue
from s2sad.tree import AST


_SPARSE = re.compile(r"an? (bsr|coo|csc|csr|dia|dok|lil)_(matrix|array)")       # what is said of a sparse matrix


@dataclass(frozen=True)
class Residual:
    """A residual function, as reading takes it, and what its parameters are: `paths` by name what a user calls each;
    `cells` are those that are arrays of one element: numbers in objects, which are assigned; `result` is the structure
    that is returned; `changed` are the paths of objects that are given and changed otherwise, `replaced` the parameters
    in whose place these hold something else in the end, `live` the objects from outside, `unrolled` the loops that are
    written out, with their rounds.
    One that is `given` has that function's own derivative, and perhaps its `residual`."""
    made: Captured
    paths: dict[str, str]
    cells: frozenset[str]
    result: PyTree | None
    changed: frozenset[str]
    replaced: frozenset[str]
    live: frozenset[int]
    unrolled: tuple[tuple[SourcePlace, int], ...] = ()
    given: Any = None
    residual: UserFunctionValue | None = None

    def captured(self) -> Captured:
        return self.made


def unread(function: Any, refused: S2sadError | None = None) -> Program:
    """The program of a function that waits for what it is given."""
    captured = captured_of(function)
    a = captured.tree.args
    if hasattr(function, "__wrapped__") and (a.vararg or a.kwarg):
        raise S2sadError(Diagnostic("S101", f"'{captured.name}' is wrapped by a decorator that takes any arguments",
                                    help="call it in a function that names them, or give the function inside: "
                                    f"{captured.name}.__wrapped__"))
    parameters = tuple(p.id for p in (*a.posonlyargs, *a.args, *a.kwonlyargs))
    if not isinstance(function, types.FunctionType):
        defaults, annotations = defaults_said(captured), annotations_said(captured)
    else:
        live = inspect.signature(partial_application(function)[0]).parameters
        defaults = {n: live[n].default for n in parameters if live[n].default is not inspect.Parameter.empty}
        said = {n: live[n].annotation for n in parameters if live[n].annotation is not inspect.Parameter.empty}
        annotations = {n: a.__name__ if isinstance(a, type) else str(a) for n, a in said.items()}
    kernel = Kernel(captured.name, tree.at(tree.function(captured.name, list(parameters), []), captured.tree),
                    captured.source, parameters, defaults, annotations)
    return Program(captured.name, {captured.name: kernel}, refused=refused, function=function)


@deep_stack
def specialize(function: Any, forms: Mapping[str, Form], facts: Mapping[Fact, Any], unrolls: bool = False,
               inlines: bool = False, no_cells: frozenset[str] = frozenset(), is_given: bool = False) -> Residual:
    """The residual function of a function, live or of a file, for arguments of these forms; raises S2sadError,
    DemandedFacts where facts would help. Loops in which lists grow are written out where it `unrolls`, calls where it
    `inlines`; the numbers at the paths `no_cells` become something that cells of their types do not hold. Of a function
    with a derivative of its own it is that of its body if it `is_given`, else a call of it."""
    sites: frozenset[int | str] = frozenset()
    cells: frozenset[str] = frozenset()
    reached: list[tuple[str, Any, bool]] = []
    while True:
        captured = captured_of(function)
        ev = Evaluator(captured.source, dict(facts), sites, unrolls, inlines, cells)
        try:
            found = _evaluated(ev, function, captured, forms, reached, is_given)
            if not (more := _assigned_numbers(ev) - no_cells):
                return found
            cells |= more
        except Reached as found:
            reached.append((found.name, found.value, found.is_owned))
        except Unevaluated as reason:
            site = None if unrolls or reason.site is None else (
                reason.site if isinstance(reason.site, str) else id(reason.site))
            if reason.demands:
                raise DemandedFacts(reason.demands, reason.error) from None
            if site is None or site in sites:
                raise reason.error from None
            sites |= {site}


def _evaluated(ev: Evaluator, function: Any, captured: Captured, forms: Mapping[str, Form],
               reached: Sequence[tuple[str, Any, bool]], is_given: bool) -> Residual:
    definition = captured.tree
    for decorator in getattr(function, "decorators", ()):
        raise ev.refusal(decorator, f"'{captured.name}' has a decorator, and is read without being run",
                         help="take it off, and wrap the kernel elsewhere under another name")
    f = ev.frame_of(FunctionValue(captured, ("entry",), handle=function), definition, True)
    f = replace(f, owner=_owner(function))
    ev.entry = f
    kernel, bound = partial_application(function)
    for name, value, is_owned in reached:
        ev.owning = is_owned
        ev.outside_value(name, value, definition, f)
    ev.owning = True
    for name, value in bound.items():
        ev.heap.put(f.reference, name, ev.outside_value(name, value, definition, f))
    ev.owning = False
    names = ev.paths
    for name in (p.id for p in (*definition.args.posonlyargs, *definition.args.args, *definition.args.kwonlyargs)):
        form = forms[name]
        ev.heap.put(f.reference, name, _argument(ev, form, name, name, definition, names))
    for extra, value in ((definition.args.vararg, TupleValue(())), (definition.args.kwarg, None)):
        if extra is not None:
            ev.heap.put(f.reference, extra.id, value or ev.heap.new(Object("dict", {}, label=extra.id)))
    if bound:
        f = replace(f, first=next(iter(bound)))
    ev.entry = f
    try:
        if GIVEN.own(function) is None or is_given:
            ev.statements(definition.body, f)
        else:
            _call_of_it(ev, FunctionValue(captured, ("live", id(function)), handle=function), list(names), f)
        _store_cells(ev, definition.body[-1])
    except Leave:
        pass
    body = without_unread_lists(settled_places(ev.block, lambda s: ev.refusal(
        s, "the places of the entries of a sparse matrix are written after it was made", "copy them before, or build "
        "another matrix"))) or [tree.at(tree.Pass(), definition)]
    title_functions(ev, body, [definition.name])
    result = _results(ev)
    function_tree = tree.at(tree.function(definition.name, list(names), body), definition)
    scope = ResidualScope(ev.outside, captured.scope)
    made = Captured(captured.name, function_tree, ev.source, scope, _no_default)
    changed, replaced = _changes(ev)
    unrolled = tuple((SourcePlace.of(ev.source, s), rounds) for s, rounds in ev.unrolled_loops.items())
    return Residual(made, names, frozenset(c.parameter for c in ev.cells), result, changed, replaced,
                    frozenset(ev.live), unrolled)


def _store_cells(ev: Evaluator, origin: AST) -> None:
    """What the numbers of arguments' objects are in the end goes to where the caller finds it."""
    for cell in ev.cells:
        place = tree.Subscript(tree.name(cell.parameter), tree.const(0), tree.Load())
        value = ev.heap.objects[cell.holder].items[cell.key]
        ev.emit(tree.assign(place, ev.spelled(value, origin)), origin, True)


def _assigned_numbers(ev: Evaluator) -> frozenset[str]:
    """The paths of numbers in arguments' objects that are other numbers in the end, and no cells yet."""
    found: set[str] = set()
    ends = (ev.heap.objects, *(objects for _, _, objects in ev.returned))
    for number, before in ev.given.items():
        for key, old in before.items.items():
            path = ev.paths.get(old.name, "") if isinstance(old, Data) and old.shape == () else ""
            now = [objects[number].items.get(key) for objects in ends]
            if path and not all(alike(old, n) for n in now) and all(
                    isinstance(n, Data) and isinstance(n.known if n.is_known else 0, (bool, int, float, complex))
                    for n in now):
                found.add(path)
    return frozenset(found)


def _call_of_it(ev: Evaluator, function: FunctionValue, names: Sequence[str], f: Frame) -> None:
    """The call of a function with a derivative of its own, in a function that is differentiated as usual."""
    definition = function.captured.tree
    found = ev.call(function, [ev.heap[f.reference].items[n] for n in names], {}, definition, f)
    if any(isinstance(n, tree.Return) and n.value is not None for n in tree.walk(definition.body)):
        ev.return_from_entry(definition, found, f)
    ev.emit(tree.Expr(ev.spelled(found, definition)), definition, True)


@operation
def body_of(ev: Evaluator, function: Any) -> Any:
    """What a function that stays one is read from: of one that has a derivative of its own, residual functions of it
    and of what it makes zero."""
    own = GIVEN.own(function)
    if own is None:
        return function
    is_called = "primal" in own.functions       # as it is, and not read
    nothing: frozenset[Any] = frozenset()
    as_it_is = Residual(captured_of(function), {}, nothing, None, nothing, nothing, nothing)
    made = as_it_is if is_called else _of_arrays(function)
    if made is None:
        return function
    meaning = None
    if isinstance(own.residual, types.FunctionType):
        zero = own.residual
        meaning = UserFunctionValue(zero.__name__, ("live", id(zero)), zero.__qualname__, _of_arrays(zero) or zero)
    return replace(made, given=function, residual=meaning)


def _of_arrays(function: Any) -> Residual | None:
    """The residual function for arrays and numbers of which nothing is known; None where that is not enough."""
    try:
        parameters = [a.id for a in captured_of(function).tree.args.args]
        return specialize(function, dict.fromkeys(parameters, UNKNOWN), {}, is_given=True)
    except (S2sadError, DemandedFacts, KeyError):
        return None


def _changes(ev: Evaluator) -> tuple[frozenset[str], frozenset[str]]:
    """The arguments' objects that have other content in the end, and the parameters that are no longer in it."""
    changed: set[str] = {*ev.grown}
    replaced: set[str] = set()
    for objects in (ev.heap.objects, *(objects for _, _, objects in ev.returned)):
        for number, before in ev.given.items():
            after = objects[number].items
            keys = {k for k in {*before.items, *after} if not alike(before.items.get(k), after.get(k))}
            keys -= {c.key for c in ev.cells if c.holder == number}
            changed |= {before.path} if keys or list(before.items) != list(after) else set()
            replaced |= {n for k in keys if k in before.items for n in _names(ev, before.items[k])}
    return frozenset(changed), frozenset(replaced)


def _names(ev: Evaluator, value: Value) -> list[str]:
    """The parameters of which a value was made when it was given."""
    if isinstance(value, Data):
        return [value.name] if value.name else []
    inner = value.items if isinstance(value, TupleValue) else tuple(
        ev.given[value.number].items.values()) if isinstance(value, Reference) and value.number in ev.given else ()
    return [n for v in inner for n in _names(ev, v)]


def _no_default(parameter: str, node: AST) -> Any:
    raise KeyError(parameter)


def _owner(function: Any) -> ClassValue | None:
    """The class that a method's function is of."""
    kernel, bound = partial_application(function)
    first = next(iter(bound.values()), None)
    classes = type(first).__mro__ if first is not None else ()
    return next((class_value(c) for c in classes if vars(c).get(kernel.__name__) is kernel), None)


def _argument(ev: Evaluator, form: Form, path: str, wanted: str, origin: AST, names: dict[str, str]) -> Value:
    """What an argument is: names for its leaves."""
    if isinstance(form, PyTree):
        items: dict[Hashable, Value] = {
            ev.member(key) if isinstance(key, Enum) else key: _argument(
                ev, item, step(form, path, key), f"{wanted}_{key}", origin, names)
            for key, item in zip(form.keys, form.items)}
        if form.kind in SPARSE:
            return given_matrix(ev, form, tuple(items.values()), path, wanted, origin)
        if form.kind in ("tuple", "named"):
            made = _class(ev, form.made, origin) if form.kind == "named" and form.made is not None else None
            return TupleValue(tuple(items.values()), made)
        kind = form.kind if form.kind in ("list", "dict") else "record"
        if kind == "list" and path in ev.sites:
            ev.grown.add(path)
            return _residual_list(ev, tuple(items.values()), wanted, origin)
        made = _class(ev, form.made, origin) if kind == "record" and form.made is not None else None
        reference = ev.heap.new(Object(kind, items, made, label=wanted, path=path,
                                       site=path if kind == "list" else None))
        ev.given[reference.number] = ev.heap[reference]
        parameters = {p: n for n, p in names.items()}
        ev.cells += [Cell(reference.number, key, parameters[inner]) for k, key in zip(form.keys, items)
                     if (inner := step(form, path, k)) in ev.cell_paths]
        return reference
    if form.kind == "none":
        return NONE
    if form.kind == "text":
        name = ev.fresh(wanted)
        names[name] = path
        known = ev.facts.get((path, "value"))
        if known is not None:
            return constant(known)
        ev.texts.add(name)
        return Data(tree.at(tree.name(name), origin), demands=frozenset(((path, "value"),)))
    if not is_held(form):
        fact = (path, "value")
        if fact in ev.facts:        # a function, a class, a member of an enumeration
            return ev.outside_value(wanted, ev.facts[fact], origin, ev.entry)
        help = "give it in another format: A.tocsr()" if _SPARSE.fullmatch(form.dtype) else ""
        return Conflict(f"'{path}' is {form.dtype or form.kind}, of which a kernel can make no use", frozenset((fact,)),
                        help)
    name = ev.fresh(wanted)
    names[name] = path
    if path != name:
        ev.leaves.add(name)
    fact = (path, "value")
    if path in ev.cell_paths:
        own = ev.fresh(re.findall(r"\w+", path)[-1] if "." in path else f"{wanted}_now")
        ev.emit(tree.assign(own, tree.Subscript(tree.name(name), tree.const(0), tree.Load())), header_of(origin))
        name = own
    if form == UNKNOWN:         # an array or a number
        return Data(tree.at(tree.name(name), origin), demands=frozenset((fact,)), origins=frozenset((path,)))
    if form.is_number and form.dtype in ("int64", "bool"):
        known = ev.facts.get(fact, NOT_KNOWN)
        return Data(tree.at(tree.name(name), origin), known, frozenset() if fact in ev.facts else frozenset((fact,)),
                    shape=())
    if not form.is_array:
        return Data(tree.at(tree.name(name), origin), shape=())
    return Data(tree.at(tree.name(name), origin), origins=frozenset((path,)), shape=ev.facts.get(
        (path, "shape"), (None,) * form.rank))


def _class(ev: Evaluator, made: Any, origin: AST) -> ClassValue:
    """The class of an argument, live or of a file."""
    return class_value(made) if isinstance(made, type) else ev.file_class(made, origin, ev.entry)


def _residual_list(ev: Evaluator, items: Sequence[Value], wanted: str, origin: AST) -> Value:
    """A list that is given and grows in the residual program, which has one of its own."""
    made = tree.List([ev.spelled(i, origin) for i in items], tree.Load())
    return ev.named(Data(tree.at(made, origin), is_list=True), wanted, origin)


# -- results ---------------------------------------------------------------------------------------------------------
@operation
def return_from_entry(ev: Evaluator, s: AST, value: Value, f: Frame) -> None:
    """A return of the residual program."""
    value = value if isinstance(value, Data) else ev.atoms(value, "result", s)
    leaves = list(_leaves(ev, value, s))
    if any(v.is_list for v in leaves):
        raise ev.refusal(s, "a list is returned whose length is not known before the run",
                         help="make it an array with np.array")
    nodes = [ev.spelled(v, s) for v in leaves]
    _store_cells(ev, s)
    if isinstance(value, Data) and value.is_known and value.known is None:
        node = None
    elif isinstance(value, Data):
        node = nodes[0]
    else:
        node = nodes[0] if len(nodes) == 1 and not isinstance(value, TupleValue) else tree.tuple_of(*nodes)
    ev.emit(tree.Return(node), s)
    ev.returned.append((s, value, ev.heap.fork()))


def _leaves(ev: Evaluator, value: Value, node: AST) -> Any:
    if isinstance(value, Data):
        if not (value.is_known and value.known is None):
            yield value
    elif isinstance(value, TupleValue):
        for v in value.items:
            yield from _leaves(ev, v, node)
    elif isinstance(value, Reference) and ev.heap[value].kind in ("list", "dict", "record"):
        for v in ev.heap[value].items.values():
            yield from _leaves(ev, v, node)
    else:
        sparse = "return its entries, and build it of them outside"
        raise ev.refusal(node, f"{ev.kind_of(value)} is returned",
                         help=sparse if is_sparse(value, ev.heap) else "return arrays and numbers")


def _results(ev: Evaluator) -> PyTree | None:
    """What structure is returned: the same at each return; None for arrays, numbers and tuples of these."""
    forms = [_form(ev, objects, value) for _, value, objects in ev.returned]
    if any(f != forms[0] for f in forms[1:]):
        raise ev.refusal(ev.returned[-1][0], "returns that are structures of different makes",
                         help="return the same structure on every path")
    found = forms[0] if forms else None
    plain = isinstance(found, PyTree) and found.kind == "tuple" and all(i is UNKNOWN for i in found.items)
    return found if isinstance(found, PyTree) and not plain else None


def _form(ev: Evaluator, objects: Mapping[int, Object], value: Value) -> Any:
    """What is returned, of what its items are."""
    if isinstance(value, Data):
        return NONE_TYPE if value.is_known and value.known is None else UNKNOWN
    if isinstance(value, TupleValue):
        items = tuple(_form(ev, objects, v) for v in value.items)
        made = value.made.live if value.made is not None else None
        fields = ev.layout_of(value.made).names if value.made is not None else tuple(range(len(items)))
        return PyTree("named" if value.made is not None else "tuple", fields, items, made, True)
    assert isinstance(value, Reference)
    held = objects[value.number]
    items = tuple(_form(ev, objects, v) for v in held.items.values())
    return PyTree(held.kind, tuple(held.items), items,  # pyright: ignore[reportArgumentType]
                  held.made.live if held.made is not None else None)
