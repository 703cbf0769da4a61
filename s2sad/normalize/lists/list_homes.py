"""list_homes: each list that grows has one name and one home, the statement that makes its array.

    pairs = []                          pairs = []
    ...                                 ...
    for k in range(n):                  for k in range(n):
        if k % 3 == 0:                      if k % 3 == 0:
            new = []                            pairs = []          refills it
            ...                                 ...
        else:
            new = pairs
        for i, j in new:                    for i, j in pairs:
            ...                                 ...
        pairs = new

Requires resolved names. Names that are bound to each other share a home where none is bound to another list while one
of them is used later; where one list takes the place of another, its items move (`_with_moved_items`). A list that is
bound several times, or that a loop carries, is made before all that mentions it; what binds it otherwise fills the same
array anew.
"""
from __future__ import annotations

from collections.abc import Callable, Set

from s2sad.normalize.buffers.may_alias import UpcomingUses
from s2sad.normalize.lists.list_statements import appended_list, grown_lists
from s2sad.tree import (
    AST, Assign, Call, Expr, For, FunctionDef, If, List, Load, Name, Tuple, While, assign, at, attribute, call,
    counted_for, head_copy, index, name, rename, walk, walk_statements, with_body,
)


def list_homes(function: FunctionDef, grown: Set[str], fresh: Callable[[str], str]) -> FunctionDef:
    """The function with one name and one home for each of these lists."""
    bound = _bindings(function)
    copied = [s for s in bound if isinstance(s.value, Name) and {s.value.id, s.targets[0].id} & grown]
    has_else = any(getattr(s, "orelse", []) for s in walk_statements(function.body) if isinstance(s, (For, While)))
    if copied and not has_else:
        function, more = _with_moved_items(_with_one_name(function, bound, copied), grown, fresh)
        grown = grown | more
    grown = grown | {*grown_lists(function)}        # under the names that they have now
    function = _with_held_items(function, grown, fresh)
    if has_else:
        return function
    several = [n for n in sorted(grown) if len(bindings_of(function, n)) > 1 or _is_carried(function, n)]
    for listed in several:
        if all(isinstance(s.value, List) for s in bindings_of(function, listed)) and not holds_lists(function, listed):
            function = with_body(function, _with_home(function, function.body, listed))
    return function


def holds_lists(function: FunctionDef, listed: str) -> bool:
    """Whether other lists are put into a list, whose lengths may differ from one time to the next."""
    others = {*grown_lists(function)}
    return any(appended_list(s) == listed and isinstance(s.value.args[0], Name) and s.value.args[0].id in others
               for s in walk_statements(function.body))


def _bindings(function: FunctionDef) -> list[Assign]:
    """The statements that bind one name."""
    return [s for s in walk_statements(function.body) if isinstance(s, Assign) and len(s.targets) == 1
            and isinstance(s.targets[0], Name)]


def bindings_of(function: FunctionDef, listed: str) -> list[Assign]:
    """The statements that bind a name, in the order of the text."""
    return [s for s in walk_statements(function.body) if isinstance(s, Assign) and any(
        isinstance(t, Name) and t.id == listed for t in s.targets)]


def _with_one_name(function: FunctionDef, bound: list[Assign], copied: list[Assign]) -> FunctionDef:
    """The function in which lists that are bound to each other have one name, where that means the same."""
    uses = UpcomingUses(function)
    group: dict[str, set[str]] = {}
    for s in copied:
        source, target = s.value.id, s.targets[0].id
        one, other = (group.setdefault(n, {n}) for n in (source, target))
        if one is other or not all(_is_only_list(function, bound, n, copied) for n in one | other):
            continue
        if not _interferes(one | other, bound, uses):
            one |= other
            group.update(dict.fromkeys(one, one))
    first = {n: min(own, key=lambda m: (len(m), m)) for n, own in group.items() if len(own) > 1}

    def block(statements: list[AST]) -> list[AST]:
        return [_with_blocks(s, block) for s in statements if not (
            isinstance(s, Assign) and isinstance(s.value, Name) and isinstance(s.targets[0], Name)
            and len(s.targets) == 1 and s.value.id == s.targets[0].id)]
    return with_body(function, block(rename(function.body, first))) if first else function


def _with_moved_items(function: FunctionDef, grown: Set[str], fresh: Callable[[str], str]
                      ) -> tuple[FunctionDef, set[str]]:
    """The function in which a list that another name is bound to, and its own no longer stands for, gives its items,
    and the lists that take them.

        old = new           old = []
        new = []            for k in range(len(new)):
                                old.append(new[k])
                            new = []
    """
    bound = _bindings(function)
    copied = [s for s in bound if isinstance(s.value, Name) and {s.value.id, s.targets[0].id} & grown]
    uses, together = UpcomingUses(function), {n.id for s in copied for n in (s.value, s.targets[0])}
    moved = {id(s) for s in copied if not uses.after[id(s)] & (together - {s.targets[0].id}) and all(
        _is_only_list(function, bound, n.id, copied) for n in (s.value, s.targets[0]))}

    def block(statements: list[AST]) -> list[AST]:
        return [n for s in statements for n in (moving(s) if id(s) in moved else [_with_blocks(s, block)])]

    def moving(s: Assign) -> list[AST]:
        target, source, k = s.targets[0].id, s.value.id, fresh("k")
        taken = Call(attribute(name(target), "append"), [index(name(source), name(k))], [])
        return [at(n, s) for n in (assign(target, List([], Load())),
                                   counted_for(k, [call("builtins.len", name(source))], [at(Expr(taken), s)]))]
    return with_body(function, block(function.body)), {s.targets[0].id for s in copied if id(s) in moved}


def _with_held_items(function: FunctionDef, grown: Set[str], fresh: Callable[[str], str]) -> FunctionDef:
    """The function in which what a list starts with is read before any of it is stored, as in `q = [q[-1], q[0]]`."""
    def block(statements: list[AST]) -> list[AST]:
        return [n for s in statements for n in held(s)]

    def held(s: AST) -> list[AST]:
        if not (isinstance(s, Assign) and isinstance(s.targets[0], Name) and s.targets[0].id in grown
                and isinstance(s.value, List) and _mentions_any(s.value.elts, grown)):
            return [_with_blocks(s, block)]
        before: list[AST] = []
        items = [name_of(item, before) for item in s.value.elts]
        return [at(n, s) for n in (*before, Assign(s.targets, List(items, Load()), None))]

    def name_of(item: AST, before: list[AST]) -> AST:
        if isinstance(item, Tuple):
            return Tuple([name_of(i, before) for i in item.elts], Load())
        if not _mentions_any(item, grown):
            return item
        before.append(assign(kept := fresh("item"), item))
        return name(kept)
    return with_body(function, block(function.body))


def _is_only_list(function: FunctionDef, bound: list[Assign], identifier: str, copied: list[Assign]) -> bool:
    """Whether a name is bound to lists that are spelled out, and to names of lists, alone."""
    own = [s for s in bound if s.targets[0].id == identifier]
    stores = sum(n.id == identifier and not isinstance(n.ctx, Load) for n in walk(function.body)
                 if isinstance(n, Name))
    return bool(own) and len(own) == stores and all(isinstance(s.value, List) or s in copied for s in own)


def _interferes(together: set[str], bound: list[Assign], uses: UpcomingUses) -> bool:
    """Whether one of the names is bound to another list while one of the others is used later."""
    for s in bound:
        source = {s.value.id} if isinstance(s.value, Name) else set()
        if s.targets[0].id in together and uses.after[id(s)] & (together - {s.targets[0].id} - source):
            return True
    return False


def _is_carried(function: FunctionDef, listed: str) -> bool:
    """Whether a loop finds a list that an earlier iteration has bound."""
    uses = UpcomingUses(function)
    return any(listed in uses.head[id(n)] and any(n is s for s in walk_statements(function.body))
               and any(isinstance(s, Assign) and isinstance(s.targets[0], Name) and s.targets[0].id == listed
                       for s in walk_statements(n.body))
               for n in walk_statements(function.body) if isinstance(n, (For, While)))


def _with_home(function: FunctionDef, block: list[AST], listed: str) -> list[AST]:
    """The block in which the list is made before all that mentions it."""
    uses = UpcomingUses(function)

    def inside(statements: list[AST]) -> list[AST]:
        there = [k for k, s in enumerate(statements) if _mentions(s, listed)]
        first = statements[there[0]]
        carried = isinstance(first, (For, While)) and listed in uses.head[id(first)]
        arms = [b for b in (getattr(first, "body", []), getattr(first, "orelse", [])) if _mentions(b, listed)]
        if len(there) == 1 and len(arms) == 1 and not carried and isinstance(first, (For, If, While)):
            return [_with_blocks(s, lambda b: inside(b) if b is arms[0] else b) if s is first else s
                    for s in statements]
        if isinstance(first, Assign) and isinstance(first.value, List) and _mentions(first.targets, listed):
            return statements
        return [*statements[:there[0]], at(assign(listed, List([], Load())), first), *statements[there[0]:]]
    return inside(block)


def _mentions(node: AST | list[AST], listed: str) -> bool:
    return any(isinstance(n, Name) and n.id == listed for n in walk(node))


def _mentions_any(node: AST | list[AST], lists: Set[str]) -> bool:
    return any(isinstance(n, Name) and n.id in lists for n in walk(node))


def _with_blocks(statement: AST, change: Callable[[list[AST]], list[AST]]) -> AST:
    new = head_copy(statement)
    for field in ("body", "orelse"):
        if hasattr(statement, field):
            setattr(new, field, change(getattr(statement, field)))
    return new
