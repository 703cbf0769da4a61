"""for, break, continue, return: a loop stays one if nothing in it must be known, else it is written out.
"""
from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence, Set
from dataclasses import replace
from typing import Any

from s2sad import tree
from s2sad.evaluate.specialize.sequences.constant_tables import lists_in
from s2sad.evaluate.specialize.sequences.counted_sequence import PartChanges, counted_sequence, refuse_changes
from s2sad.evaluate.specialize.sequences.cursors import Known
from s2sad.evaluate.specialize.sequences.generators import is_lazy
from s2sad.evaluate.specialize.sequences.nested_ranges import NESTED
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator, operation, statement
from s2sad.evaluate.specialize.signals import NOWHERE, Leave, Unevaluated
from s2sad.evaluate.specialize.heap import Temporary
from s2sad.evaluate.specialize.control.first_iteration import peeled, split_iteration
from s2sad.evaluate.specialize.control.loop_closed_names import read_outside
from s2sad.evaluate.specialize.control.residual_loops import ResidualLoop
from s2sad.evaluate.specialize.separate.needed_numbers import needed_numbers
from s2sad.evaluate.specialize.values import (
    NONE, Data, Iteration, Reference, ResidualObject, TupleValue, Value, alike, constant,
)
from s2sad.tree import AST


def rolled(ev: Evaluator, s: Any, *forms: Callable[[], Any] | None) -> None:
    """A loop as it stands; where something in it must be known, it is taken back, and evaluated in the next form. Of a
    recursion without an end its outermost loop alone tries other forms, and none where facts would tell the end."""
    if forms[-1] is not None and any(s is one for one in ev.endless):
        forms = forms[-1:]
    before = ev.snapshot()
    pending, loops, guarded = list(ev.pending), list(ev.loops), ev.guarded
    outer, may_stay = ev.block, ev.may_stay
    why: Unevaluated | None = None
    for form in forms:
        if form is None or why is not None and not why.differs and form is not forms[-1]:
            continue
        ev.may_stay = may_stay or why is not None and _may_stay(ev, why)
        try:
            form()
            return
        except Unevaluated as reason:
            if reason.endless and (reason.demands or any(s is one for one in ev.residual)):
                raise
            if reason.endless:
                ev.endless.append(s)
            ev.pending[:], ev.loops[:] = pending, loops
            ev.block, ev.guarded = outer, guarded
            ev.restore(before)
            why = reason if why is None or _tells_more(ev, reason, why) else why
        finally:
            ev.may_stay = may_stay
    assert why is not None
    raise why from None


def _may_stay(ev: Evaluator, why: Unevaluated) -> bool:
    """Whether a loop may stay one where a list is one of the run, or a slot a choice."""
    return not ev.unrolls and why.site is not None and why.site not in ev.sites and id(why.site) not in ev.sites or (
        bool(why.choice) and why.choice not in ev.choices)


def _tells_more(ev: Evaluator, reason: Unevaluated, other: Unevaluated) -> bool:
    """Which of two reasons is better acted on: a list that can be residual, facts that can be asked, a choice,
    rows of a table; of reasons of which none is, the first one tells what is in the way."""
    if ev.unrolls or other.site is None:
        acts = reason.site is not None or bool(reason.choice or reason.objects - ev.object_sites)
        return bool(reason.demands) or not other.demands and acts
    return False


@statement("For")
def for_statement(ev: Evaluator, s: Any, f: Frame) -> None:
    whole = ev.gone_through(s.iter, f)
    if isinstance(whole, Iteration) and whole.kind in NESTED:
        whole = ev.nested(whole, s.target, s.iter, f)
    elif not _is_range(whole):       # a range that stays is read as it is
        whole = ev.atoms(ev.as_generator(whole, s.iter, f), "items", s.iter)
    if s.orelse and ev.stays_one(whole) and not _has_known_rounds(ev, whole, s, f) and not isinstance(
            s.target, (tree.Subscript, tree.Attribute)):
        whole = ev.one_loop(whole, s.target, s.iter, f)
    ev.used(whole, s.iter)
    if is_lazy(whole):
        ev.for_lazy(s, whole, f)
        return
    slot = Temporary("iterated", id(s))

    def bind(item: Value) -> None:
        ev.store(s.target, item, f)

    def held(sequence: Value) -> Value:
        through = ev.atoms(sequence, "iterated", s.iter)
        ev.heap.put(f.reference, slot, through)      # its names are in use
        return through

    def unroll() -> None:
        cursor = ev.cursor_of(held(whole), s.iter, f)
        if isinstance(cursor, Known):       # the names of what is to come are in use
            ev.heap.put(f.reference, slot, TupleValue(cursor.items))
        ev.unrolled(s, cursor, f, bind)

    def peel() -> None:
        split = split_iteration(ev, held(whole), s.iter)
        if split is None:
            raise ev.unknown(s, "the first round of a loop differs from the others")
        ev.heap.put(f.reference, slot, split.rest)
        peeled(ev, s, f, split, lambda: rolled(ev, s, lambda: for_stays(ev, s, split.rest, f, held)), bind)

    def stays() -> None:
        lists = lists_in(ev, whole)
        start = len(ev.block)
        loop = for_stays(ev, s, through if _is_range(through) else held(through), f, held)
        if short is not None and _needs_numbers(loop, ev.block[start:]):
            raise ev.unknown(s.iter, "the numbers that a loop goes through must be known in it")
        if any(len(before) != len(ev.heap.objects[n].items) or not all(
                map(alike, before.values(), ev.heap.objects[n].items.values())) for n, before in lists):
            raise ev.unknown(s.iter, "a list is changed by the loop that goes through it")

    short = ev.through_short_tables(whole, s)
    through = ev.through_tables(whole, s.iter) if short is None else short
    if ev.stays_one(through):
        rolled(ev, s, stays, peel, unroll)
    else:
        _with_site_beside(ev, through, f, unroll)
    items = dict(ev.heap[f.reference].items)
    items.pop(slot, None)
    ev.heap.set_items(f.reference, items)


def _with_site_beside(ev: Evaluator, through: Value, f: Frame, unroll: Callable[[], None]) -> None:
    """Writes a loop out; a list that grows, and is gone through beside one of the run, would have to be one, too."""
    try:
        unroll()
    except Unevaluated as reason:
        parts = _gone_through(through)
        if reason.site is None and any(isinstance(p, Data) and p.is_list for p in parts):
            grown = {n.func.value.id for n in tree.walk(f.captured.tree) if isinstance(n, tree.Call) and isinstance(
                n.func, tree.Attribute) and n.func.attr == "append" and isinstance(n.func.value, tree.Name)}
            reason.site = next((held.site for p in parts if isinstance(p, Reference) and (
                held := ev.heap[p]).kind == "list" and (not held.items or held.label in grown)), None)
        raise


def _gone_through(through: Value) -> list[Value]:
    """What the iterators that a loop goes through take their items from."""
    if isinstance(through, Iteration) and through.kind in ("zip", "enumerate", "reversed"):
        return [inner for p in through.parts for inner in _gone_through(p)]
    return [through]


def _needs_numbers(loop: ResidualLoop, statements: list[AST]) -> bool:
    """Whether something in a loop depends on which numbers it goes through, other than what is computed and picked: a
    part of an array that has a name may be apart from others, or not."""
    body = next(n for n in reversed(statements) if isinstance(n, tree.For)).body
    bound = [s for s in tree.walk(body) if isinstance(s, (tree.Assign, tree.AugAssign))
             and not loop.targets & {*tree.stored_names(s)}]
    numbers = set(loop.targets)
    while more := {n for s in bound if numbers & {*_computed_with(s.value)} for n in tree.stored_names(s)} - numbers:
        numbers |= more
    changes = loop.home_names() & {n for s in bound if isinstance(s, tree.Assign) for n in tree.stored_names(s)}
    return bool(changes) or any(isinstance(s.value, tree.Subscript) for s in bound) or bool(needed_numbers(
        body, dict.fromkeys(numbers, 1), picks=True))


def _computed_with(node: AST) -> list[str]:
    """The names of an expression that are not in a subscript."""
    if isinstance(node, (tree.Name, tree.Subscript)):
        return [node.id] if isinstance(node, tree.Name) else []
    return [n for c in tree.children(node) for n in _computed_with(c)]


def _has_known_rounds(ev: Evaluator, through: Value, s: Any, f: Frame) -> bool:
    """Whether a loop can be written out."""
    before = ev.snapshot()
    try:
        ev.cursor_of(through, s.iter, f)
    except Unevaluated:
        return False
    finally:
        ev.restore(before)
    return True


def _is_range(through: Value) -> bool:
    return isinstance(through, Iteration) and (
        through.kind == "range" or through.kind == "reversed" and _is_range(through.parts[0]))


def for_stays(ev: Evaluator, s: Any, through: Value, f: Frame, held: Callable[[Value], Value]) -> ResidualLoop:
    """A loop over numbers and arrays that stays one, and counts; what it goes through is `held`. One that changes a
    list of which it goes through a part goes through a copy."""
    before = ev.snapshot()
    try:
        return _counting_loop(ev, s, through, f)
    except PartChanges:
        ev.restore(before)
        return _counting_loop(ev, s, held(ev.copied_parts(through, s.iter)), f)


def _counting_loop(ev: Evaluator, s: Any, through: Value, f: Frame) -> ResidualLoop:
    if s.orelse:
        raise ev.unknown(s, "else of a loop that stays one is not supported in a kernel")
    names = [n.id for n in tree.walk(s.target) if isinstance(n, tree.Name)]
    if not all(isinstance(n, (tree.Name, tree.Tuple, tree.List)) for n in tree.walk(s.target)):
        raise ev.unknown(s.target, "a loop over items of a structure")
    sequence = counted_sequence(ev, through, s.iter)
    before = ev.snapshot()
    try:
        item = sequence.item(tree.name(""))
    except Leave:       # nothing was put there yet
        item = Data(tree.index(tree.name(""), tree.const(0)))
    counting, structures = _counting_name(s.target, item), _structures(s.target, item)
    ev.restore(before)
    own = _own_targets(ev, names, structures, s, f)
    loops: list[ResidualLoop] = []

    def once() -> Callable[[list[AST]], AST]:
        own.update({n: ev.fresh(n) for n in names if n not in there})
        counter = own[counting] if counting else ev.fresh("index")
        loop = ev.loops[-1]
        loops.append(loop)
        loop.targets = frozenset({counter, *own.values()})
        loop.make = lambda body: tree.For(tree._target(tree.name(counter)), tree.call(
            "range", *map(tree.copy, sequence.bounds)), body, [], None)
        _bind_items(ev, s.target, sequence.item(tree.at(tree.name(counter), s.target)), own, f)
        ev.statements(s.body, f)
        return loop.make
    there = {*own}
    start = len(ev.block)
    ev.residual_loop(s, once, f)
    refuse_changes(ev, through, ev.block[start:], s.iter)
    return loops[-1]


def _own_targets(ev: Evaluator, names: Sequence[str], structures: Set[str], s: Any, f: Frame) -> dict[str, str]:
    """The residual names of a loop's targets that are bound before it: they keep what they hold where there is no
    round, as far as that is read behind the loop. What nothing reads is gone where it is a structure, or becomes one
    (`structures`) in each round."""
    held = ev.heap[f.reference].items
    there = {n: held[n] for n in names if n in held}
    read = read_outside(ev, f.reference.number, there, s, f) if there else set()
    gone = {n for n, v in there.items() if n not in read and (
        n in structures or not isinstance(v, (Data, ResidualObject)))}
    there = {n: v for n, v in there.items() if n not in gone}
    if gone:
        ev.heap.set_items(f.reference, {k: v for k, v in held.items() if k not in gone})
    found: dict[str, str] = {}
    for n, whole in there.items():
        value = whole.number if isinstance(whole, ResidualObject) else whole
        found[n] = value.name if isinstance(value, Data) and ev.owns(value.name) else ev.fresh(n)
        kept = isinstance(value, Data) and not (value.is_known and value.known is None)
        if n in read and not kept and not isinstance(value, Data):
            raise ev.unknown(s.target, f"'{n}' is a structure before a loop that binds it, and read behind it",
                             help="give what the loop binds another name")
        if n in read and isinstance(value, Data) and kept and value.name != found[n]:
            ev.emit(tree.assign(found[n], ev.spelled(value, s)), s)
        name = Data(tree.at(tree.name(found[n]), s.target))
        ev.heap.put(f.reference, n, replace(whole, number=name) if isinstance(whole, ResidualObject) else name)
    ev.rebound += found.values()
    return found


def _counting_name(target: Any, item: Value) -> str:
    """The name of a target that the count itself is bound to, first of all; "" if there is none."""
    if isinstance(target, tree.Name):
        return target.id if isinstance(item, Data) and isinstance(item.node, tree.Name) else ""
    return _counting_name(target.elts[0], item.items[0]) if isinstance(item, TupleValue) and target.elts else ""


def _structures(target: Any, item: Value) -> set[str]:
    """The names of a target that get structures."""
    if isinstance(target, tree.Name):
        return set() if isinstance(item, (Data, ResidualObject)) else {target.id}
    inner = zip(target.elts, item.items) if isinstance(item, TupleValue) else ()
    return {n for t, i in inner for n in _structures(t, i)}


def _bind_items(ev: Evaluator, target: Any, item: Value, own: Mapping[str, str], f: Frame) -> None:
    """The names of a loop's target get the items of a round, each under one name in all of them."""
    if isinstance(target, tree.Name) and isinstance(item, ResidualObject):
        _bind_items(ev, target, item.number, own, f)
        ev.heap.put(f.reference, target.id, replace(item, number=ev.heap[f.reference].items[target.id]))
    elif isinstance(target, tree.Name) and isinstance(item, Data):
        if item.name != own[target.id]:
            ev.emit(tree.assign(own[target.id], item.node), target)
        ev.heap.put(f.reference, target.id, replace(item, node=tree.at(tree.name(own[target.id]), target)))
    elif isinstance(target, tree.Name):
        ev.store(target, item, f)
    elif isinstance(item, (TupleValue, ResidualObject)):
        items = ev.items_of(item, target, f)
        if len(items) != len(target.elts):
            raise ev.refusal(target, f"{len(target.elts)} targets for {len(items)} values", code="S203")
        for t, i in zip(target.elts, items):
            _bind_items(ev, t, i, own, f)
    else:
        whole = ev.unpackable(item, "row", target, target, True)  # pyright: ignore[reportArgumentType]
        for k, t in enumerate(target.elts):
            _bind_items(ev, t, ev.item_of(whole, constant(k), target, f), own, f)


@statement("Break")
def break_statement(ev: Evaluator, s: Any, f: Frame) -> None:
    _jump(ev, s, 0)


@statement("Continue")
def continue_statement(ev: Evaluator, s: Any, f: Frame) -> None:
    _jump(ev, s, 1)


def _jump(ev: Evaluator, s: AST, which: int) -> None:
    loop = ev.loops[-1]
    if isinstance(loop, ResidualLoop):
        jump = tree.at(tree.Continue() if which else tree.Break(), s)
        ev.emit(jump, s)
        loop.exits.append((jump, ev.block, ev.heap.fork()))
        raise Leave(NOWHERE)
    ev.leave(s, loop[which], None)


@statement("Return")
def return_statement(ev: Evaluator, s: Any, f: Frame) -> None:
    evaluated = ev.value if f.is_entry else ev.carried
    leave_function(ev, s, NONE if s.value is None else evaluated(s.value, f), f)


@operation
def leave_function(ev: Evaluator, s: Any, value: Value, f: Frame) -> None:
    """A return of a value."""
    if f.is_entry:
        ev.returns(s, value, f)
        raise Leave(NOWHERE)
    ev.leave(s, f.mark, ev.atoms(value, "result", s))
