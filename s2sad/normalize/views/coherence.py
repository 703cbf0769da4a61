"""coherence: a view that one of NumPy's functions makes has memory of its own, and is kept coherent with its operand.

Requires structured form in which functions of whole arrays stand alone; establishes it without such views where a store
would make them differ from the operand's memory (`unsupported_views` refuses what is left). The side that was stored
into is copied to the other one before that is mentioned again; where a loop's body mentions both, they are coherent at
both of its ends.

    def f(y, n):                                def f(y, n):
        u = np.reshape(y[:n * n], (n, n))           u = np.copy(np.reshape(y[:n * n], (n, n)))
        u[0] = 2.0 * u[1]                           u[0] = 2.0 * u[1]
        return y[0] * u[1, 1]                       y[:n * n] = np.ravel(u)
                                                    return y[0] * u[1, 1]

Whether NumPy gives a view depends on the operand's memory: the context gains the parameters that must be contiguous.
"""
from __future__ import annotations

from collections.abc import Iterator

from s2sad.blocks import with_blocks
from s2sad.infer.inference import Typing
from s2sad.liveness import base_name
from s2sad.naming import Names
from s2sad.normalize.buffers.may_alias import UpcomingUses
from s2sad.normalize.context import NormalContext
from s2sad.normalize.shape_guards import counts
from s2sad.normalize.views.contiguity import Contiguity, asked_order
from s2sad.normalize.views.inverse_views import InverseView, by_element, inverse_views, splits
from s2sad.normalize.views.view_aliases import (
    OperandAliases, Writes, differing, operand_aliases, sources, written_names,
)
from s2sad.tree import (
    AST, Assign, AugAssign, Break, Call, Expr, For, FunctionDef, If, Name, Raise, Return, Store, Subscript, While,
    assign, at, call, call_name, const, copy, index, name, names, rename, times_bound, walk, walk_statements, with_body,
)

_WHOLE = {"numpy.asarray", "numpy.ascontiguousarray"}
_LYING = {"numpy.ravel", "numpy.ascontiguousarray"}         # a view of what lies together only, even of one axis
_ORDERED = {"numpy.transpose", "numpy.moveaxis", "numpy.swapaxes"}


def coherence(function: FunctionDef, context: NormalContext) -> FunctionDef:
    """The function without such views; the context has its parameters that must be contiguous."""
    typing = context.typing
    context.contiguity = Contiguity(function, typing, {*context.swapped, *context.lists, *_results(function, context)})
    function, context.contiguous = kept_coherent(function, typing, context.names, context.written_arrays,
                                                 context.contiguity)
    return function


def _results(function: FunctionDef, context: NormalContext) -> list[str]:
    """The arrays that take what functions return."""
    return [base_name(a) for n in walk(function.body) if isinstance(n, Call)
            for room, _, kernel in [(call_name(n) or "").partition(".")] if room == "user"
            if kernel in context.program.kernels
            for a in n.args[len(n.args) - context.program.kernels[kernel].results:]]


def kept_coherent(function: FunctionDef, typing: Typing, free: Names, writes: Writes,
                  lying: Contiguity) -> tuple[FunctionDef, set[str]]:
    """The function without such views, and its parameters that must be contiguous."""
    needed: set[str] = set()
    tried: set[str] = set()
    if not any(differing(function, typing, writes)):
        return function, needed
    function = splits(_lives(function, typing, free, lying))
    while told := [(n, other) for _, n, other in differing(function, typing, writes)]:
        found = next(((b, s) for b in _views(function, typing) if b.targets[0].id not in tried
                      and (s := operand_aliases(function, b, typing)).concerned(told)), None)
        if found is None:
            break
        binding, both = found
        tried.add(binding.targets[0].id)
        made = _CoherentView(function, binding, both, typing, free, writes).made(lying)
        if made is not None:
            function, more = made
            needed |= more
    return function, needed


def _views(function: FunctionDef, typing: Typing) -> Iterator[Assign]:
    return (s for s in walk(function.body) if any(shown for _, shown in sources(s, typing)))


class _CoherentView:
    """One view that is given memory of its own."""

    def __init__(self, function: FunctionDef, binding: Assign, both: OperandAliases, typing: Typing, free: Names,
                 writes: Writes):
        self.function, self.binding, self.both = function, binding, both
        self.typing, self.free, self.writes = typing, free, writes
        self.target: str = binding.targets[0].id
        self.called = call_name(binding.value) or ""
        self.operand = binding.value.args[0]

    def made(self, lying: Contiguity) -> tuple[FunctionDef, frozenset[str]] | None:
        """The function without the view, and the parameters that must be contiguous for it; None if it cannot be."""
        needed = self.needed(lying)
        if needed is None or self.both.ambiguous:
            return None
        if self.called in _WHOLE:
            return self.replaced([at(assign(self.target, self.operand), self.binding)], None), needed
        block, place = _place(self.function.body, self.binding)
        rest = block[place + 1:]
        mentions = [sum(isinstance(n, Name) and n.id in self.both.view for n in walk(where))
                    for where in ([self.binding, *rest], self.function.body)]
        if mentions[0] != mentions[1]:
            return None     # it, or a part of it, is used where it was not bound
        if UpcomingUses(self.function).after[id(self.binding)] & self.both.view - {self.target}:
            return None     # a part of what it was in the iteration before
        before, part = self.part(rest)
        if self.called in _ORDERED and (plain := by_element(self.binding, part, rest, self.typing)) is not None:
            return self.replaced(before, plain), needed
        turned = inverse_views(self.binding, part, self.typing)
        assert turned is not None       # `needed` has asked
        kept = self.synced(part, turned, rest)
        if kept is not None:
            own = assign(self.target, call("numpy.copy", turned.made))
            guards = [at(counts(n), self.binding) for n in self.both.required]
            return self.replaced([*guards, *before, at(own, self.binding)], kept), needed
        plain = by_element(self.binding, part, rest, self.typing)
        return None if plain is None else (self.replaced(before, plain), needed)

    def needed(self, lying: Contiguity) -> frozenset[str] | None:
        order, several = asked_order(self.binding.value), self.typing.of(self.operand).rank > 1
        asks = self.called in _LYING or order != "K" or self.called == "numpy.reshape" and several
        if inverse_views(self.binding, self.operand, self.typing) is None and self.called not in _WHOLE:
            return None
        if several and order not in ("C", "K"):
            return None     # a copy, unless it lies so
        return lying.needs(self.operand) if asks else frozenset()

    def part(self, rest: list[AST]) -> tuple[list[AST], AST]:
        """The operand as an expression that stays what it is, with what binds a name for it where one must."""
        stays = not set(names(self.operand)) & _bound_in(rest, self.typing) and not any(
            isinstance(n, (Subscript, Call)) for n in walk(self.operand) if n is not self.operand)
        if isinstance(self.operand, Name) and stays or stays and self.typing.of(self.operand).rank == 1:
            return [], self.operand
        held = self.typing.declare(self.free.fresh(f"{self.target}_part"), self.typing.of(self.operand))
        return [at(assign(held, self.operand), self.binding)], name(held)

    def synced(self, part: AST, turned: InverseView, rest: list[AST]) -> list[AST] | None:
        """What follows the binding with both sides in step; None if that copies too much."""
        whole = index(name(self.target), const(...))
        place = index(part, const(...)) if isinstance(part, Name) else copy(part)
        pass_ = CoherenceCopies(self.both, self.typing, self.writes, assign(place, turned.back),
                                assign(whole, turned.again))
        made = pass_.life(rest)
        return None if pass_.costly else made

    def replaced(self, own: list[AST], rest: list[AST] | None) -> FunctionDef:
        """The function with these statements in place of the binding and, if given, of what follows it."""
        def block(given: list[AST]) -> list[AST]:
            places = [k for k, s in enumerate(given) if s is self.binding]
            if places:
                return [*given[:places[0]], *own, *(given[places[0] + 1:] if rest is None else rest)]
            return [with_blocks(s, block) for s in given]
        new = copy(self.function)
        new.body = block(self.function.body)
        return new


def _place(block: list[AST], binding: AST) -> tuple[list[AST], int]:
    """The block in which a statement stands, and where."""
    for k, statement in enumerate(block):
        if statement is binding:
            return block, k
        for inner in _blocks(statement):
            if any(s is binding for s in walk(inner)):
                return _place(inner, binding)
    raise ValueError("a statement of another function")


def _blocks(statement: AST) -> list[list[AST]]:
    if isinstance(statement, If):
        return [statement.body, statement.orelse]
    return [statement.body] if isinstance(statement, (For, While)) else []


def _lives(function: FunctionDef, typing: Typing, free: Names, lying: Contiguity) -> FunctionDef:
    """The function with a name of its own for each view whose name is bound elsewhere, too, where nothing reads it
    behind its block or the next binding there."""
    counted = times_bound(function.body, Assign)
    counted.update(p.id for p in function.args.args)
    references = UpcomingUses(function)

    def block(given: list[AST]) -> list[AST]:
        made = [with_blocks(s, block) for s in given]
        for k in reversed(range(len(made))):
            target = _bound(made[k])
            end = next((j for j in range(k + 1, len(made)) if _bound(made[j]) == target), len(made))
            read_on = end == len(made) and target in references.after[id(given[-1])]
            if counted[target] < 2 or read_on or not any(shown for _, shown in sources(made[k], typing)) or (
                    target in _bound_in(made[k + 1:end], typing) or any(map(leaves, made[k + 1:end]))):
                continue
            counted[target] -= 1
            held = typing.declare(free.fresh(target), typing.table[target])
            lying.same(target, held)
            one = {target: held}
            made[k] = at(assign(held, made[k].value), made[k])
            made[k + 1:end] = [rename(s, one) for s in made[k + 1:end]]
            if end < len(made):
                made[end] = at(assign(target, rename(made[end].value, one)), made[end])
        return made
    return with_body(function, block(function.body))


def _bound(statement: AST) -> str:
    """The name that a statement binds, or ""."""
    return statement.targets[0].id if isinstance(statement, Assign) and isinstance(statement.targets[0], Name) else ""


def _bound_in(block: list[AST], typing: Typing) -> set[str]:
    """The names that statements bind; an array that is added to in place stays what it is."""
    kept = {id(s.target) for s in walk_statements(block) if isinstance(s, AugAssign) and typing.of(s.target).is_array}
    return {n.id for n in walk(block) if isinstance(n, Name) and isinstance(n.ctx, Store) and id(n) not in kept}


VIEW, OPERAND = "view", "operand"


def leaves(statement: AST) -> bool:
    """Whether a statement may leave the loop in which it stands."""
    if isinstance(statement, If):
        return any(leaves(s) for s in (*statement.body, *statement.orelse))
    return isinstance(statement, Break)


class CoherenceCopies:
    """Puts the copies into the statements of one view's life; `ahead` is the side that was written last and is not
    copied. `costly` if whole arrays would be copied for single elements, or if a call is given both sides."""

    def __init__(self, both: OperandAliases, typing: Typing, writes: Writes, back: Assign, again: Assign):
        self.both, self.typing, self.writes, self.back, self.again = both, typing, writes, back, again
        self.ahead = ""
        self.costly = False
        self.copies = 0

    def life(self, rest: list[AST]) -> list[AST]:
        """The statements behind the binding: at the end the operand holds what the view does."""
        made = self.block(rest)
        if self.ahead == VIEW:
            made += self.copied(rest[-1])
        return made

    def block(self, block: list[AST]) -> list[AST]:
        return [made for s in block for made in self.statement(s)]

    def copied(self, place: AST) -> list[AST]:
        """The copy after which both sides are in step."""
        made = {"": [], VIEW: [self.back], OPERAND: [self.again]}[self.ahead]
        self.copies += len(made)
        self.ahead = ""
        return [at(copy(s), place) for s in made]

    def statement(self, statement: AST) -> list[AST]:
        if isinstance(statement, (Break, Return, Raise)):
            needed = self.ahead == VIEW or self.both.mentioned(statement)[0]
            return [*(self.copied(statement) if needed else []), statement]
        view, operand = self.both.mentioned(statement)
        written = {n for s in walk(statement) for n in self.written(s)}
        if leaves(statement) or view and operand and written and isinstance(statement, (For, If, While)):
            return self.inside(statement)
        if self.ahead == VIEW and operand or self.ahead == OPERAND and view:
            before = self.copied(statement)
        else:
            before = []
        if written:
            self.ahead = min(written)
            self.costly |= view and operand and len(written) > 1 or self.is_given_both(statement)
        return [*before, statement]

    def written(self, statement: AST) -> set[str]:
        """The sides that a simple statement writes."""
        if not isinstance(statement, (Assign, AugAssign, Expr)):
            return set()
        names = written_names(statement, self.typing, self.writes)
        return {VIEW for n in names if n in self.both.view} | (
            {OPERAND} if names & self.both.operand and self.both.mentioned(statement)[1] else set())

    def is_given_both(self, statement: AST) -> bool:
        """Whether a kernel that writes an array is given both sides."""
        return any(isinstance(n, Call) and (call_name(n) or "").startswith("user.") and self.writes(n)
                   and all(self.both.mentioned(n)) for n in walk(statement))

    def inside(self, statement: AST) -> list[AST]:
        """A loop or branch with both sides in step where its blocks begin and end."""
        before = self.copied(statement)

        def block(given: list[AST]) -> list[AST]:
            known, self.copies = self.copies, 0
            made = self.block(given)
            made += self.copied(given[-1]) if made and not isinstance(made[-1], Break) else []
            self.costly |= self.copies > 0 and isinstance(statement, (For, While)) and self.is_slight(given)
            self.copies = known + (self.copies if isinstance(statement, If) else 0)
            self.ahead = ""
            return made
        return [*before, with_blocks(statement, block)]

    def is_slight(self, body: list[AST]) -> bool:
        """Whether the body of a loop does less than a copy of an array: it works on single elements."""
        return not any(isinstance(s, (For, While)) or isinstance(s, (Assign, AugAssign)) and (
            self.typing.of(s.targets[0] if isinstance(s, Assign) else s.target).is_array
            or self.typing.of(s.value).is_array) or isinstance(s, Expr) for s in walk_statements(body))
