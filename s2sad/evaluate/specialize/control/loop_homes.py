"""Homes: the names that slots have in all rounds of a loop that stays.

A slot that a round changes has names for its leaves, its own where nothing else has it. One that holds different things
in different rounds holds one of them by a number, and each of them has homes for its leaves.
"""
from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from s2sad import tree
from s2sad.evaluate.specialize.control.choice_joins import (
    alternatives, is_chosen, maybe_unbound, number_of, structure,
)
from s2sad.evaluate.specialize.control.joined_names import parallel
from s2sad.evaluate.specialize.evaluator import Evaluator
from s2sad.evaluate.specialize.heap import Object, uses
from s2sad.evaluate.specialize.sequences.known_shapes import shape as known_shape
from s2sad.evaluate.specialize.sequences.listed_records import hold_alike
from s2sad.evaluate.specialize.values import (
    Choice, Data, Reference, ResidualObject, TupleValue, Value, alike, parts, with_parts,
)
from s2sad.tree import AST, names

Objects = Mapping[int, Object]
MOST = 8        # times that a loop is found to hold yet another thing: each round holds its own


@dataclass(frozen=True)
class ChoiceHome:
    """The name of the number, and of each alternative a value as it was found, with its heap, and its homes."""
    number: str
    alternatives: tuple[tuple[Objects, Value, Any], ...]
    times: int = 0      # how often one was added


class NumberName(str):
    """The name of what is a number in all rounds."""


@dataclass(frozen=True)
class Move:
    """What a name of a home gets. Where a choice must hold an alternative for it to be there, `held` asks the choice
    before the moves, and `holds` the home behind them."""
    target: str
    value: AST
    held: AST | None = None
    holds: AST | None = None


def names_of(home: Any) -> list[str]:
    """All names of a slot's home."""
    if isinstance(home, ChoiceHome):
        return [home.number, *(n for _, _, h in home.alternatives for n in names_of(h))]
    return [home] if isinstance(home, str) else [n for h in (home or {}).values() for n in names_of(h)]


def size(home: Any) -> int:
    """How many names and alternatives a home has, those twice that may be arrays: what grows as more is found."""
    if isinstance(home, ChoiceHome):
        return 2 + sum(1 + size(h) for _, _, h in home.alternatives)
    return 2 - isinstance(home, NumberName) if isinstance(home, str) else sum(map(size, (home or {}).values()))


def _parts(objects: Objects, value: Value) -> list[tuple[Any, Value]] | None:
    if isinstance(value, (TupleValue, ResidualObject)):
        return list(enumerate(parts(value)))
    return list(objects[value.number].items.items()) if isinstance(value, Reference) else None


def _make(ev: Evaluator, objects: Objects, value: Value) -> Any:
    """What a structure that nothing else holds is made as, and of which items; None of what is no such structure."""
    if isinstance(value, ResidualObject):
        return value.table
    if isinstance(value, TupleValue):
        return "tuple", value.made, len(value.items)
    held = objects.get(value.number) if isinstance(value, Reference) else None
    if held is None or held.kind in ("frame", "class") or held.path or held.live is not None or isinstance(
            value, Reference) and not ev.is_listed(value) and ev.heap.holders(value, objects) > 1:
        return None     # one that others hold stays the one that it is
    return held.kind, held.made, tuple(held.items)


def shape(ev: Evaluator, objects: Objects, value: Value) -> Any:
    """What must be the same in all rounds: all but the names and numbers in it."""
    if isinstance(value, Data):
        special = value.is_known and (value.known is None or isinstance(value.known, str))
        return ("data", value.known if special else "")
    if isinstance(value, Choice):
        return "choice"
    make = _make(ev, objects, value)
    return value if make is None else (make, tuple(shape(ev, objects, v) for _, v in _parts(objects, value) or ()))


def differing(ev: Evaluator, had: Any, first: tuple[Objects, Value], new: tuple[Objects, Value], wanted: str
              ) -> tuple[str, Value] | None:
    """The innermost slot that holds different things in different rounds, by its name, and what it holds at first; None
    where all of them have their homes."""
    if isinstance(had, ChoiceHome) or shape(ev, *first) == shape(ev, *new):
        return None
    make = _make(ev, *first)
    if make is None or make != _make(ev, *new):
        return wanted, first[1]
    inner = zip(_parts(*first) or (), _parts(*new) or ())
    found = (differing(ev, (had or {}).get(k), (first[0], v), (new[0], other), f"{wanted}_{k}")
             for (k, v), (_, other) in inner)
    return next((slot for slot in found if slot is not None), None)


def home_of(ev: Evaluator, had: Any, first: tuple[Objects, Value], new: tuple[Objects, Value], wanted: str,
            origin: AST) -> Any:
    """Names for the leaves of a value that a round changes, its own where nothing else has it; None for the others."""
    objects, value = first
    inner, after = _parts(objects, value), dict(_parts(*new) or ())
    if isinstance(had, ChoiceHome) or isinstance(value, Choice) or isinstance(new[1], Choice) or differing(
            ev, None, first, new, wanted) == (wanted, value):
        return choice_home(ev, had, first, new, wanted, origin)
    if not hold_alike(value, new[1]):
        raise ev.refusal(origin, f"'{wanted}' is a list of other things in each round, or a deque of another length",
                         help="give each a name of its own")
    is_number = known_shape(new[1]) == ()
    if isinstance(had, str):
        return had if is_number else str(had)
    if inner is not None:
        return {k: home_of(ev, (had or {}).get(k), (objects, v), (new[0], after[k]), f"{wanted}_{k}", origin)
                for k, v in inner}
    if alike(value, new[1]):
        return None
    own = value.name if isinstance(value, Data) else ""
    plain = own and own not in ev.leaves and "." not in own and uses(objects, own) == 1
    name = own if plain else ev.fresh(wanted)
    return NumberName(name) if is_number and known_shape(value) == () else name


def placed(ev: Evaluator, objects: Objects, value: Value, home: Any, origin: AST, into: dict[int, Object]
           ) -> Value:
    """The value with its leaves at home."""
    if home is None:
        return value
    if isinstance(home, ChoiceHome):
        values = tuple(placed(ev, there, v, h, origin, into) for there, v, h in home.alternatives)
        return Choice(Data(tree.at(tree.name(home.number), origin)), tuple(map(maybe_unbound, values)),
                      (*range(len(values)),))
    if isinstance(home, str):
        node = tree.at(tree.name(str(home)), origin)
        known = () if isinstance(home, NumberName) else None
        return Data(node, demands=value.demands, is_list=value.is_list, rows=value.rows, shape=known) if isinstance(
            value, Data) else Data(node)
    inner = _parts(objects, value) or []
    items = {k: placed(ev, objects, v, home[k], origin, into) for k, v in inner}
    if isinstance(value, (TupleValue, ResidualObject)):
        return with_parts(value, [*items.values()])
    assert isinstance(value, Reference)
    made = ev.heap.new(replace(objects[value.number], items=items))
    into[made.number] = ev.heap.objects.pop(made.number) if into is not ev.heap.objects else ev.heap[made]
    return made


def moved(ev: Evaluator, objects: Objects, value: Value, home: Any, origin: AST) -> list[Move]:
    """What the names of a home get where the slot holds a value."""
    if home is None:
        return []
    if isinstance(home, ChoiceHome):
        return _moved_choice(ev, objects, value, home, origin)
    if isinstance(home, str):
        return [Move(str(home), tree.copy(value.node))] if isinstance(value, Data) else []
    return [m for k, v in _parts(objects, value) or [] for m in moved(ev, objects, v, home[k], origin)]


def choice_home(ev: Evaluator, had: Any, first: tuple[Objects, Value], new: tuple[Objects, Value], wanted: str,
                origin: AST) -> ChoiceHome:
    """The home of a slot that holds other things in other rounds: as it was, with what is new."""
    held = [new] if isinstance(had, ChoiceHome) else [first, new]
    return _with_alternatives(ev, had, held, wanted, first[0], origin)


def _with_alternatives(ev: Evaluator, had: Any, held: Sequence[tuple[Objects, Value]], wanted: str, start: Objects,
                       origin: AST) -> ChoiceHome:
    """A home, as it was, with room for these values."""
    known = had if isinstance(had, ChoiceHome) else ChoiceHome(ev.fresh(f"{wanted}_which"), ())
    before = [(objects, v) for objects, v, _ in known.alternatives]
    found, _ = alternatives(ev.heap, [*before, *held])
    if known.times > MOST or any(
            len({repr(shape(ev, objects, v)) for _, objects, v in one.held}) > 1 or not hold_alike(
                *(v for _, _, v in one.held)) for one in found):
        raise ev.unknown(origin, f"'{wanted}' is another structure in each round")
    homes = [h for _, _, h in known.alternatives]
    homes += [None] * (len(found) - len(before))
    for k, one in enumerate(found):
        for way, objects, value in one.held:
            if way >= len(before):
                homes[k] = _leaves(ev, homes[k], objects, value, wanted, start, origin)
    return ChoiceHome(known.number, tuple((one.held[0][1], one.held[0][2], h) for one, h in zip(found, homes)),
                      known.times + (len(found) > max(len(before), 1)))


def _leaves(ev: Evaluator, had: Any, objects: Objects, value: Value, wanted: str, start: Objects, origin: AST) -> Any:
    """A name for each number and array of a value, as it was found before; what others hold stays where it is."""
    if isinstance(value, Choice):
        return _with_alternatives(ev, had, [(objects, value)], wanted, start, origin)
    if isinstance(value, Data):
        if value.is_known and (value.known is None or isinstance(value.known, str)):
            return None
        if had is not None:
            return had
        own = value.name if objects is start else ""
        return own if own and own not in ev.leaves and "." not in own and uses(objects, own) == 1 else ev.fresh(wanted)
    if structure(ev.heap, objects, value) is not None:
        return {k: _leaves(ev, (had or {}).get(k), objects, v, f"{wanted}_{k}", start, origin)
                for k, v in _parts(objects, value) or []}
    if isinstance(value, Reference) and value.number not in start:
        raise ev.unknown(origin, f"'{wanted}' is an object of one round in another, and has another name there",
                         help="copy what is read of it later")
    return None


def _unbound(objects: Objects, value: Value) -> Iterator[str]:
    """The names in a value that some ways do not bind."""
    if isinstance(value, Data):
        yield from [value.name] if value.may_be_unbound else ()
    held = [v for _, v in _parts(objects, value) or []]
    for inner in [value.number, *value.values] if isinstance(value, Choice) else held:
        yield from _unbound(objects, inner)


def _moved_choice(ev: Evaluator, objects: Objects, value: Value, home: ChoiceHome, origin: AST
                  ) -> list[Move]:
    known = [(there, v) for there, v, _ in home.alternatives]
    _, places = alternatives(ev.heap, [*known, (objects, value)])
    found = [Move(home.number, tree.copy(number_of(value, places[-1], origin).node))]
    own = zip(value.numbers, value.values) if isinstance(value, Choice) else ((0, value),)
    for number, one in own:
        place = places[-1][number]
        moves = moved(ev, objects, one, home.alternatives[place][2], origin)
        unbound = {*_unbound(objects, one)}
        held, holds = is_chosen(value, number, origin), _is_held(home, place, origin)
        for m in moves:
            if not unbound - {m.target} & {*names(m.value)}:
                found.append(m)
            elif held is None:
                raise ev.refusal(origin, "what a loop carries is one of several things, and has other names on each "
                                 "way", help="bind it in one place of the loop")
            else:
                found.append(replace(m, held=_both(held, m.held), holds=_both(holds, m.holds)))
    return found


def _both(test: AST, inner: AST | None) -> AST:
    """Two tests, of which the inner one may be asked where the first one holds."""
    return test if inner is None else tree.at(tree.BoolOp(tree.And(), [test, inner]), test)


def _is_held(home: ChoiceHome, place: int, origin: AST) -> AST:
    return tree.at(tree.compare(tree.name(home.number), tree.Eq(), tree.const(place)), origin)


def at_once(ev: Evaluator, moves: Sequence[Move], origin: AST) -> list[AST]:
    """The statements of moves that happen at once; what is there for an alternative only is moved where that holds."""
    plain, tested = [m for m in moves if m.held is None], [m for m in moves if m.held is not None]
    written = {m.target for m in moves}
    before, behind = [], []
    for m in tested:
        value = tree.copy(m.value)
        if written & {*names(value)}:       # which another move overwrites
            kept = ev.fresh(m.target)
            before.append(tree.at(tree.If(tree.copy(m.held), [tree.at(tree.assign(kept, value), origin)], []), origin))
            value = tree.name(kept)
        behind.append(tree.at(tree.If(tree.copy(m.holds), [tree.at(tree.assign(m.target, value), origin)], []), origin))
    return [*before, *parallel([(m.target, m.value) for m in plain], origin), *behind]
