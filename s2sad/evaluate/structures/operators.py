"""What a structure's class says of operators, items and lengths is called, while structures are taken apart.

    v + w                ->   user.__add__(v, w)
    0.5 * v              ->   user.__rmul__(v, 0.5)
    len(g), abs(v), -v   ->   user.__len__(g), user.__abs__(v), user.__neg__(v)
    g[i], v < w          ->   user.__getitem__(g, i), user.__lt__(v, w)
    s.source(t)          ->   user.__call__(s.source, t)

As in Python: the left operand's class is asked first, unless the right one's is a subclass of it with a method of its
own. A number of NumPy's and an array ask nobody and take a named tuple for an array: only what is surely a number of
Python's may stand on the left of a reflected operator.
"""
from __future__ import annotations

from s2sad.evaluate.structures.items import spoken
from s2sad.evaluate.structures.call_values import CallValues
from s2sad.evaluate.structures.groups import StructureValue, Leaf, Plain, Value
from s2sad.pytree import own_method
from s2sad.tree import (
    AST, Add, Attribute, AugAssign, BinOp, BitAnd, BitOr, BitXor, Call, Compare, Constant, Div, Eq, FloorDiv, Gt, GtE,
    Invert, LShift, Lt, LtE, MatMult, Mod, Mult, Name, Not, NotEq, Pow, RShift, Sub, Subscript, UAdd, UnaryOp, USub,
    at, call_name, name,
)

_BINARY: dict[type, str] = {
    Add: "add", Sub: "sub", Mult: "mul", MatMult: "matmul", Div: "truediv", FloorDiv: "floordiv", Mod: "mod",
    Pow: "pow", LShift: "lshift", RShift: "rshift", BitAnd: "and", BitOr: "or", BitXor: "xor"}
_UNARY: dict[type, str] = {USub: "__neg__", UAdd: "__pos__", Invert: "__invert__"}
_COMPARED: dict[type, tuple[str, str]] = {
    Eq: ("__eq__", "__eq__"), NotEq: ("__ne__", "__ne__"), Lt: ("__lt__", "__gt__"), Gt: ("__gt__", "__lt__"),
    LtE: ("__le__", "__ge__"), GtE: ("__ge__", "__le__")}
_CALLS = {"builtins.len": "__len__", "builtins.abs": "__abs__"}
_NUMBERS = ("builtins.len", "builtins.int", "builtins.float")
_ASKING = {                             # what else asks a class, and for what
    "builtins.max": ("__gt__", "__lt__"), "builtins.min": ("__lt__", "__gt__"), "builtins.sum": ("__add__", "__radd__"),
    "builtins.float": ("__float__",), "builtins.int": ("__int__",), "builtins.bool": ("__bool__", "__len__"),
    "builtins.round": ("__round__",), "builtins.pow": ("__pow__", "__rpow__")}


class Operators(CallValues):
    """Operators of structures whose classes define them."""

    def as_call(self, node: AST) -> Call | None:
        found = super().as_call(node)
        return found if found is not None else self._operator(node)

    def _operator(self, node: AST) -> Call | None:
        """The call of a method that an operator means; None for any other expression."""
        if isinstance(node, BinOp):
            word = _BINARY[type(node.op)]
            return self._between(node, node.left, node.right, (f"__{word}__", f"__r{word}__"))
        if isinstance(node, Compare):
            return self._comparison(node)
        if isinstance(node, UnaryOp) and not isinstance(node.op, Not):
            return self._alone(node, node.operand, _UNARY[type(node.op)])
        if isinstance(node, Call) and call_name(node) in _CALLS and len(node.args) == 1:
            return self._alone(node, node.args[0], _CALLS[call_name(node) or ""])
        if isinstance(node, Call) and isinstance(node.func, Attribute):
            return self._called_field(node)
        if isinstance(node, Subscript) and self._operand(node.value) is not None:
            return self._alone(node, node.value, "__getitem__", node.slice)
        return None

    def _called_field(self, node: Call) -> Call | None:
        """The call of an object that is a field: `self.source(t)`."""
        owner = self._operand(node.func.value)
        field = owner.item(node.func.attr) if owner is not None and node.func.attr in owner.form.keys else None
        if not isinstance(field, StructureValue) or not own_method(field.form.made, "__call__"):
            return None
        found = self._method_call(field, "__call__", node.func, node, node.args)
        return found and at(Call(found.func, found.args, [*found.keywords, *node.keywords]), node)

    def in_place(self, node: AugAssign) -> Call | None:
        """The call that an augmented assignment to a name means."""
        read, word = at(name(node.target.id), node.target), _BINARY[type(node.op)]
        base = self._operand(read)
        if base is not None and own_method(base.form.made, f"__i{word}__"):
            return self._method_call(base, f"__i{word}__", read, node, [node.value])
        return self._between(node, read, node.value, (f"__{word}__", f"__r{word}__"))

    def _operand(self, node: AST) -> StructureValue | None:
        """The object or named tuple that an operand is."""
        found = self.structural(node)
        return found if isinstance(found, StructureValue) and found.form.kind in ("record", "named") else None

    def _method_call(self, base: StructureValue, word: str, operand: AST, node: AST, given: list[AST]) -> Call | None:
        """A call of what a class has under a name; refused where that is no function that can be read."""
        called = at(Call(at(Attribute(operand, word, name("x").ctx), operand), given, []), node)
        found = self._of_class(base, called.func, called)
        if found is None:
            self.refuse(node, f"an operator of {spoken(base)}, whose class has '{word}', which is no method written in "
                        "Python", "write out what it does")
        return found

    def _alone(self, node: AST, operand: AST, word: str, *given: AST) -> Call | None:
        base = self._operand(operand)
        if base is None or not own_method(base.form.made, word):
            return None
        return self._method_call(base, word, operand, node, list(given))

    def _between(self, node: AST, left: AST, right: AST, words: tuple[str, str], compared: bool = False) -> Call | None:
        one, other = self._operand(left), self._operand(right)
        if one is None and other is None:
            return None
        first = one is not None and bool(own_method(one.form.made, words[0]))
        second = other is not None and bool(own_method(other.form.made, words[1]))
        if first and second and _goes_first(one, other, words[1]) or second and not first and not (
                compared and one is not None and one.form.kind == "named" and not _goes_first(one, other, words[1])):
            assert other is not None
            if one is None and not self._is_number(left, other):
                self.refuse(node, f"an operator with {spoken(other)} on its right, and on its left what may be a number"
                            " or an array of NumPy's, which would not ask its class", "put it on the left, or call the "
                            f"method: v.{words[1]}(x)")
            return self._method_call(other, words[1], right, node, [left])
        return self._method_call(one, words[0], left, node, [right]) if first and one is not None else None

    def _comparison(self, node: Compare) -> Call | None:
        operands = [node.left, *node.comparators]
        words = [w for op in node.ops for w in _COMPARED.get(type(op), ())]
        if not words:
            return None
        if len(node.ops) > 1:
            base = next((b for o in operands if (b := self._operand(o)) is not None
                         and any(own_method(b.form.made, w) for w in words)), None)
            if base is not None:
                self.refuse(node, f"a chain of comparisons with {spoken(base)}, whose class defines them",
                            "join two comparisons with and")
            return None
        found = self._between(node, operands[0], operands[1], (words[0], words[1]), True)
        return found if found is not None or not isinstance(node.ops[0], NotEq) else self._unequal(node)

    def _unequal(self, node: Compare) -> Call | None:
        """An object that does not define `!=` inverts what its `==` gives; a tuple has its own."""
        found = [b for o in (node.left, node.comparators[0]) if (b := self._operand(o)) is not None]
        if found and found[0].form.kind == "record" and any(own_method(b.form.made, "__eq__") for b in found):
            self.refuse(node, f"'!=' of {spoken(found[0])}, whose class defines '=='", "write not (v == w)")
        return None

    def _is_number(self, node: AST, other: StructureValue) -> bool:
        """Whether an expression is surely a number that asks the class of the other operand: Python's, or one of
        NumPy's where the other is no tuple."""
        if isinstance(node, Constant) or call_name(node) in _NUMBERS:
            return True
        if isinstance(node, BinOp):
            return self._is_number(node.left, other) and self._is_number(node.right, other)
        if isinstance(node, UnaryOp):
            return self._is_number(node.operand, other)
        if isinstance(node, Name) and isinstance(found := self.env.get(node.id), Plain):
            return isinstance(found.node, Constant)
        found = self.structural(node)
        return other.form.kind == "record" and isinstance(found, Leaf) and found.type.is_number

    # -- what else asks a class ----------------------------------------------------------------------------------------

    def _operated(self, node: AST) -> Value | None:
        called = self._operator(node)
        return None if called is None else self._call(called)

    def _calls(self, node: Call) -> Value | None:
        words = _ASKING.get(call_name(node) or "", ())
        for base in map(self._first_of, node.args if words else ()):
            own = [w for w in words if base is not None and own_method(base.form.made, w)]
            if own and base is not None:
                self.refuse(node, f"{(call_name(node) or '').partition('.')[2]}() of {spoken(base)}, whose class "
                            f"defines '{own[0]}'", "write out what it does, with an if or a loop")
                return Plain(at(Constant(0.0, None), node))
        found = self._operated(node)
        return found if found is not None else self._call(node)

    def _first_of(self, node: AST) -> StructureValue | None:
        """The object that a value is, or the first that is in a sequence."""
        found = self.structural(node)
        if isinstance(found, StructureValue) and found.form.kind in ("tuple", "list"):
            found = next((i for i in found.items if isinstance(i, StructureValue)), None)
        return found if isinstance(found, StructureValue) else None

    def _compared_or_decided(self, node: Compare) -> Value | None:
        found = self._operated(node)
        return found if found is not None else self._test(node)

    def _unary(self, node: UnaryOp) -> Value | None:
        if isinstance(node.op, Not):
            return self._test(node)
        return self._operated(node)

    def _picked(self, node: Subscript) -> Value | None:
        found = self._operated(node)
        return found if found is not None else self._item(node)


def _goes_first(one: StructureValue | None, other: StructureValue | None, reflected: str) -> bool:
    """Whether the right operand's class is a subclass of the left one's with a method of its own."""
    a, b = (None if g is None else g.form.made for g in (one, other))
    return a is not None and b is not None and a is not b and issubclass(b, a) and (
        own_method(a, reflected) != own_method(b, reflected))


Operators.seen = {**CallValues.seen, BinOp: Operators._operated, UnaryOp: Operators._unary, Call: Operators._calls,
                  Compare: Operators._compared_or_decided, Subscript: Operators._picked}
