"""Expressions of a generated text, evaluated without content: numbers where they are known, bounds where not, arrays as
shapes with the memory that their making takes, intermediate results included."""
from __future__ import annotations

import ast
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from s2sad.run.memory.abstract_arrays import (
    Array, KeptList, Meter, allocated, broadcast, elementwise, extent_of_slice,
)
from s2sad.run.memory.allocating_functions import called, product
from s2sad.run.memory.interval_arithmetic import (
    UNKNOWN, Between, joined, loops_of_values, negated, operated, truth, truth_value,
)

_MISFITS = (ArithmeticError, TypeError, ValueError, LookupError, AttributeError)
Call = Callable[[str, list[Any]], Any]


class Expressions:
    """The evaluation in one scope after the other: `call` runs a function of the text, of which `functions` has the
    names, `constants` the text's own."""

    def __init__(self, meter: Meter, functions: Mapping[str, Any], constants: Mapping[str, Any], call: Call):
        self.meter, self.functions, self.constants, self.call = meter, functions, constants, call
        self.names: dict[ast.expr, str] = {}

    def value(self, node: ast.expr, scope: Mapping[str, Any]) -> Any:
        """What an expression gives; what is not followed is not known."""
        try:
            found = getattr(self, f"_{type(node).__name__}", None)
            return UNKNOWN if found is None else found(node, scope)
        except _MISFITS:
            return UNKNOWN

    def _Constant(self, node: ast.Constant, scope: Mapping[str, Any]) -> Any:
        return node.value

    def _Name(self, node: ast.Name, scope: Mapping[str, Any]) -> Any:
        return scope[node.id] if node.id in scope else self.constants.get(node.id, UNKNOWN)

    def _Tuple(self, node: ast.Tuple, scope: Mapping[str, Any]) -> Any:
        return tuple([self.value(e, scope) for e in node.elts])

    _List = _Tuple

    def _UnaryOp(self, node: ast.UnaryOp, scope: Mapping[str, Any]) -> Any:
        value = self.value(node.operand, scope)
        if isinstance(value, Array):
            return elementwise(self.meter, [value])
        if isinstance(node.op, ast.Not):
            known = truth(value)
            return truth_value(loops_of_values(value)) if known is None else not known
        return negated(value) if isinstance(node.op, ast.USub) else value if isinstance(node.op, ast.UAdd) else UNKNOWN

    def _BinOp(self, node: ast.BinOp, scope: Mapping[str, Any]) -> Any:
        return self.operation(node.op, self.value(node.left, scope), self.value(node.right, scope))

    def operation(self, op: ast.operator, left: Any, right: Any) -> Any:
        """What a binary operation gives."""
        if isinstance(left, Array) or isinstance(right, Array):
            if isinstance(op, ast.MatMult):
                return product(self.meter, [left, right], {})
            float_ = isinstance(op, ast.Div) and all(
                v.dtype.kind in "biu" for v in (left, right) if isinstance(v, Array))
            return elementwise(self.meter, [left, right], np.float64 if float_ else None)
        if isinstance(left, tuple) and isinstance(right, tuple):
            return left + right
        return operated(type(op).__name__, left, right)

    def _Compare(self, node: ast.Compare, scope: Mapping[str, Any]) -> Any:
        values = [self.value(v, scope) for v in (node.left, *node.comparators)]
        if any(isinstance(v, Array) for v in values):
            return elementwise(self.meter, values, np.bool_)
        found = [operated(type(op).__name__, a, b) for op, a, b in zip(node.ops, values, values[1:])]
        return _connected(found, every=True)

    def _BoolOp(self, node: ast.BoolOp, scope: Mapping[str, Any]) -> Any:
        return _connected([self.value(v, scope) for v in node.values], isinstance(node.op, ast.And))

    def _IfExp(self, node: ast.IfExp, scope: Mapping[str, Any]) -> Any:
        known = truth(self.value(node.test, scope))
        if known is None:
            return either(self.value(node.body, scope), self.value(node.orelse, scope))
        return self.value(node.body if known else node.orelse, scope)

    def _Attribute(self, node: ast.Attribute, scope: Mapping[str, Any]) -> Any:
        if isinstance(node.value, ast.Name) and node.value.id == "np" and "np" not in scope:
            found = getattr(np, node.attr)
            return found if isinstance(found, (type, float, int)) else UNKNOWN
        value = self.value(node.value, scope)
        if not isinstance(value, Array):
            return UNKNOWN
        if node.attr in ("shape", "size", "dtype"):
            return getattr(value, node.attr)
        return {"ndim": len(value.shape), "T": value.view(value.shape[::-1]), "flat": value.view((value.size,)),
                "real": value.view(value.shape), "imag": value.view(value.shape)}.get(node.attr, UNKNOWN)

    def _Call(self, node: ast.Call, scope: Mapping[str, Any]) -> Any:
        args = [self.value(a, scope) for a in node.args]
        name = self.names.get(node.func) or self.names.setdefault(node.func, ast.unparse(node.func))
        if name in self.functions:
            return self.call(name, args)
        keywords = {k.arg: self.value(k.value, scope) for k in node.keywords if k.arg}
        if isinstance(node.func, ast.Attribute) and not name.startswith(("np.", "math.")):
            holder = self.value(node.func.value, scope)
            if isinstance(holder, KeptList):
                return holder.entry if node.func.attr == "pop" else UNKNOWN
            if isinstance(holder, Array):
                name, args = f"method {node.func.attr}", [holder, *args]
        return called(self.meter, name, args, keywords)

    # -- parts of arrays -----------------------------------------------------------------------------------------------

    def _Subscript(self, node: ast.Subscript, scope: Mapping[str, Any]) -> Any:
        base = self.value(node.value, scope)
        if isinstance(base, tuple):
            place = self.value(node.slice, scope)
            return base[place] if isinstance(place, int) else UNKNOWN
        if not isinstance(base, Array):
            return UNKNOWN
        parts = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
        return self.part(base, [self._subscript(p, scope) for p in parts])

    def _subscript(self, node: ast.expr, scope: Mapping[str, Any]) -> Any:
        if isinstance(node, ast.Slice):
            return slice(*(None if p is None else self.value(p, scope) for p in (node.lower, node.upper, node.step)))
        return self.value(node, scope)

    def part(self, base: Array, parts: list[Any]) -> Any:
        """What subscripts pick: a view, a number, or a copy where arrays pick."""
        taken = sum(len(p.shape) if isinstance(p, Array) and p.dtype == np.bool_ else 1 for p in parts
                    if p is not None and p is not Ellipsis)
        if Ellipsis in [p for p in parts if not isinstance(p, Array)]:
            place = next(k for k, p in enumerate(parts) if p is Ellipsis)
            parts = [*parts[:place], *[slice(None)] * (len(base.shape) - taken), *parts[place + 1:]]
        else:
            parts = [*parts, *[slice(None)] * (len(base.shape) - taken)]
        if any(isinstance(p, Array) for p in parts):
            return self._picked(base, parts)
        shape: list[Any] = []
        axis = 0
        for part in parts:
            if isinstance(part, slice):
                shape.append(extent_of_slice(part.start, part.stop, part.step, base.shape[axis]))
            axis += part is not None
            if part is None:
                shape.append(1)
        if shape:
            return base.view(tuple(shape))
        if base.content is not None:
            return _content(base.content, parts)
        values = None if base.buffer is None else base.buffer.values
        return UNKNOWN if values is None else values

    def _picked(self, base: Array, parts: list[Any]) -> Array:
        """The copy that arrays of integers or a mask pick."""
        masks = [p for p in parts if isinstance(p, Array) and p.dtype == np.bool_]
        if masks:
            rest = base.shape[len(masks[0].shape):]
            most = masks[0].size
            return allocated(self.meter, (Between(0, most.high if isinstance(most, Between) else most), *rest),
                             base.dtype, True)
        picked = broadcast([p.shape for p in parts if isinstance(p, Array)])
        others = [extent_of_slice(p.start, p.stop, p.step, extent) for p, extent in zip(parts, base.shape)
                  if isinstance(p, slice)]
        return allocated(self.meter, (*picked, *others), base.dtype, True)


def _content(content: Any, parts: list[Any]) -> Any:
    """What lies in an array at a place, or what may lie there."""
    if all(isinstance(p, int) for p in parts):
        return content[tuple(parts)].item()
    return Between(content.min().item(), content.max().item(), loops_of_values(*parts)) if content.size else UNKNOWN


def _connected(values: list[Any], every: bool) -> Any:
    """What `and` gives of truths, or `or`."""
    known = [truth(v) if not isinstance(v, Array) else None for v in values]
    if (not every) in known:
        return not every
    return every if None not in known else truth_value(loops_of_values(*values))


def either(first: Any, second: Any) -> Any:
    """A value that is one or the other: of arrays the larger one."""
    if first is second:
        return first
    if isinstance(first, Array) and isinstance(second, Array):
        sizes = [0 if a.buffer is None else a.buffer.bytes for a in (first, second)]
        return first if sizes[0] >= sizes[1] else second
    if isinstance(first, tuple) and isinstance(second, tuple) and len(first) == len(second):
        return tuple(map(either, first, second))
    if first is None or second is None or isinstance(first, Array) or isinstance(second, Array):
        return first if isinstance(first, Array) or second is None else second
    if isinstance(first, np.ndarray) and isinstance(second, np.ndarray):
        return first if first.nbytes >= second.nbytes else second
    return first if type(first) is type(second) and first == second else joined(first, second)
