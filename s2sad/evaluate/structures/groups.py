"""What expressions of a kernel stand for while structures are taken apart: a plain expression, a leaf or a group.

    state        Group of u, t          flat names state_u, state_t
    state.u      Leaf state_u
    state.t      Leaf state_t, or state_t[0] where the field is assigned (an array of one element: a cell)
    p is None    decided by what p is
"""
from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from s2sad.infer.types import NONE, UNKNOWN, Type
from s2sad.pytree import Form, PyTree, is_held, step
from s2sad.tree import AST, Constant, at, const, index, name, tuple_of

SPELLED = "the tuple"                   # the path of a tuple that is written out
CELL = "cell"                           # the kind of type of a number that lives in an array of one element


@dataclass(frozen=True)
class Plain:
    """An expression with no structure in it."""
    node: AST


@dataclass(frozen=True)
class Leaf:
    """An array, number or string of a structure, by its flat name; None and what cannot be used have none.

    `place` is the number of the kernel's flat parameter that it is, -1 for what the kernel made itself.
    """
    name: str
    path: str
    type: Type
    place: int = -1

    @property
    def is_cell(self) -> bool:
        return self.type.kind == CELL

    def read(self, origin: AST) -> AST:
        """The expression that reads it."""
        node = index(name(self.name), const(0)) if self.is_cell else name(self.name)
        return at(node, origin)


@dataclass(frozen=True)
class StructureValue:
    """A structure whose items are known."""
    form: PyTree
    items: tuple[Value, ...]
    path: str

    def item(self, key: str | int) -> Value:
        return self.items[self.form.keys.index(key)]


@dataclass(frozen=True)
class Conflict:
    """A name that is one structure on one way and something else on another."""


@dataclass(frozen=True)
class Ordinary:
    """A name that is bound to something with no structure in it."""


ORDINARY = Ordinary()
Value = Plain | Leaf | StructureValue
NOTHING = Leaf("", "", NONE)


def nothing(value: object) -> bool:
    """Whether a value is None, known when the kernel is compiled."""
    return isinstance(value, Leaf) and value.type.kind == "none" or (
        isinstance(value, Plain) and isinstance(value.node, Constant) and value.node.value is None)


def usable(value: Leaf) -> bool:
    """Whether a leaf has a flat name."""
    return is_held(value.type)


def spelled(value: Value, origin: AST) -> AST | None:
    """A value as an expression: a tuple or list of plain things is written out. None if it has no spelling."""
    if isinstance(value, Plain):
        return value.node
    if isinstance(value, Leaf):
        return value.read(origin) if usable(value) else None
    parts = [spelled(item, origin) for item in value.items]
    if value.form.kind not in ("tuple", "list", "named") or any(p is None for p in parts):
        return None
    return at(tuple_of(*[p for p in parts if p is not None]), origin)


def flat(value: Value) -> Iterator[Leaf | Plain]:
    """The leaves that take part, in order."""
    if isinstance(value, StructureValue):
        for item in value.items:
            yield from flat(item)
    elif isinstance(value, Plain) and not nothing(value) or isinstance(value, Leaf) and usable(value):
        yield value


def pattern(value: Value) -> Form:
    """What a helper must know of an argument: its structure, and what is None; UNKNOWN where it is an expression."""
    if isinstance(value, StructureValue):
        return replace(value.form, items=tuple(map(pattern, value.items)))
    if nothing(value):
        return NONE
    return value.type if isinstance(value, Leaf) else UNKNOWN


def listed(items: tuple[Value, ...], kind: str = "tuple") -> StructureValue:
    """Values as a tuple, or as a list."""
    return StructureValue(PyTree(kind, tuple(range(len(items))), (UNKNOWN,) * len(items), None, True), items, SPELLED)


def grouped(form: Form, path: str, leaf) -> Value:
    """The value of a parameter: `leaf(path, type)` gives each leaf."""
    if isinstance(form, Type):
        return leaf(path, form)
    return StructureValue(form, tuple(grouped(item, step(form, path, key), leaf) for key, item in zip(form.keys,
                                                                                                      form.items)),
                          path)
