"""The evaluator: one program on its way to its residual program.

What is known is computed; what is not is emitted, statement by statement, into `block`. The transfer function of each
construct of Python stands in a table by the name of its node: `EXPRESSIONS`, `STATEMENTS`. Every slot of the heap holds
names and constants: a residual name is bound anew only while one slot alone holds it.
"""
from __future__ import annotations

import difflib
import functools
import re
from collections.abc import Callable, Hashable, Sequence
from dataclasses import replace
from typing import Any, NoReturn

from s2sad import tree
from s2sad.diagnostics import Diagnostic, S2sadError, Source
from s2sad.diagnostics import Span as Place
from s2sad.evaluate.specialize.control.choice_joins import are_functions
from s2sad.evaluate.specialize.evaluation_state import Cell, Frame, Snapshot
from s2sad.evaluate.specialize.heap import Heap, Object, Temporary
from s2sad.evaluate.specialize.operations import Operations
from s2sad.evaluate.specialize.signals import NOWHERE, Leave, OutsideError, Undecided, Unevaluated
from s2sad.evaluate.specialize.values import (
    Choice, Conflict, Data, FunctionValue, Iteration, MethodValue, OpaqueValue, Reference, ResidualObject,
    SliceValue, TupleValue, Value, constant, count, parts,
)
from s2sad.naming import Names, identifier
from s2sad.program import Fact
from s2sad.read.outside_values import Captured, Meaning
from s2sad.read.outside_values import Library as LibraryMeaning
from s2sad.tree import AST

LARGEST = 20_000        # statements of a residual function
UNROLL_LIMIT = 24       # rounds of a loop that is written out where it would stay one with lists of the run, or choices
LARGEST_UNROLLED = 4_000        # where loops are written out for want of anything better


Pending = tuple[Callable[[], None], tuple[Any, ...]]        # work, and the loops around it
EXPRESSIONS: dict[str, Callable[[Evaluator, Any, Frame], Value]] = {}
STATEMENTS: dict[str, Callable[[Evaluator, Any, Frame], None]] = {}


def expression(*kinds: str) -> Callable[[Any], Any]:
    """Registers the transfer function of a kind of expression."""
    def register(function: Any) -> Any:
        for kind in kinds:
            EXPRESSIONS[kind] = function
        return function
    return register


def statement(*kinds: str) -> Callable[[Any], Any]:
    """Registers the transfer function of a kind of statement."""
    def register(function: Any) -> Any:
        for kind in kinds:
            STATEMENTS[kind] = function
        return function
    return register


def operation(function: Any) -> Any:
    """Makes a function one that others call through the evaluator."""
    setattr(Evaluator, function.__name__, function)
    return function


def _not_said() -> None:
    """How many items a starred operand must have, where nothing says that."""


class Evaluator(Operations):
    """The state of one evaluation; `facts` are what is known of arguments, `sites` the nodes whose lists are residual,
    or the places of lists that are given. Where it `unrolls`, no list is: loops are written out. Where it `inlines`, so
    are all calls.

    The operations that transfer functions share are methods, each defined where its subject is (`operation`).
    """

    def __init__(self, source: Source, facts: dict[Fact, Any], sites: frozenset[int | str],
                 unrolls: bool = False, inlines: bool = False, cells: frozenset[str] = frozenset(),
                 choices: frozenset[str] = frozenset(), unroll_limit: float = UNROLL_LIMIT):
        self.source, self.facts, self.sites, self.unrolls, self.inlines = source, facts, sites, unrolls, inlines
        self.cell_paths, self.cells = cells, list[Cell]()
        self.choices = choices          # the slots that may hold choices of other things than functions
        self.found_none: frozenset[Any] = frozenset()       # the slots that hold None of several things, in a statement
        self.decisions = 0              # how often a statement was evaluated for one of several things
        self.unroll_limit = unroll_limit            # rounds of a loop that is written out though it may stay one
        self.may_stay = False           # a loop around would stay one with a list of the run or a choice
        self.stayed = False             # and did, for its rounds are many
        self.unrolled_loops: dict[AST, int] = {}    # those that are written out, and how often
        self.heap, self.names = Heap(), Names()
        self.births, self.born = 0, dict[str, int]()       # when each residual name was made
        self.block: list[AST] = []
        self.effects = 0
        self.rebound: list[str] = []
        self.pending: list[Pending | None] = []     # work that follows, outermost first; None is a mark
        self.outside: dict[str, Meaning] = {}                   # what residual names of things outside mean
        self.frames: dict[int, Frame] = {}
        self.loaded: dict[int, Captured] = {}                   # functions by id
        self.leaves: set[str] = set()                           # parameters that arguments' objects hold
        self.grown: set[str] = set()                            # the places of given lists that are residual
        self.paths: dict[str, str] = {}                         # what a user calls each parameter
        self.texts: set[str] = set()                            # parameters that are texts, not known yet
        self.given: dict[int, Object] = {}                      # arguments' objects as they are given
        self.entry: Frame | None = None
        self.modules: dict[str, Frame] = {}                     # the frames of files that are not run
        self.of_files: dict[Any, Any] = {}                      # what is evaluated there
        self.evaluates_module = False
        self.outset: dict[int, Object] = {}                     # objects from outside as they are before the run
        self.layouts: dict[int, Any] = {}                   # of classes that are defined here, by number
        self.annotated: dict[int, dict[str, AST]] = {}      # the annotations in their bodies
        self.live: dict[int, Value] = {}                    # objects of modules, by id
        self.assigned_attributes: set[Any] = set()          # of classes from outside, that the kernel assigns
        self.assigned_classes: dict[type, Reference] = {}   # where these attributes are
        self.held: list[Any] = []
        self.loops_of: dict[Any, Any] = {}                      # the loops of comprehensions
        self.loops: list[Any] = []                              # residual loops around
        self.returned: list[tuple[AST, Value, dict[int, Object]]] = []
        self.depth = self.emitted = 0
        self.residual: tuple[AST, ...] = ()                 # the loops around that stay, those of callers, too
        self.endless: list[AST] = []                        # the loops with which a recursion had no end
        self.guarded: tuple[frozenset[Fact], ...] = ()      # residual branches and loops around: what would decide them
        self.owning = False                                 # what is taken from outside now belongs to a bound object
        self.wanted: dict[AST, tuple[str, AST]] = {}        # what gets a name, that name and the statement
        self.called = self.label = ""                       # the function that is called; what a new object is for
        self.in_lists: dict[int, set[Any]] = {}     # objects in lists of the residual program, with where such are made
        self.object_sites: frozenset[int] = frozenset()         # where objects are made that are rows of tables
        self.object_tables: dict[Any, Any] = {}                 # by their make
        self.prefers_choices = False        # a slot with one of many objects holds a choice
        self.unfilled: list[Any] = []       # of lists that were read before anything was put there (`ListedRecords`)
        self.unsure: set[str] = set()       # names of the residual program that may be read before they are bound
        self.limited: list[AST] = []                            # where deques with a length are made
        self.row_forms: dict[int, Any] = {}                     # by their site what is in such lists
        self.touched: set[int] = set()                          # objects that are changed
        self.targets: tuple[str, ...] = ()                      # the names that take what a call gives
        self.tables: dict[Any, tuple[str, AST]] = {}            # arrays of numbers that are known, by these
        self.outside_tables: dict[Any, Any] = {}
        self.spread: set[AST] = set()                           # the expressions of which only items are taken
        self.returns: Callable[[AST, Value, Frame], None] = self.return_from_entry
        self.separate: Any = None                               # the functions that stay functions
        self.shared_sequence: Any = None                        # of random numbers, where the program has begun it
        self.handlers: list[Any] = []                           # of exceptions, around
        self.mentioned: dict[int, frozenset[str]] = {}          # the names in functions' texts

    # -- errors ------------------------------------------------------------------------------------------------------
    def refusal(self, node: AST, message: str, help: str = "", code: str = "S201") -> S2sadError:
        place = Place.of(self.source, node) if getattr(node, "lineno", None) else None
        return S2sadError(Diagnostic(code, message, place, help=help))

    def outside_error(self, node: AST, message: str, help: str = "", code: str = "S201") -> OutsideError:
        return OutsideError(*self.refusal(node, message, help, code).diagnostics)

    def missing(self, node: AST, owner: str, name: str, known: Sequence[str]) -> OutsideError:
        """Something from outside does not have what is read of it; `name` is as it is written behind the owner."""
        close = difflib.get_close_matches(name, known, 1, 0.7)
        help = f"did you mean '{owner}{close[0]}'?" if close else f"define it in '{owner}', or correct the name"
        plain = name.strip("[].'\"")
        return self.outside_error(node, f"'{owner}' has no '{plain}'", help, "S202")

    def unknown(self, node: AST, message: str, value: Value | None = None, help: str = "", site: Any = None,
                code: str = "S201") -> Unevaluated:
        """What must be known and is not."""
        demands = value.demands if isinstance(value, (Data, OpaqueValue, Conflict)) else frozenset()
        return Unevaluated(self.refusal(node, message, help, code), demands, site)

    def change(self, reference: Reference, node: AST) -> Object:
        """The object, which is about to be changed."""
        held = self.heap[reference]
        if reference.number in self.in_lists:
            raise self.changed_in_list(reference.number, node)
        self.touched.add(reference.number)
        if not held.is_owned:
            raise self.outside_error(node, f"'{held.label}' is from outside, and is changed", "pass it as an argument")
        return held

    # -- the residual program ----------------------------------------------------------------------------------------
    def emit(self, node: AST, origin: AST, effect: bool = False) -> None:
        self.block.append(tree.at(node, origin))
        self.effects += effect
        self.emitted += 1
        largest = LARGEST_UNROLLED if self.unrolls else LARGEST
        if self.emitted > largest:
            raise self.refusal(origin, f"more than {largest} statements are left when what is known is evaluated",
                               help="let loops run over arrays, or make fewer objects")

    def is_sure(self) -> bool:
        """Whether the kernel comes here whenever it runs."""
        return not self.guarded and not self.returned

    def raises(self, name: str, arguments: Sequence[AST], node: AST) -> NoReturn:
        """An exception of the residual program's, which ends this way."""
        self.raised_in_runs(name, node)
        self.emit(tree.Raise(tree.call(self.library(name), *arguments), None), node, True)
        raise Leave(NOWHERE)

    def library(self, path: str) -> str:
        """The residual name of something of a library."""
        self.outside.setdefault(path, LibraryMeaning(path))
        return path

    def fresh(self, wanted: str) -> str:
        new = self.names.numbered(identifier(wanted))
        self.born[new] = self.births = self.births + 1
        return new

    def named(self, value: Data, wanted: str, origin: AST) -> Data:
        """The value under a name, or as it is if it is a name or a constant."""
        if value.is_atom:
            return value
        if value.is_known and is_spelled(value.known) and not value.name:
            return constant(value.known)
        if (part := self.copied_part(value, wanted, origin)) is not None:
            return part
        new = self.fresh(wanted)
        self.emit(tree.assign(new, value.node), origin)
        return replace(value, node=tree.at(tree.name(new), origin))

    def atoms(self, value: Value, wanted: str, origin: AST) -> Value:
        """A value as the heap holds it: expressions under names."""
        if isinstance(value, Data):
            return self.named(value, wanted, origin)
        if isinstance(value, TupleValue):
            return replace(value, row=None, items=tuple(self.atoms(v, f"{wanted}_{k}", origin) for k, v in enumerate(
                value.items)))
        if isinstance(value, ResidualObject):
            return replace(value, number=self.named(value.number, wanted, origin))
        if isinstance(value, (SliceValue, Iteration)):
            return replace(value, parts=tuple(self.atoms(v, wanted, origin) for v in value.parts))  # pyright: ignore
        if isinstance(value, MethodValue):
            return replace(value, base=self.atoms(value.base, wanted, origin))
        return value

    def assign_slot(self, holder: Reference, key: Hashable, value: Value, wanted: str, origin: AST) -> None:
        """A slot of the heap gets a value; an expression is bound to the name that it alone holds, or a new one."""
        if isinstance(value, Data) and (part := self.copied_part(value, wanted, origin)) is not None:
            value = part
        elif isinstance(value, Data) and not value.is_atom and not (value.is_known and is_spelled(value.known)):
            old = self.heap[holder].items.get(key)
            own = old.name if isinstance(old, Data) and self.owns(old.name) else ""
            if own:
                self.rebound.append(own)
                self.effects += 1
            else:
                own = self.fresh(wanted)
            self.emit(tree.assign(own, value.node), origin)
            value = replace(value, node=tree.at(tree.name(own), origin))
        self.heap.put(holder, key, self.atoms(value, wanted, origin))

    def owns(self, name: str) -> bool:
        """Whether a residual name may be bound anew: the program's own, held by one slot."""
        return bool(name) and "." not in name and name not in self.leaves and self.heap.uses(name) == 1

    def later(self, work: Callable[[], None]) -> None:
        """Work that follows what is evaluated now."""
        self.pending.append((work, tuple(self.loops)))

    # -- evaluation --------------------------------------------------------------------------------------------------
    def value(self, node: AST, f: Frame) -> Value:
        """What an expression gives, as one thing: raises Undecided where it is one of several."""
        since = self.emitted, self.heap.changes
        return self.one(self.carried(node, f), node, since)

    def one(self, value: Value, node: AST, since: tuple[int, int] = (-1, -1)) -> Value:
        """The value, which must be one thing, or one of several functions."""
        if isinstance(value, Choice) and not are_functions(value.values):
            raise Undecided(node, value, since)
        return value

    def carried(self, node: AST, f: Frame) -> Value:
        """What an expression gives, which is carried along: it may be a choice."""
        if self.choices and (slot := Temporary("decided", id(node))) in self.heap[f.reference].items:
            return self.heap[f.reference].items[slot]       # found before the statement that it is in
        transfer = EXPRESSIONS.get(type(node).__name__)
        if transfer is None:
            raise self.refusal(node, f"{_spelled_kind(node)} is not supported in a kernel")
        found = transfer(self, node, f)
        if isinstance(found, Conflict):
            raise Unevaluated(self.refusal(node, found.what, found.help), found.demands, choice=found.choice)
        if isinstance(found, Data) and found.name:      # what is said of it is about where it is read
            return replace(found, node=tree.at(tree.name(found.name), node))
        return found

    def values(self, nodes: Sequence[AST], f: Frame, carries: bool = False,
               taken: Callable[[Value], int | None] = lambda first: None) -> list[Value]:
        """Operands from left to right, starred ones as tuples of their items; one that a later one's effects may change
        is held before them. They may be choices where they are carried along. `taken` says how many items a starred
        one must have, by the first operand."""
        evaluated = self.carried if carries else self.value
        found: list[Value] = []
        marks: list[tuple[int, int, int]] = []
        for node in nodes:
            if isinstance(node, tree.Starred):
                count = functools.partial(taken, found[0]) if found else _not_said
                found.append(TupleValue(tuple(self.starred_items(node, f, count))))
            else:
                found.append(evaluated(node, f))
            marks.append((len(self.block), self.effects, len(self.rebound)))
        for k in reversed(range(len(found))):
            at, effects, rebound = marks[k]
            if self.effects > effects:
                found[k] = self.held_at(found[k], at, {*self.rebound[rebound:]}, nodes[k])
        return found

    def starred_items(self, node: Any, f: Frame, taken: Callable[[], int | None]) -> list[Value]:
        """The items of a starred operand; of an array whose length nothing says as many as are taken."""
        value = self.value(node.value, f)
        shape = self.shape_of(value)
        told = not isinstance(value, Data) or value.is_known or value.count is not None or (
            shape.is_known or shape.demands)
        count = None if told else taken()
        if count is None or not isinstance(value, Data):
            return self.items_of(value, node, f)
        whole = self.named(value, "unpacked", node)
        self._raise_unless_as_long(whole, count, node)
        return [self.item_of(whole, constant(k), node, f) for k in range(count)]

    def _raise_unless_as_long(self, array: Data, count: int, node: AST) -> None:
        """Leaves the error of a call that is given an array of another length than it takes."""
        self.raised_in_runs("builtins.TypeError", node)
        test = tree.compare(tree.call("len", self.spelled(array, node)), tree.NotEq(), tree.const(count))
        text = tree.const(f"the call takes {count} items of its starred argument")
        error = tree.Raise(tree.call(self.library("builtins.TypeError"), text), None)
        self.emit(tree.If(test, [tree.at(error, node)], []), node, True)

    def held_at(self, value: Value, at: int, rebound: set[str], origin: AST) -> Value:
        """A value as it was at an earlier place of the block."""
        block, self.block = self.block, []
        try:
            kept = self._held(value, rebound, origin)
            block[at:at] = self.block
        finally:
            self.block = block
        return kept

    def _held(self, value: Value, rebound: set[str], origin: AST) -> Value:
        if isinstance(value, Data):
            if value.name in rebound or not value.is_atom:
                new = self.fresh("held")
                self.emit(tree.assign(new, value.node), origin)
                return replace(value, node=tree.at(tree.name(new), origin))
            return value
        if isinstance(value, TupleValue):
            return replace(value, row=None, items=tuple(self._held(v, rebound, origin) for v in value.items))
        if isinstance(value, ResidualObject):
            return replace(value, number=self._held(value.number, rebound, origin))
        if isinstance(value, (SliceValue, Iteration)):
            return replace(value, parts=tuple(self._held(v, rebound, origin) for v in value.parts))  # pyright: ignore
        if isinstance(value, MethodValue):
            return replace(value, base=self._held(value.base, rebound, origin))
        if isinstance(value, Choice) and any(count(value, name) for name in rebound):
            raise self.unknown(origin, "one of several things is bound anew before it is used",
                               help="give it another name first")
        return value

    def known(self, value: Value, node: AST, what: str) -> Any:
        """The constant that a value is; raises Unevaluated."""
        if isinstance(value, Data) and value.is_known:
            return value.known
        if isinstance(value, TupleValue):
            return tuple(self.known(v, node, what) for v in value.items)
        if isinstance(value, OpaqueValue):
            raise self.unknown(node, "what a text is made of must be known before the run", value)
        raise self.unknown(node, f"{what} must be known before the run", value)

    # -- going back --------------------------------------------------------------------------------------------------
    def snapshot(self) -> Snapshot:
        return Snapshot(self.heap.fork(), tuple(self.block), self.names.copy(), self.effects, len(self.rebound),
                        self.emitted, dict(self.unrolled_loops))

    def has_acted(self, before: Snapshot) -> bool:
        """Whether something was emitted since, or an object that was there holds something else."""
        return len(self.block) > len(before.block) or self.has_changed(before)

    def has_changed(self, before: Snapshot) -> bool:
        """Whether an object that was there holds something else."""
        return any(
            self.heap.objects.get(n) is not held for n, held in before.objects.items())

    def restore(self, before: Snapshot) -> None:
        self.heap.objects = {**self.outset, **before.objects}
        self.block[:] = before.block
        self.names = before.names.copy()
        self.names.taken |= {name for name, _ in self.tables.values()}
        self.effects, self.emitted = before.effects, before.emitted
        del self.rebound[before.rebound:]
        self.unrolled_loops = dict(before.unrolled_loops)

    def note_outside(self, holder: Reference, name: str, value: Value) -> None:
        """An attribute of an object from outside is read for the first time: it was there from the start."""
        held = self.outset.get(holder.number)
        if held is not None:
            self.outset[holder.number] = replace(held, items={**held.items, name: value})

    def fill(self, objects: dict[int, Object]) -> None:
        """Adds to a state the attributes of objects from outside that were read after it was kept."""
        for number, held in self.outset.items():
            there = objects.get(number)
            if there is not None and there is not held and held.items.keys() - there.items.keys():
                objects[number] = replace(there, items={**held.items, **there.items})

    def contained(self, value: Value) -> bool:
        """Whether a value has references in it."""
        return isinstance(value, (Reference, FunctionValue)) or any(map(self.contained, parts(value)))


def is_spelled(known: Any) -> bool:
    """Whether a constant has a spelling of its own."""
    return known is None or known is ... or isinstance(known, (bool, int, str)) or (
        isinstance(known, float) and known == known and abs(known) != float("inf"))


def _spelled_kind(node: AST) -> str:
    return re.sub(r"(?<!^)(?=[A-Z])", " ", type(node).__name__).lower()
