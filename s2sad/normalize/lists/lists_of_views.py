"""lists_of_views: a list of the rows of an array is a view of that array, where one of the two is stored into.

    rows = builtins.list(n)             rows = a[0:n]
    count = 0                           count = 0
    for i in range(n):                  for i in range(n):
        rows[i] = a[i]                      count += 1
        count += 1                      rows[1][0] *= 3.0
    rows[1][0] *= 3.0

Requires structured form and types. `list_allocation` makes an array in place of a list, into which arrays are copied:
establishes that no store makes a copy differ from what it was copied from. Only a list of the rows of one array, one
after the other, can be a view; all others are refused.
"""
from __future__ import annotations

from s2sad.blocks import with_blocks
from s2sad.diagnostics import Report
from s2sad.evaluate.effects import Memory
from s2sad.infer.inference import Typing
from s2sad.liveness import base_name
from s2sad.normalize.lists.list_contents import HELP, ListContents, Writes, counter_offset, stored_into_later
from s2sad.tree import (
    AST, Add, Assign, Attribute, AugAssign, BinOp, Break, Compare, Constant, FloorDiv, For, FunctionDef, Mult, Name,
    Slice, Store, Sub, Subscript, add, assign, at, call, call_name, const, copy, dump, index, indices, names, rebuild,
    stored_names, sub, walk, walk_statements, with_body,
)


def lists_of_views(function: FunctionDef, typing: Typing, memory: Memory, writes: Writes,
                   report: Report) -> FunctionDef:
    """The function with those views; refuses the lists that would have to be one and cannot."""
    function = _with_copied_elements(function, ListContents(function, typing, writes))
    contents = ListContents(function, typing, writes)
    pass_ = _Views(contents)
    diverging: dict[str, tuple[str, AST, str]] = {}
    stores = [s for several in contents.stores.values() for s in several]
    for statement in stored_into_later(function, stores, typing, memory):
        diverging.setdefault(base_name(statement.targets[0]),
                        ("a list holds an array that is written, not a copy of it", statement, HELP))
    for listed in contents.stores:
        if (place := contents.replaced_element(listed)) is not None:
            diverging.setdefault(listed, (f"an element of the list {listed!r} becomes another array, and what it was "
                                          "is read later", place, "name a copy of what it was: x = xs[k].copy()"))
        if (place := contents.diverging_store(listed)) is not None:
            diverging.setdefault(listed, (f"the list {listed!r} holds views of an array, or one array several times, "
                                          "and what it holds is written", place, HELP))
    if not diverging:
        return function
    together = {other for listed in diverging for other in contents.related(listed)}
    views = {listed: view for listed in sorted(together) if (view := pass_.as_view(listed)) is not None}
    for listed, (message, place, help) in diverging.items():
        if any(other not in views for other in contents.related(listed)):
            report.error("S201", message, place, help=help)
    return with_body(function, pass_.with_views(function.body, views))


def _with_copied_elements(function: FunctionDef, contents: ListContents) -> FunctionDef:
    """The function in which a name of an element is one of a copy, where another array takes its place while the name
    is used; not where what the list holds is written, unless the element is taken out, and nothing else has it.

        v = us[us_count - 1]            v = np.copy(us[us_count - 1])
        us_count -= 1                   us_count -= 1
        us[us_count] = 0.5 * v          us[us_count] = 0.5 * v
        us[us_count + 1] = 0.3 * v      us[us_count + 1] = 0.3 * v
    """
    replaced = {n for n in contents.stores if contents.replaced_element(n) is not None}
    written = {n for n in replaced if contents.is_written(n)}

    def change(node: AST) -> AST | None:
        if not isinstance(node, Assign) or not isinstance(node.value, Subscript) or not isinstance(
                node.targets[0], Name) or (listed := base_name(node.value)) not in replaced or any(
                isinstance(i, Slice) for i in indices(node.value)) or not contents.typing.of(node.value).is_array or (
                listed in written and not (contents.has_alone(listed) and contents.takes_out(node))):
            return None
        return at(assign(node.targets[0].id, call("numpy.copy", copy(node.value))), node)
    return rebuild(function, change) if replaced else function


class _Views:
    """The views in place of lists."""

    def __init__(self, contents: ListContents):
        self.contents, self.function = contents, contents.function

    def as_view(self, listed: str) -> tuple[AST, AST] | None:
        """The part of an array whose rows a list holds, one after the other, and the loop that puts them there."""
        made, stores = self.contents.made[listed], self.contents.stores[listed]
        block = next(b for b in self.contents.blocks if any(s is made for s in b))
        here = next(k for k, s in enumerate(block) if s is made)
        place = next((k for k, s in enumerate(block) if isinstance(s, For) and len(stores) == 1 and any(
            n is stores[0] for n in s.body)), 0)
        loop = block[place]
        if not isinstance(loop, For) or any(isinstance(n, Break)
                                            for n in walk_statements(loop.body)) or listed in names(
                block[here + 1:place]):
            return None
        value = self.stored_value(stores[0], loop)
        if not isinstance(value, Subscript) or not isinstance(value.value, Name):
            return None
        first, *rest = indices(value)
        shift = counter_offset(first, loop)
        bounds = loop.iter.args if len(loop.iter.args) == 2 else [const(0), *loop.iter.args]
        plain = len(bounds) == 2 and all(
            isinstance(r, Slice) and (r.lower, r.upper, r.step) == (None, None, None) for r in rest)
        if shift is None or not plain or not all(
                self.is_bound_once_before(n, loop) for n in names([value.value, *bounds])):
            return None
        lowest = lower_bound(bounds[0], self.function)
        # a row that is counted from the end is no part's first one
        if lowest is None or lowest + shift < 0 or not fills_in_order(stores[0], loop, self.function):
            return None
        return index(value.value, Slice(*(_shifted(copy(b), shift) for b in bounds), None)), loop

    def stored_value(self, store: Assign, loop: For) -> AST:
        """What is stored; the value of a name that the same iteration binds."""
        if not isinstance(store.value, Name):
            return store.value
        place = next(k for k, s in enumerate(loop.body) if s is store)
        bound = [s for s in loop.body[:place] if store.value.id in stored_names(s)]
        return bound[0].value if len(bound) == 1 and isinstance(bound[0], Assign) else store.value

    def is_bound_once_before(self, identifier: str, place: AST) -> bool:
        """Whether a name is bound once, and before a statement."""
        stores = [n for n in walk(self.function.body) if isinstance(n, Name) and n.id == identifier
                  and isinstance(n.ctx, Store)]
        return "." in identifier or len(stores) == (identifier not in self.contents.parameters) and all(
            self.contents.order[id(n)] < self.contents.order[id(place)] for n in stores)

    def with_views(self, block: list[AST], views: dict[str, tuple[AST, AST]]) -> list[AST]:
        """A block with each view bound before the loop that would fill the list."""
        gone = {id(s) for listed in views for s in (self.contents.made[listed], *self.contents.stores[listed])}
        made: list[AST] = []
        for s in block:
            made += [at(assign(listed, view), self.contents.made[listed]) for listed, (view, loop) in views.items()
                     if loop is s]
            made += [] if id(s) in gone else [with_blocks(s, lambda inner: self.with_views(inner, views))]
        return made


def _shifted(bound: AST, shift: int) -> AST:
    if isinstance(bound, Constant) and type(bound.value) is int:
        return const(bound.value + shift)
    return bound if not shift else add(bound, const(shift)) if shift > 0 else sub(bound, const(-shift))


def fills_in_order(store: Assign, loop: For, function: FunctionDef) -> bool:
    """Whether a store in a loop over a range of two bounds or one goes to the places 0, 1, 2, ... of a list."""
    place = store.targets[0].slice
    if isinstance(place, BinOp) and isinstance(place.right, BinOp) and isinstance(place.right.right, Compare):
        place = place.left                              # what is added where it is negative
    start = loop.iter.args[0] if len(loop.iter.args) == 2 else const(0)
    shift = counter_offset(place, loop)
    if shift is not None:
        return isinstance(start, Constant) and start.value + shift == 0
    if isinstance(place, BinOp):
        return isinstance(place.op, Sub) and counter_offset(place.left, loop) == 0 and dump(place.right) == dump(start)
    return isinstance(place, Name) and _is_count(place.id, store, loop, function)


def _is_count(identifier: str, store: Assign, loop: For, function: FunctionDef) -> bool:
    """Whether a name is 0 before a loop and one more after a store in it, which every iteration runs."""
    bound = [s for s in walk_statements(function.body) if isinstance(s, (Assign, AugAssign, For)) and any(
        isinstance(n, Name) and n.id == identifier and isinstance(n.ctx, Store)
        for n in walk(s.target if isinstance(s, (AugAssign, For)) else s.targets[0]))]
    if len(bound) != 2 or not isinstance(bound[0], Assign) or not isinstance(bound[1], AugAssign):
        return False
    added = bound[1]
    own = any(s is added for s in loop.body) and any(s is store for s in loop.body)
    return own and isinstance(added.op, Add) and getattr(added.value, "value", None) == 1 and getattr(
        bound[0].value, "value", None) == 0 and _precedes(store, added, loop.body)


def _precedes(first: AST, second: AST, block: list[AST]) -> bool:
    places = [k for k, s in enumerate(block) if s is first or s is second]
    return block[places[0]] is first


def lower_bound(node: AST, function: FunctionDef, depth: int = 0) -> int | None:
    """What an integer is at least, as far as the text shows it."""
    if isinstance(node, Constant):
        return node.value if type(node.value) is int else None
    if call_name(node) == "builtins.len" or isinstance(node, Subscript) and isinstance(
            node.value, Attribute) and node.value.attr == "shape":
        return 0
    if isinstance(node, Name) and depth < 8:
        bound = [s for s in walk_statements(function.body) if isinstance(s, (Assign, AugAssign, For)) and any(
            isinstance(n, Name) and n.id == node.id and isinstance(n.ctx, Store)
            for n in walk(s.target if isinstance(s, (AugAssign, For)) else s.targets[0]))]
        if len(bound) != 1 or node.id in {p.id for p in function.args.args}:
            return None
        return lower_bound(bound[0].value, function, depth + 1) if isinstance(bound[0], Assign) and isinstance(
            bound[0].targets[0], Name) else None
    if not isinstance(node, BinOp):
        return None
    left, right = lower_bound(node.left, function, depth), lower_bound(node.right, function, depth)
    if left is None or right is None:
        return None
    if isinstance(node.op, Add):
        return left + right
    if isinstance(node.op, Sub):
        return left - right if isinstance(node.right, Constant) else None
    positive = left >= 0 and (right >= 0 if isinstance(node.op, Mult) else right > 0)
    return 0 if positive and isinstance(node.op, (Mult, FloorDiv)) else None
