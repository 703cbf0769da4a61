"""Comprehensions and generators.
"""
from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

from numpy import ufunc

from s2sad import tree
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator, expression, operation
from s2sad.evaluate.specialize.sequences.counted_sequence import list_parts
from s2sad.evaluate.specialize.signals import Unevaluated
from s2sad.evaluate.specialize.heap import Object, Temporary
from s2sad.evaluate.specialize.values import LARGEST_SEQUENCE, Data, Iteration, TupleValue, Value
from s2sad.read.outside_values import library_value
from s2sad.tree import AST

_PURE = ("builtins.", "math.", "scipy.special.")
FILLED, ITERATED = ".filled", ".iterated"


@operation
def generate(ev: Evaluator, generators: Sequence[Any], f: Frame, add: Callable[[Frame], Any],
             first: Value | None = None) -> None:
    """Every round of a comprehension whose items are known; `first` is what its first loop goes through."""
    if not generators:
        add(f)
        return
    one, *rest = generators
    through = first or ev.atoms(ev.gone_through(one.iter, f), "iterated", one.iter)
    ev.used(through, one.iter)
    inner = ev.inner_frame(f, one)
    ev.heap.put(inner.reference, ITERATED, through)
    cursor = ev.cursor_of(through, one.iter, f)
    while (step := cursor.next()) is not None:
        item, cursor = step
        ev.store(one.target, item, inner)
        if all(_kept(ev, t, inner) for t in one.ifs):
            generate(ev, rest, inner, add)
    if inner.reference.number not in ev.frames:
        ev.heap.objects.pop(inner.reference.number, None)


def _kept(ev: Evaluator, node: AST, f: Frame) -> bool:
    test = ev.test_of(node, f)
    if isinstance(test, Data):
        raise ev.unknown(node, "which items a comprehension keeps must be known before the run", test)
    return test


class Gathered:
    """What a comprehension has made so far: held in the heap, so that its names are in use."""

    def __init__(self, ev: Evaluator, f: Frame, node: AST):
        self.ev, self.holder, self.slot, self.node = ev, f.reference, Temporary("items", id(self)), node
        ev.heap.put(self.holder, self.slot, TupleValue(()))      # a loop that stays cannot add to it

    def add(self, value: Value, wanted: str = "item") -> None:
        items = self._there(self.ev.heap[self.holder].items[self.slot])
        if len(items.items) >= LARGEST_SEQUENCE:
            raise self.ev.refusal(self.node, f"a tuple or list of more than {LARGEST_SEQUENCE} items",
                                  help="allocate an array before and fill it in a for loop")
        self.ev.heap.put(self.holder, self.slot, TupleValue((*items.items, self.ev.atoms(value, wanted, self.node))))

    def done(self) -> tuple[Value, ...]:
        """All of it, as it is in the heap."""
        items = dict(self.ev.heap[self.holder].items)
        found = items.pop(self.slot, TupleValue(()))
        self.ev.heap.set_items(self.holder, items)
        return self._there(found).items

    def _there(self, found: Value) -> TupleValue:
        if not isinstance(found, TupleValue):
            raise self.ev.unknown(self.node, "which items are given must be known before the run", found)
        return found


@expression("ListComp")
def list_comprehension(ev: Evaluator, node: Any, f: Frame) -> Value:
    before = ev.snapshot()
    found = Gathered(ev, f, node)
    try:
        if id(node) in ev.sites:
            raise ev.unknown(node, "a list of the residual program")
        generate(ev, node.generators, f, lambda g: found.add(ev.value(node.elt, g)))
        return ev.list_of(found.done(), node)
    except Unevaluated as reason:
        ev.restore(before)
        return _filled(ev, node, f, reason)


def _filled(ev: Evaluator, node: Any, f: Frame, reason: Unevaluated, first: Value | None = None) -> Value:
    """A list of the residual program that statements fill: what is kept, or how many, only the run knows."""
    if reason.demands and isinstance(node.elt, tree.List) and not node.elt.elts:
        raise reason                # lists that are filled each apart: how many must be known
    before = ev.snapshot()
    start, asked = len(ev.block), bool(reason.demands) and all(what == "value" for _, what in reason.demands)
    wanted = ev.wanted.get(node, ("items", node))[0]
    made = ev.named(Data(tree.at(tree.List([], tree.Load()), node), is_list=True, rows=ev.listed_records(node)), wanted,
                    node)
    one = node.generators[0]
    try:
        first = first or ev.atoms(ev.gone_through(one.iter, f), "iterated", one.iter)
        inner = frame_inside(ev, f, node)
        ev.heap.set_items(inner.reference, {FILLED: made, ITERATED: first})
        with own_loops(ev):
            ev.statements([loops_of(ev, node, "filled", lambda: [
                tree.at(tree.Expr(tree.Call(tree.attribute(tree.name(FILLED), "append"), [node.elt], [])), node.elt)
            ])], inner)
        if reason.demands and ev.listed_records(node).known.form:
            raise reason        # of objects, which are written out where facts can say how many there are
        if asked and ev.inlines and any(map(_computes, tree.walk(ev.block[start:]))):
            raise reason        # of integers that say what there is: items that are more than expressions
        return ev.heap.objects.pop(inner.reference.number).items[FILLED]
    except Unevaluated as inner:
        ev.restore(before)
        raise (inner if inner.objects else reason) from None


@contextmanager
def own_loops(ev: Evaluator) -> Iterator[None]:
    """Statements that bind and fill what is theirs alone change nothing for what is evaluated before them."""
    start, births, effects = len(ev.block), ev.births, ev.effects
    yield
    if not any(_changes(ev, n, births) for s in ev.block[start:] for n in tree.walk(s)):
        ev.effects = effects


def _changes(ev: Evaluator, node: Any, births: int) -> bool:
    """Whether a part of a statement may change what was there when so many names had been made."""
    if isinstance(node, tree.Call):
        own = isinstance(node.func, tree.Attribute) and node.func.attr == "append" and isinstance(
            node.func.value, tree.Name) and ev.born.get(node.func.value.id, 0) >= births
        path = tree.call_name(node) or ""
        elementwise = isinstance(library_value(path), ufunc) if path.startswith("numpy.") else path.startswith(_PURE)
        return not own and not elementwise and path not in ("len", "range", "min", "max")
    if isinstance(node, tree.Name):
        return not isinstance(node.ctx, tree.Load) and ev.born.get(node.id, 0) < births
    return isinstance(node, (tree.Raise, tree.Assert, tree.Return)) or isinstance(
        node, (tree.Subscript, tree.Attribute)) and not isinstance(node.ctx, tree.Load)


def _computes(node: Any) -> bool:
    return isinstance(node, tree.Assign) and not isinstance(node.value, tree.List)


def frame_inside(ev: Evaluator, f: Frame, node: Any, *more: str) -> Frame:
    """The frame of a comprehension that statements stand for."""
    targets = frozenset(n.id for g in node.generators for n in tree.walk(g.target) if isinstance(n, tree.Name))
    return replace(ev.inner_frame(f, node.generators[0]), local=targets | {FILLED, ITERATED, *more})


def loops_of(ev: Evaluator, node: Any, use: Any, body: Callable[[], list[AST]]) -> AST:
    """The statements that a comprehension stands for in a use, the same ones each time; what its first loop goes
    through is there before."""
    if (node, use) not in ev.loops_of:
        inner = body()
        for one in reversed(node.generators):
            for test in reversed(one.ifs):
                inner = [tree.If(test, inner, [])]
            through = tree.name(ITERATED) if one is node.generators[0] else one.iter
            inner = [tree.For(one.target, through, inner, [], None)]
        ev.loops_of[node, use] = tree.at(inner[0], node)
    return ev.loops_of[node, use]


@operation
def listed(ev: Evaluator, value: Value, node: AST, f: Frame) -> Value:
    """What is gone through as a list, one of the residual program where only the run knows how long it is."""
    before = ev.snapshot()
    try:
        return ev.list_of(ev.items_of(value, node, f), node)
    except Unevaluated as reason:
        if not isinstance(value, Iteration) or value.kind != "generator" and not ev.stays_one(value):
            raise
        ev.restore(before)
        if value.kind == "generator":
            ev.used(value, node)
            return _filled(ev, value.more[0], value.more[1], reason, ev.first_of(value))
        return _filled(ev, _each(ev, node), f, reason, ev.atoms(list_parts(value), "iterated", node))


def _each(ev: Evaluator, node: AST) -> Any:
    """`[item for item in items]`, the same one each time."""
    if (node, "each") not in ev.loops_of:
        made: Any = tree.statements("[item for item in items]")[0]
        made = made.value
        made.generators[0].iter = tree.name(ITERATED)
        ev.loops_of[node, "each"] = tree.at(made, node)
    return ev.loops_of[node, "each"]


@operation
def as_comprehension(ev: Evaluator, value: Value, node: AST, f: Frame) -> Value:
    """`map` and `filter` as the generators that they are: `(f(*a) for a in zip(u, v))`."""
    if not isinstance(value, Iteration) or value.kind not in ("map", "filter"):
        return value
    function, *through = value.parts
    plain = value.kind == "filter" and isinstance(function, Data)
    several = value.kind == "map" and len(through) > 1
    if (node, value.kind) not in ev.loops_of:
        text: Any = tree.statements("(function(*item) for item in items)" if several else "(function(item) for item in "
                                    "items)" if value.kind == "map" else "(item for item in items if item)" if plain
                                    else "(item for item in items if function(item))")[0]
        ev.loops_of[node, value.kind] = tree.at(text.value, node)
    items = ev.iterator("zip", *through) if several else through[0]
    held: dict[Hashable, Value] = {"items": items, "function": function}
    inner = replace(f, reference=ev.heap.new(Object("frame", held)), outer=f, is_entry=False,
                    local=frozenset({"items", "function"}), nonlocals=frozenset())
    ev.frames.setdefault(inner.reference.number, inner)
    return generator(ev, ev.loops_of[node, value.kind], inner)


@operation
def in_statements(ev: Evaluator, value: Iteration, node: AST, f: Frame) -> Iteration:
    """A generator, a `map` or a `filter` as a generator function's, where only the run knows what it goes through."""
    before = ev.snapshot()
    try:
        for source in [ev.first_of(value)] if value.kind == "generator" else value.parts[1:]:
            ev.cursor_of(source, node, f)
        return value
    except Unevaluated:
        ev.restore(before)
    made = as_comprehension(ev, value, node, f)
    assert isinstance(made, Iteration)
    comprehension, outer = made.more
    inner = frame_inside(ev, outer, comprehension)
    ev.heap.put(inner.reference, ITERATED, ev.first_of(made))
    ev.frames.setdefault(inner.reference.number, inner)
    loops = loops_of(ev, comprehension, "yielded", lambda: [tree.Expr(tree.Yield(comprehension.elt))])
    text = tree.at(tree.FunctionDef("generator", None, [loops], [], None, None, []), node)
    return Iteration("yields", (), (inner, ev.loops_of.setdefault((comprehension, "yields"), text)), value.once)


@expression("GeneratorExp")
def generator(ev: Evaluator, node: Any, f: Frame) -> Value:
    """A generator; what its first loop goes through is evaluated now."""
    frame: Frame | None = f
    while frame is not None:        # which outlive their calls
        ev.frames.setdefault(frame.reference.number, frame)
        frame = frame.outer
    one = node.generators[0]
    return ev.iterator("generator", more=(node, f), first=ev.atoms(ev.gone_through(one.iter, f), "iterated",
                                                                         one.iter))


@expression("DictComp")
def dict_comprehension(ev: Evaluator, node: Any, f: Frame) -> Value:
    gathered = Gathered(ev, f, node)
    keys: list[Any] = []

    def add(g: Frame) -> None:
        key, value = ev.values([node.key, node.value], g)
        keys.append(ev.key_of(key, node))
        gathered.add(value, str(keys[-1]))
    generate(ev, node.generators, f, add)
    return ev.new_dict(dict(zip(keys, gathered.done())), node)


@expression("SetComp")
def set_comprehension(ev: Evaluator, node: Any, f: Frame) -> Value:
    found: list[Value] = []
    generate(ev, node.generators, f, lambda g: found.append(ev.value(node.elt, g)))
    return ev.new_set(found, node)
