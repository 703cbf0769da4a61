"""Loop-closed names: what a loop within a loop binds, and something behind it reads, has a name that only it binds.

    for i in range(n):                          for i in range(n):
        for j in range(i + 1, n):                   for j in range(i + 1, n):
            last = i                                    s += x[j]
            s += x[j]                   ->              last = i
    return s * x[last]                          return s * x[last]

Without it `last` would be one with `i`, which goes on where the inner loop has no round.
"""
from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Any

from s2sad import tree
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator
from s2sad.evaluate.specialize.heap import Object
from s2sad.evaluate.specialize.values import Data, Reference, ResidualObject, TupleValue, Value, parts
from s2sad.tree import AST

Objects = dict[int, Object]


def close_names(ev: Evaluator, loop: Any, head: Objects, ends: Sequence[Objects], origin: AST, f: Frame) -> bool:
    """Gives such names homes in a loop; whether there are new ones."""
    around = [other for other in ev.loops if not isinstance(other, tuple)]
    found = False
    for objects in ends if around else ():
        for n, held in objects.items():
            if held.kind != "frame" or n not in head:
                continue
            new = {k: v for k, v in held.items.items() if k not in head[n].items and (n, k) not in loop.homes
                   and any(_goes_on(ev, m, loop, around) for m in _leaf_names(objects, v))}
            for key in new.keys() & read_outside(ev, n, new, origin, f):
                if not isinstance(new[key], Data):
                    raise ev.unknown(origin, f"'{key}' is made in this loop of what a loop around it binds, and read "
                                     "behind it")
                loop.homes[n, key] = ev.fresh(str(key))
                found = True
    return found


def forget_own_names(ev: Evaluator, head: Objects, ends: Sequence[Objects], origin: AST, f: Frame) -> None:
    """Takes out of the states at the ends of a round the names of objects that each round binds before it reads them,
    and nothing reads outside: `old = new` leaves one name for the object."""
    n = f.reference.number
    there = head[n].items if n in head else {}
    bound = {k for objects in ends if n in objects for k, v in objects[n].items.items()
             if k not in there and isinstance(k, str) and isinstance(v, Reference)
             and objects[v.number].kind in ("record", "dict") and ev.heap.holders(v, objects) > 1}
    if not bound:
        return
    inner = [m for m in tree.walk(origin) if type(m).__name__ in ("FunctionDef", "Lambda", "GeneratorExp", "ClassDef")]
    own = bound - read_outside(ev, n, bound, origin, f) - {m.id for m in tree.walk(inner) if isinstance(m, tree.Name)}
    for objects in ends if own else ():
        objects[n] = replace(objects[n], items={k: v for k, v in objects[n].items.items() if k not in own})


def _leaf_names(objects: Objects, value: Value) -> Iterator[str]:
    if isinstance(value, Data):
        yield value.name
    elif isinstance(value, (TupleValue, ResidualObject)):
        for v in parts(value):
            yield from _leaf_names(objects, v)
    elif isinstance(value, Reference) and value.number in objects:
        for v in objects[value.number].items.values():
            if not isinstance(v, Reference):
                yield from _leaf_names(objects, v)


def _goes_on(ev: Evaluator, name: str, loop: Any, around: Sequence[Any]) -> bool:
    """Whether loops around a loop bind a name, and the loop itself does not."""
    born = ev.born.get(name, 0)
    if not name or born > loop.birth or name in loop.targets:
        return False
    return any(born > other.birth or name in other.targets or name in other.home_names() for other in around)


def frames_around(ev: Evaluator, f: Frame) -> dict[int, Frame]:
    """The frames whose statements a loop in a frame may run, by number: those around it, and those of loops that go
    through the generator that it is in."""
    found: dict[int, Frame] = {}
    for inner in (f, *(loop[3] for loop in ev.loops if isinstance(loop, tuple) and len(loop) > 3)):
        frame: Frame | None = inner
        while frame is not None:
            found.setdefault(frame.reference.number, frame)
            frame = frame.outer
    return found


def read_outside(ev: Evaluator, n: int, names: Iterable[Any], origin: AST, f: Frame) -> set[Any]:
    """The names of a frame that its text reads outside of the loop, behind where the loops around it begin; all of them
    where the text is not at hand."""
    frame = frames_around(ev, f).get(n) or ev.frames.get(n)
    if frame is None:
        return set(names)
    inside = {id(origin), *(id(loop[2]) for loop in ev.loops if isinstance(loop, tuple) and len(loop) > 2)}
    inside |= {id(node) for (node, _), text in ev.loops_of.items() if id(text) in inside}
    found: set[Any] = {k for k in names if not isinstance(k, str)}
    begin = _begin(frame.captured.tree, inside)
    work: list[tuple[AST, frozenset[str], tuple[int, int]]] = [(frame.captured.tree, frozenset(), begin)]
    while work:
        node, bound, begin = work.pop()
        if id(node) in inside:
            continue
        if isinstance(node, tree.Name) and isinstance(node.ctx, tree.Load) and node.id not in bound and (
                _place(node) >= begin):
            found.add(node.id)
        kind = type(node).__name__
        begin = (0, 0) if kind in ("Lambda", "GeneratorExp") or kind == "FunctionDef" and (
            node is not frame.captured.tree) else begin      # which may be called behind
        work += [(part, own, begin) for part, own in _parts_with_bound(node, bound, inside)]
    return found


def _parts_with_bound(node: Any, bound: frozenset[str], inside: set[int]) -> Iterator[tuple[AST, frozenset[str]]]:
    """The parts of a node, with the names that it has bound itself where they are read."""
    others: list[AST] = []
    own = bound
    if isinstance(node, tree.For) and not any(id(n) in inside for n in tree.walk(node)):
        own, others = bound.union(tree.stored_names(node.target)), [node.iter, *node.orelse]
    elif generators := getattr(node, "generators", ()):
        own, others = bound.union(*(tree.stored_names(g.target) for g in generators)), [generators[0].iter]
    elif type(node).__name__ == "Lambda":
        own = bound.union(n.id for n in tree.walk(node.args) if isinstance(n, tree.Name))
        others = [n for n in (*node.args.defaults, *node.args.kw_defaults) if n is not None]
    outer = set(map(id, others))
    left = list(tree.children(node))
    while left:
        part = left.pop()
        if id(part) not in outer and type(part).__name__ in ("comprehension", "arguments"):
            left += tree.children(part)
        else:
            yield part, bound if id(part) in outer else own


def _begin(text: AST, inside: set[int]) -> tuple[int, int]:
    """Where the outermost loop of a text begins that a node is in."""
    node: AST | None = text
    while node is not None:
        if id(node) in inside or type(node).__name__ in ("For", "While") or getattr(node, "generators", ()):
            return _place(node)
        node = next((c for c in tree.children(node) if any(id(n) in inside for n in tree.walk(c))), None)
    return 0, 0


def _place(node: Any) -> tuple[int, int]:
    return getattr(node, "lineno", None) or 0, getattr(node, "col_offset", None) or 0
