"""augmented_primal: an adjoint as two functions: the augmented primal runs the kernel and returns the tape beside its
results, the reverse sweep takes it.

    def f_adjoint(u, u_bar):            def f_augmented(u):             def f_reverse(tape, u_bar):
        # forward sweep                     u_before = np.copy(u)           u, u_before = tape
        u_before = np.copy(u)               u[...] = u * u                  ...
        u[...] = u * u                      return (None, (np.empty_like(u), u_before))
        # reverse sweep
        ...

The tape is what is live where the sweeps meet. What the caller may write by the time of the reverse sweep, arguments
and results, it holds copies of: where the reverse sweep reads what they hold there; where it only restores into them it
has memory of its own, and of what it asks for sizes the array itself. (Moses and Churavy, NeurIPS 2020; a function that
returns what its derivative needs: Siskind and Pearlmutter, TOPLAS 30, 2008.)
"""
from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass

from s2sad.differentiate.reallocation import empty_array
from s2sad.differentiate.adjoint import REVERSE
from s2sad.infer.affine import Affine
from s2sad.infer.inference import Typing
from s2sad.infer.shapes import shapes_of
from s2sad.infer.types import Type
from s2sad.liveness import Accesses, Liveness, base_name, read_names, targets
from s2sad.tree import (
    AST, Assign, Call, Eq, For, FunctionDef, If, Name, Return, Subscript, While, assign, attribute, call, compare,
    const, copy, function, index, is_comment, known, name, names, tuple_of, user_call, walk, walk_statements, with_body,
)


@dataclass(frozen=True)
class TapeEntry:
    """What the reverse sweep takes under a name: whether it reads the content of an array, whether it writes it."""
    name: str
    kind: Type
    read: bool
    written: bool


class BothSweeps:
    """An adjoint, cut where the reverse sweep begins; `given` are those of its parameters that the reverse sweep is
    given again, shadows and seeds for one, `live_out` the shadows of arrays."""

    def __init__(self, adjoint: FunctionDef, parameters: Sequence[str], given: Sequence[str], live_out: set[str],
                 accesses: Accesses, typing: Typing):
        [cut] = [k for k, s in enumerate(adjoint.body) if is_comment(s) and s.value.value == REVERSE]
        self.forward, behind = adjoint.body[:cut], adjoint.body[cut:]
        self.parameters, self.live_out, self.accesses, self.typing = parameters, live_out, accesses, typing
        whole = function(adjoint.name, [], behind)
        mentioned = {n.lstrip("=") for n in Liveness(whole, live_out, accesses, strong=False).start}
        self.taken = [n for n in dict.fromkeys([*parameters, *_bound(self.forward)]) if n in mentioned - {*given}]
        self.given = [n for n in parameters if n in given]
        self.shapes = shapes_of(function(adjoint.name, list(parameters), self.forward), typing)
        self.reverse = function(adjoint.name, [*self.taken, *given], [*self.equal_sizes(self.taken), *behind])

    def equal_sizes(self, taken: Collection[str]) -> list[AST]:
        """Marks of which sizes are equal where the reverse sweep begins, by what the forward sweep has allocated."""
        found: dict[Affine, AST] = {}
        made: list[AST] = []
        for used in (*self.given, *taken):
            kind = self.typing.table[used]
            places: list[AST] = [index(attribute(name(used), "shape"), const(k)) for k in range(kind.rank)] if \
                kind.is_array else [name(used)] if kind.is_integer else []
            sizes = self.shapes.of(name(used)) if kind.is_array else map(self.shapes.size, places)
            for place, size in zip(places, sizes):
                if size is None or used in self.shapes.several:
                    continue
                first = found.setdefault(self.shapes.reduced(size), place)
                if first is not place:
                    made.append(known(compare(place, Eq(), copy(first))))
        return made

    def tape(self, reverse: FunctionDef, writes: Collection[int]) -> tuple[TapeEntry, ...]:
        """What the reverse sweep still takes after the passes of `simplify`; at the positions `writes` it writes."""
        before, after = (Liveness(f, self.live_out, self.accesses).start for f in (self.reverse, reverse))
        return tuple(TapeEntry(n, kind := self.typing.table[n], n in before & after,
                               k in writes or not kind.is_array and not kind.is_number)
                     for k, n in enumerate(self.taken) if {n, f"={n}"} & after)

    def augmented(self, title: str, results: Sequence[AST], tape: Sequence[TapeEntry]) -> FunctionDef:
        """The forward sweep as a function that returns its results, and behind them the tape. A name that is not bound
        on every path has a value from the start, which nothing reads."""
        certain = {*self.parameters, *_certainly_bound(self.forward)}
        first = [_unset(e.name, e.kind) for e in tape if e.name not in certain]
        returned = Return(tuple_of(*map(copy, results), *(name(e.name) for e in tape)))
        return function(title, list(self.parameters), [*first, *self.forward, returned])


    def spares_runs(self, tape: Sequence[TapeEntry], writes: Callable[[Call], list[str]]) -> bool:
        """Whether a loop, a statement over arrays or a call of one makes what is on the tape: it would run again."""
        needed = {e.name for e in tape if e.read}

        def spared(block: list[AST]) -> bool:
            for statement in reversed(block):
                parts = list(walk_statements([statement]))
                changed = {base_name(t) for s in parts for t in targets(s)} | {
                    n for part in walk(statement) if user_call(part) for n in writes(part)}
                if not changed & needed:
                    continue
                if isinstance(statement, If):
                    if spared(statement.body) or spared(statement.orelse):
                        return True
                elif isinstance(statement, (For, While)) or any(
                        is_whole(t, self.typing) for t in targets(statement)) or any(map(user_call, walk(statement))):
                    return True
                needed.update(read_names(statement))
            return False
        return spared(self.forward)


def is_whole(place: AST, typing: Typing) -> bool:
    """Whether a place is one of many elements."""
    return isinstance(place, Subscript) and typing.of(place).is_array


def _unset(identifier: str, kind: Type) -> AST:
    if kind.is_array:
        return empty_array(identifier, [const(0)] * kind.rank, kind)
    if not kind.is_number:
        return assign(identifier, const(None))
    zero = const(kind.zero)
    return assign(identifier, call("numpy.float32", zero) if kind.dtype == "float32" else zero)


def _certainly_bound(block: list[AST]) -> set[str]:
    """The names that are bound behind a block, whatever way is taken through it."""
    found: set[str] = set()
    for statement in block:
        if isinstance(statement, If):
            found |= _certainly_bound(statement.body) & _certainly_bound(statement.orelse)
        elif isinstance(statement, Assign):
            found |= {t.id for t in targets(statement) if isinstance(t, Name)}
    return found


def with_tape(forward: FunctionDef, reverse: FunctionDef, results: int, tape: Sequence[TapeEntry], title: str
              ) -> tuple[FunctionDef, FunctionDef]:
    """The two functions with the tape as one value: the first returns it beside its results, the second takes it as its
    first argument, called `title`."""
    returned = forward.body[-1].value.elts
    exposed = {p.id for p in forward.args.args} | {n for r in returned[:results] for n in names(r)}
    held = [_held(entry, value, exposed) for entry, value in zip(tape, returned[results:])]
    first: AST = const(None) if not results else returned[0] if results == 1 else tuple_of(*returned[:results])
    own = [p.id for p in reverse.args.args][len(tape):]
    unpacked: list[AST] = [assign(tuple_of(*(name(e.name) for e in tape)), name(title))] if tape else []
    return (with_body(forward, [*forward.body[:-1], Return(tuple_of(first, tuple_of(*held)))]),
            function(reverse.name, [title, *own], [*unpacked, *reverse.body]))


def with_kept_tape(forward: FunctionDef, reverse: FunctionDef, results: int, tape: Sequence[TapeEntry], title: str
                   ) -> tuple[FunctionDef, FunctionDef]:
    """The two functions as a caller calls them: the first returns the tape as one more result, the second takes it as
    its last argument, called `title`, behind those of the kernel."""
    returned = forward.body[-1].value.elts
    kept = tuple_of(*returned[results:])
    given = [p.id for p in reverse.args.args][len(tape):]
    last = Return(tuple_of(*returned[:results], kept) if results else kept)
    return (with_body(forward, [*forward.body[:-1], last]),
            function(reverse.name, [*given, title], [assign(tuple_of(*(name(e.name) for e in tape)), name(title)),
                                                     *reverse.body]))


def _held(entry: TapeEntry, value: AST, exposed: Collection[str]) -> AST:
    """What the tape holds for an entry: a copy of what the caller may write, where that counts."""
    if not entry.kind.is_array or base_name(value) not in exposed or not (entry.read or entry.written):
        return value
    return call("numpy.copy" if entry.read else "numpy.empty_like", value)


def _bound(block: list[AST]) -> list[str]:
    """The names that statements bind, each once, in the order of the text."""
    found = [t.id for s in walk_statements(block) for t in targets(s) if isinstance(t, Name)]
    return list(dict.fromkeys(found))
