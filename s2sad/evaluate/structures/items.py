"""Names, fields and items of one kernel's expressions while structures are taken apart.

    state.inner.k * x[0]       ->   state_inner_k * x[0]
    layers[1][0] @ x           ->   layers_1_0 @ x
    layers[:-1]                ->   a structure of the first layers
"""
from __future__ import annotations

import difflib
from collections.abc import Callable
from contextlib import suppress
from typing import Any, ClassVar

from s2sad.infer.bounded_arithmetic import operation
from s2sad.diagnostics import Report
from s2sad.evaluate.structures.literal_arguments import Nest, by_item
from s2sad.evaluate.structures.iterated_structures import late_comprehension
from s2sad.evaluate.structures.groups import (
    CELL, SPELLED, Conflict, StructureValue, Leaf, Ordinary, Plain, Value, listed, nothing, spelled, usable,
)
from s2sad.program import Kernel
from s2sad.pytree import own_method
from s2sad.tree import (
    AST, Add, Attribute, BinOp, Call, Constant, FloorDiv, GeneratorExp, List, ListComp, Load, Mod, Mult, Name, Slice,
    Store, Sub, Subscript, Tuple, UnaryOp, USub, at, call_name, const, copy, index, indices, rebuild, walk,
)

_ARITHMETIC = (Add, Sub, Mult, FloorDiv, Mod)
_SEQUENCE = ("__iter__", "__len__", "__getitem__", "__array__")


class ItemValues:
    """What the expressions of one kernel stand for, given what its names do; `needed` are the places of parameters
    that are assigned and must be cells."""

    seen: ClassVar[dict[type, Callable[[Any, Any], Value | None]]] = {}    # how each kind of expression is looked at

    def __init__(self, kernel: Kernel, report: Report):
        self.kernel, self.report = kernel, report
        self.env: dict[str, Value | Conflict | Ordinary] = {}
        self.nests: dict[str, Nest] = {}

    def refuse(self, node: AST, message: str, help: str = "", code: str = "S201") -> None:
        self.report.error(code, message, node, help=help)

    # -- what an expression is -----------------------------------------------------------------------------------------

    def value(self, node: AST) -> Value:
        found = self.structural(node)
        if found is not None:
            return found
        inside = isinstance(node, (ListComp, GeneratorExp))
        return Plain(rebuild(node, self._changed) if inside else self._parts_changed(node))

    def _parts_changed(self, node: AST) -> AST:
        new = self._picking(node) if isinstance(node, Subscript) else node
        return rebuild(new, lambda n: None if n is new else self._changed(n))

    def _picking(self, node: Subscript) -> Subscript:
        """A subscript that is a list picks several; a tuple is one subscript for each axis."""
        places = indices(node)
        found = [self.structural(p) if isinstance(p, (Name, Attribute, Subscript)) else None for p in places]
        shown = [spelled(f, p) if isinstance(f, StructureValue) and f.form.kind == "list" else None
                 for f, p in zip(found, places)]
        if not any(isinstance(s, Tuple) for s in shown):
            return node
        picked = [at(List(list(s.elts), Load()), p) if isinstance(s, Tuple) else p for s, p in zip(shown, places)]
        return at(Subscript(node.value, index(node.value, *picked).slice, node.ctx), node)

    def whole(self, node: AST) -> Value:
        """The value of an expression, a tuple that is written out as a structure."""
        spelled_out = isinstance(node, (Tuple, List)) and self.structural(node) is None
        return self._spelled_out(node) if spelled_out else self.value(node)

    def argument(self, node: AST) -> Value:
        """The value of what a function is given, of a name of what is spelled out its items."""
        base = node
        while isinstance(base, Subscript):
            base = base.value
        held = isinstance(base, Name) and base.id in self.nests and not isinstance(
            self.env.get(base.id), (StructureValue, Leaf, Conflict))
        found = by_item(node, self.nests) if held else None
        return self.whole(node) if found is None else self._spelled_out(found)

    def _spelled_out(self, node: Tuple | List) -> StructureValue:
        kind = "tuple" if isinstance(node, Tuple) else "list"
        return listed(tuple(self.now(self.argument(item), item) for item in node.elts), kind)

    def now(self, value: Value, origin: AST, own: bool = False) -> Value:
        """A value as it is when a structure is made of it: of a field that is assigned, the number that it holds. A
        structure whose items can be assigned has its `own` numbers."""
        copied = isinstance(value, Leaf) and usable(value) and (value.is_cell or own and not value.type.is_array)
        return Plain(value.read(origin)) if isinstance(value, Leaf) and copied else value

    def plain(self, node: AST) -> AST:
        """The expression without structures; one that stays a structure is refused."""
        return self.plainly(self.value(node), node)

    def plainly(self, value: Value, node: AST) -> AST:
        found = spelled(self.gone_through(value, node, *_SEQUENCE), node)
        if found is not None and not (nothing(value) and isinstance(value, Leaf)):
            return found
        if isinstance(value, Leaf):
            self._unusable(value, node)
        elif isinstance(value, StructureValue):
            self.refuse(node, f"{spoken(value)} is {value.form}, which is used as a whole here",
                        f"name what is in it: {parts_of(value)}" if value.items else "", "S203")
        return at(const(0.0), node)

    def structural(self, node: AST) -> Value | None:
        """The value of an expression that has to do with structures, None for any other."""
        seen = self.seen.get(type(node))
        return None if seen is None else seen(self, node)

    def _changed(self, node: AST) -> AST | None:
        if isinstance(node, (Attribute, Subscript)) and isinstance(node.ctx, Store):
            return self.stored(node)
        if isinstance(node, (ListComp, GeneratorExp)):
            return late_comprehension(node, self.env, lambda n: rebuild(n, self._changed))
        found = self.structural(node)
        if found is None:
            return self._parts_changed(node) if isinstance(node, Subscript) else None
        return self.plainly(found, node)

    def stored(self, node: AST) -> AST | None:
        """A target inside another one; field_blocks knows what may be stored where."""
        return None

    def _unusable(self, value: Leaf, node: AST) -> None:
        path = value.path or (node.id if isinstance(node, Name) else "this")
        if nothing(value):
            self.refuse(node, f"'{path}' is None here", f"test it before: if {path} is not None: ...", "S203")
        else:
            self.refuse(node, f"'{path}' is {value.type.dtype}, which a kernel cannot use",
                        "keep what the kernel reads in arrays, floats and ints", "S203")

    # -- names, fields, items ------------------------------------------------------------------------------------------

    def _name(self, node: Name) -> Value | None:
        found = None if isinstance(node.ctx, Store) else self.env.get(node.id)
        if isinstance(found, Conflict):
            self.refuse(node, f"'{node.id}' is one thing on one way to here and another on another, one of them a "
                        "structure or None", "give the two different names", "S203")
            return None
        if isinstance(found, Plain):
            return Plain(at(copy(found.node), node)) if isinstance(found.node, Constant) else None
        return None if isinstance(found, Ordinary) else found

    def _read_part(self, node: AST) -> Value | None:
        """The structure that a field or an item is read of, or what stands for it where there is none to read."""
        base = self.structural(node.value)
        if isinstance(base, Leaf) and not usable(base):
            self._unusable(base, node.value)
            return Plain(at(const(0.0), node))
        return base if isinstance(base, StructureValue) and not isinstance(node.ctx, Store) else None

    def _field(self, node: Attribute) -> Value | None:
        base = self._read_part(node)
        return self.field_of(base, node) if isinstance(base, StructureValue) else base

    def property_of(self, base: StructureValue, node: Attribute) -> Value | None:
        """What a property or a constant of a structure's class gives; None if it is neither."""
        return None

    def field_of(self, base: StructureValue, node: Attribute) -> Value:
        computed = self.property_of(base, node)
        if computed is not None:
            return computed
        if base.form.kind in ("record", "named", "either"):
            if node.attr in base.form.keys:
                return base.item(node.attr)
            made = base.form.made
            if made is not None and hasattr(made, node.attr):
                self.refuse(node, f"'{node.attr}' is an attribute of the class of {spoken(base)}, and no field",
                            "make it a field, or pass it as an argument", "S202")
            else:
                self._absent(base, node, f"{spoken(base)} has no field '{node.attr}'", node.attr, "fields")
        else:
            numbers = all(isinstance(i, Leaf) and i.type.kind in ("number", CELL) for i in base.items)
            help = f"write {base.path}[{node.attr!r}]" if node.attr in base.form.keys else (
                f"its items are read as {parts_of(base)}" if base.items and not (numbers and base.form.is_sequence) else
                f"pass numpy.array({base.path}, dtype=float)" if base.form.is_sequence else "it is empty")
            self.refuse(node, f"{spoken(base)} is {base.form}, which has no attribute '{node.attr}' in a "
                        "kernel", help, "S203")
        return Plain(at(const(0.0), node))

    def _absent(self, base: StructureValue, node: AST, message: str, key: str, what: str) -> None:
        keys = [str(k) for k in base.form.keys]
        close = difflib.get_close_matches(key, keys, 1, 0.7)
        listed = f"its {what} are {', '.join(keys)}" if keys else f"it has no {what}"
        self.refuse(node, message, f"did you mean '{close[0]}'? {listed}" if close else listed, "S202")

    def _item(self, node: Subscript) -> Value | None:
        base = self._read_part(node)
        if not isinstance(base, StructureValue):
            return base
        if isinstance(node.slice, Slice) and base.form.is_sequence:
            return self._slice(base, node)
        if base.form.is_sequence and _is_numbers(base) and self.key(node.slice) is None and not any(
                isinstance(n, (Slice, Tuple)) for n in walk(node.slice)):
            return Plain(at(Subscript(spelled(base, node), self.plain(node.slice), node.ctx), node))
        found = self.item_of(base, node)
        return Plain(at(const(0.0), node)) if found is None else found

    def item_of(self, base: StructureValue, node: Subscript) -> Value | None:
        """The item that a subscript names; None, and a diagnostic, if it names none."""
        key = self.key(node.slice)
        form, count = base.form, len(base.items)
        if form.is_sequence and isinstance(key, int):
            if -count <= key < count:
                return base.items[key]
            self.refuse(node, f"{spoken(base)} has {count} items, and no item {key}", code="S203")
        elif form.kind in ("dict", "either") and key is not None:
            if key in form.keys:
                return base.item(key)
            self._absent(base, node, f"{spoken(base)} has no key {key!r}", str(key), "keys")
        elif form.kind == "record":
            self.refuse(node, f"{spoken(base)} is {form}, which has no items",
                        f"its fields are read as {parts_of(base)}", "S203")
        else:
            self._dynamic(base, node)
        return None

    def _dynamic(self, base: StructureValue, node: Subscript) -> None:
        wanted = "a constant" if base.form.is_sequence else "a string that is written out"
        numbers = all(isinstance(i, Leaf) and i.type.kind in ("number", CELL) for i in base.items)
        help = f"write {parts_of(base)}"
        if base.form.is_sequence:
            help = (f"pass an array: numpy.array({base.path})" if numbers and base.items else
                    f"loop over it, for item in {base.path}, or over range(len({base.path}))")
        self.refuse(node, f"an item of {spoken(base)}, which is {base.form}, is picked by something other "
                    f"than {wanted}", help, "S203")

    def _slice(self, base: StructureValue, node: Subscript) -> Value:
        written = (node.slice.lower, node.slice.upper, node.slice.step)
        bounds = [None if b is None else self.key(b) for b in written]
        if any(b is not None and not isinstance(k, int) for b, k in zip(written, bounds)) or bounds[2] == 0:
            self._dynamic(base, node)
            return Plain(at(const(0.0), node))
        return listed(base.items[slice(*[k if isinstance(k, int) else None for k in bounds])])

    def key(self, node: AST) -> int | str | None:
        """The constant that an index is, loops that are written out considered."""
        if isinstance(node, Constant):
            return node.value if type(node.value) in (int, str) else None
        if isinstance(node, Name):
            found = self.env.get(node.id)
            return self.key(found.node) if isinstance(found, Plain) and isinstance(found.node, Constant) else None
        if isinstance(node, UnaryOp) and isinstance(node.op, USub):
            inner = self.key(node.operand)
            return -inner if isinstance(inner, int) else None
        if isinstance(node, BinOp) and isinstance(node.op, _ARITHMETIC):
            left, right = self.key(node.left), self.key(node.right)
            if isinstance(left, int) and isinstance(right, int):
                with suppress(ArithmeticError):
                    return operation(type(node.op).__name__, left, right)
        if call_name(node) == "builtins.len":
            found = self._length(node)
            return self.key(found.node) if isinstance(found, Plain) else None
        return None

    def _display(self, node: Tuple | List) -> Value | None:
        """A tuple that is spelled out is a structure if one of its items is one, or None."""
        if isinstance(node.ctx, Store):
            return None
        found = [self.structural(item) for item in node.elts]
        if not any(isinstance(f, (StructureValue, Leaf)) and not (isinstance(f, Leaf) and usable(f)) for f in found):
            return None
        return self._spelled_out(node)

    def _length(self, node: Call) -> Value | None:
        found = self.structural(node.args[0]) if len(node.args) == 1 else None
        if not isinstance(found, StructureValue) or own_method(found.form.made, "__len__"):
            return None
        if found.form.kind == "record":
            self.refuse(node, f"len() of {spoken(found)}, which is {found.form}", "give the length of what is in it")
        return Plain(at(const(len(found.items)), node))

    def gone_through(self, value: Value, node: AST, *words: str) -> Value:
        """A structure whose items something goes through; refused where its class says itself what these are."""
        own = [w for w in words or ("__iter__",) if isinstance(value, StructureValue) and own_method(value.form.made,
                                                                                                     w)]
        if own and isinstance(value, StructureValue) and value.form.kind in ("record", "named"):
            self.refuse(node, f"the items of {spoken(value)}, whose class defines '{own[0]}'",
                        f"name its fields one by one: {parts_of(value)}")
        return value


def _is_numbers(base: StructureValue) -> bool:
    """Whether the items are numbers that no one assigns: a variable may pick one."""
    return bool(base.items) and all(isinstance(i, Leaf) and i.type.kind == "number" and not i.is_cell
                                    for i in base.items)


def spoken(group: StructureValue) -> str:
    """A structure in a sentence."""
    return f"'{group.path}'" if group.path != SPELLED else str(group.form).replace("a ", "the ", 1)


def parts_of(group: StructureValue) -> str:
    """The first items of a structure as one writes them."""
    shown = [i.path for i in group.items if isinstance(i, (Leaf, StructureValue)) and i.path]
    return ", ".join(shown[:4]) + (", ..." if len(shown) > 4 else "")
