"""Abstract values: what the partial evaluator knows of each value of the user's program.

    Data(node, known)        what the residual program computes; `known` where it is a constant here as well
    TupleValue(items, made)       a tuple, or an object of a named tuple's class
    Reference(number)        a list, a dict, an object or a frame: its content lies in the heap; identity is the number
    FunctionValue(...)              a function of the user's with its frame, and what it was given
    LibraryValue(path)            something of numpy, math, ...
    ClassValue(...)               a class, live or defined in what is evaluated
    ResidualObject(number, table)   an object of which only the run knows which one it is: a row of a table
    ObjectValue(value)            a Python object that is compared by identity: a member of an enumeration, a type
    SliceValue(parts)              a slice
    Iteration(kind, parts)        range, zip, enumerate, ...: what a loop goes through, as lazily as Python does
"""
from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

from s2sad.live_objects.guards import same
from s2sad.program import Fact
from s2sad.read.outside_values import Captured
from s2sad.tree import AST, Constant, Name, UnaryOp, const


def value_of_key(key: Hashable) -> Value:
    """The value that a key was made of."""
    if isinstance(key, (Reference, FunctionValue, ObjectValue, ClassValue)):
        return key
    return TupleValue(tuple(map(value_of_key, key))) if isinstance(key, tuple) else constant(key)


LARGEST_SEQUENCE = 2 ** 14      # values of a tuple or a list, those in sequences within it counted one by one
FACTORY = "a key of our own: what makes missing values of a defaultdict"


class _Unknown:
    def __repr__(self) -> str:
        return "UNKNOWN"


UNKNOWN: Any = _Unknown()


@dataclass(frozen=True)
class Data:
    """An expression of the residual program; what is held in the heap is a name or a constant (`is_atom`). `origins`
    are the arguments of whose shapes its own is made."""
    node: AST = field(compare=False)
    known: Any = field(default=UNKNOWN, compare=False)
    demands: frozenset[Fact] = field(default=frozenset(), compare=False)    # what would make it known
    origins: frozenset[str] = field(default=frozenset(), compare=False)
    may_be_unbound: bool = field(default=False, compare=False)
    is_list: bool = field(default=False, compare=False)     # of the residual program
    rows: Any = field(default=None, compare=False)          # what the items of a list are made of (`ListedRecords`)
    shape: tuple[int | None, ...] | None = field(default=None, compare=False)       # lengths of axes, as far as known
    dtype: str = field(default="", compare=False)           # of an argument as it is given
    is_signed: bool = field(default=False, compare=False)   # an integer of a table with negative ones
    count: int | None = field(default=None, compare=False)      # of a tuple's items
    may_be_row: bool = field(default=False, compare=False)      # a tuple or a list, perhaps

    @property
    def is_known(self) -> bool:
        return self.known is not UNKNOWN

    @property
    def name(self) -> str:
        """The residual name that it is; "" for anything else."""
        return self.node.id if isinstance(self.node, Name) else ""

    @property
    def is_literal(self) -> bool:
        node = self.node.operand if isinstance(self.node, UnaryOp) else self.node
        return self.is_known and isinstance(node, Constant)

    @property
    def is_atom(self) -> bool:
        return isinstance(self.node, Name) or self.is_literal


@dataclass(frozen=True)
class TupleValue:
    """A tuple; `row` is the table that a variable has picked it from, and the place, before it has a name."""
    items: tuple[Value, ...]
    made: ClassValue | None = None
    row: tuple[Data, Value] | None = field(default=None, compare=False)

    @cached_property
    def count(self) -> int:
        """How many values are in it, those of tuples within tuples counted one by one."""
        return sum(i.count if isinstance(i, TupleValue) else 1 for i in self.items)


@dataclass(frozen=True)
class Reference:
    number: int


@dataclass(frozen=True)
class ResidualObject:
    """An object of which only the run knows which one it is: a row of an `ObjectTable`; identity is the number."""
    number: Data
    table: Any


@dataclass(frozen=True)
class FunctionValue:
    """A function: `key` tells one from another; `frame` is the number of the frame that it was defined in, `owner` the
    class in whose body it stands, `first` and `keywords` what it was given before."""
    captured: Captured = field(compare=False)
    key: Hashable = None
    frame: int | None = None
    owner: ClassValue | None = None
    first: tuple[Value, ...] = ()
    keywords: tuple[tuple[str, Value], ...] = ()
    defaults: tuple[tuple[str, Value], ...] = ()
    handle: Any = field(default=None, compare=False)    # the live function


@dataclass(frozen=True)
class LibraryValue:
    """Something of a library by its path; `first` and `keywords` are what a partial gave it."""
    path: str
    first: tuple[Value, ...] = ()
    keywords: tuple[tuple[str, Value], ...] = ()


@dataclass(frozen=True)
class Choice:
    """One of several values by a number that only the run knows: None or a number, one of two objects, of functions."""
    number: Data
    values: tuple[Value, ...]
    numbers: tuple[int, ...]        # of each value


@dataclass(frozen=True)
class MethodValue:
    """A method of a container (or of an array, a string), looked up and not called yet."""
    base: Value
    name: str


@dataclass(frozen=True)
class ClassValue:
    """A class: `live` is the class itself, or `number` that of the heap's object with its namespace."""
    name: str
    live: Any = None
    number: int = 0
    bases: tuple[ClassValue, ...] = ()

    def __eq__(self, other: object) -> bool:
        return isinstance(other, ClassValue) and self.live is other.live and self.number == other.number

    def __hash__(self) -> int:
        return hash((id(self.live), self.number))


@dataclass(frozen=True)
class SuperValue:
    """`super()`: the methods after a class in the order of those of an object's class."""
    after: ClassValue
    instance: Value


@dataclass(frozen=True)
class ObjectValue:
    value: Any = field(compare=False)
    key: Hashable = None


@dataclass(frozen=True)
class ScopeValue:
    """A module, or what else is reached as attributes."""
    name: str
    scope: Any = field(compare=False)


@dataclass(frozen=True)
class SliceValue:
    parts: tuple[Value, ...]        # three


@dataclass(frozen=True)
class Iteration:
    """What is gone through; `once` is the heap's object that says whether an iterator was already."""
    kind: str
    parts: tuple[Value, ...] = ()
    more: Any = field(default=None, compare=False)      # a generator's expression and frame
    once: Reference | None = field(default=None, compare=False)


@dataclass(frozen=True)
class OpaqueValue:
    """What may be carried along and printed, and nothing else: a text made of what is not known, the time of day."""
    what: str = "a text of what only the run knows"
    demands: frozenset[Any] = field(default=frozenset(), compare=False)


WITH_NONE = "an array with None in it"      # an OpaqueValue


@dataclass(frozen=True)
class Conflict:
    """What must not be asked for: one thing on one way and another on another, say; `demands` would make it known, or
    a choice between these things do (`choice` is what the slot is called)."""
    what: str = ""
    demands: frozenset[Any] = frozenset()
    help: str = ""
    choice: str = ""


Value = (Data | TupleValue | Reference | ResidualObject | FunctionValue | LibraryValue | Choice | MethodValue
         | ClassValue | SuperValue | ObjectValue | ScopeValue | SliceValue | Iteration | OpaqueValue | Conflict)


def constant(value: Any) -> Data:
    """A number, a string, None, ... that is known."""
    return Data(const(value), value)


NONE = constant(None)


def alike(a: Value | None, b: Value | None) -> bool:
    """Whether two values of the heap are the same: of names and constants by what they are."""
    if isinstance(a, Data) and isinstance(b, Data):
        if a.is_known != b.is_known or a.is_known and not same(a.known, b.known):
            return False
        if a.name or b.name:
            return a.name == b.name and (a.shape, a.dtype, a.rows) == (b.shape, b.dtype, b.rows)
        return a.is_known and a.is_literal and b.is_literal
    if type(a) is not type(b):
        return False
    if isinstance(a, ResidualObject) and isinstance(b, ResidualObject):
        return a.table is b.table and alike(a.number, b.number)
    if isinstance(a, TupleValue) and isinstance(b, TupleValue):
        return a.made == b.made and len(a.items) == len(b.items) and all(map(alike, a.items, b.items))
    if isinstance(a, (Iteration, SliceValue)) and isinstance(b, (Iteration, SliceValue)):
        same_kind = not isinstance(a, Iteration) or not isinstance(b, Iteration) or (
            a.kind == b.kind and a.more is b.more and a.once == b.once)
        return same_kind and len(a.parts) == len(b.parts) and all(map(alike, a.parts, b.parts))
    if isinstance(a, FunctionValue) and isinstance(b, FunctionValue):
        return (a.key, a.frame, a.owner) == (b.key, b.frame, b.owner) and len(a.first) == len(b.first) and all(
            map(alike, a.first, b.first)) and [k for k, _ in a.keywords] == [k for k, _ in b.keywords] and all(
            alike(x, y) for (_, x), (_, y) in zip(a.keywords, b.keywords))
    if isinstance(a, MethodValue) and isinstance(b, MethodValue):
        return a.name == b.name and alike(a.base, b.base)
    if isinstance(a, Choice) and isinstance(b, Choice):
        return a.numbers == b.numbers and all(map(alike, parts(a), parts(b)))
    return a == b


def parts(value: Value) -> tuple[Value, ...]:
    """The values directly inside an immutable one."""
    if isinstance(value, TupleValue):
        return value.items
    if isinstance(value, ResidualObject):
        return (value.number,)
    if isinstance(value, (Iteration, SliceValue)):
        return value.parts
    if isinstance(value, (FunctionValue, LibraryValue)):
        return (*value.first, *(v for _, v in value.keywords), *(
            v for _, v in value.defaults)) if isinstance(value, FunctionValue) else (*value.first, *(
                v for _, v in value.keywords))
    if isinstance(value, MethodValue):
        return (value.base,)
    if isinstance(value, Choice):
        return (value.number, *value.values)
    return (value.instance,) if isinstance(value, SuperValue) else ()


def with_parts(value: TupleValue | ResidualObject, items: Sequence[Any]) -> TupleValue | ResidualObject:
    """The value with other values directly inside."""
    return replace(value, number=items[0]) if isinstance(value, ResidualObject) else replace(
        value, items=tuple(items))


def count(value: Value, name: str) -> int:
    """How often a residual name is held in a value."""
    if isinstance(value, Data):
        return value.name == name
    return sum(count(v, name) for v in parts(value))


def renamed(value: Value, names: Mapping[str, str]) -> Value:
    """A value in which residual names are other ones."""
    if isinstance(value, Data):
        if value.name not in names:
            return value
        node = Name(names[value.name], value.node.ctx, None, None)
        node.__dict__.update({k: v for k, v in value.node.__dict__.items() if k.endswith(("lineno", "offset"))})
        return replace(value, node=node)
    if isinstance(value, (TupleValue, ResidualObject)):
        return with_parts(value, [renamed(v, names) for v in parts(value)])
    if isinstance(value, (Iteration, SliceValue)):
        return replace(value, parts=tuple(renamed(v, names) for v in value.parts))  # pyright: ignore
    if isinstance(value, (FunctionValue, LibraryValue)):
        return replace(value, first=tuple(renamed(v, names) for v in value.first), keywords=tuple(
            (k, renamed(v, names)) for k, v in value.keywords))
    if isinstance(value, MethodValue):
        return replace(value, base=renamed(value.base, names))
    if isinstance(value, Choice):
        number, *values = (renamed(v, names) for v in parts(value))
        return replace(value, number=number, values=tuple(values))
    return value


def demands_of(*values: Value) -> frozenset[Any]:
    return frozenset().union(*(v.demands for v in values if isinstance(v, (Data, OpaqueValue))))
