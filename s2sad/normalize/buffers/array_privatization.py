"""array_privatization: a name that is written, and leaves its array in a loop or branch, has a copy of the array.

    def f(u, n):                    def f(u, n):
        for k in range(n):              u_own = np.copy(u)
            u[0] = 0.0                  u_own_left = 0
            u = u * 2.0                 for k in range(n):
        return u[1]                         u_own[0] = 0.0
                                            if u_own_left == 0:
                                                u[...] = u_own
                                                u_own_left = 1
                                            u_own = u_own * 2.0
                                        if u_own_left == 0:
                                            u[...] = u_own
                                        return u_own[1]

Requires structured form and types; establishes that such a name shares no array with an argument, or with a name from
before it. In NumPy it leaves the shared array where it is bound anew first, and the array keeps what was stored until
then: it takes that here, at the same place. Left as they are: names of whose array there is a view that is read later,
and arrays that are used under another name meanwhile, or that a tuple or list holds.

Tried where a store would make a buffer differ from NumPy's array (`Aliases.check`).
"""
from __future__ import annotations

from s2sad.blocks import with_blocks
from s2sad.infer.types import INT
from s2sad.normalize.context import NormalContext
from s2sad.normalize.lists.list_contents import ListContents
from s2sad.tree import (
    AST, Assign, Break, Continue, Eq, For, FunctionDef, If, List, Name, Return, Tuple, assign, at, call, compare, const,
    copy, index, name, names, rename, stored_names, user_call, walk, walk_statements,
)


def array_privatization(function: FunctionDef, context: NormalContext) -> FunctionDef:
    """The function with such copies; the same one if there are none."""
    for p in [p.id for p in function.args.args if context.typing.table[p.id].is_array]:
        if any(p in _bound_by(s) for s in walk_statements(function.body)):
            named = _under_another_name(function, p, context)
            made = _with_copy(named, named.body[0], context)
            if made is None:
                context.names.release(named.body[0].targets[0].id)
            function = made or function
    for statement in walk_statements(function.body):
        if _names_array(statement, context):
            function = _with_copy(function, statement, context) or function
    return function


def _bound_by(statement: AST) -> list[str]:
    """The names that a statement itself binds."""
    if isinstance(statement, Assign):
        return stored_names(statement.targets)
    return stored_names(statement.target) if isinstance(statement, For) else []


def _names_array(statement: AST, context: NormalContext) -> bool:
    """Whether a statement gives an array another name."""
    return isinstance(statement, Assign) and isinstance(statement.targets[0], Name) and isinstance(
        statement.value, Name) and context.typing.of(statement.value).is_array


def _under_another_name(function: FunctionDef, argument: str, context: NormalContext) -> FunctionDef:
    """The function in which all that is done with an argument is done under another name."""
    own = context.typing.declare(context.names.fresh(f"{argument}_own"), context.typing.table[argument])
    context.names.user_names[own] = argument
    made, naming = copy(function), at(assign(own, name(argument)), function.body[0])
    made.body = [naming, *(rename(s, {argument: own}) for s in function.body)]
    return made


def _with_copy(function: FunctionDef, naming: Assign, context: NormalContext) -> FunctionDef | None:
    """The function in which what gives an array another name copies it; None if that would not be the same."""
    owner, shared = naming.targets[0].id, naming.value.id
    contents = ListContents(function, context.typing, context.written)
    block = next(b for b in contents.blocks if any(s is naming for s in b))
    start = next(k for k, s in enumerate(block) if s is naming) + 1
    together = contents.component({owner})
    used = [k for k in range(start, len(block)) if not isinstance(block[k], Return) and any(
        owner in _bound_by(s) or contents.stored_arrays(s) & together for s in walk_statements(block[k]))]
    meanwhile = block[start:used[-1] + 1] if used else []
    if not _leaves(owner, naming, meanwhile, contents, _older(shared, owner, contents)):
        return None
    left = context.typing.declare(context.names.fresh(f"{owner}_left"), INT)
    put_back = _PutBack(owner, shared, left)
    made = [at(assign(owner, call("numpy.copy", name(shared))), naming), at(assign(left, const(0)), naming),
            *put_back.block(meanwhile), at(put_back.statement([]), meanwhile[-1])]
    return _replaced(function, block, [*block[:start - 1], *made, *block[start + len(meanwhile):]])


def _older(shared: str, owner: str, contents: ListContents) -> set[str]:
    """The names that an array has without its new one."""
    found = {shared}
    while more := {n for n, above in contents.links.items() if n != owner and above & found} | {
            a for n in found for a in contents.links.get(n, ())} - {owner}:
        if more <= found:
            break
        found |= more
    return found


def _leaves(owner: str, naming: Assign, meanwhile: list[AST], contents: ListContents, older: set[str]) -> bool:
    """Whether a name leaves the array that it was given in a loop or branch, where nothing that is read later shares
    it; the array is not used under an older name until then, nor written later, where the name may still be its."""
    every, inside = list(walk_statements(contents.function.body)), {id(s) for s in walk_statements(meanwhile)}
    bound = [s for s in every if owner in _bound_by(s) and s is not naming]
    held = {n for s in every if isinstance(s, Assign) and isinstance(s.value, (Tuple, List)) for n in names(s.value)}
    others, same = contents.component({owner}) - older - {owner}, contents.views_of({owner, *older})
    return (any(not any(s is t for t in meanwhile) for s in bound)
            and all(id(s) in inside and _is_plain(s) and not contents.sources(s.value) & same
                and not (others | contents.sources(s.value)) & contents.uses.after[id(s)] for s in bound)
            and not older & {*names(meanwhile), *stored_names(meanwhile)}
            and not held & (others | older | {owner})
            and not _exits(meanwhile)
            and not (contents.views_of({owner}) & contents.uses.after[id(meanwhile[-1])] and any(
                contents.stored_arrays(s) & (others | older | {owner}) for s in every if id(s) not in inside)))


def _is_plain(statement: AST) -> bool:
    return isinstance(statement, Assign) and isinstance(statement.targets[0], Name) and not any(
        map(user_call, walk(statement.value)))


def _exits(block: list[AST]) -> bool:
    """Whether a statement leaves the block for the loop around it."""
    return any(isinstance(s, (Break, Continue)) or isinstance(s, If) and _exits([*s.body, *s.orelse]) for s in block)


def _replaced(function: FunctionDef, block: list[AST], made: list[AST]) -> FunctionDef:
    """The function with other statements in place of one of its blocks."""
    def changed(current: list[AST]) -> list[AST]:
        return made if current is block else [with_blocks(s, changed) for s in current]
    new = copy(function)
    new.body = changed(function.body)
    return new


class _PutBack:
    """Statements in which the array that a name shared takes what its copy holds when the name leaves it."""

    def __init__(self, owner: str, shared: str, left: str):
        self.owner, self.shared, self.left = owner, shared, left

    def statement(self, after: list[AST]) -> AST:
        fill = assign(index(name(self.shared), const(...)), name(self.owner))
        return If(compare(name(self.left), Eq(), const(0)), [fill, *after], [])

    def block(self, block: list[AST]) -> list[AST]:
        new: list[AST] = []
        for s in block:
            if self.owner in _bound_by(s):
                new.append(at(self.statement([assign(self.left, const(1))]), s))
            new.append(with_blocks(s, self.block))
        return new
