"""sizes: how many bytes a stack takes for concrete arguments, computed from shapes without running the kernel.

Requires a derivative and the values of its kernel's arguments, as far as they are known. Names that are bound once,
outside of loops, are computed from what they are bound to; content that the kernel may have written is not known.
"""
from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from s2sad.liveness import base_name, targets
from s2sad.emit.layout import text
from s2sad.emit.stack_report import StackEntry
from s2sad.normalize.loops.hoist_allocations import is_allocation
from s2sad.tree import AST, Call, Name, call_name, calls_kernel, names, user_call, walk
from s2sad.units import Unit, Units

_BUILTINS = {"len": len, "range": range, "abs": abs, "min": min, "max": max, "int": int, "float": float, "bool": bool,
             "round": round, "__builtins__": {}}


class Unknown(Exception):
    """A size that is known only when the kernel runs."""


class Shape:
    """An array of which the shape is known and the content is not."""

    def __init__(self, shape: tuple[int, ...], dtype: Any):
        self.shape, self.dtype, self.ndim, self.size = shape, np.dtype(dtype), len(shape), math.prod(shape)

    def __len__(self) -> int:
        return self.shape[0]

    def __getitem__(self, key: Any) -> Any:
        raise Unknown


class SizeEvaluator:
    """The names of one kernel with their values where they are known."""

    def __init__(self, unit: Unit, arguments: Mapping[str, Any], constants: Mapping[str, Any]):
        self.unit, self.constants = unit, constants
        written = {p.id for k, p in enumerate(unit.function.args.args) if k in unit.summary.written}
        self.known = {n: Shape(v.shape, v.dtype) if n in written and isinstance(v, np.ndarray) else v
                      for n, v in arguments.items()}
        self.waiting: set[str] = set()

    def bytes(self, recorded: StackEntry) -> int | None:
        """The bytes of a stack, of one push if it grows; None if they are known only at run time."""
        try:
            return math.prod(max(0, int(self.value(factor))) for factor in recorded.factors)
        except (Unknown, ArithmeticError, TypeError, ValueError, LookupError, NameError, AttributeError):
            return None

    def value(self, node: AST) -> Any:
        """The value of an expression; raises Unknown."""
        if calls_kernel(node):
            raise Unknown
        space = {n: self.name(n) for n in names(node)}
        space |= {n.id[6:]: self.constants[n.id[6:]] for n in walk(node)
                  if isinstance(n, Name) and n.id.startswith("const.")}
        return eval(text(node), {**_BUILTINS, "np": np, "math": math}, space)  # our own text of a size, no call in it

    def name(self, name: str) -> Any:
        if name not in self.known:
            bound = self.unit.structure.bindings.get(name, [])
            if len(bound) != 1 or name in self.waiting or self.unit.structure.place(bound[0]).loops:
                raise Unknown
            self.waiting.add(name)
            self.known[name] = self.bound(bound[0])
        return self.known[name]

    def bound(self, statement: AST) -> Any:
        if isinstance(targets(statement)[0], Name) and not is_allocation(statement):
            return self.value(statement.value)
        like = call_name(statement.value) or ""
        first = statement.value.args[0]
        shape = self.value(first).shape if like.endswith("_like") else self.value(first)
        kind = self.unit.typing.table[targets(statement)[0].id]
        return Shape(tuple(shape) if isinstance(shape, tuple) else (int(shape),), kind.dtype)


def sizes_of(units: Units, entry: Unit, arguments: Mapping[str, Any]) -> dict[str, SizeEvaluator]:
    """The sizes of the entry and of every kernel that it calls (of its first call), by title."""
    constants = units.program.constants
    found = {entry.title: SizeEvaluator(entry, arguments, constants)}
    waiting = [entry]
    while waiting:
        unit = waiting.pop(0)
        for node in walk(unit.function.body):
            called = units.callee(node) if user_call(node) else None
            if called is not None and called.title not in found:
                found[called.title] = SizeEvaluator(called, _passed(found[unit.title], called, node), constants)
                waiting.append(called)
    return found


def _passed(caller: SizeEvaluator, called: Unit, node: Call) -> dict[str, Any]:
    """What is known of the arguments of a call."""
    values: dict[str, Any] = {}
    for parameter, argument in zip((p.id for p in called.function.args.args), node.args):
        try:
            value = caller.name(argument.id) if isinstance(argument, Name) else _part(caller, argument)
        except (Unknown, ArithmeticError, TypeError, ValueError, LookupError, NameError, AttributeError):
            continue
        values[parameter] = value
    return values


def _part(caller: SizeEvaluator, argument: AST) -> Any:
    """The value of an argument; of a part of an array that the kernel may write its shape alone."""
    kind = caller.unit.typing.of(argument)
    if not kind.is_array:
        return caller.value(argument)
    whole = caller.name(base_name(argument))
    shape = np.broadcast_to(np.zeros(()), whole.shape)
    space = {n: caller.name(n) for n in names(argument) if n != base_name(argument)}
    part = eval(text(argument), {**_BUILTINS, "np": np}, {**space, base_name(argument): shape})
    return Shape(part.shape, kind.dtype)
