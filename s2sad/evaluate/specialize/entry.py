"""specialize: a program with structures becomes its residual program, over arrays and numbers.

    class Grid: ...                              def loss(grid_u, grid_width, x):
    def loss(grid, x):                    ->         grid_u[2:18] = x
        grid.u[2:18] = x                             return np.sum(grid_u ** 2) * grid_width
        return grid.norm(grid.u)

Requires a function whose text can be had, and what its arguments are made of; gives one kernel, the functions that have
derivatives of their own apart.
"""
from __future__ import annotations

import math
import types
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from s2sad import tree
from s2sad.deep_stack import deep_stack
from s2sad.diagnostics import Diagnostic, S2sadError
from s2sad.evaluate.specialize.classes.class_lookup import class_value
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import UNROLL_LIMIT, Evaluator, operation
from s2sad.evaluate.specialize.separate.call_view import NUMBER
from s2sad.evaluate.specialize.signals import Leave, Reached, Unevaluated
from s2sad.evaluate.specialize.entry_arguments import (
    argument_value, assigned_numbers, changed_outside, changes_of, mutated, store_cells,
)
from s2sad.evaluate.specialize.entry_results import result_structure_of
from s2sad.evaluate.specialize.heap import Object
from s2sad.evaluate.specialize.separate.separate_functions import title_functions
from s2sad.evaluate.specialize.sparse.place_writes import settled_places
from s2sad.evaluate.specialize.sequences.constant_tables import with_tables
from s2sad.evaluate.specialize.sequences.object_tables import with_columns
from s2sad.evaluate.specialize.unread_lists import without_unread_lists
from s2sad.evaluate.specialize.meanings import ResidualScope
from s2sad.evaluate.specialize.values import (
    ClassValue, FunctionValue, TupleValue,
)
from s2sad.infer.types import UNKNOWN
from s2sad.live_objects.guards import ABSENT, taken
from s2sad.live_objects.registry import GIVEN
from s2sad.live_objects.unwrap import default_values, partial_application
from s2sad.program import DemandedFacts, Fact, Kernel, Program, SourcePlace
from s2sad.pytree import Form, PyTree
from s2sad.read.capture import captured_of
from s2sad.read.linker import annotations_said, defaults_said
from s2sad.read.outside_values import Captured, UserFunctionValue
from s2sad.tree import AST




@dataclass(frozen=True)
class Residual:
    """A residual function, as reading takes it, and what its parameters are: `paths` by name what a user calls each;
    `cells` are those that are arrays of one element: numbers in objects, which are assigned; `result` is the structure
    that is returned; `changed` are the paths of objects that are given and hold something else in the end, beside
    the cells, `mutated` of those that do so at any time, `replaced` the parameters in whose place they do, `live` the
    objects from outside, `unrolled` the loops that are written out, with their rounds, `changed_outside` what the
    objects from outside are called that are changed. One that is `given`
    has that function's own derivative, and perhaps its `residual`."""
    made: Captured
    paths: dict[str, str]
    cells: frozenset[str]
    result: PyTree | None
    changed: frozenset[str]
    mutated: frozenset[str]
    replaced: frozenset[str]
    live: frozenset[int]
    unrolled: tuple[tuple[SourcePlace, int], ...] = ()
    changed_outside: frozenset[str] = frozenset()
    stayed: bool = False        # a loop of many rounds does, that could be written out
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
        live = partial_application(function)[0]
        values, said = default_values(live), {n: taken(live, "annotation", n) for n in parameters}
        defaults = {n: values[n] for n in parameters if n in values}
        annotations = {n: text for n, text in said.items() if text is not ABSENT}
    kernel = Kernel(captured.name, tree.at(tree.function(captured.name, list(parameters), []), captured.tree),
                    captured.source, parameters, defaults, annotations,
                    rest=tuple(f"{stars}{p.id}" for stars, p in (("*", a.vararg), ("**", a.kwarg)) if p is not None))
    return Program(captured.name, {captured.name: kernel}, refused=refused, function=function)


@deep_stack
def specialize(function: Any, forms: Mapping[str, Form], facts: Mapping[Fact, Any], unrolls: bool = False,
               inlines: bool = False, no_cells: frozenset[str] = frozenset(), is_given: bool = False,
             unroll_limit: float = UNROLL_LIMIT) -> Residual:
    """The residual function of a function, live or of a file, for arguments of these forms; raises S2sadError,
    DemandedFacts where facts would help. Loops in which lists grow are written out where it `unrolls`, calls where it
    `inlines`; the numbers at the paths `no_cells` become something that cells of their types do not hold. Of a function
    with a derivative of its own it is that of its body if it `is_given`, else a call of it. A loop of more rounds than
    `unroll_limit` stays one where a list of the run or a choice may be in it, unless that is refused."""
    asked, stayed = _Asked(), False
    reached: list[tuple[str, Any, bool]] = []
    while True:
        captured = captured_of(function)
        ev = Evaluator(captured.source, dict(facts), asked.sites, unrolls, inlines, asked.cells, asked.choices,
                       unroll_limit)
        ev.stayed, ev.object_sites, ev.prefers_choices = stayed, asked.objects, asked.prefers_choices
        try:
            found = _evaluated(ev, function, captured, forms, reached, is_given)
            if not (cells := assigned_numbers(ev) - no_cells):
                return replace(found, stayed=ev.stayed)
            asked = replace(asked, cells=asked.cells | cells)
        except Reached as found:
            reached.append((found.name, found.value, found.is_owned))
        except (Unevaluated, S2sadError) as reason:
            more = asked.extended(ev, reason) if isinstance(reason, Unevaluated) else None
            if more is None and asked.objects and not asked.prefers_choices:
                more = _Asked(prefers_choices=True)
            if more is None and not ev.stayed:
                raise (reason.error if isinstance(reason, Unevaluated) else reason) from None
            if more is None:
                unroll_limit, ev.stayed = math.inf, False
            asked = more or _Asked()
        stayed = ev.stayed


@dataclass(frozen=True)
class _Asked:
    """What an evaluation was found to need: lists of the run, numbers in objects with cells, slots with choices,
    objects that are rows of tables."""
    sites: frozenset[int | str] = frozenset()
    cells: frozenset[str] = frozenset()
    choices: frozenset[str] = frozenset()
    objects: frozenset[int] = frozenset()
    prefers_choices: bool = False

    def extended(self, ev: Evaluator, reason: Unevaluated) -> _Asked | None:
        """With what would help, None if nothing would; raises DemandedFacts where facts of arguments do."""
        of_arguments = frozenset(fact for fact in reason.demands if fact[1] != NUMBER)
        if of_arguments:
            raise DemandedFacts(of_arguments, reason.error) from None
        if reason.demands and not ev.inlines:       # what a function of its own makes of numbers is known where it is
            return None                             # written out
        if reason.choice and reason.choice not in self.choices:
            return replace(self, choices=self.choices | {reason.choice})
        if not reason.objects <= self.objects and not ev.unrolls:
            return replace(self, objects=self.objects | reason.objects)
        site = None if ev.unrolls or reason.site is None else (
            reason.site if isinstance(reason.site, str) else id(reason.site))
        more = {site} if site is not None and site not in self.sites else {*map(id, () if ev.unrolls else ev.limited)}
        return None if more <= self.sites else replace(self, sites=self.sites | more)


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
        ev.heap.put(f.reference, name, argument_value(ev, form, name, name, definition, names))
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
        store_cells(ev, definition.body[-1])
    except Leave:
        pass
    body = without_unread_lists(settled_places(with_columns(ev, ev.block, definition), lambda s: ev.refusal(
        s, "the places of the entries of a sparse matrix are written after it was made", "copy them before, or build "
        "another matrix"))) or [tree.at(tree.Pass(), definition)]
    body = with_tables(ev, body)
    title_functions(ev, body, [definition.name])
    result = result_structure_of(ev)
    function_tree = tree.at(tree.function(definition.name, list(names), body), definition)
    scope = ResidualScope(ev.outside, captured.scope)
    made = Captured(captured.name, function_tree, ev.source, scope, _no_default, unsure=frozenset(ev.unsure))
    changed, replaced = changes_of(ev)
    unrolled = tuple((SourcePlace.of(ev.source, s), rounds) for s, rounds in ev.unrolled_loops.items())
    return Residual(made, names, frozenset(c.parameter for c in ev.cells), result, changed,
                    changed | mutated(ev), replaced,
                    frozenset(ev.live), unrolled, changed_outside(ev))


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
    as_it_is = Residual(captured_of(function), {}, nothing, None, nothing, nothing, nothing, nothing)
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


def _no_default(parameter: str, node: AST) -> Any:
    raise KeyError(parameter)


def _owner(function: Any) -> ClassValue | None:
    """The class that a method's function is of."""
    kernel, bound = partial_application(function)
    first = next(iter(bound.values()), None)
    classes = type(first).__mro__ if first is not None else ()
    return next((class_value(c) for c in classes if vars(c).get(kernel.__name__) is kernel), None)
