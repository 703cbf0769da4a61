"""view_aliases: which names share memory in NumPy: an array and the views of it that functions make.

Such a view is an array of its own here. `sources` says what a name may be a view of, `diverging_stores` after which
stores it differs from NumPy's array, `OperandAliases` which names are on either side of one view. Parts of one array
that share no element are known whatever its size:

    y[:n * n]  y[n * n:]            they share no element
    y[:n]      y[2 * n:]            none if n is not negative: `DisjointSlices` says so
    y[0::2]    y[1::2]              none
    y[:n]      y[k:]                perhaps
"""
from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field

from s2sad.infer.inference import Typing
from s2sad.infer.shapes import single_values
from s2sad.infer.signatures.laws import whole_number
from s2sad.liveness import Accesses, Liveness, base_name, read_names, targets
from s2sad.normalize.context import NormalContext
from s2sad.normalize.views.views_without_axes import (
    ELEMENT, WITHOUT_AXES, makes_view, refuse_elsewhere, views_without_axes,
)
from s2sad.tree import (
    AST, Add, Assign, Attribute, AugAssign, BinOp, Call, Constant, Expr, For, FunctionDef, IfExp, List, Mult, Name,
    Slice, Sub, Subscript, Tuple, USub, UnaryOp, call_name, copy, dump, indices, names, times_bound, user_call, walk,
    walk_statements,
)

_SLICED = {f"numpy.{f}" for f in ("squeeze", "expand_dims", "atleast_1d", "atleast_2d",
                                 "atleast_3d")}     # `pieces` writes subscripts
_ALIASES = {"numpy.asarray", "numpy.ascontiguousarray"}
Links = dict[str, dict[str, bool]]
Writes = Callable[[Call], list[str]]


def unsupported_views(function: FunctionDef, context: NormalContext) -> None:
    """Refuses the stores after which an array and a view of it by a function would differ from NumPy's.

        def f(m: float64[:, :], y):
            w = np.diagonal(m)
            m[0] = 2.0
            y[:] = w[1]

    refused: an array is written that NumPy shares with another one

    Requires structured form in which functions of whole arrays stand alone, after `coherence`, which keeps most of
    these views and their operands alike; changes nothing.
    """
    typing, writes, report = context.typing, context.written_arrays, context.report
    refuse_elsewhere(function, context, _links(function, typing))
    found = {s: typing.table[n].is_number or typing.table[other].is_number
             for s, n, other in diverging_stores(function, typing, writes)}
    for statement, of_number in found.items():
        if of_number:
            report.error("S201", f"{WITHOUT_AXES}, and it or its array is written", statement, help=ELEMENT)
        else:
            report.error("S201", "an array is written that NumPy shares with another one, which is a view of it by a "
                         "function", statement, help="write into the array itself, or take a copy: np.copy(...)")


def diverging_stores(function: FunctionDef, typing: Typing, writes: Writes) -> Iterator[tuple[AST, str, str]]:
    """The statements that store into an array, its name, and that of another one which then differs from NumPy's."""
    links = _links(function, typing)
    if not any(by_function for above in links.values() for by_function in above.values()):
        return
    parameters = {p.id for p in function.args.args}
    live = Liveness(function, parameters, Accesses(), strong=False)
    for statement in walk_statements(function.body):
        if not isinstance(statement, (Assign, AugAssign, Expr)):
            continue
        value = statement.value
        called = user_call(value)
        added = {t.id for t in targets(statement) if isinstance(t, Name) and t.id in links} if isinstance(
            statement, AugAssign) else set()
        near = live.after[id(statement)] | parameters | (read_names(value) if called else set())
        for n in sorted(stored_arrays(statement, typing, writes) | added):
            yield from ((statement, n, other) for other in sorted(near) if _diverge(n, other, links))


def stored_arrays(statement: AST, typing: Typing, writes: Writes) -> set[str]:
    """The arrays that a simple statement stores into."""
    value = getattr(statement, "value", None)
    called = value if isinstance(value, Call) and user_call(value) else None
    return {base_name(t) for t in targets(statement) if isinstance(t, Subscript) or isinstance(
        statement, AugAssign) and typing.of(t).is_array} | set(() if called is None else writes(called))


def sources(statement: AST, typing: Typing) -> list[tuple[AST, bool]]:
    """The arrays that the name which a statement binds may be a view of; true where a function makes it."""
    if not isinstance(statement, Assign) or not isinstance(statement.targets[0], Name):
        return []
    value, called = statement.value, call_name(statement.value)
    if isinstance(value, (Tuple, List, IfExp)):
        return [(n, False) for n in walk(value) if isinstance(n, Name) and typing.of(n).is_array]
    if called == "numpy.diag" and typing.of(value.args[0]).rank == 1:
        return []  # a matrix is made
    if called in _ALIASES and typing.of(value).dtype != typing.of(value.args[0]).dtype:
        return []  # a copy in another dtype
    by_function = makes_view(value)
    source = value.args[0] if by_function else value
    is_array = isinstance(source, (Name, Subscript)) and typing.of(source).is_array
    return [(source, by_function and called not in _SLICED)] if is_array else []


def _links(function: FunctionDef, typing: Typing) -> Links:
    """The names that each name may be a view of; true where a function makes it, or it is a number here."""
    direct: dict[str, set[tuple[str, bool]]] = {}
    for statement in walk(function.body):
        for source, by_function in sources(statement, typing):
            direct.setdefault(statement.targets[0].id, set()).add((base_name(source), by_function))
    for n, above in views_without_axes(function, typing).items():
        direct.setdefault(n, set()).update((m, True) for m in above)
    return {n: _above(n, direct) for n in direct}


def _above(identifier: str, direct: dict[str, set[tuple[str, bool]]]) -> dict[str, bool]:
    found: dict[str, bool] = {}
    waiting: list[tuple[str, bool]] = sorted(direct[identifier])
    while waiting:
        above, by_function = waiting.pop()
        if above in found and (found[above] or not by_function):
            continue
        found[above] = by_function
        waiting += [(n, by_function or s) for n, s in sorted(direct.get(above, ()))]
    return found


def _diverge(stored: str, other: str, links: Links) -> bool:
    """Whether two names share an array in NumPy and do not share one here."""
    first, second = ({n: False, **links.get(n, {})} for n in (stored, other))
    common = [first[n] or second[n] for n in first if n in second]
    if stored == other:
        return first[stored]
    return bool(common) and all(common)


@dataclass
class OperandAliases:
    """The names on both sides; `nonnegative` are numbers that must not be negative for parts to be disjoint;
    `ambiguous` if a name may be on either side."""
    view: set[str]
    operand: set[str]
    ambiguous: bool
    part: AST
    disjoint: DisjointSlices
    nonnegative: list[AST] = field(default_factory=list)

    def concerns(self, diverging: Iterable[tuple[str, str]]) -> bool:
        """Whether the view is one of two arrays that differ from NumPy's."""
        return any({n, other} & self.view for n, other in diverging)

    def mentioned(self, node: AST | list[AST]) -> tuple[bool, bool]:
        """Whether elements of the view, and of what it is a view of, are mentioned."""
        shapes = {id(n.value) for n in walk(node) if isinstance(n, Attribute) and n.attr in ("shape", "size", "dtype")}
        found = [n for n in occurrences(node) if id(n) not in shapes]
        return (any(base_name(n) in self.view for n in found),
                any(base_name(n) in self.operand and not self.is_disjoint(n) for n in found))

    def is_disjoint(self, occurrence: AST) -> bool:
        """Whether a part of an array is known to share no element with that of the view."""
        if base_name(occurrence) != base_name(self.part):
            return False
        needed = self.disjoint.disjointness(self.part, occurrence)
        if needed:
            known = {dump(n) for n in self.nonnegative}
            self.nonnegative += [copy(n) for n in needed if dump(n) not in known]
        return needed is not None


def operand_aliases(function: FunctionDef, binding: Assign, typing: Typing) -> OperandAliases:
    """Both sides of a view."""
    values = single_values(function)
    part = binding.value.args[0]
    edges = [(s.targets[0].id, source) for s in walk(function.body) if s is not binding
             for source, _ in sources(s, typing)]
    view, operand = {binding.targets[0].id}, {base_name(part)}
    while more := {t for t, source in edges if base_name(source) in view} - view:
        view |= more
    aliases = OperandAliases(view, operand, False, _resolved(part), DisjointSlices(function, values))
    if base_name(part) not in values:
        aliases.part = Name("", part.ctx, None, None)      # what is bound anew has no parts that are known to be others
    edges = [(t, source) for t, source in edges if not aliases.is_disjoint(source)]
    while more := {n for t, source in edges for n in (t, base_name(source))
                   if {t, base_name(source)} & operand and not {t, base_name(source)} & view} - operand:
        operand |= more
    aliases.ambiguous = bool(view & operand) or any(
        t in view and base_name(source) not in view for t, source in edges) or _is_bound_to_others(function, aliases, [
            binding.targets[0].id, *(t for t, _ in edges)])
    return aliases


def _is_bound_to_others(function: FunctionDef, aliases: OperandAliases, known: list[str]) -> bool:
    """Whether a name of either side is bound to memory of its own as well, in a branch or in a loop: then it shares
    none of the other side's. `known` are the names as often as they are bound to what is on a side."""
    times = times_bound(function.body, Assign, For)
    times.update(p.id for p in function.args.args)
    sides = Counter(known)
    return any(times[n] > sides[n] for n in aliases.view) or any(times[n] > max(sides[n], 1) for n in aliases.operand)


def _resolved(part: AST) -> AST:
    return copy(part) if isinstance(part, (Name, Subscript)) else part


Polynomial = dict[tuple[str, ...], int]


class DisjointSlices:
    """The parts of arrays in one function; `values` are its names bound once, with what binds them."""

    def __init__(self, function: FunctionDef, values: Mapping[str, AST | None]):
        self.parameters = {p.id for p in function.args.args}
        self.values = values
        self.atoms: dict[str, AST] = {}

    def is_invariant(self, node: AST, depth: int = 0) -> bool:
        """Whether an expression is the same wherever it stands: of arrays it reads sizes of parameters."""
        if depth > 20 or isinstance(node, Subscript) and not (isinstance(node.value, Attribute) and self.is_invariant(
                node.value, depth + 1)) or isinstance(node, Call):
            return False
        for n in names(node):
            if n not in self.values or n not in self.parameters and (
                    (value := self.values[n]) is None or not self.is_invariant(value, depth + 1)):
                return False
        return True

    def disjointness(self, one: AST, other: AST) -> list[AST] | None:
        """The expressions that must not be negative for two parts of one array to share nothing; None if they may."""
        if not isinstance(one, Subscript) or not isinstance(other, Subscript):
            return None
        for a, b in zip(_first(one), _first(other)):
            for low, high in ((a, b), (b, a)):
                if (found := self.precedes(low, high)) is not None:
                    return found
        return None

    def precedes(self, low: AST, high: AST) -> list[AST] | None:
        """The same for one axis, where the first part is to lie before the second, or between its elements."""
        if not isinstance(low, Slice) or not isinstance(high, Slice):
            a, b = whole_number(low), whole_number(high)
            return [] if a is not None and b is not None and 0 <= a < b else None
        step, other = (1 if s.step is None else whole_number(s.step) for s in (low, high))
        if step is not None and step == other and step > 1:
            first, second = (0 if s.lower is None else whole_number(s.lower) for s in (low, high))
            if first is not None and second is not None and min(first, second) >= 0 and (second - first) % step:
                return []
        if step is None or other is None or min(step, other) < 1 or low.upper is None or high.lower is None:
            return None
        end, start = self.polynomial(low.upper), self.polynomial(high.lower)
        if end is None or start is None:
            return None
        if end == start:
            return []
        rest = _plus(start, end, -1)
        if any(c < 0 for c in (*rest.values(), *end.values())):
            return None
        found = sorted({s for terms in (*rest, *end) for s in terms})
        return [copy(self.atoms[s]) for s in found]

    def polynomial(self, node: AST, depth: int = 0) -> Polynomial | None:
        """An integer expression as a sum of products of what stays the same; None if it may change."""
        number = whole_number(node)
        if number is not None:
            return {(): number} if number else {}
        if depth > 20 or not self.is_invariant(node):
            return None
        if isinstance(node, UnaryOp) and isinstance(node.op, USub):
            inner = self.polynomial(node.operand, depth + 1)
            return None if inner is None else _plus({}, inner, -1)
        if isinstance(node, BinOp) and isinstance(node.op, (Add, Sub, Mult)):
            left, right = self.polynomial(node.left, depth + 1), self.polynomial(node.right, depth + 1)
            if left is None or right is None:
                return None
            if isinstance(node.op, Mult):
                made: Polynomial = {}
                for terms, c in left.items():
                    made = _plus(made, {tuple(sorted((*terms, *t))): d for t, d in right.items()}, c)
                return made
            return _plus(left, right, 1 if isinstance(node.op, Add) else -1)
        value = self.values.get(node.id) if isinstance(node, Name) else None
        if value is not None:
            return self.polynomial(value, depth + 1)
        key = dump(node)
        self.atoms[key] = node
        return {(key,): 1}


def _plus(one: Polynomial, other: Polynomial, factor: int) -> Polynomial:
    made = dict(one)
    for terms, c in other.items():
        made[terms] = made.get(terms, 0) + factor * c
    return {terms: c for terms, c in made.items() if c}


def _first(part: Subscript) -> list[AST]:
    """The subscripts of the first axes."""
    found = indices(part)
    ends = [k for k, s in enumerate(found) if isinstance(s, Constant) and s.value in (None, Ellipsis)]
    return found[:ends[0]] if ends else found


def occurrences(node: AST | list[AST]) -> list[AST]:
    """The names in a statement or expression, each with the subscript that takes a part of it, if one does."""
    inside = {id(n.value) for n in walk(node) if isinstance(n, Subscript) and isinstance(n.value, Name)}
    return [n for n in walk(node) if isinstance(n, Name) and id(n) not in inside or isinstance(
        n, Subscript) and isinstance(n.value, Name)]
