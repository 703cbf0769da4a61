"""inference: the type of every name of a function in structured or normal form.

Requires the types of the parameters; establishes a table name -> Type, the join over all bindings of a name.

    def f(x, n):                    x: float64[:]   n: int64
        t = x[n - 1] * 2            t: float64
"""
from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Final

from s2sad.diagnostics import Report
from s2sad.infer.signatures.laws import constant_slice, of_rank
from s2sad.infer.promotion import RANKS, join, promote
from s2sad.infer.types import BOOL, FLOAT, INT, TEXT, UNKNOWN, Type, array, of_value
from s2sad.infer.call_types import CallTypes, TypesOfCalls
from s2sad.infer.list_arrays import is_list_allocation, stored_list
from s2sad.infer.unit_axes import unit_axes
from s2sad.tree import (
    AST, Add, Assign, Attribute, AugAssign, BinOp, BitAnd, BitOr, BitXor, BoolOp, Call, Compare, Constant, Div, For,
    FunctionDef, If, IfExp, LShift, List, Mult, Name, Not, Pow, RShift, Return, Slice, Subscript, Tuple, USub,
    UnaryOp, While, call_name, indices, is_unset,
)

_MOST = 1 << 14         # items of a tuple, those of tuples within it counted


def inference(function: FunctionDef, parameters: Mapping[str, Type], call_types: CallTypes, report: Report,
              constants: Mapping[str, object] | None = None, conflicting: set[str] | None = None,
              wider: bool = False) -> Mapping[str, Type]:
    """The type of every name; type conflicts go into the report, their names into `conflicting`. With `wider` a
    name of arrays of several floats has the widest of them."""
    found = _Inference(parameters, call_types, report, constants or {})
    found.wider = wider
    for _ in range(20):
        before = found.with_ones()
        found.block(function.body)
        if found.with_ones() == before:
            break
    found.final = True
    found.block(function.body)
    if conflicting is not None:
        conflicting |= found.conflicting
    return found.with_ones()


_FLOATS = frozenset({"numpy.pi", "numpy.e", "numpy.inf", "numpy.nan", "math.pi", "math.e", "math.inf", "math.nan",
                     "math.tau", "numpy.euler_gamma"})


class Typing(TypesOfCalls):
    """The types of expressions by those of names, which never change: `declare` gives a new name its type.

    The type of each expression is found once. Expressions of unknown types are not remembered: an error in one is
    reported at each use, if the types are `final`.
    """

    def __init__(self, table: Mapping[str, Type], call_types: CallTypes, report: Report,
                 constants: Mapping[str, object], final: bool = False,
                 runs_once: Callable[[Call], bool] = lambda call: False):
        self.call_types, self.final = call_types, final
        self.report: Final = report
        self.constants: Final = constants
        self.runs_once: Final = runs_once       # whether a kernel's call is not to be run again
        self.ones: Final[dict[str, tuple[int, ...]]] = {n: t.ones for n, t in table.items() if t.ones}
        self._types = {n: t.plain for n, t in table.items()}
        self.table: Final[Mapping[str, Type]] = MappingProxyType(self._types)
        self._known: dict[AST, Type] = {}       # by identity
        self._unknown = 0                       # how many expressions were of unknown types

    def declare(self, identifier: str, kind: Type) -> str:
        """The name, which has this type from here on: `typing.declare(names.fresh("part"), typing.of(node))`."""
        known = self._types.setdefault(identifier, kind.plain)
        assert known == kind.plain, f"{identifier} is {known}, not {kind}"
        if kind.ones:
            self.ones.setdefault(identifier, kind.ones)
        return identifier

    def copy(self, report: Report | None = None, final: bool = False,
             runs_once: Callable[[Call], bool] | None = None) -> Typing:
        """The same types, to which others are added."""
        return Typing(self.with_ones(), self.call_types, report or self.report, self.constants, final,
                      runs_once or self.runs_once)

    def extended(self, block: list[AST]) -> Typing:
        """The types with those of the names that statements bind."""
        found = _Inference(self.with_ones(), self.call_types, self.report, self.constants, self.final, self.runs_once)
        found.block(block)
        return found.copy(final=self.final)

    def with_ones(self) -> dict[str, Type]:
        """The types of names, with the axes that are known to have length 1."""
        return {n: replace(t, ones=self.ones[n]) if n in self.ones else t for n, t in self._types.items()}

    def argument(self, node: AST) -> Type:
        """The type of an argument of a call, with the axes that are known to have length 1."""
        ones = unit_axes(node, self)
        return replace(self.of(node), ones=ones) if ones else self.of(node)

    def of(self, node: AST) -> Type:
        kind = type(node)
        is_kept = kind is not Name and kind is not Constant
        if is_kept and (known := self._known.get(node)) is not None:
            return known
        method = getattr(self, "_" + kind.__name__, None)
        unknown, found = self._unknown, UNKNOWN if method is None else method(node)
        self._unknown += found.kind == "unknown"
        if is_kept and unknown == self._unknown:
            self._known[node] = found
        return found

    def _Name(self, node: Name) -> Type:
        if "." in node.id:
            room, _, rest = node.id.partition(".")
            if room in ("const", "array") and rest:
                return of_value(self.constants[rest]) if rest in self.constants else FLOAT
            if node.id in _FLOATS:
                return FLOAT
        return self.table.get(node.id, UNKNOWN)

    def _Constant(self, node: Constant) -> Type:
        if is_unset(node):
            return UNKNOWN
        return TEXT if isinstance(node.value, str) else of_value(node.value)

    def _Tuple(self, node: Tuple) -> Type:
        return self._tuple(node, tuple(map(self.of, node.elts)))

    def _tuple(self, node: AST, items: tuple[Type, ...]) -> Type:
        """The type of a tuple; one that grows exponentially is refused before it is large."""
        if sum(item.count for item in items) > _MOST:
            self.report.error("S201", f"a tuple or list of more than {_MOST} items", node, help="make it an array")
            self.report.finish()
        return Type("tuple", items=items)

    def _List(self, node: List) -> Type:
        return self._Tuple(node)

    def _UnaryOp(self, node: UnaryOp) -> Type:
        operand = self.of(node.operand)
        if isinstance(node.op, Not):
            return BOOL
        return promote(operand, INT) if operand == BOOL else operand

    def _BoolOp(self, node: BoolOp) -> Type:
        joined: Type | None = self.of(node.values[0])
        for value in node.values[1:]:
            joined = joined and join(joined, self.of(value))
        return joined or UNKNOWN

    def _Compare(self, node: Compare) -> Type:
        rank = max((t.rank for t in map(self.of, [node.left, *node.comparators])), default=0)
        return array("bool", rank) if rank else BOOL

    def _IfExp(self, node: IfExp) -> Type:
        return join(self.of(node.body), self.of(node.orelse)) or UNKNOWN

    def _BinOp(self, node: BinOp) -> Type:
        left, right = self.of(node.left), self.of(node.right)
        if left.kind == right.kind == "tuple" and isinstance(node.op, Add):
            return self._tuple(node, left.items + right.items)
        if isinstance(node.op, (Add, Mult)):
            left, right = _as_array(node.left, left, right), _as_array(node.right, right, left)
        result = promote(left, right)
        if result.dtype == "bool":
            if isinstance(node.op, (BitAnd, BitOr, BitXor)) or result.is_array and isinstance(node.op, (Add, Mult)):
                return result
            result = Type(result.kind, "int64", result.rank)
        if not result.is_inexact and result.dtype and (isinstance(node.op, Div) or isinstance(
                node.op, Pow) and result.is_number and is_inverted(node.right)):
            return Type(result.kind, "float64", result.rank)
        if isinstance(node.op, (LShift, RShift)):
            return left
        return result

    def _Attribute(self, node: Attribute) -> Type:
        base = self.of(node.value)
        if not base.is_array:
            return UNKNOWN
        if node.attr == "shape":
            return Type("tuple", items=(INT,) * base.rank)
        if node.attr in ("size", "ndim"):
            return INT
        return array(base.dtype, base.rank) if node.attr == "T" else UNKNOWN

    def _Subscript(self, node: Subscript) -> Type:
        base = self.of(node.value)
        if base.kind == "tuple" and isinstance(node.slice, Slice):
            part = constant_slice(node.slice)
            return UNKNOWN if part is None else Type("tuple", items=base.items[part])
        if base.kind == "tuple":
            if isinstance(node.slice, Constant) and isinstance(node.slice.value, int) and base.items:
                return base.items[node.slice.value] if node.slice.value < len(base.items) else UNKNOWN
            return base.items[0] if base.items and len(set(base.items)) == 1 else UNKNOWN
        if not base.is_array:
            if self.final and base.kind not in ("unknown",):
                self.report.error("S203", f"a {base} cannot be indexed", node)
            return UNKNOWN
        subscripts = indices(node)
        added = sum(isinstance(s, Constant) and s.value is None for s in subscripts)
        dropped = sum(not isinstance(s, Slice) and not (isinstance(s, Constant) and s.value in (None, Ellipsis))
                      for s in subscripts)
        arrays = [kind for s in subscripts if not isinstance(s, (Slice, Constant)) and (kind := self.of(s)).is_array]
        if arrays:
            return self._gathered(node, base, subscripts, arrays)
        count = sum(not (isinstance(s, Constant) and s.value in (None, Ellipsis)) for s in subscripts)
        if count > base.rank:
            if self.final:
                self.report.error("S203", f"{count} subscripts for {base}", node,
                                  help="the types are taken from the arguments: check their ranks")
            return UNKNOWN
        return of_rank(base, base.rank - dropped + added)

    def _gathered(self, node: Subscript, base: Type, subscripts: list[AST], arrays: list[Type]) -> Type:
        """The type of what arrays of integers gather, or an array of bools."""
        masked = [a for a in arrays if a.dtype == "bool"]
        if masked and len(arrays) > 1 or any(a.is_float for a in arrays):
            if self.final:
                self.report.error("S203", f"subscripts of {', '.join(map(str, arrays))}", node,
                                  help="pick with one array of bools, or with arrays of integers")
            return UNKNOWN
        count = sum(not (isinstance(s, Constant) and s.value in (None, Ellipsis)) for s in subscripts)
        used = count + sum(a.rank - 1 for a in masked)
        if used > base.rank:
            if self.final:
                self.report.error("S203", f"{used} subscripts for {base}", node,
                                  help="the types are taken from the arguments: check their ranks")
            return UNKNOWN
        added = sum(isinstance(s, Constant) and s.value is None for s in subscripts)
        kept = sum(isinstance(s, Slice) for s in subscripts) + base.rank - used + added
        return of_rank(base, kept + (1 if masked else max(a.rank for a in arrays)))


_SEVERAL = ("numpy.unravel_index", "numpy.nonzero", "numpy.meshgrid", "numpy.split", "numpy.indices", "numpy.gradient")


_OF_MATRICES = {
    "scipy.sparse.entries": ("a sparse matrix times something that is no number", "A @ x is the product with a vector"),
    "scipy.sparse.along": ("a diagonal that is neither a number nor an array with one axis", "give it such an array"),
}


def _hint(value: AST | None) -> tuple[str, str]:
    """The note and the help of the error for a value without a type."""
    called = call_name(value) or ""
    if called in _OF_MATRICES:
        return _OF_MATRICES[called]
    if not called.startswith(("numpy.", "builtins.")) or not isinstance(value, Call):
        return "", "write it with operations on numbers and arrays that are known"
    options = ", ".join(f"{k.arg}=" for k in value.keywords if k.arg != "part")
    note = f"what {called.removeprefix('builtins.')} gives{' with ' + options if options else ' here'} is not known"
    return note, "bind each of the parts to a name: i, j = ..." if called in _SEVERAL else (
        "name the axis: np.squeeze(x, axis=0)" if called == "numpy.squeeze" else
        "leave the option out" if options else "write it with operations on numbers and arrays that are known")


def _rebinding_help(old: Type | None, new: Type) -> str:
    sums = old is not None and old.is_number and new.is_array
    return "start with an array: np.zeros_like(...); or give the second one another name" if sums else (
        "give the second one another name")


def _as_array(node: AST, own: Type, other: Type) -> Type:
    """The type of a display of numbers, which an operation with an array makes an array."""
    numbers = own.kind == "tuple" and isinstance(node, (List, Tuple)) and other.dtype in ("int64", "float64")
    if not numbers or not other.is_array or not own.items or not all(
            i.is_number and i.dtype in ("int64", "float64") for i in own.items):
        return own
    return array(max((i.dtype for i in own.items), key=RANKS.index), 1)


def is_inverted(power: AST) -> bool:
    """Whether an exponent has a minus in the text: of two integers the power is a float, `2 ** -k`."""
    return isinstance(power, UnaryOp) and isinstance(power.op, USub) or isinstance(
        power, Constant) and type(power.value) is int and power.value < 0


class _Inference(Typing):
    """The fixpoint: a table that grows with every binding, by statements in their order; conflicts are reported in
    the last round, when the types are `final`."""

    def __init__(self, table: Mapping[str, Type], call_types: CallTypes, report: Report,
                 constants: Mapping[str, object], final: bool = False,
                 runs_once: Callable[[Call], bool] = lambda call: False):
        super().__init__(table, call_types, report, constants, final, runs_once)
        self.wider = False
        self.conflicting: set[str] = set()     # the names whose bindings have no type in common
        self.listed: set[str] = set()       # the arrays in place of lists

    def block(self, block: list[AST]) -> None:
        for statement in block:
            self.statement(statement)

    def statement(self, statement: AST) -> None:
        if isinstance(statement, Assign):
            self.assignment(statement)
        elif isinstance(statement, AugAssign) and isinstance(statement.target, Name):
            if not self.table.get(statement.target.id, UNKNOWN).is_array:
                self.bind(statement.target.id, self._BinOp(_operation(statement)), statement)
        elif isinstance(statement, AugAssign) and (listed := stored_list(statement.target, self.listed)):
            self.bind_item(listed, self._BinOp(_operation(statement)))
        elif isinstance(statement, For):
            self.bind(statement.target.id, INT, statement)
            self.block(statement.body)
        elif isinstance(statement, While):
            self.block(statement.body)
        elif isinstance(statement, If):
            self.block(statement.body)
            self.block(statement.orelse)
        elif self.final and isinstance(statement, Return) and statement.value is not None:
            self.of(statement.value)

    def assignment(self, statement: Assign) -> None:
        target = statement.targets[0]
        if is_list_allocation(statement):
            self.listed.add(target.id)
        if listed := stored_list(target, self.listed):
            self.bind_item(listed, self.of(statement.value))
        elif isinstance(target, Name):
            self.bind(target.id, self.argument(statement.value), statement)
        elif isinstance(target, Tuple) and isinstance(statement.value, Call):
            results = self.call_results(statement.value)
            for item, kind in zip(target.elts, results):
                self.bind(item.id, kind, statement)
            if self.final and results and len(results) != len(target.elts):
                self.report.error("S203", f"{len(target.elts)} names for {len(results)} results", statement)

    def bind_item(self, identifier: str, item: Type) -> None:
        """An array in place of a list has one axis more than what is stored in it."""
        old = self.table.get(identifier, UNKNOWN)
        if item.kind in ("number", "array") and item.dtype in RANKS and old.rank in (0, item.rank + 1):
            dtype = max(item.dtype, old.dtype or item.dtype, key=RANKS.index)
            self._enter(identifier, array(dtype, item.rank + 1))

    def bind(self, identifier: str, new: Type, place: AST) -> None:
        old, ones, new = self.table.get(identifier), new.ones, new.plain
        if self.final and (old or new).kind == "unknown":
            note, help = _hint(getattr(place, "value", None))
            self.report.error("S203", f"the type of '{identifier}' cannot be inferred", place, note, help)
        joined = new if old is None else join(old, new)
        if joined is None and self.wider and old is not None and old.is_array and new.is_array and (
                old.is_float and new.is_float and old.rank == new.rank):
            joined = promote(old, new)
        if joined is None:
            if self.final:
                self.conflicting.add(identifier)
                self.report.error("S203", f"'{identifier}' is bound to {old} and to {new}", place,
                                  help=_rebinding_help(old, new))
            return      # it is another name, or refused
        self._join_ones(identifier, ones)
        self._enter(identifier, joined)

    def _join_ones(self, identifier: str, new: tuple[int, ...]) -> None:
        """The axes that have length 1 in every binding of a name: they grow fewer from round to round."""
        old = self.ones.get(identifier, ())
        joined = tuple(k for k in old if k in new) if identifier in self.table else new
        if joined != old:
            self._known = {}
            self.ones[identifier] = joined

    def _enter(self, identifier: str, kind: Type) -> None:
        """The type of a name; where it had another, expressions are typed anew."""
        if self._types.get(identifier, kind) != kind:
            self._known = {}
        self._types[identifier] = kind


def _operation(statement: AugAssign) -> BinOp:
    return BinOp(statement.target, statement.op, statement.value)
