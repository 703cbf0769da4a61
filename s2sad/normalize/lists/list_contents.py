"""list_contents: which names share memory with the elements of a list, which are copies here and in Python arrays.

    for k in range(n):                  for k in range(n):
        w = np.zeros(2)                     us.append(x)
        w[0] = x[k]                         x[0] = 0.0          a copy would differ: Python's list holds the new x
        us.append(w)    a copy is as good
"""
from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from s2sad.evaluate.effects import Memory, bindings, fresh_value
from s2sad.infer.inference import Typing
from s2sad.infer.list_arrays import LISTED, is_reused, list_arrays, stored_list
from s2sad.liveness import base_name
from s2sad.normalize.buffers.may_alias import UpcomingUses
from s2sad.normalize.lists.capacity import Appended, own_parts
from s2sad.normalize.views.views_without_axes import makes_view
from s2sad.program import Program
from s2sad.tree import (
    AST, Add, Assign, Attribute, AugAssign, BinOp, Call, Constant, Expr, For, FunctionDef, If, IfExp, List, Name,
    Store, Sub, Subscript, While, call, call_name, const, dump, index, indices, name, names, rebuild, rename,
    stored_names, user_call, walk, walk_statements,
)

Writes = Callable[[Call], Sequence[int]]
HELP = "append a copy: .append(x.copy())"
COPIED = "append a copy: .append(list(w))"


def memory_with_lists(function: FunctionDef, program: Program) -> Memory:
    """What may share memory where each list is an array of its own."""
    made = rebuild(function, lambda n: call("numpy.empty", const(0)) if call_name(n) == LISTED else None)
    return Memory(made, program)


class ListContents:
    """What the lists of one function hold, and which names are views of it."""

    def __init__(self, function: FunctionDef, typing: Typing, writes: Writes):
        self.function, self.typing, self.writes = function, typing, writes
        self.parameters = {p.id for p in function.args.args}
        nodes = list(walk(function.body))
        self.order = {id(n): k for k, n in enumerate(nodes)}
        self.blocks = [b for n in (function, *nodes) for b in (getattr(n, "body", None), getattr(n, "orelse", None))
                       if isinstance(b, list)]
        self.made = list_arrays(function)
        self.stores: dict[str, list[Assign]] = {n: [] for n in self.made}
        for s in nodes:
            if isinstance(s, Assign) and (listed := stored_list(s.targets[0], self.made)):
                self.stores[listed].append(s)
        self.links: dict[str, set[str]] = {}        # a name and what it may be a view of
        for s in nodes:
            if isinstance(s, Assign) and isinstance(s.targets[0], Name):
                self.links.setdefault(s.targets[0].id, set()).update(self.sources(s.value))
        self.uses = UpcomingUses(function)

    def sources(self, value: AST) -> set[str]:
        """The names whose memory a value may be."""
        if isinstance(value, IfExp):
            return self.sources(value.body) | self.sources(value.orelse)
        if makes_view(value):
            return self.sources(value.args[0])
        if not isinstance(value, (Name, Subscript, Attribute)) or not self.typing.of(value).is_array:
            return set()
        picked = isinstance(value, Subscript) and any(self.typing.of(i).is_array for i in indices(value))
        return set() if picked else {base_name(value.value if isinstance(value, Attribute) else value)} - {""}

    def is_shared(self, store: Assign) -> bool:
        return self.typing.of(store.value).is_array and isinstance(store.value, (Name, Subscript, Attribute))

    def views_of(self, arrays: Iterable[str]) -> set[str]:
        """Names and those that may be views of them."""
        found = set(arrays)
        while more := {n for n, above in self.links.items() if above & found} - found:
            found |= more
        return found

    def component(self, arrays: Iterable[str]) -> set[str]:
        """All names that may share memory with some, through lists as well."""
        found = self.views_of(arrays)
        while True:
            above = {a for n in found for a in self.links.get(n, ())}
            for listed, stores in self.stores.items():
                of = {a for s in stores if self.is_shared(s) and not self.is_fresh(s) for a in self.sources(s.value)}
                above |= {listed} if of & found else of if listed in found else set()
            if above <= found:
                return found
            found = self.views_of(found | above)

    def related(self, listed: str) -> list[str]:
        """A list and the other ones that hold views of the same array."""
        found = self.component({listed})
        return [n for n in self.made if n == listed or n in found]

    def loops_around(self, node: AST, of: AST) -> list[AST]:
        """The loops around a statement that are not around another one."""
        return [n for n in walk_statements(self.function.body) if isinstance(n, (For, While))
                and any(m is node for m in walk(n))
                and not any(m is of for m in walk(n))]

    def is_fresh(self, store: Assign, identifier: str = "") -> bool:
        """Whether what is stored is a name that was bound to a new array just before, which lies in no other list;
        `identifier` is the name where it lies in a row that is stored."""
        block = next(b for b in self.blocks if any(s is store for s in b))
        identifier = identifier or (store.value.id if isinstance(store.value, Name) else "")
        before = block[:next(k for k, s in enumerate(block) if s is store)]
        bound = max((k for k, s in enumerate(before) if identifier in stored_names(s)), default=-1)
        if bound < 0 or not isinstance(before[bound], Assign) or self.sources(before[bound].value):
            return False
        after = [n for s in block[bound:] for n in walk(s)]
        return not any(s is not store and identifier in self.sources(s.value) and any(n is s for n in after)
                       for stores in self.stores.values() for s in stores)

    def has_alone(self, listed: str) -> bool:
        """Whether nothing else has the arrays that a list holds once they are in it."""
        return all(not self.is_shared(s) or self.is_fresh(s) and not self.views_of({base_name(s.value)})
                   & self.uses.after[id(s)] for s in self.stores[listed])

    def takes_out(self, statement: Assign) -> bool:
        """Whether a name is bound to the last item of a list, which is one shorter then, or to its first one."""
        block = next(b for b in self.blocks if any(s is statement for s in b))
        after = block[next(k for k, s in enumerate(block) if s is statement) + 1:]
        place = indices(statement.value)[0]
        last = place.left if isinstance(place, BinOp) and isinstance(place.op, Sub) else None
        return bool(after) and isinstance(statement.value.value, Name) and isinstance(after[0], AugAssign) and (
            dump(after[0].target) == dump(place if last is None else last)) and isinstance(
            after[0].op, Add if last is None else Sub)

    def is_repeated(self, listed: str) -> bool:
        """Whether a list may hold one array, or one part of it, several times."""
        shared = [s for s in self.stores[listed] if self.is_shared(s) and not self.is_fresh(s)]
        if any(self.component(self.sources(a.value)) & self.component(self.sources(b.value))
               for k, a in enumerate(shared) for b in shared[:k]):
            return True
        for s in shared:
            loops = self.loops_around(s, self.made[listed])
            own = indices(s.value) if isinstance(s.value, Subscript) else []
            if len(loops) > 1 or loops and not any(counter_offset(i, loops[0]) is not None for i in own):
                return True
        return False

    def diverging_store(self, listed: str) -> AST | None:
        """The first store into what a list holds that other names, or other elements, share in Python."""
        shared = [s for s in self.stores[listed] if self.is_shared(s)]
        if not shared:
            return None
        own = self.views_of({listed})
        writing = self.writing(listed, own)
        if writing and self.is_repeated(listed):
            return writing[0]
        kept = [self.views_of({s.value.id}) if self.is_fresh(s) and isinstance(s.value, Name)
                else self.component(self.sources(s.value)) for s in shared]
        others = set().union(*kept) - own
        for s in writing:
            seen = self.uses.after[id(s)] | self.parameters | (
                set(names(s.value)) if isinstance(s.value, Call) else set())
            if others & seen or any(n.startswith("array.") for n in others):
                return s
        return None

    def replaced_element(self, listed: str) -> AST | None:
        """The first store of another array in place of an element whose name is read later."""
        parts = {n for n in self.views_of({listed}) if self.typing.of(name(n)).rank < self.typing.of(name(listed)).rank}
        reused = is_reused(self.made[listed])
        return next((s for s in self.stores[listed] if (reused or isinstance(s.targets[0].value, Subscript))
                     and parts & self.uses.after[id(s)]), None)

    def is_written(self, listed: str) -> bool:
        """Whether something is stored into what a list holds."""
        return bool(self.writing(listed, self.views_of({listed})))

    def writing(self, listed: str, own: set[str]) -> list[AST]:
        """What stores into one of the arrays, and does not put one into the list."""
        filling = {id(s) for s in self.stores[listed]}
        return [s for s in walk(self.function.body) if id(s) not in filling and self.stored_arrays(s) & own]

    def stored_arrays(self, statement: AST) -> set[str]:
        """The arrays that a statement stores into."""
        if not isinstance(statement, (Assign, AugAssign, Expr)):
            return set()
        target = statement.targets[0] if isinstance(statement, Assign) else getattr(statement, "target", None)
        whole = isinstance(statement, AugAssign) and target is not None and self.typing.of(target).is_array
        found = {base_name(target)} if isinstance(target, Subscript) or whole else set()
        called = user_call(statement.value)
        return found | ({base_name(statement.value.args[k]) for k in self.writes(statement.value)} if called else set())


def stored_into_later(function: FunctionDef, stores: Sequence[AST], typing: Typing, memory: Memory) -> list[AST]:
    """The stores of an array into a list after which the array may be stored into under a name of its own."""
    return [s for s in stores if is_shared(s.value, typing)
            and is_stored_into_later(function, s, s.value, stores, memory)]


def is_shared(value: AST, typing: Typing) -> bool:
    """Whether a value is an array that another name or list may share."""
    return (isinstance(value, (Name, Subscript, Attribute)) or makes_view(value)) and typing.of(value).is_array


def is_stored_into_later(function: FunctionDef, store: AST, value: AST, stores: Sequence[AST], memory: Memory) -> bool:
    """Whether an array that is put into a list may be stored into later under a name of its own."""
    appended = {id(s) for s in stores}
    every = [p for p in _statements_after(function.body, store) if id(p) not in appended]
    made = {id(p) for p in own_parts(_statements_since_creation(function.body, store, value))}
    outside = memory.written([p for p in every if id(p) not in made])
    own = {value.id: f"{value.id}."} if isinstance(value, Name) else {}
    by_others = memory.written([rename(p, own) for p in every if id(p) in made])
    return memory.affected(index(value, const(0)), outside | by_others)


def _statements_after(block: list[AST], store: AST) -> list[AST]:
    """What of the statements may come after a store; none if it is not here."""
    for position, statement in enumerate(block):
        if not any(n is store for n in walk(statement)):
            continue
        inside = [statement] if not isinstance(statement, If) else [
            n for arm in (statement.body, statement.orelse) for n in _statements_after(arm, store)]
        return [*(own_parts(inside) if not isinstance(statement, If) else inside), *own_parts(block[position + 1:])]
    return []


def _statements_since_creation(block: list[AST], store: AST, value: AST) -> list[AST]:
    """The statements from the one that makes an array anew to its store, in one turn; none if it is not made so."""
    found = _statements_since_binding(block, store, value.id) if isinstance(value, Name) else None
    return found[1] if found is not None and found[0] else []


def _statements_since_binding(block: list[AST], store: AST, identifier: str) -> tuple[bool, list[AST]] | None:
    """Whether what binds the array's name was found, and the statements since then; None if the store is not here."""
    for position, statement in enumerate(block):
        if statement is store:
            return _suffix_from_binding(block[:position], identifier)
        for field in ("body", "orelse"):
            found = _statements_since_binding(getattr(statement, field, []), store, identifier)
            if found is not None and (found[0] or not isinstance(statement, If)):
                return found if found[0] else (True, [])
            if found is not None:
                bound, statements = _suffix_from_binding(block[:position], identifier)
                return (bound, [*statements, *found[1]]) if statements or not bound else (True, [])
    return None


def _suffix_from_binding(before: list[AST], identifier: str) -> tuple[bool, list[AST]]:
    for position in range(len(before) - 1, -1, -1):
        statement = before[position]
        if _binds(statement, identifier):
            new = isinstance(statement, Assign) and isinstance(statement.targets[0], Name) and fresh_value(
                statement.value)
            return True, before[position:] if new else []
    return False, before


def _binds(statement: AST, identifier: str) -> bool:
    """Whether a statement binds a name to another array; `w += x` writes the one that it has."""
    added = {id(n.target) for n in walk_statements(statement) if isinstance(n, AugAssign)}
    return any(isinstance(n, Name) and n.id == identifier and isinstance(n.ctx, Store) and id(n) not in added
               for n in walk(statement))


def counter_offset(place: AST, loop: AST) -> int | None:
    """How far a subscript is from a loop's counter."""
    if not isinstance(loop, For) or not isinstance(loop.target, Name):
        return None
    if isinstance(place, Name) and place.id == loop.target.id:
        return 0
    if isinstance(place, BinOp) and isinstance(place.op, (Add, Sub)) and isinstance(place.left, Name) and (
            place.left.id == loop.target.id and isinstance(place.right, Constant)
            and type(place.right.value) is int):
        return place.right.value if isinstance(place.op, Add) else -place.right.value
    return None


def row_aliases(function: FunctionDef, appended: Appended) -> list[AST]:
    """The statements that put a list under a name into another one where a store would make its copy differ from it.

    w = [x[0], x[1]]
    h.append(w)             or h = [w, v], h[0] = w
    w[0] = 0.0              Python's h holds the new number

    A list that grows must be made anew for each `append` of it, and be left alone afterwards.

    Requires resolved names. Only lists are asked about: for arrays `stored_into_later` is.
    """
    nodes = list(walk(function.body))
    order = {id(n): k for k, n in enumerate(nodes)}
    bound = [(s.targets[0].id, s) for s in nodes if isinstance(s, Assign) and isinstance(s.targets[0], Name)]
    spelled = {n for n, s in bound if isinstance(s.value, List) and s.value.elts}
    lists = {n for n, s in bound if isinstance(s.value, List)} | {*list_arrays(function)}
    stored = [n for n in nodes if isinstance(n, Subscript) and isinstance(n.ctx, Store)]
    found = [s for s in nodes if appended(s) and isinstance(item := s.value.args[0], Name)
             and item.id in lists - spelled and not _is_made_for(function, s, item.id)]
    for store, outer, value, several in ((s, *put) for s in nodes for put in _list_insertions(s, appended, spelled)):
        before = [order[id(s)] for n, s in bound if n == value and order[id(s)] < order[id(store)]]
        if outer not in lists or value not in spelled or not before:
            continue
        own = {id(n) for n in walk(store)}
        again = _repeated_nodes(store, [n for n in nodes if isinstance(n, (For, While)) and order[id(n)] > max(before)])
        ends = min((order[id(s)] for n, s in bound if n == value and order[id(s)] > order[id(store)]),
                   default=len(order))
        later = {id(n) for n in nodes if isinstance(n, Name) and n.id == value and id(n) not in own and (
            order[id(store)] < order[id(n)] < ends or id(n) in again)}
        by_others = {n for t, v in bindings(function) if outer in names(v) for n in stored_names(t)} - {outer}
        rows = any(n in by_others or n == outer and isinstance(w.value, Subscript)
                   for w in stored for n in [getattr(_base(w), "id", "")])
        if later & {id(_base(w)) for w in stored} or (later or again or several) and rows:
            found.append(store)
    return found


def _is_made_for(function: FunctionDef, append: AST, item: str) -> bool:
    """Whether a list is made anew before each run of a statement that appends it to another one, and is used nowhere
    else than between the two."""
    for node in (function, *walk(function.body)):
        for block in (b for b in (getattr(node, "body", None), getattr(node, "orelse", None)) if isinstance(b, list)):
            made = next((k for k, s in enumerate(block) if isinstance(s, Assign) and isinstance(s.targets[0], Name)
                         and s.targets[0].id == item), None)
            if made is not None:
                inside = [n for s in block[made:] for n in walk(s)]
                until = next((k for k, n in enumerate(inside) if n is append.value.args[0]), -1)
                between = sum(isinstance(n, Name) and n.id == item for n in inside[:until + 1])
                again = any(isinstance(n, (For, While)) and any(m is append for m in walk(n)) for n in inside)
                return not again and between == sum(
                    isinstance(n, Name) and n.id == item for n in walk(function.body))
    return False


def _list_insertions(store: AST, appended: Appended, spelled: set[str]) -> list[tuple[str, str, bool]]:
    """The names of a list and of those that a statement puts into it, and whether it does so more than once."""
    outer, target = appended(store), store.targets[0] if isinstance(store, Assign) else None
    value = store.value.args[0] if outer else getattr(store, "value", None)
    if isinstance(target, Name) and isinstance(value, List):
        held = [i.id for i in value.elts if isinstance(i, Name) and i.id in spelled]
        return [(target.id, n, held.count(n) > 1) for n in dict.fromkeys(held)]
    outer = outer or (_base(target).id if isinstance(target, Subscript) and isinstance(_base(target), Name) else "")
    return [(outer, value.id, False)] if outer and isinstance(value, Name) else []


def _repeated_nodes(store: AST, loops: list[AST]) -> set[int]:
    """What is in the loops around a store that a list is there before."""
    return {id(n) for loop in loops if any(m is store for m in walk(loop.body)) for n in walk(loop.body)}


def _base(node: AST) -> AST:
    while isinstance(node, Subscript):
        node = node.value
    return node
