"""growing: lists that grow by `append` become arrays that are filled.

    def f(x, n):                                def f(x, n):
        u = [x[0]]                                  u = list(1 + len(range(n)))
        for k in range(n):                          u[0] = x[0]
            u.append(np.sin(u[-1]) * x[k])          u_count = 1
        return u[-1]                                for k in range(n):
                                                        u[k + 1] = np.sin(u[u_count - 1]) * x[k]
                                                        u_count += 1
                                                    return u[u_count - 1]

Requires resolved names and no comprehensions; establishes that there are no appends. `builtins.list(count)` is an array
whose type follows from what is stored (`infer`); `list_allocation` allocates it. Where it is not known how long
a list becomes (`Capacity`), its array doubles when it is full.
"""
from __future__ import annotations

from s2sad.infer.list_arrays import LISTED, MARKS, filled_part, growing_capacity, list_arrays
from s2sad.normalize.live_range_splitting import LiveRanges
from s2sad.normalize.lists.capacity import Capacity, sink_empty_lists
from s2sad.normalize.lists.list_columns import list_columns
from s2sad.normalize.lists.list_lengths import ListLengths
from s2sad.normalize.lists.list_homes import bindings_of, holds_lists, list_homes
from s2sad.normalize.lists.list_statements import (
    appended_list, as_arrays, changed_inside, grown_lists, is_first, operands, popped_list, unfilled,
)
from s2sad.normalize.lists.list_contents import COPIED, row_aliases
from s2sad.normalize.lists.escaping_lists import escaping_lists, has_sizes
from s2sad.evaluate.scope import KernelScope
from s2sad.liveness import base_name
from s2sad.normalize.views.views_without_axes import makes_view
from s2sad.tree import (
    AST, Add, Assign, Attribute, BoolOp, Call, Eq, FunctionDef, Gt, If,
    IfExp, List, Name, Not, Raise, Slice, Store, Sub, Subscript, Tuple, UnaryOp, add, assign, at,
    augment,
    call, call_name, compare, const, copy, head_copy, index, indices, name, rebuild, sub,
    walk, walk_statements,
)

_REBOUND = ("pick its elements by written numbers, or in loops through it, and give it no second name; or allocate an "
         "array before and fill it in a for loop")
_DISPLAYS = {"tuple": Tuple, "list": List}
HELP = "allocate an array before and fill it in a for loop"
_SAME = ("numpy.asarray", "numpy.ascontiguousarray")
_LIST = next(m for m, kind in MARKS.items() if kind == "list")
_EXTREME = {"builtins.max": "numpy.max", "builtins.min": "numpy.min"}      # of one list


def growing(function: FunctionDef, scope: KernelScope) -> FunctionDef:
    """The function with arrays in place of these lists and of comprehensions."""
    function = rebuild(function, unfilled)
    nodes = list(walk(function.body))
    if not escaping_lists(function) and not grown_lists(function) and not any(call_name(n) == LISTED for n in nodes):
        _refuse_row_aliases(function, scope)
        return function
    new = sink_empty_lists(_with_own_names(function, scope), scope, appended_list)
    new = list_columns(list_homes(new, {*grown_lists(new)}, scope.fresh), scope.fresh)
    scope.report.finish()
    scope.begin(new)
    _refuse_row_aliases(new, scope)
    alone = {s.targets[0].id for s in walk_statements(new.body) if isinstance(s, Assign)
             and isinstance(s.targets[0], Name)}
    return _GrowingLists(new, scope, [n for n in escaping_lists(new) if n in alone],
                         {appended_list(n) for n in nodes}).function()


def marked(item: AST) -> AST:
    """An item of a list; one that is a list or a tuple has a mark, for `list_operators`."""
    return next((call(m, item) for m, kind in MARKS.items() if isinstance(item, _DISPLAYS[kind])), item)


def _refuse_row_aliases(function: FunctionDef, scope: KernelScope) -> None:
    for store in row_aliases(function, appended_list):
        scope.refuse(store, "a list holds another list that is written, not a copy of it", help=COPIED)


def _with_own_names(function: FunctionDef, scope: KernelScope) -> FunctionDef:
    """The function in which a name that is a list at first and another thing later is two, as behind
    `us = np.array(us)` or in `for row in rows`."""
    return LiveRanges(function, {*grown_lists(function)}).split(scope.names) or function


class _GrowingLists:
    def __init__(self, tree: FunctionDef, scope: KernelScope, escaping: list[str], appended: set[str | None]):
        self.tree, self.scope, self.escaping = tree, scope, escaping
        self.capacity = Capacity(tree, scope, appended_list)
        self.intervals = self.capacity.intervals
        self.appended = appended        # names that the text appends to, not a comprehension
        self.as_arrays, self.changed_inside, self.operands = as_arrays(tree), changed_inside(tree), operands(tree)
        self.made: dict[str, Assign] = {}
        self.counts: dict[str, str] = {}
        self.sizes: dict[str, AST | None] = {}      # how long each becomes; None if that is not known where it is made
        self.refills: dict[int, str] = {}           # what binds a list that is there already
        self.popped = {n for s in walk_statements(tree.body) if (n := popped_list(s)) is not None}
        self.firsts = {n: scope.fresh(f"{n}_first") for n in sorted(self.popped) if any(
            popped_list(s) == n and is_first(s) for s in walk_statements(tree.body))}  # where each begins in its array

    def function(self) -> FunctionDef:
        empty = list_arrays(self.tree)
        grown = dict.fromkeys([*self.escaping, *grown_lists(self.tree)])
        self.made |= empty
        self.counts |= {n: self.scope.fresh(f"{n}_count") for n in empty}
        for found in grown:
            bound = bindings_of(self.tree, found)
            stores = [n for n in walk(self.tree.body) if isinstance(n, Name) and n.id == found
                      and isinstance(n.ctx, Store)]
            if not bound or len(stores) != len(bound) or len(bound) > 1 and (
                    found in self.escaping or holds_lists(self.tree, found)) or not all(
                    len(s.targets) == 1 and isinstance(s.value, (List, Tuple) if found in self.escaping else List)
                    for s in bound):
                self.refuse_rebound(found)
                continue
            self.made[found] = bound[0]
            self.counts[found] = self.scope.fresh(f"{found}_count")
            self.refills |= {id(s): found for s in bound[1:]}
            self.sizes[found] = None if bound[1:] else self.capacity.of(found, bound[0])
        self.scope.report.finish()
        self.lengths = ListLengths(self.tree, self.made, self.capacity)
        new = copy(self.tree)
        new.body = self.block(self.tree.body)
        return new

    def block(self, block: list[AST]) -> list[AST]:
        return [at(made, s) for s in block for made in self.statement(s)]

    def refuse_rebound(self, found: str) -> None:
        place = next(s for s in walk(self.tree.body) if appended_list(s) == found or popped_list(s) == found)
        if found in self.appended:
            self.scope.refuse(place, f"append to {found!r}, which is not bound once, to a list",
                              help="bind it once, as [] or as a list of what it starts with")
        else:
            self.scope.refuse(place, f"{found!r} is a list that a comprehension binds anew", help=_REBOUND)

    def statement(self, statement: AST) -> list[AST]:
        appended = appended_list(statement)
        if appended in self.made:
            count = self.counts[appended]
            item = statement.value.args[0]
            item = call(_LIST, item) if isinstance(item, Name) and item.id in self.made else marked(item)
            known = self.sizes.get(appended) is not None and appended not in self.popped
            place = known and self.lengths.append_index(appended) or name(count)
            return [assign(index(name(appended), place), self.read(item)), augment(count, Add(), const(1))]
        target = statement.targets[0] if isinstance(statement, Assign) else None
        if isinstance(target, Subscript) and isinstance(target.value, Name) and target.value.id in self.made:
            return [assign(self.read(target), self.read(marked(statement.value)))]
        if id(statement) in self.refills:
            return self.filled(self.refills[id(statement)], list(map(marked, statement.value.elts)))
        if popped_list(statement) in self.made:
            taken = popped_list(statement) or ""
            return self.pop(statement, taken) if isinstance(statement, Assign) else self.filled(taken, [])
        bound = next((n for n, s in self.made.items() if s is statement), None)
        if bound is not None:
            return self.allocation(bound, statement)
        if isinstance(target, Name) and isinstance(statement.value, Name) and statement.value.id in self.made:
            self.scope.refuse(statement, f"{target.id!r} is bound to another list", help=_REBOUND)
            return [statement]
        new = head_copy(statement)
        for field in statement._fields:
            inner = getattr(statement, field)
            if field in ("body", "orelse"):
                setattr(new, field, self.block(inner))
            elif field == "test":
                new.test = self.test(inner)
            elif isinstance(inner, AST):
                setattr(new, field, self.read(inner))
            elif isinstance(inner, list):
                setattr(new, field, [self.read(i) if isinstance(i, AST) else i for i in inner])
        return [new]

    def allocation(self, bound: str, statement: Assign) -> list[AST]:
        """The array in place of the list, as large as its capacity, with what it starts with."""
        if call_name(statement.value) == LISTED:
            count = statement.value.args[0]
            return [assign(self.counts[bound], count), assign(bound, call(LISTED, name(self.counts[bound])))]
        items = list(map(marked, statement.value.elts))
        first: list[AST] = []
        if bound in self.escaping and not has_sizes(items[0]) and call_name(items[0]) not in MARKS:
            items[0] = self.scope.held(items[0], f"{bound}_first", first)      # whose sizes `list_allocation` takes
        size, reused = self.sizes[bound], [const(True)] if self.is_reused(bound) else []
        longest = max([len(items), *(len(s.value.elts) for s in bindings_of(self.tree, bound))])
        sizes = [growing_capacity(longest), const(True)] if size is None else [size, const(False)][:1 + len(reused)]
        return [*first, assign(bound, call(LISTED, *sizes, *reused)), *self.filled(bound, items)]

    def filled(self, bound: str, items: list[AST]) -> list[AST]:
        """What a list starts with, in its array."""
        made: list[AST] = [assign(index(name(bound), const(k)), self.read(item)) for k, item in enumerate(items)]
        made += [assign(self.firsts[bound], const(0))] if bound in self.firsts else []
        return [*made, assign(self.counts[bound], const(len(items)))]

    def is_reused(self, bound: str) -> bool:
        """Whether places of the array are filled again."""
        return bound in self.popped or bound in self.refills.values()

    def pop(self, statement: Assign, popped: str) -> list[AST]:
        """An item of a list that has one, which is no longer in it."""
        first, count = self.firsts.get(popped), self.counts[popped]
        error = Raise(call("builtins.IndexError", const("pop from empty list")), None)
        empty = compare(name(count), Eq(), const(0) if first is None else name(first))
        at_first = is_first(statement)
        place = name(first) if at_first and first else sub(name(count), const(1))
        return [If(empty, [error], []), assign(copy(statement.targets[0]), index(name(popped), place)),
                augment(first, Add(), const(1)) if at_first and first else augment(count, Sub(), const(1))]

    def length(self, listed: str) -> AST:
        """How long a list is."""
        count = name(self.counts[listed])
        return sub(count, name(self.firsts[listed])) if listed in self.firsts else count

    def filled_length(self, node: Subscript) -> AST | None:
        """How long the array of a list is, if that is how long the list is where one of its items is read."""
        known = self.sizes.get(node.value.id) is not None and self.lengths.is_filled(node) and not isinstance(
            indices(node)[0], UnaryOp)
        return call("builtins.len", name(node.value.id)) if known else None

    def items(self, listed: str) -> AST:
        """The part of its array that a list is."""
        first = name(self.firsts[listed]) if listed in self.firsts else None
        return index(name(listed), Slice(first, name(self.counts[listed]), None))

    # -- reading -----------------------------------------------------------------------------------------------------

    def read(self, node: AST) -> AST:
        return rebuild(node, self.change)

    def test(self, node: AST) -> AST:
        """A test, in which a list is true if something is in it."""
        if isinstance(node, Name) and node.id in self.made:
            first = name(self.firsts[node.id]) if node.id in self.firsts else const(0)
            return at(compare(name(self.counts[node.id]), Gt(), first), node)
        if isinstance(node, UnaryOp) and isinstance(node.op, Not):
            return at(UnaryOp(Not(), self.test(node.operand)), node)
        if isinstance(node, BoolOp):
            return at(BoolOp(node.op, list(map(self.test, node.values))), node)
        return self.read(node)

    def change(self, node: AST) -> AST | None:
        if isinstance(node, IfExp):
            return at(IfExp(self.test(node.test), self.read(node.body), self.read(node.orelse)), node)
        if isinstance(node, Subscript) and isinstance(node.value, Name) and node.value.id in self.made:
            return self.element(node)
        if call_name(node) == "builtins.len" and isinstance(node.args[0], Name) and node.args[0].id in self.made:
            return at(self.length(node.args[0].id), node)
        if call_name(node) in _EXTREME and len(node.args) == 1 and not node.keywords and isinstance(
                node.args[0], Name) and node.args[0].id in self.made:
            return at(call(_EXTREME[call_name(node) or ""], self.items(node.args[0].id)), node)
        if isinstance(node, Call) and makes_view(node) and base_name(node.args[0]) in self.made and id(
                node.args[0]) in self.as_arrays:
            return self.new_array(node)
        if isinstance(node, Attribute) and isinstance(node.value, Name) and node.value.id in self.made:
            self.scope.refuse(node, f"the method {node.attr!r} of a list", help="a list may grow by append and be read")
            return copy(node)
        if isinstance(node, Name) and node.id in self.made:
            if isinstance(node.ctx, Store):
                return None
            if id(node) in self.operands:
                return at(call(_LIST, self.items(node.id)), node)
            if id(node) not in self.as_arrays:
                self.scope.refuse(node, f"the list {node.id!r} is used as a list",
                                  help="make it an array with np.array")
            return at(self.items(node.id), node)
        return None

    def new_array(self, node: Call) -> AST:
        """A function that gives a view of an array, of a list: it makes an array of its items, a new one."""
        items, *args = map(self.read, node.args)
        keywords = [self.read(k) for k in node.keywords]
        if call_name(node) in _SAME:
            return at(Call(name("numpy.array"), [items, *args], keywords), node)
        return at(Call(self.read(node.func), [call("numpy.array", items), *args], keywords), node)

    def element(self, node: Subscript) -> AST:
        """An element of a list, counted from the end where its index is negative."""
        place, count = indices(node)[0], name(self.counts[node.value.id])
        if len(indices(node)) == 1 and isinstance(place, Slice) and id(node) in self.as_arrays - self.changed_inside:
            return at(index(self.items(node.value.id), self.read(place)), node)
        if len(indices(node)) > 1 or isinstance(place, Slice):
            self.scope.refuse(node, "a part of a list", help=HELP)
        inside, first = self.lengths.is_inside(node), self.firsts.get(node.value.id)
        if inside and isinstance(place, UnaryOp):
            found: AST = sub(count, place.operand)
        else:
            found = self.read(place)
            if not self.intervals.is_nonnegative(place) or not (inside or self.lengths.is_fixed(node.value.id)):
                found = call("runtime.element", found, self.lengths.exact(node) or self.filled_length(node)
                             or self.length(node.value.id))
            found = add(name(first), found) if first else found
        array = filled_part(node.value, copy(count)) if isinstance(node.ctx, Store) else node.value
        return at(index(array, found), node)
