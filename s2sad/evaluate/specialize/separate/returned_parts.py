"""returned_parts: what a function gives back, taken apart into arrays and numbers, and put together where it is called.

    return Faces(left + d, right - d, self.grid)     ->      return left + d, right - d

What it was given is not given back: the caller has it. What may share memory with it is refused (`NotSeparate`).
"""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from s2sad import tree
from s2sad.evaluate.specialize.evaluator import Evaluator, is_spelled
from s2sad.evaluate.specialize.heap import Object
from s2sad.evaluate.specialize.separate.call_view import CallView, NotSeparate
from s2sad.evaluate.specialize.values import (
    UNKNOWN, ClassValue, Data, LibraryValue, ObjectValue, Reference, TupleValue, Value, constant,
)
from s2sad.read.outside_values import library_value
from s2sad.tree import AST

Objects = Mapping[int, Object]


@dataclass(frozen=True)
class Part:
    """One value of what is returned: a `leaf` of the result or one that was `given` (by number), a `constant`, an
    `object` that is made, one that was met before (`again`), one that was given (`reference`), a `tuple`."""
    kind: str
    what: Any = None
    parts: tuple[Part, ...] = ()
    made: Any = field(default=None, compare=False)      # the constant, the object


@dataclass
class ReturnedParts:
    """The parts at one return; `leaves` are what the function returns."""
    whole: Part
    leaves: list[Data]


@dataclass
class Returned:
    """A value at a return; `data` are the names and expressions in it, which the return `node` reads in that order, by
    the names that they have in the end."""
    value: Value
    objects: Objects
    data: list[Data]
    node: Any = None

    def now(self) -> dict[int, Data]:
        """What these are in the end."""
        return {id(d): replace(d, node=n) for d, n in zip(self.data, self.node.value.args)} if self.data else {}


MARK = "returned."


def returning(ev: Evaluator, value: Value, count: int, s: AST) -> tuple[AST, Returned]:
    """A return that reads all of a value, as it stands while a function is evaluated."""
    found: list[Data] = []
    met: set[int] = set()

    def visit(v: Value) -> None:
        if isinstance(v, Data) and not v.is_literal and not v.is_list:
            found.append(v)
        elif isinstance(v, TupleValue):
            for item in v.items:
                visit(item)
        elif isinstance(v, Reference) and v.number not in met:
            met.add(v.number)
            for item in ev.heap[v].items.values():
                visit(item)
    visit(value)
    node = tree.Return(tree.call(f"{MARK}{count}", *(ev.spelled(d, s) for d in found)))
    return node, Returned(value, ev.heap.fork(), found)


def returns_in(body: Sequence[AST], every: Sequence[Returned]) -> list[Returned]:
    """The returns that are left in a function."""
    found = []
    for s in tree.walk_statements([*body]):
        if isinstance(s, tree.Return):
            made = every[int(s.value.func.id.removeprefix(MARK))]  # pyright: ignore
            found.append(replace(made, node=s))
    return found


class _Apart:
    def __init__(self, view: CallView, returned: Returned, rebound: frozenset[str], opens: bool):
        self.view, self.objects, self.rebound, self.opens = view, returned.objects, rebound, opens
        self.now = returned.now()
        self.leaves: list[Data] = []
        self.met: dict[int, int] = {}
        self.given = {leaf.name: k for k, leaf in enumerate(view.leaves)}

    def part(self, value: Value) -> Part:
        if isinstance(value, Data):
            return self._data(value)
        if isinstance(value, TupleValue):
            self._checked(value.made)
            return Part("tuple", value.made, tuple(map(self.part, value.items)))
        if isinstance(value, LibraryValue) and not value.first and not value.keywords or isinstance(value, ObjectValue):
            return Part("value", value)
        if isinstance(value, ClassValue):
            self._checked(value)
            return Part("value", value)
        if isinstance(value, Reference):
            return self._reference(value)
        raise NotSeparate("what is returned is no array, number or structure of these")

    def _data(self, value: Data) -> Part:
        value = self.now.get(id(value), value)
        if value.is_list or value.may_be_unbound:
            raise NotSeparate("a list is returned")
        place = self.given.get(value.name)
        if place is not None and value.name not in self.rebound and not (self.opens and value.shape == ()):
            return Part("given", place)
        if "." in value.name:
            return Part("constant", value.name, made=value)
        is_open = self.opens and isinstance(value.known, (bool, int, float))
        if value.is_known and not value.name and not is_open and (value.is_literal or is_spelled(value.known)):
            made = value if value.is_literal else constant(value.known)
            return Part("constant", (type(value.known).__name__, repr(value.known)), made=made)
        if isinstance(value.known, tuple) or isinstance(value.node, tree.Attribute):
            raise NotSeparate("a shape is returned")
        if value.name:
            for k, leaf in enumerate(self.leaves):
                if leaf.name == value.name:
                    return Part("leaf", k)
        self.leaves.append(value)
        return Part("leaf", len(self.leaves) - 1)

    def _reference(self, value: Reference) -> Part:
        number = value.number
        if number in self.view.objects:
            return Part("reference", self.view.order[number])
        if number in self.view.ev.outset:
            return Part("value", value)
        if number in self.met:
            return Part("again", self.met[number])
        held = self.objects[number]
        if held.kind not in ("list", "dict", "record") or held.live is not None or held.path or any(
                isinstance(k, Reference) for k in held.items):
            raise NotSeparate("what is returned is no array, number or structure of these")
        self._checked(held.made)
        self.met[number] = len(self.met)
        return Part("object", (held.kind, held.made, held.most, tuple((type(k).__name__, k) for k in held.items)),
                    tuple(map(self.part, held.items.values())), held)

    def _checked(self, made: ClassValue | None) -> None:
        if made is not None and made.live is None and not (
                made.number in self.view.objects or made.number in self.view.ev.outset):
            raise NotSeparate("an object of a class that is defined in the function")


def returned_parts(view: CallView, returned: Sequence[Returned], body: Sequence[AST], rebound: frozenset[str]
                   ) -> list[ReturnedParts]:
    """What is returned at each return, of one make; raises NotSeparate. `rebound` are the names that are bound."""
    for opens in (False, True):
        made = [_Apart(view, r, rebound, opens) for r in returned]
        wholes = [a.part(r.value) for a, r in zip(made, returned)]
        if all(w == wholes[0] for w in wholes[1:]):
            bindings = _bindings(body)
            for apart, r in zip(made, returned):
                given = {*apart.given} - _bound_before(r.node, body)
                if not all(_is_fresh(leaf, bindings, given) for leaf in apart.leaves):
                    raise NotSeparate("what is returned may be a part of what was given")
            return [ReturnedParts(w, a.leaves) for w, a in zip(wholes, made)]
    raise NotSeparate("returns of different makes")


def together(ev: Evaluator, view: CallView, whole: Part, leaves: Sequence[Value]) -> Value:
    """The value that parts are of, where the function is called."""
    met: list[Reference] = []

    def value(part: Part) -> Value:
        if part.kind == "leaf":
            return leaves[part.what]
        if part.kind == "given":
            return view.leaves[part.what].outer
        if part.kind == "constant":
            return part.made
        if part.kind == "value":
            return part.what
        if part.kind == "reference":
            return Reference(view.number_of(part.what))
        if part.kind == "again":
            return met[part.what]
        if part.kind == "tuple":
            return TupleValue(tuple(map(value, part.parts)), part.what)
        made = ev.heap.new(replace(part.made, items={}, label=""))
        met.append(made)
        ev.heap.set_items(made, dict(zip(part.made.items, map(value, part.parts))))
        return made
    return value(whole)


def given_leaves(whole: Part) -> list[int]:
    """Which of what was given comes back."""
    return [whole.what] if whole.kind == "given" else [k for p in whole.parts for k in given_leaves(p)]


def merged(leaves: Sequence[Data]) -> Data:
    """What is known of a leaf that several returns give."""
    shapes = {leaf.shape for leaf in leaves}
    return replace(leaves[0], known=UNKNOWN, shape=shapes.pop() if len(shapes) == 1 else None,
                   demands=frozenset().union(*(leaf.demands for leaf in leaves)),
                   origins=frozenset().union(*(leaf.origins for leaf in leaves)))


# -- memory ----------------------------------------------------------------------------------------------------------
def rebound_names(body: Sequence[AST]) -> frozenset[str]:
    """The names that statements bind: an array that is added to in place stays the one that it is."""
    augmented = {id(s.target) for s in tree.walk_statements([*body]) if isinstance(s, tree.AugAssign)}
    return frozenset(n.id for n in tree.walk([*body]) if isinstance(n, tree.Name) and isinstance(n.ctx, tree.Store)
                     and id(n) not in augmented)


def _bound_before(node: AST, body: Sequence[AST]) -> set[str]:
    """The names that are bound whenever a return is reached."""
    found: set[str] = set()
    for s in body:
        if any(n is node for n in tree.walk_statements([s])):
            break
        if isinstance(s, tree.Assign):
            found |= {t.id for t in s.targets if isinstance(t, tree.Name)}
    return found


def _bindings(body: Sequence[AST]) -> dict[str, list[AST | None]]:
    """What names are bound to; None for what says nothing of memory."""
    found: dict[str, list[AST | None]] = {}

    def bind(target: Any, value: AST | None) -> None:
        if isinstance(target, tree.Name):
            found.setdefault(target.id, []).append(value)
        elif isinstance(target, tree.Tuple):
            items = value.elts if isinstance(value, tree.Tuple) and len(value.elts) == len(target.elts) else None
            own = isinstance(value, tree.Call) and is_separate(value)
            for k, t in enumerate(target.elts):
                bind(t, items[k] if items is not None else value if own else None)
    for s in tree.walk_statements([*body]):
        if isinstance(s, tree.Assign):
            for target in s.targets:
                bind(target, s.value)
        elif isinstance(s, tree.For):
            ranges = isinstance(s.iter, tree.Call) and isinstance(s.iter.func, tree.Name) and s.iter.func.id == "range"
            bind(s.target, tree.const(0) if ranges else None)
    return found


def is_separate(call: Any) -> bool:
    """Whether a call is one of a function that was evaluated by itself."""
    return isinstance(call.func, tree.Name) and call.func.id.startswith("separate.")


_FRESH = (
    "zeros", "ones", "empty", "full", "zeros_like", "ones_like", "empty_like", "full_like", "copy", "array",
    "sum", "mean", "prod", "max", "min", "amax", "amin", "dot", "matmul", "outer", "cumsum", "cumprod", "roll",
    "where", "concatenate", "stack", "vstack", "hstack", "column_stack", "diff", "linspace", "arange", "clip",
    "sort", "argsort", "interp", "tile", "repeat", "solve", "norm", "inv", "det", "cross", "kron", "pad", "triu",
    "tril", "eye", "identity", "argmax", "argmin", "std", "var", "trace", "vdot", "inner", "tensordot",
    "trapezoid", "average", "median", "cholesky", "float64", "len", "float", "int", "abs", "round", "range")
_METHODS = ("copy", "sum", "mean", "prod", "max", "min", "dot", "cumsum", "cumprod", "std", "var", "trace", "argmax",
            "argmin", "item")


def _is_fresh(leaf: Data, bindings: Mapping[str, Sequence[AST | None]], given: set[str]) -> bool:
    """Whether something is a number or an array that nothing else has."""
    asked: set[str] = set()

    def fresh(node: Any) -> bool:
        if isinstance(node, tree.Name):
            if node.id in asked:
                return True
            asked.add(node.id)
            return node.id not in given and node.id in bindings and all(map(fresh, bindings[node.id]))
        if isinstance(node, tree.IfExp):
            return fresh(node.body) and fresh(node.orelse)
        if isinstance(node, tree.Call):
            return _makes_fresh(node)
        if isinstance(node, tree.Subscript):        # a part of what has no name
            return not isinstance(node.value, tree.Name) and fresh(node.value)
        return isinstance(node, (tree.Constant, tree.BinOp, tree.UnaryOp, tree.Compare))
    return leaf.shape == () or fresh(leaf.node)


def _makes_fresh(call: Any) -> bool:
    if any(k.arg in ("out", "copy") for k in call.keywords):
        return False
    if is_separate(call):
        return True
    if isinstance(call.func, tree.Attribute):
        return call.func.attr in _METHODS
    path = tree.call_name(call) or ""
    room, _, name = path.rpartition(".")
    if room == "math":
        return True
    value: Any = library_value(path) if room.startswith("numpy") else None
    return getattr(value, "nin", 0) > 0 and len(call.args) == value.nin or room.partition(".")[0] in (
        "numpy", "scipy", "builtins", "") and name in _FRESH


