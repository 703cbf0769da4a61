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
from s2sad.normalize.shape_guards import nonnegative
from s2sad.normalize.views.contiguity import Contiguity, requested_order
from s2sad.normalize.views.inverse_views import InverseView, through_operand, inverse_views, splits
from s2sad.normalize.views.view_aliases import (
    OperandAliases, Writes, diverging_stores, operand_aliases, sources, stored_arrays,
)
from s2sad.tree import (
    AST, Assign, AugAssign, Break, Call, Expr, For, FunctionDef, If, Name, Raise, Return, Store, Subscript, While,
    assign, at, call, call_name, const, copy, index, name, names, rename, times_bound, user_call, walk,
    walk_statements, with_body,
)

_IDENTITIES = {"numpy.asarray", "numpy.ascontiguousarray"}
_OF_CONTIGUOUS = {"numpy.ravel", "numpy.ascontiguousarray"}     # a view of contiguous memory only, even of one axis
_PERMUTATIONS = {"numpy.transpose", "numpy.moveaxis", "numpy.swapaxes"}


def coherence(function: FunctionDef, context: NormalContext) -> FunctionDef:
    """The function without such views; the context gains its parameters that must be contiguous."""
    typing = context.typing
    context.contiguity = Contiguity(function, typing, {*context.swapped, *context.lists, *_results(function, context)})
    function, context.contiguous = coherent_views(function, typing, context.names, context.written_arrays,
                                                 context.contiguity)
    return function


def _results(function: FunctionDef, context: NormalContext) -> list[str]:
    """The arrays that take what functions return."""
    return [base_name(a) for n in walk(function.body) if (kernel := user_call(n)) in context.program.kernels
            for a in n.args[len(n.args) - context.program.kernels[kernel].results:]]


def coherent_views(function: FunctionDef, typing: Typing, free: Names, writes: Writes,
                  contiguity: Contiguity) -> tuple[FunctionDef, set[str]]:
    """The function without such views, and its parameters that must be contiguous."""
    needed: set[str] = set()
    tried: set[str] = set()
    if not any(diverging_stores(function, typing, writes)):
        return function, needed
    function = splits(_split_names(function, typing, free, contiguity))
    while diverging := [(n, other) for _, n, other in diverging_stores(function, typing, writes)]:
        found = next(((b, s) for b in _views(function, typing) if b.targets[0].id not in tried
                      and (s := operand_aliases(function, b, typing)).concerns(diverging)), None)
        if found is None:
            break
        binding, aliases = found
        tried.add(binding.targets[0].id)
        made = _CoherentView(function, binding, aliases, typing, free, writes).rewritten(contiguity)
        if made is not None:
            function, more = made
            needed |= more
    return function, needed


def _views(function: FunctionDef, typing: Typing) -> Iterator[Assign]:
    return (s for s in walk(function.body) if any(by_function for _, by_function in sources(s, typing)))


class _CoherentView:
    """One view that gets memory of its own."""

    def __init__(self, function: FunctionDef, binding: Assign, aliases: OperandAliases, typing: Typing, free: Names,
                 writes: Writes):
        self.function, self.binding, self.aliases = function, binding, aliases
        self.typing, self.free, self.writes = typing, free, writes
        self.target: str = binding.targets[0].id
        self.called = call_name(binding.value) or ""
        self.operand = binding.value.args[0]

    def rewritten(self, contiguity: Contiguity) -> tuple[FunctionDef, frozenset[str]] | None:
        """The function without the view, and the parameters that must be contiguous for it; None if it cannot be."""
        needed = self.required_order(contiguity)
        if needed is None or self.aliases.ambiguous:
            return None
        if self.called in _IDENTITIES:
            return self.with_binding_replaced([at(assign(self.target, self.operand), self.binding)], None), needed
        block, place = _place(self.function.body, self.binding)
        rest = block[place + 1:]
        mentions = [sum(isinstance(n, Name) and n.id in self.aliases.view for n in walk(where))
                    for where in ([self.binding, *rest], self.function.body)]
        if mentions[0] != mentions[1]:
            return None     # it, or a part of it, is used where it was not bound
        if UpcomingUses(self.function).after[id(self.binding)] & self.aliases.view - {self.target}:
            return None     # a part of what it was in the iteration before
        before, part = self.part(rest)
        if self.called in _PERMUTATIONS and (
                plain := through_operand(self.binding, part, rest, self.typing)) is not None:
            return self.with_binding_replaced(before, plain), needed
        inverse = inverse_views(self.binding, part, self.typing)
        assert inverse is not None       # `needed` has asked
        coherent = self.with_copies(part, inverse, rest)
        if coherent is not None:
            own = assign(self.target, call("numpy.copy", inverse.view))
            guards = [at(nonnegative(n), self.binding) for n in self.aliases.nonnegative]
            return self.with_binding_replaced([*guards, *before, at(own, self.binding)], coherent), needed
        plain = through_operand(self.binding, part, rest, self.typing)
        return None if plain is None else (self.with_binding_replaced(before, plain), needed)

    def required_order(self, contiguity: Contiguity) -> frozenset[str] | None:
        order, several = requested_order(self.binding.value), self.typing.of(self.operand).rank > 1
        asks = self.called in _OF_CONTIGUOUS or order != "K" or self.called == "numpy.reshape" and several
        if inverse_views(self.binding, self.operand, self.typing) is None and self.called not in _IDENTITIES:
            return None
        if several and order not in ("C", "K"):
            return None     # a copy, unless it lies so
        return contiguity.needs(self.operand) if asks else frozenset()

    def part(self, rest: list[AST]) -> tuple[list[AST], AST]:
        """The operand as an expression that stays what it is, with what binds a name for it where one must."""
        stays = not set(names(self.operand)) & _bound_in(rest, self.typing) and not any(
            isinstance(n, (Subscript, Call)) for n in walk(self.operand) if n is not self.operand)
        if isinstance(self.operand, Name) and stays or stays and self.typing.of(self.operand).rank == 1:
            return [], self.operand
        held = self.typing.declare(self.free.fresh(f"{self.target}_part"), self.typing.of(self.operand))
        return [at(assign(held, self.operand), self.binding)], name(held)

    def with_copies(self, part: AST, inverse: InverseView, rest: list[AST]) -> list[AST] | None:
        """What follows the binding with both sides coherent; None if that copies too much."""
        whole = index(name(self.target), const(...))
        place = index(part, const(...)) if isinstance(part, Name) else copy(part)
        pass_ = CoherenceCopies(self.aliases, self.typing, self.writes, assign(place, inverse.operand),
                                assign(whole, inverse.refreshed))
        made = pass_.live_range(rest)
        return None if pass_.costly else made

    def with_binding_replaced(self, own: list[AST], rest: list[AST] | None) -> FunctionDef:
        """The function with these statements in place of the binding and, unless None, of what follows it."""
        def block(body: list[AST]) -> list[AST]:
            places = [k for k, s in enumerate(body) if s is self.binding]
            if places:
                return [*body[:places[0]], *own, *(body[places[0] + 1:] if rest is None else rest)]
            return [with_blocks(s, block) for s in body]
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


def _split_names(function: FunctionDef, typing: Typing, free: Names, contiguity: Contiguity) -> FunctionDef:
    """The function with a name of its own for each view whose name is bound elsewhere, too, where nothing reads it
    behind its block or the next binding there."""
    counted = times_bound(function.body, Assign)
    counted.update(p.id for p in function.args.args)
    uses = UpcomingUses(function)

    def block(body: list[AST]) -> list[AST]:
        made = [with_blocks(s, block) for s in body]
        for k in reversed(range(len(made))):
            target = _bound(made[k])
            end = next((j for j in range(k + 1, len(made)) if _bound(made[j]) == target), len(made))
            read_on = end == len(made) and target in uses.after[id(body[-1])]
            if counted[target] < 2 or read_on or not any(by for _, by in sources(made[k], typing)) or (
                    target in _bound_in(made[k + 1:end], typing) or any(map(may_break, made[k + 1:end]))):
                continue
            counted[target] -= 1
            held = typing.declare(free.fresh(target), typing.table[target])
            contiguity.rebind(target, held)
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


def may_break(statement: AST) -> bool:
    """Whether a statement may leave the loop in which it stands."""
    if isinstance(statement, If):
        return any(may_break(s) for s in (*statement.body, *statement.orelse))
    return isinstance(statement, Break)


class CoherenceCopies:
    """Puts the copies into the live range of one view; `newer` is the side that was stored into last and is not copied
    yet. `costly` if whole arrays would be copied for single elements, or if a call has both sides as arguments."""

    def __init__(self, aliases: OperandAliases, typing: Typing, writes: Writes, to_operand: Assign, to_view: Assign):
        self.aliases, self.typing, self.writes = aliases, typing, writes
        self.to_operand, self.to_view = to_operand, to_view
        self.newer = ""
        self.costly = False
        self.copies = 0

    def live_range(self, rest: list[AST]) -> list[AST]:
        """The statements behind the binding: at the end the operand holds what the view does."""
        made = self.block(rest)
        if self.newer == VIEW:
            made += self.flush(rest[-1])
        return made

    def block(self, block: list[AST]) -> list[AST]:
        return [made for s in block for made in self.statement(s)]

    def flush(self, place: AST) -> list[AST]:
        """The copy after which both sides are coherent."""
        made = {"": [], VIEW: [self.to_operand], OPERAND: [self.to_view]}[self.newer]
        self.copies += len(made)
        self.newer = ""
        return [at(copy(s), place) for s in made]

    def statement(self, statement: AST) -> list[AST]:
        if isinstance(statement, (Break, Return, Raise)):
            needed = self.newer == VIEW or self.aliases.mentioned(statement)[0]
            return [*(self.flush(statement) if needed else []), statement]
        view, operand = self.aliases.mentioned(statement)
        stored = {n for s in walk(statement) for n in self.stored_sides(s)}
        if may_break(statement) or view and operand and stored and isinstance(statement, (For, If, While)):
            return self.compound(statement)
        if self.newer == VIEW and operand or self.newer == OPERAND and view:
            before = self.flush(statement)
        else:
            before = []
        if stored:
            self.newer = min(stored)
            self.costly |= view and operand and len(stored) > 1 or self.is_passed_both(statement)
        return [*before, statement]

    def stored_sides(self, statement: AST) -> set[str]:
        """The sides that a simple statement stores into."""
        if not isinstance(statement, (Assign, AugAssign, Expr)):
            return set()
        names = stored_arrays(statement, self.typing, self.writes)
        return {VIEW for n in names if n in self.aliases.view} | (
            {OPERAND} if names & self.aliases.operand and self.aliases.mentioned(statement)[1] else set())

    def is_passed_both(self, statement: AST) -> bool:
        """Whether a kernel that stores into an array has both sides as arguments."""
        return any(user_call(n) and self.writes(n) and all(self.aliases.mentioned(n)) for n in walk(statement))

    def compound(self, statement: AST) -> list[AST]:
        """A loop or branch with both sides coherent where its blocks begin and end."""
        before = self.flush(statement)

        def block(body: list[AST]) -> list[AST]:
            known, self.copies = self.copies, 0
            made = self.block(body)
            made += self.flush(body[-1]) if made and not isinstance(made[-1], Break) else []
            self.costly |= self.copies > 0 and isinstance(statement, (For, While)) and self.is_scalar_body(body)
            self.copies = known + (self.copies if isinstance(statement, If) else 0)
            self.newer = ""
            return made
        return [*before, with_blocks(statement, block)]

    def is_scalar_body(self, body: list[AST]) -> bool:
        """Whether the body of a loop does less than a copy of an array: it works on single elements."""
        return not any(isinstance(s, (For, While)) or isinstance(s, (Assign, AugAssign)) and (
            self.typing.of(s.targets[0] if isinstance(s, Assign) else s.target).is_array
            or self.typing.of(s.value).is_array) or isinstance(s, Expr) for s in walk_statements(body))
