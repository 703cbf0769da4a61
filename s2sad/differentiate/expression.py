"""One expression: its adjoint (what each operand's shadow gains) and its tangent, from the same partials.

    y = alpha * (u[i] - v)          seed = alpha * y_bar
                                    alpha_bar += (u[i] - v) * y_bar
                                    u_bar[i] += seed
                                    v_bar -= seed
"""
from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from s2sad.analyze.uses import is_active
from s2sad.differentiate.arithmetic import Term, guarded, is_plain, scalar_choices, total
from s2sad.infer.infer import Typing
from s2sad.naming import Names
from s2sad.rules.operation import operation
from s2sad.tree import (
    AST, Attribute, BinOp, Constant, Mult, Name, Subscript, assign, attribute, call, call_name, const, copy, dump, name,
)


@dataclass
class Gains:
    """What the leaves of an expression gain: `before`, the bindings of shared seeds; then leaf and term, in order."""
    before: list[AST] = field(default_factory=list)
    terms: dict[str, tuple[AST, list[Term]]] = field(default_factory=dict)

    def add(self, leaf: AST, term: Term) -> None:
        self.terms.setdefault(dump(leaf), (leaf, []))[1].append(term)

    def sums(self) -> list[tuple[AST, Term]]:
        return [(leaf, total(_doubled(terms))) for leaf, terms in self.terms.values()]


def _doubled(terms: list[Term]) -> list[Term]:
    """The terms with equal ones counted: 2.0 * x * seed instead of x * seed + x * seed."""
    groups: dict[tuple[str, bool], list[Term]] = {}
    for term in terms:
        groups.setdefault((dump(term.tree), term.negative), []).append(term)
    return [same[0] if len(same) == 1 else Term(BinOp(const(float(len(same))), Mult(), same[0].tree), same[0].negative)
            for same in groups.values()]


class Pullback:
    """Pulls a seed back through expressions of one function.

    `bind(wanted, like)` allocates a name for a shared seed and types it as the expression `like`.
    """

    def __init__(self, typing: Typing, active: frozenset[str], free: Names, bind: Callable[[str, AST], str]):
        self.typing, self.active, self.free, self.bind = typing, active, free, bind

    def gains(self, node: AST, seed: Term, result: AST | None = None, region: AST | None = None) -> Gains:
        """The gains of an expression's leaves; `result` is where the expression's value lies, `region` the array
        that a whole-array expression fills."""
        found = Gains()
        self.pull(node, seed, result, region, found)
        return found

    def pull(self, node: AST, seed: Term, result: AST | None, region: AST | None, found: Gains) -> None:
        if not is_active(node, self.typing, self.active):
            return
        if isinstance(node, (Name, Subscript)):
            found.add(node, self.narrowed(node, seed, region))
            return
        if call_name(node) == "numpy.sum":
            operand = node.args[0]
            self.pull(operand, self.shared(operand, seed, found), None, model_of(operand, self.typing), found)
            return
        operated = operation(node)
        assert operated is not None
        rule, operands = operated
        flowing = [p for p, o in operands.items() if p not in rule.zero and is_active(o, self.typing, self.active)]
        if len(flowing) > 1 or any(rule.is_singular(p, operands) for p in flowing):
            seed = self.shared(node, seed, found, len(flowing) > 1)
        for parameter in flowing:
            partial = rule.partial(parameter, operands, copy(node) if result is None else result)
            whole = self.typing.of(partial).is_array or self.typing.of(seed.tree).is_array
            term = seed.times(partial if whole else scalar_choices(partial))
            if rule.is_singular(parameter, operands):
                term = guarded(seed.tree, term, whole)
            operand = operands[parameter]
            if self.leaves(operand) > 1:
                term = self.shared(operand, term, found)
            self.pull(operand, term, None, region, found)

    def leaves(self, node: AST) -> int:
        """How often a derivative leaves an expression, up to two."""
        if not is_active(node, self.typing, self.active):
            return 0
        operated = operation(node)
        if operated is None or isinstance(node, (Name, Subscript)):
            return 1
        return min(2, sum(self.leaves(o) for p, o in operated[1].items() if p not in operated[0].zero))

    def shared(self, node: AST, seed: Term, found: Gains, several: bool = True) -> Term:
        """The seed as something that can be written more than once."""
        if is_plain(seed.tree) or not several and isinstance(seed.tree, (Name, Subscript)):
            return seed
        held = self.bind("seed", seed.tree)
        found.before.append(assign(held, seed.tree))
        return Term(name(held), seed.negative)

    def narrowed(self, leaf: AST, seed: Term, region: AST | None) -> Term:
        """The one place where broadcasting is undone: a number that met an array gains the sum over it."""
        if region is None or self.typing.of(leaf).is_array:
            return seed
        if self.typing.of(seed.tree).is_array:
            return Term(call("numpy.sum", seed.tree), seed.negative)
        return Term(BinOp(seed.tree, Mult(), size_of(region)), seed.negative)


def model_of(node: AST, typing: Typing) -> AST | None:
    """An array whose shape an elementwise expression has."""
    if isinstance(node, (Name, Subscript)):
        return node if typing.of(node).is_array else None
    if isinstance(node, (Attribute, Constant)) or call_name(node) in ("numpy.sum", "builtins.len"):
        return None
    children = [getattr(node, f, None) for f in node._fields]
    flat = [c for child in children for c in (child if isinstance(child, list) else [child]) if isinstance(c, AST)]
    return next((m for c in flat if (m := model_of(c, typing)) is not None), None)


def size_of(region: AST) -> AST:
    if isinstance(region, Name):
        return attribute(region, "size")
    return attribute(copy(region), "size")


class Pushforward:
    """Tangents of expressions of one function; `dot(leaf)` is the tangent of a name or element."""

    def __init__(self, typing: Typing, active: frozenset[str], dot: Callable[[AST], AST]):
        self.typing, self.active, self.dot = typing, active, dot

    def tangent(self, node: AST, result: AST | None = None) -> Term | None:
        """The tangent of an expression, None if it is zero."""
        if not is_active(node, self.typing, self.active):
            return None
        if isinstance(node, (Name, Subscript)):
            return Term(self.dot(node))
        if call_name(node) == "numpy.sum":
            inner = self.tangent(node.args[0])
            return inner and self.summed(node.args[0], inner)
        operated = operation(node)
        assert operated is not None
        rule, operands = operated
        terms = []
        for parameter, operand in operands.items():
            inner = None if parameter in rule.zero else self.tangent(operand)
            if inner is None:
                continue
            partial = rule.partial(parameter, operands, copy(node) if result is None else result)
            whole = self.typing.of(node).is_array
            term = inner.times(partial if whole else scalar_choices(partial))
            if rule.is_singular(parameter, operands):
                term = guarded(inner.tree, term, whole)
            terms.append(term)
        return total(terms) if terms else None

    def summed(self, operand: AST, inner: Term) -> Term:
        """The sum of a tangent over an array; one that is the same everywhere is multiplied."""
        if self.typing.of(inner.tree).is_array:
            return Term(call("numpy.sum", inner.tree), inner.negative)
        model = model_of(operand, self.typing)
        return inner if model is None else Term(BinOp(inner.tree, Mult(), size_of(model)), inner.negative)


