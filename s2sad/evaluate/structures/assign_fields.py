"""Fields and items of structures that are assigned while structures are taken apart.

    state.t = 0.0                ->   state_t[0] = 0.0
    state.k += 1                 ->   state_k[0] += 1
    state.u += x                 ->   state_u[...] += x         in a function, of an object that its caller made
"""
from __future__ import annotations

from s2sad.infer.types import UNKNOWN
from s2sad.evaluate.structures.static_tests import NO
from s2sad.evaluate.structures.integer_fields import KEEPING, is_whole, whole_names
from s2sad.evaluate.structures.operators import Operators
from s2sad.evaluate.structures.groups import StructureValue, Leaf, Plain, flat, nothing, usable
from s2sad.pytree import said_to_be_array
from s2sad.tree import (
    AST, Add, Attribute, BoolOp, Compare, Constant, Mult, Name, Not, Store, Sub, Subscript, UnaryOp, at, const, index,
    name,
)

BOTH_PARTS = "store both parts: z[...] = a + 1j * b"
_KEPT_LOCALLY = "return the value, or write it to an element of an array argument"


class Assignments(Operators):
    """Targets that are items of structures: an array's name, or the cell of a number."""

    def assigned(self, node: AST, value: AST | None, augmented: bool, op: AST | None = None) -> AST | None:
        """The target for an item of a structure; None if the target is no such item."""
        base = self.structural(node.value)
        if not isinstance(base, StructureValue):
            if isinstance(node, Attribute):
                self.refuse(node, f"an assignment to the attribute .{node.attr} {NO}",
                            BOTH_PARTS if node.attr in ("real", "imag") else _KEPT_LOCALLY)
                return at(Name("_", Store(), None, None), node)
            return None
        said = len(self.report.found)
        read = type(node)(*[getattr(node, f) for f in node._fields[:-1]], name("x").ctx)
        found = self.field_of if isinstance(node, Attribute) else self.item_of
        item = found(base, at(read, node))  # pyright: ignore[reportArgumentType]
        dummy = at(Name("_", Store(), None, None), node)
        if isinstance(item, Plain) and len(self.report.found) == said:
            self.refuse(node, "a property, or an item that is a constant here, is assigned",
                        "assign the fields that it stands for, numbers and arrays")
        if not isinstance(item, Leaf) or not self._assignable(base, item, node, augmented):
            if isinstance(item, StructureValue):
                self.refuse(node, f"'{item.path}' is {item.form}, which is replaced by another value",
                            "assign what is in it")
            return dummy
        if item.type.is_array:
            return at(Name(item.name, Store(), None, None), node)
        if augmented and item.type == UNKNOWN and item.place >= 0 and _is_array(base, item):
            whole = index(name(item.name), const(...))      # refused there if it is a number
            return at(Subscript(whole.value, whole.slice, Store()), node)
        if not item.is_cell and item.place < 0:
            return at(Name(item.name, Store(), None, None), node)
        if not _keeps_dtype(item, value, augmented, op) and not self._keeps_whole(item, value, augmented, op):
            whole = ", else write int(...) around it" if item.type.dtype == "int64" else ""
            self.refuse(node, f"'{item.path}' is of type {item.type.dtype or item.type}, and what is assigned need not "
                        "be", f"give a float (0.0, not 0) if it is a real quantity{whole}", "S203")
        if not item.is_cell:
            self.needed.add(item.place)
        cell = index(name(item.name), const(0))
        return at(Subscript(cell.value, cell.slice, Store()), node)

    def _keeps_whole(self, item: Leaf, value: AST | None, augmented: bool, op: AST | None) -> bool:
        """Whether an integer is assigned to a field of integers."""
        if item.type.dtype != "int64" or augmented and not isinstance(op, KEEPING):
            return False
        types = {leaf.name: leaf.type.dtype for v in self.env.values() if isinstance(v, (StructureValue, Leaf))
                 for leaf in flat(v) if isinstance(leaf, Leaf) and not leaf.type.is_array}
        return is_whole(value, whole_names(self.kernel.tree, types))

    def _assignable(self, base: StructureValue, item: Leaf, node: AST, augmented: bool) -> bool:
        if base.form.fixed:
            what = "a frozen dataclass" if base.form.kind == "record" else str(base.form)
            self.refuse(node, f"'{base.path}' is {what}, to which nothing can be assigned",
                        f"write into an array, {item.path}[...] = ..." if item.type.is_array else
                        "return the new value")
        elif nothing(item) or not usable(item):
            self._unusable(item, node)
        elif item.type.is_array and not augmented:
            self.refuse(node, f"the array '{item.path}' is replaced by another one",
                        f"write into it: {item.path}[...] = ...")
        elif item.type.kind == "text":
            self.refuse(node, f"'{item.path}' is a str, which is replaced by another one", "use an int")
        else:
            return True
        return False

    def stored(self, node: AST) -> AST | None:
        return self.assigned(node, None, False)


def _is_array(base: StructureValue, item: Leaf) -> bool:
    """Whether the class of a structure says that an item is an array."""
    return any(i is item and said_to_be_array(base.form, k) for k, i in zip(base.form.keys, base.items))


def _keeps_dtype(item: Leaf, value: AST | None, augmented: bool, op: AST | None) -> bool:
    """Whether what is assigned to a number surely has its type; an element of an array cannot change it."""
    dtype = item.type.dtype
    if dtype in ("", "float64", "complex128"):
        return True
    if dtype == "bool":
        return isinstance(value, (Compare,)) or isinstance(value, Constant) and isinstance(value.value, bool) or (
            isinstance(value, UnaryOp) and isinstance(value.op, Not)) or isinstance(value, BoolOp) and all(
            _keeps_dtype(item, v, False, None) for v in value.values)
    whole = isinstance(value, Constant) and type(value.value) is int
    return dtype.startswith(("int", "uint")) and whole and (not augmented or isinstance(op, (Add, Sub, Mult)))
