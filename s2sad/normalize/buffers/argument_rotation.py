"""argument_rotation: names that swap the arrays of arguments swap copies of them, and what an argument then holds is
put back.

    def f(u, v, n):                 def f(u, v, n):
        for k in range(n):              u_own = np.copy(u)
            v[1:] = 2.0 * u[:-1]        v_own = np.copy(v)
            before = u                  u_place = 0
            u = v                       v_place = 1
            v = before                  for k in range(n):
        return u[0]                         v_own[1:] = 2.0 * u_own[:-1]
                                            before = u_own
                                            u_own = v_own
                                            v_own = before
                                            u_place = 1 - u_place
                                            v_place = 1 - v_place
                                        if u_place == 0:
                                            u[...] = u_own
                                        else:
                                            u[...] = v_own
                                        if v_place == 0:
                                            v[...] = u_own
                                        else:
                                            v[...] = v_own
                                        return u_own[0]

Requires structured form and types; establishes that arguments are not rebound. In NumPy the names exchange the
caller's array; which of them has it is counted. Left as they are: names that are bound in any other way, or of whose
arrays there are views.
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from s2sad.infer.inference import Typing
from s2sad.infer.types import INT
from s2sad.naming import Names
from s2sad.normalize.buffers.allocations import ALLOCATING
from s2sad.normalize.context import NormalContext
from s2sad.tree import (
    AST, Assign, Attribute, AugAssign, BinOp, Call, Eq, For, FunctionDef, If, Name, Return, Sub, Subscript, While,
    assign, at, call, call_name, compare, const, copy, index, name, names, rename, stored_names, user_call, walk,
)

Writes = Callable[[Call], Sequence[int]]


@dataclass(frozen=True)
class Swap:
    """Assignments of names to names, one after the other: `origins[n]` is the name whose array n has after them."""
    statements: tuple[AST, ...]
    origins: dict[str, str]


def argument_rotation(function: FunctionDef, context: NormalContext) -> FunctionDef:
    """The function with such copies."""
    return rotated(function, context.typing, context.names)


def rotated(function: FunctionDef, typing: Typing, free: Names, within: bool = False) -> FunctionDef:
    """The function with such copies; the table of `typing` gains their names. `within` another function what is
    returned is the argument itself where its name has it at the end."""
    swaps = [s for block in _blocks(function.body) for s in swaps_of(block, typing)]
    if swaps and (own := _renamed_arguments(function, typing, {n for s in swaps for n in s.origins})) is not function:
        function, swaps = own, [s for block in _blocks(own.body) for s in swaps_of(block, typing)]
    for group in _groups(swaps):
        arguments = [p.id for p in function.args.args if p.id in group]
        inside = [s for s in swaps if group & s.origins.keys()]
        if arguments and _is_plain(function, group, inside, typing):
            function = _Rotation(function, typing, free, sorted(group), arguments, inside, within).function
            swaps = [s for block in _blocks(function.body) for s in swaps_of(block, typing)]
    return function


def _renamed_arguments(function: FunctionDef, typing: Typing, swapped: set[str]) -> FunctionDef:
    """The function in which arguments bound to other names only, `a = u`, which swap, go on under their own."""
    parameters = {p.id for p in function.args.args}
    for place, statement in enumerate(function.body):
        if not isinstance(statement, Assign) or not isinstance(statement.value, Name):
            continue
        argument, bound = statement.value.id, str(getattr(statement.targets[0], "id", ""))
        before, after = function.body[:place], function.body[place + 1:]
        unused = not _is_read(argument, after) and argument not in stored_names(before) and bound not in {
            *names(before), *stored_names(before)}
        if argument in parameters and bound in swapped - parameters and unused and (
                typing.table[argument] == typing.table[bound]):
            made = copy(function)
            made.body = [*before, *(rename(s, {bound: argument}) for s in after)]
            return _renamed_arguments(made, typing, swapped | {argument})
    return function


def _is_read(array: str, block: list[AST]) -> bool:
    """Whether statements mention an array but for its sizes."""
    sizes = {id(n.value) for n in walk(block) if isinstance(n, Attribute) and n.attr in ("shape", "size", "ndim")}
    sizes |= {id(n.args[0]) for n in walk(block) if call_name(n) in ("numpy.empty_like", "numpy.zeros_like") and n.args}
    return any(isinstance(n, Name) and n.id == array and id(n) not in sizes for n in walk(block))


def _blocks(block: list[AST]) -> list[list[AST]]:
    found = [block]
    for statement in block:
        if isinstance(statement, (For, While, If)):
            found += _blocks(statement.body) + _blocks(statement.orelse)
    return found


def swaps_of(block: list[AST], typing: Typing) -> list[Swap]:
    """The swaps in a block: each is a permutation of the names that it binds, but for those that only hold one."""
    found: list[Swap] = []
    run: list[tuple[AST, str, str]] = []
    for statement in [*block, None]:
        if isinstance(statement, Assign) and isinstance(statement.targets[0], Name) and isinstance(
                statement.value, Name) and typing.of(statement.value).is_array:
            run.append((statement, str(statement.targets[0].id), str(statement.value.id)))
            continue
        if len(run) > 2:
            origins: dict[str, str] = {}
            for _, bound, value in run:
                origins[bound] = origins.get(value, value)
            held = {n for n in origins if n not in origins.values()}
            kept = {n: g for n, g in origins.items() if n not in held}
            if kept and set(kept) == set(kept.values()):
                found.append(Swap(tuple(s for s, _, _ in run), kept))
        run = []
    return found


def _groups(swaps: list[Swap]) -> list[set[str]]:
    """The names that swap with each other, by any of the swaps."""
    groups: list[set[str]] = []
    for swap in swaps:
        joined = set(swap.origins).union(*(g for g in groups if g & swap.origins.keys()))
        groups = [g for g in groups if not g & joined] + [joined]
    return groups


def _is_plain(function: FunctionDef, group: set[str], swaps: list[Swap], typing: Typing) -> bool:
    """Whether nothing but the swaps binds these names after they are made, no other name is a view of their arrays
    before, what only holds an array is read by its swap alone, and one of the arrays is stored into."""
    first = _first(function.body, swaps)
    own = {id(n) for s in swaps for statement in s.statements for n in walk(statement)}
    parameters = {p.id for p in function.args.args}
    made: list[str] = []
    for place, statement in enumerate(function.body):
        for node in walk(statement):
            if isinstance(node, Assign) and id(node) not in own and group & set(stored_names(node.targets[0])):
                fresh = call_name(node.value) in ALLOCATING or isinstance(node.value, BinOp)
                if place >= first or node is not statement or not fresh or not isinstance(node.targets[0], Name):
                    return False
                made.append(node.targets[0].id)
            elif isinstance(node, For) and node.target.id in group:
                return False
            if place < first and isinstance(node, Assign) and isinstance(node.targets[0], Name) and group & set(
                    names(node.value)) and not typing.of(node.targets[0]).is_number and not (
                    call_name(node.value) in ALLOCATING or isinstance(node.value, BinOp)):
                return False    # a view, or may be one
    holders = {n for s in swaps for statement in s.statements for n in stored_names(statement)} - group
    outside = {n.id for n in walk(function.body) if isinstance(n, Name) and id(n) not in own}
    return sorted([*made, *(group & parameters)]) == sorted(group) and not holders & outside and _is_stored_into(
        function, group)


def _is_stored_into(function: FunctionDef, group: set[str]) -> bool:
    for node in walk(function.body):
        target = node.target if isinstance(node, AugAssign) else node.targets[0] if isinstance(node, Assign) and \
            isinstance(node.targets[0], Subscript) else None
        while isinstance(target, Subscript):
            target = target.value
        if isinstance(target, Name) and target.id in group or user_call(node) and group & set(names(node.args)):
            return True
    return False


def _first(body: list[AST], swaps: list[Swap]) -> int:
    """The statement of a function in which the first swap is."""
    inside = {id(s) for swap in swaps for s in swap.statements}
    return next(k for k, statement in enumerate(body) if any(id(n) in inside for n in walk(statement)))


class _Rotation:
    """A function in which the arguments among some names have copies."""

    def __init__(self, function: FunctionDef, typing: Typing, free: Names, group: list[str], arguments: list[str],
                 swaps: list[Swap], within: bool):
        self.group, self.typing, self.free = group, typing, free
        self.copies = {p: typing.declare(free.fresh(f"{p}_own"), typing.table[p]) for p in arguments}
        self.places = {p: typing.declare(free.fresh(f"{p}_place"), INT) for p in arguments}
        free.user_names.update({copied: p for p, copied in self.copies.items()})
        self.last = {id(s.statements[-1]): s for s in swaps}
        first = _first(function.body, swaps)
        start = [assign(self.copies[p], call("numpy.copy", name(p))) for p in arguments]
        start += [assign(self.places[p], const(group.index(p))) for p in arguments]
        rest = self.block(function.body[first:])
        end = [rest.pop()] if rest and isinstance(rest[-1], Return) else []
        left = [at(self.put_back(p, 0), function.body[first]) for p in arguments]
        if within and end:
            end = self.returned_holders(end[0], [n for n in names(function.body[-1]) if n in group])
        self.function = copy(function)
        self.function.body = [*function.body[:first], *(at(s, function.body[first]) for s in start), *rest, *left, *end]

    def block(self, block: list[AST]) -> list[AST]:
        new: list[AST] = []
        for statement in block:
            made = rename(statement, self.copies)
            if isinstance(statement, (For, While, If)):
                made.body = self.block(statement.body)
                made.orelse = self.block(statement.orelse)
            new.append(made)
            if id(statement) in self.last:
                new += [at(self.counted_swap(p, self.last[id(statement)]), statement) for p in self.places]
        return new

    def counted_swap(self, parameter: str, swap: Swap) -> AST:
        """Counts which name has an argument's array after a swap."""
        place = self.places[parameter]
        goes = {self.group.index(g): self.group.index(n) for n, g in swap.origins.items()}
        if len(self.group) == 2:
            return assign(place, BinOp(const(1), Sub(), name(place)))
        made: list[AST] = []
        for before, after in sorted(goes.items(), reverse=True):
            made = [If(compare(name(place), Eq(), const(before)), [assign(place, const(after))], made)]
        return made[0]

    def returned_holders(self, last: AST, returned: list[str]) -> list[AST]:
        """The return, of an argument's array where the name of what is returned has it."""
        made: list[AST] = []
        for holder in returned:
            own = self.copies.get(holder, holder)
            result = self.typing.declare(self.free.fresh(f"{holder}_left"), self.typing.table[own])
            choice: list[AST] = [assign(result, name(own))]
            for p, place in self.places.items():
                test = compare(name(place), Eq(), const(self.group.index(holder)))
                choice = [If(test, [assign(result, name(p))], choice)]
            made += choice
            last = rename(last, {own: result})
        return [*(at(s, last) for s in made), last]

    def put_back(self, parameter: str, number: int) -> AST:
        """The argument's array takes the content of the name that has it."""
        holder = self.group[number]
        fill = assign(index(name(parameter), const(...)), name(self.copies.get(holder, holder)))
        if number == len(self.group) - 1:
            return fill
        return If(compare(name(self.places[parameter]), Eq(), const(number)), [fill],
                  [self.put_back(parameter, number + 1)])
