"""The parts of an evaluation's state: calls on their way, numbers of arguments that are assigned, places to go back to.
"""
from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import dataclass

from s2sad.evaluate.specialize.heap import Object
from s2sad.evaluate.specialize.values import ClassValue, Reference, Value
from s2sad.naming import Names
from s2sad.read.outside_values import Captured
from s2sad.tree import AST


@dataclass(frozen=True)
class Frame:
    """A call on its way: where its names are, what its function is, and where `return` goes."""
    reference: Reference
    captured: Captured
    outer: Frame | None = None
    owner: ClassValue | None = None
    is_entry: bool = False
    mark: int = -1
    loops: int = 0              # how many loops are around the call
    label: str = ""
    local: frozenset[str] = frozenset()
    nonlocals: frozenset[str] = frozenset()
    first: str = ""             # the first parameter: what `super()` is for
    yields: Callable[[Value], None] | None = None       # what is done with each item of a generator


@dataclass(frozen=True)
class Cell:
    """A number in an argument's object that is assigned: the residual parameter is an array of one element."""
    holder: int
    key: Hashable
    parameter: str


@dataclass(frozen=True)
class Snapshot:
    objects: dict[int, Object]
    block: tuple[AST, ...]
    names: Names
    effects: int
    rebound: int
    emitted: int
    unrolled_loops: dict[AST, int]
