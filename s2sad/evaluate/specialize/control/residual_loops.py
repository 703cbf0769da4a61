"""Loops that stay: slots that rounds change have one residual name in all of them.

The body is evaluated until what holds at its start holds at its end.
"""
from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from s2sad import tree
from s2sad.evaluate.specialize.control.branches import Objects
from s2sad.evaluate.specialize.control.decisions import bound_throughout
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator, operation
from s2sad.evaluate.specialize.signals import NOWHERE, Leave, Unbound, Unevaluated
from s2sad.evaluate.specialize.heap import Object
from s2sad.evaluate.specialize.control.joined_names import Way, parallel, plainly_named, same_things
from s2sad.evaluate.specialize.control.loop_closed_names import (
    close_names, forget_own_names, frames_around, read_outside,
)
from s2sad.evaluate.specialize.control.loop_homes import (
    Move, at_once, differing, home_of, moved, names_of, placed, size,
)
from s2sad.evaluate.specialize.control.state_joins import Join
from s2sad.evaluate.specialize.values import (
    NONE, Conflict, Data, FunctionValue, Reference, ResidualObject, TupleValue, Value, alike, constant, count, parts,
    renamed,
)
from s2sad.tree import AST

# -- loops that stay -------------------------------------------------------------------------------------------------
Homes = dict[tuple[int, Any], Any]


@dataclass
class ResidualLoop:
    """A loop of the residual program: the slots that its rounds change have one name each in all of them."""
    start: Objects
    is_endless: bool = False        # jumps alone leave it
    homes: Homes = field(default_factory=dict)
    listed: dict[tuple[int, Any], set[Any]] = field(default_factory=dict)   # those whose objects a residual list holds
    exits: list[tuple[AST, list[AST], Objects]] = field(default_factory=list)   # a jump, its block, its heap
    place: int = 0                  # on the stack of pending work
    goals: list[int] = field(default_factory=list)          # marks outside that it is left for
    left: Reference = Reference(0)                          # by mark: whether it was left for that, with what
    birth: int = 0                                          # the names that were made before it
    targets: frozenset[str] = frozenset()                   # the names that it binds itself

    def home_names(self) -> set[str]:
        return {n for home in self.homes.values() for n in names_of(home)}


class NewGoal(Exception):
    """A loop that stays is left for a mark outside, for the first time."""

    def __init__(self, loop: ResidualLoop, mark: int):
        super().__init__(mark)
        self.loop, self.mark = loop, mark


@operation
def leave(ev: Evaluator, s: AST, mark: int, value: Value | None) -> None:
    """Goes to a mark; out of a loop that stays by a flag and `break`, behind which it goes on."""
    inside = [loop for loop in ev.loops if isinstance(loop, ResidualLoop) and loop.place > mark]
    if not inside:
        raise Leave(mark, value)
    loop = inside[-1]
    if mark not in loop.goals:
        raise NewGoal(loop, mark)
    ev.heap.put(loop.left, ("left", mark), constant(True))
    if value is not None:
        ev.heap.put(loop.left, ("value", mark), ev.atoms(value, "result", s))
    jump = tree.at(tree.Break(), s)
    ev.emit(jump, s)
    loop.exits.append((jump, ev.block, ev.heap.fork()))
    raise Leave(NOWHERE)


@operation
def residual_loop(ev: Evaluator, origin: AST, once: Callable[[], Callable[[list[AST]], AST]], f: Frame) -> None:
    """Evaluates the body until what holds at its start holds at its end; `once` gives what makes the loop of a body."""
    left = ev.heap.new(Object("frame"))
    loop = ResidualLoop(ev.heap.fork(), place=len(ev.pending), left=left, birth=ev.births)
    outer, before, guarded, depth = ev.block, ev.snapshot(), ev.guarded, (len(ev.pending), len(ev.loops))
    around = ev.residual
    while True:
        prelude: list[AST] = []
        ev.heap.objects, ev.block = dict(loop.start), []
        _at_home(ev, loop, prelude, origin)
        head = dict(ev.heap.objects)
        loop.exits.clear()
        ev.loops.append(loop)
        ev.pending.append(None)
        falls, read = True, len(ev.unfilled)
        ev.guarded, ev.residual = (*guarded, frozenset()), (*around, origin)
        try:
            make = once()
        except (Unbound, NewGoal) as missing:
            _extend(ev, loop, missing)
            ev.block = outer
            ev.restore(before)
            ev.names.taken |= loop.home_names()
            continue
        except Leave as leave:
            if leave.mark != NOWHERE:
                raise ev.refusal(origin, "a loop is left for a place outside of it that is written out",
                                 help="return once, behind the loop") from None
            falls, make = False, getattr(loop, "make", None)
        finally:
            ev.guarded, ev.residual = guarded, around
            del ev.pending[depth[0]:], ev.loops[depth[1]:]
        body = ev.block
        ends = [*([ev.heap.objects] if falls else []), *(objects for _, _, objects in loop.exits)]
        forget_own_names(ev, head, ends, origin, f)
        names, ev.names = ev.names, before.names.copy()
        ev.names.taken |= loop.home_names()
        again = _are_filled(ev, read)
        if not _settle(ev, loop, head, ends, origin) and not close_names(ev, loop, head, ends, origin, f) and not again:
            ev.names = names
            break
        ev.block = outer
        ev.restore(before)
        ev.names.taken |= loop.home_names()
    ev.block = outer
    kept: dict[str, str] = {}
    ways = [Way(ev.heap.objects, _moves(ev, loop, ev.heap.objects, origin, kept))] if falls else []
    ways += [Way(objects, _moves(ev, loop, objects, origin, kept)) for _, _, objects in loop.exits]
    late = _bound_on_exits(ev, loop, ways, head, origin, f)
    if falls:
        body += ways.pop(0).block
    for way, (jump, block, _) in zip(ways, loop.exits):
        at = next(k for k, n in enumerate(block) if n is jump)
        block[at:at] = way.block
    ev.block += prelude
    assert make is not None
    ev.emit(make(body or [tree.at(tree.Pass(), origin)]), origin, True)
    last = ends[0] if ends else {}
    after = {**head, **{n: o for n, o in last.items() if n not in head}}
    for (n, key), home in loop.homes.items():
        old = loop.start[n].items.get(key, NONE)
        value = ev.as_listed(placed(ev, loop.start, old, home, origin, after), after, loop.listed.get((n, key)))
        after[n] = _with(after[n], key, _known_on_exits(value, [o[n].items[key] for _, _, o in loop.exits])
                         if loop.is_endless else value)
    ev.heap.objects = {**after, **late.found}
    for n, values in late.values.items():
        for key, value in values.items():
            ev.heap.put(Reference(n), key, value)
    _bound_inside(ev, ends)
    _go_on(ev, loop, late.left, origin)


def _are_filled(ev: Evaluator, first: int) -> bool:
    """Whether something was put into lists that a round has read before."""
    filled = [r for r in ev.unfilled[first:] if r.known.form is not None]
    ev.unfilled[first:] = [r for r in ev.unfilled[first:] if r.known.form is None]
    return bool(filled)


def _extend(ev: Evaluator, loop: ResidualLoop, missing: Unbound | NewGoal) -> None:
    """The loop with what it was found to lack."""
    if isinstance(missing, Unbound):
        if (missing.frame, missing.name) in loop.homes:
            raise missing.error from None
        home = loop.homes[missing.frame, missing.name] = ev.fresh(missing.name)
        ev.unsure.add(home)
    elif missing.loop is not loop:
        raise missing
    else:
        loop.goals.append(missing.mark)
        held = loop.start[loop.left.number]
        loop.start[loop.left.number] = _with(held, ("left", missing.mark), constant(False))


def _go_on(ev: Evaluator, loop: ResidualLoop, values: Mapping[Any, Value], origin: AST) -> None:
    """Behind a loop that may have been left for marks outside of it."""
    items = ev.heap.objects.pop(loop.left.number).items
    for mark in loop.goals:
        flag, value = items["left", mark], values.get(("value", mark), items.get(("value", mark)))    # or at home

        def going(mark: int = mark, value: Value | None = value) -> None:
            ev.leave(origin, mark, None if value is None else bound_throughout(ev, value))
        assert isinstance(flag, Data)
        if flag.known is True:
            going()
        elif not flag.is_known:
            ev.branch(flag, (going, lambda: None), origin)


@dataclass(frozen=True)
class _Late:
    values: dict[int, dict[Any, Value]]         # by frame and name
    left: dict[Any, Value]          # what goes to marks outside
    found: Objects


def _bound_on_exits(ev: Evaluator, loop: ResidualLoop, ways: Sequence[Way], head: Objects, origin: AST, f: Frame
                    ) -> _Late:
    """What only some ends of a round bind, and the function reads behind the loop."""
    join = Join(ev, ways, origin, begun=loop.birth)
    late: dict[int, dict[Any, Value]] = {}
    for number in (*frames_around(ev, f), loop.left.number):
        if number not in head:
            continue
        late[number] = {}
        new = {k for w in ways if number in w.objects for k in w.objects[number].items} - head[number].items.keys()
        wanted = read_outside(ev, number, new, origin, f) if new else ()
        ends = [w.objects[number].items for w in ways if number in w.objects]
        for key in dict.fromkeys(k for items in ends for k in items):
            there = [(w, items[key]) for w, items in zip(ways, ends) if key in items]
            same = len(there) == len(ways) and all(
                same_things(there[0][0].objects, there[0][1], w.objects, v) for w, v in there[1:])
            is_read = number == loop.left.number or key in wanted and not same
            if is_read and key not in head[number].items:
                late[number][key] = join.bound_on(there, "result" if isinstance(key, tuple) else str(key))
    left = late.pop(loop.left.number)
    return _Late(late, left, join.found)


def _with(held: Object, key: Any, value: Value) -> Object:
    return replace(held, items={**held.items, key: value})


def _stays(value: Value) -> bool:
    """Whether what a round binds is there behind the loop: numbers and arrays, also in tuples, plain functions."""
    plain = isinstance(value, FunctionValue) and not parts(value)
    return plain or isinstance(value, (Data, TupleValue, ResidualObject))


def _bound_inside(ev: Evaluator, ends: Sequence[Objects]) -> None:
    """Names that are bound in every round are there behind the loop, too, as what the last round has left."""
    for n, held in list(ev.heap.objects.items()):
        if held.kind != "frame":
            continue
        found = [end[n].items for end in ends if n in end]
        more = {k: v for items in found for k, v in items.items() if k not in held.items
                and (_stays(v) or isinstance(v, Reference))
                and all(k in end[n].items and same_things(ends[0], v, end, end[n].items[k])
                        for end in ends if n in end)}
        for key, value in more.items():
            ev.heap.put(Reference(n), key, plainly_named(value))
            ev.unsure |= _names_in(ev, value)


def _names_in(ev: Evaluator, value: Value) -> set[str]:
    """The names of what a value is, and of what lies in it."""
    found, left, seen = set[str](), [value], set[int]()
    while left:
        one = left.pop()
        if isinstance(one, Data):
            found |= {one.name} if one.name else set()
        elif not isinstance(one, Reference):
            left += parts(one)
        elif one.number not in seen:
            seen.add(one.number)
            left += ev.heap[one].items.values()
    return found


def _known_on_exits(value: Value, ends: Sequence[Value]) -> Value:
    """What is known of a value behind a loop that only its exits leave."""
    known = [v.known for v in ends if isinstance(v, Data)]
    if isinstance(value, Data) and known and all(isinstance(k, bool) and k == known[0] for k in known):
        return replace(value, known=known[0])
    return value


def _at_home(ev: Evaluator, loop: ResidualLoop, prelude: list[AST], origin: AST) -> None:
    """What has a home holds it when a round begins."""
    moves: list[Move] = []
    for (n, key), home in loop.homes.items():
        old = loop.start[n].items.get(key)
        if old is None:         # bound in the loop, and read in a later round
            ev.heap.put(Reference(n), key, Data(tree.at(tree.name(home), origin)))
            continue
        if isinstance(old, Data) and old.may_be_unbound and old.name != home:
            raise ev.refusal(origin, f"'{key}' is bound on some ways only before this loop", help="bind it on all")
        moves += moved(ev, loop.start, old, home, origin)
        value = placed(ev, loop.start, old, home, origin, ev.heap.objects)
        ev.heap.put(Reference(n), key, ev.as_listed(value, ev.heap.objects, loop.listed.get((n, key))))
    prelude += at_once(ev, moves, origin)


def _moves(ev: Evaluator, loop: ResidualLoop, objects: Objects, origin: AST, kept: dict[str, str]) -> list[AST]:
    """What slots with homes hold at the end of a round goes there; what else holds what was there keeps it under a name
    of its own (`kept`)."""
    found = [m for (n, key), home in loop.homes.items() if n in objects
             for m in moved(ev, objects, objects[n].items[key], home, origin)]
    targets = {m.target for m in found if not (isinstance(m.value, tree.Name) and m.value.id == m.target)}
    saved = []
    for n, held in list(objects.items()):
        changed = {}
        for key, value in held.items.items():
            for t in targets if (n, key) not in loop.homes else ():
                if count(value, t):
                    new = kept.setdefault(t, ev.fresh(t)) if t not in kept else kept[t]
                    saved.append((new, tree.at(tree.name(t), origin)))
                    changed[key] = renamed(changed.get(key, value), {t: new})
        if changed:
            objects[n] = replace(held, items={**held.items, **changed})
    return [*parallel(list(dict(saved).items()), origin), *at_once(ev, found, origin)]


def residual_site(ev: Evaluator, *held: tuple[Objects, Value]) -> Any:
    """The site of a list that must be one at run time, as what takes its place is, or has another length; None of
    other values."""
    lists = [o.get(v.number) for o, v in held if isinstance(v, Reference)]
    own = [found for found in lists if found is not None and found.kind == "list"]
    residual = sum(isinstance(v, Data) and v.is_list for _, v in held)
    if len(own) + residual < len(held) or not residual and len({len(found.items) for found in own}) == 1:
        return None
    return next((found.site for found in own if found.site is not None and id(found.site) not in ev.sites), None)


def _settle(ev: Evaluator, loop: ResidualLoop, head: Objects, ends: Sequence[Objects], origin: AST) -> bool:
    """Gives homes to slots that a round changes; whether there are new ones."""
    for objects in (loop.start, head, *ends):
        ev.fill(objects)
    found = False
    for end in ends:
        for n, held in head.items():
            if n not in end or held.kind in ("list", "set", "dict") and list(end[n].items) != list(held.items) or (
                    held.kind == "record" and held.items.keys() != end[n].items.keys()):
                raise ev.unknown(origin, f"'{held.label or 'a ' + held.kind}' is another structure after each round",
                                 help="make it before the loop, and assign its items", site=held.site)
    for end in ends:
        for n, held in head.items():
            if end[n] is held or n not in loop.start:   # a slot with a home says where the items of what it has go
                continue
            for key, old in held.items.items():
                new = end[n].items[key]
                if alike(old, new) or isinstance(old, Conflict):
                    continue
                if (sites := ev.listed_sites(new)) is not None and (n, key) not in loop.listed:
                    loop.listed[n, key] = sites
                    found = True
                had = loop.homes.get((n, key))
                loop.homes[n, key] = _home(ev, loop, head, (n, key), (end, new), origin)
                found |= size(loop.homes[n, key]) != size(had)
    return found


def _home(ev: Evaluator, loop: ResidualLoop, head: Objects, slot: tuple[int, Any], new: tuple[Objects, Value],
          origin: AST) -> Any:
    """The home of a slot that a round changes, with room for what it holds behind it."""
    n, key = slot
    had, old, wanted = loop.homes.get(slot), head[n].items[key], head[n].name_of(key)
    first = loop.start, loop.start[n].items.get(key, old)
    if (site := residual_site(ev, first, new)) is not None:
        raise ev.unknown(origin, f"'{key}' is another list in each round", site=site,
                         help="make it before the loop, and assign its items")
    differs = differing(ev, had, first if had is None else (head, old), new, wanted)
    if isinstance(new[1], Conflict) or differs is not None and differs[0] not in ev.choices:
        name, before = differs or (wanted, first[1])
        begins = had is None and isinstance(before, Data) and before.known is None
        error = ev.refusal(origin, f"'{key}' is another structure in each round")
        raise Unevaluated(error, differs=begins, choice=name)
    return home_of(ev, had, first, new, wanted, origin)
