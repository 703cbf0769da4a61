"""expression_rules: the adjoint of an expression (an increment of each operand's shadow) and its tangent, from the
same partials.

    y = alpha * (u[i] - v)          seed = alpha * y_bar
                                    alpha_bar += (u[i] - v) * y_bar
                                    u_bar[i] += seed
                                    v_bar -= seed
"""
from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

from s2sad import rules
from s2sad.analyze.uses import DerivativeFlow, operated
from s2sad.differentiate.arithmetic import Term, is_plain, choice_product, scalar_choices, total, unsigned
from s2sad.differentiate.zero_law import ZeroLaw
from s2sad.infer.inference import Typing
from s2sad.infer.signatures.laws import ONE
from s2sad.infer.shapes import Shapes, shape_expression
from s2sad.rules.array import RESULT, SEED
from s2sad.rules.complexes import HOLOMORPHIC
from s2sad.rules.rule import Rule, number
from s2sad.tree import (
    AST, Attribute, BinOp, Call, Constant, Div, Mult, Name, Subscript, UnaryOp, USub, assign, attribute, call,
    call_name, const, copy, dump, name, names, rebuild, substitute, tuple_of, walk,
)


@dataclass
class Increments:
    """The increments of the leaves of an expression: `before`, the bindings of shared seeds; then leaf and term."""
    before: list[AST] = field(default_factory=list)
    terms: dict[str, tuple[AST, list[Term]]] = field(default_factory=dict)
    seeds: dict[str, str] = field(default_factory=dict)      # the names of shared seeds, by their text

    def add(self, leaf: AST, term: Term) -> None:
        self.terms.setdefault(dump(leaf), (leaf, []))[1].append(term)

    def sums(self) -> list[tuple[AST, Term]]:
        return [(leaf, total(_merged(terms))) for leaf, terms in self.terms.values()]


def _merged(terms: list[Term]) -> list[Term]:
    """The terms with equal ones counted: 2.0 * x * seed instead of x * seed + x * seed."""
    groups: dict[tuple[str, bool], list[Term]] = {}
    for term in terms:
        groups.setdefault((dump(term.tree), term.negative), []).append(term)
    return [same[0] if len(same) == 1 else Term(BinOp(const(float(len(same))), Mult(), same[0].tree), same[0].negative)
            for same in groups.values()]


class Pullback:
    """Pulls a seed back through expressions of one function.

    `bind(base, like)` allocates a name for a shared seed and types it as the expression `like`.
    """

    def __init__(self, flow: DerivativeFlow, bind: Callable[[str, AST], str], shapes: Shapes, zero_law: ZeroLaw):
        self.typing, self.flow, self.bind, self.shapes, self.zero_law = flow.typing, flow, bind, shapes, zero_law
        self._leaves: dict[AST, int] = {}       # by identity

    def increments(self, node: AST, seed: Term, result: AST | None = None, region: AST | None = None) -> Increments:
        """The increments of an expression's leaves; `result` holds the expression's value, `region` is the array that a
        whole-array expression fills."""
        found = Increments()
        self.pull(node, seed, result, region, found)
        return found

    def pull(self, node: AST, seed: Term, result: AST | None, region: AST | None, found: Increments) -> None:
        if not self.flow.through(node):
            return
        seed = self.real(node, seed)
        if isinstance(node, (Name, Subscript)):
            found.add(node, self.unbroadcast(node, seed, region))
            return
        if rules.find_array(call_name(node)) is not None:
            self.pull_function(node, self.unbroadcast(node, seed, region), result, found)
            return
        operation = operated(node, self.typing)
        assert operation is not None
        rule, operands = operation
        flowing = [p for p, o in operands.items() if p not in rule.zero and self.flow.through(o)]
        partials = {p: self.flow.partial(node, rule, p, operands, result) for p in flowing}
        tested = {p for p in flowing if self.zero_law.tests_seed(rule, p, operands)}
        if len(flowing) > 1 or tested:
            seed = self.bind_seed(node, seed, found, len(flowing) > 1)
        for parameter, partial in partials.items():
            operand = operands[parameter]
            root = self.zero_law.root_test(rule, parameter, operands, result)
            term = self.contribution(rule, seed, partial, [*([seed.tree] if parameter in tested else []), *(
                [] if root is None else [root])], found)
            steep = self.zero_law.flag and self.zero_law.unbounded.is_steep_in(rule, parameter, operands)
            if self.leaves(operand) > 1 or steep:
                term = self.bind_seed(operand, term, found)
            if steep:
                found.before.append(self.zero_law.set_flag(term.tree))
            with self.zero_law.pulled(rule, parameter, operands):
                self.pull(operand, term, None, region, found)

    def contribution(self, rule: Rule, seed: Term, partial: AST, tested: list[AST], found: Increments) -> Term:
        """The increment of an operand, zero where a tested factor is, and where the partial is, if need be."""
        whole = self.typing.of(partial).is_array or self.typing.of(seed.tree).is_array
        partial = partial if whole else scalar_choices(partial)
        zero = self.zero_law.slope_test(seed, partial)
        if zero is not None and not is_plain(zero):
            held = self.bind("slope", partial)
            found.before.append(assign(held, partial))
            zero = partial = name(held)
        term = self.zero_law.product(self.term(rule, seed, partial), tested, whole)
        return term if zero is None else self.zero_law.strong(term, zero, whole)

    def term(self, rule: Rule, seed: Term, partial: AST) -> Term:
        """The increment of an operand: the product of the seed with the conjugate of the partial."""
        if rule.kind == "conjugate":
            return Term(conjugated(seed.tree, self.typing), seed.negative)
        factor = partial if rule.kind == "gradient" else conjugated(partial, self.typing)
        return choice_product(seed, factor) or seed.times(factor)

    def real(self, node: AST, seed: Term) -> Term:
        """The one place where the imaginary part of a seed is dropped: what meets complex numbers but is real itself
        gains the real part."""
        if self.typing.of(node).is_complex or not self.typing.of(seed.tree).is_complex:
            return seed
        return Term(call("numpy.real", seed.tree), seed.negative)

    def pull_function(self, node: AST, seed: Term, result: AST | None, found: Increments) -> None:
        """The increments of the operands of a function of whole arrays."""
        rule = rules.find_array(call_name(node))
        assert rule is not None and isinstance(node, Call)
        arguments, ranks = rule.arguments(node), tuple(self.typing.of(a).rank for a in node.args)
        if rule.name == "numpy.sum" and not node.keywords:
            operand = node.args[0]
            self.pull(operand, self.bind_seed(operand, seed, found), None, operand, found)
            return
        flowing = [p for p in rule.adjoints if self.flow.through(arguments[p])]
        seed = self.bind_seed(node, seed, found, len(flowing) > 1 or any(
            names(rule.adjoint(p, ranks)).count(SEED) != 1 for p in flowing))
        filled = {**arguments, RESULT: copy(node) if result is None else result}
        if rule.name in HOLOMORPHIC:
            read = {n for p in flowing for n in rule.uses(p, ranks)}
            filled = {p: conjugated(value, self.typing) if p in read else value for p, value in filled.items()}
        filled[SEED] = seed.tree
        for shared in dict.fromkeys(s for p in flowing for s in rule.needs(p, ranks)):
            value = substitute(rule.shared[shared], filled)
            held = self.bind(shared, value)
            found.seeds.setdefault(dump(value), held)
            found.before.append(assign(held, value))
            filled[shared] = name(held)
        for parameter in flowing:
            operand = arguments[parameter]
            gain, negative = unsigned(self.sized(substitute(rule.gain(parameter, ranks, arguments), filled)))
            term = Term(gain, seed.negative != negative)
            if self.zero_law.steep and isinstance(gain, BinOp) and isinstance(gain.op, Mult) and is_plain(gain.right):
                term = self.zero_law.strong(term, gain.right, True)
            if self.leaves(operand) > 1:
                term = self.bind_seed(operand, term, found)
            self.pull(operand, term, None, operand, found)

    def sized(self, gain: AST) -> AST:
        """An increment that reads sizes of names, not of expressions, which would be computed for that."""
        def change(n: AST) -> AST | None:
            if not isinstance(n, Attribute) or n.attr != "shape" or isinstance(n.value, (Name, Subscript)):
                return None
            whole = self.shapes.of(n.value)
            like = next((m for m in walk(n.value) if isinstance(m, Name) and m.id in self.typing.table
                         and self.typing.of(m).is_array and self.shapes.of(m) == whole), None)
            if like is not None:
                return attribute(copy(like), "shape")
            return None if None in whole else tuple_of(*(self.shapes.extent(d) for d in whole if d is not None))
        return rebuild(gain, change)

    def leaves(self, node: AST) -> int:
        """The number of active leaves of an expression, up to two."""
        if node not in self._leaves:
            self._leaves[node] = self._count_leaves(node)
        return self._leaves[node]

    def _count_leaves(self, node: AST) -> int:
        if not self.flow.through(node):
            return 0
        operation = operated(node, self.typing)
        if operation is None or isinstance(node, (Name, Subscript)):
            return 1
        return min(2, sum(self.leaves(o) for p, o in operation[1].items() if p not in operation[0].zero))

    def bind_seed(self, node: AST, seed: Term, found: Increments, several: bool = True) -> Term:
        """The seed as an expression that may be repeated: it is bound to a name, if it is not plain."""
        if is_plain(seed.tree) or not several and isinstance(seed.tree, (Name, Subscript)):
            return seed
        key = dump(seed.tree)
        held = found.seeds.get(key)
        if held is None:
            held = found.seeds[key] = self.bind("seed", seed.tree)
            found.before.append(assign(held, seed.tree))
        return Term(name(held), seed.negative)

    def unbroadcast(self, leaf: AST, seed: Term, region: AST | None) -> Term:
        """The one place where broadcasting is undone: the increment of an operand is summed over its new axes."""
        if region is None:
            return seed
        whole, own = self.shapes.of(region), self.shapes.of(leaf)
        extra = len(whole) - len(own)
        ones = [k for k, size in enumerate(own, extra) if size == ONE and whole[k] != ONE]
        if not extra and not ones:
            return seed
        if not own and not self.typing.of(seed.tree).is_array:
            return Term(BinOp(seed.tree, Mult(), size_of(region, self.shapes)), seed.negative)
        gain = seed.tree
        if self.shapes.of(gain) != whole:
            gain = call("numpy.broadcast_to", gain, shape_expression(self.shapes, whole))
        if not own:
            return Term(call("numpy.sum", gain), seed.negative)
        if extra:
            gain = call("numpy.sum", gain, axis=axes(range(extra)))
        if ones:
            gain = call("numpy.sum", gain, axis=axes(k - extra for k in ones), keepdims=const(True))
        return Term(gain, seed.negative)


def conjugated(node: AST, typing: Typing) -> AST:
    """The conjugate of an expression; what is real stays as it is."""
    if not typing.of(node).is_complex:
        return node
    if isinstance(node, Constant):
        return UnaryOp(USub(), node) if node.value.real == 0.0 else const(node.value.conjugate())
    if isinstance(node, UnaryOp):
        return UnaryOp(node.op, conjugated(node.operand, typing))
    if isinstance(node, BinOp) and isinstance(node.op, (Mult, Div)) and not all(
            typing.of(n).is_complex and not isinstance(n, Constant) for n in (node.left, node.right)):
        return BinOp(conjugated(node.left, typing), node.op, conjugated(node.right, typing))
    return node.args[0] if call_name(node) in ("numpy.conj", "numpy.conjugate") else call("numpy.conj", node)


def axes(numbers: Iterable[int]) -> AST:
    """The value of `axis=` for these axes."""
    found = list(map(const, numbers))
    return found[0] if len(found) == 1 else tuple_of(*found)


def size_of(region: AST, shapes: Shapes) -> AST:
    """The number of elements of an array expression."""
    if isinstance(region, (Name, Subscript)):
        return attribute(copy(region), "size")
    sizes = [shapes.extent(d) for d in shapes.of(region) if d is not None]
    made = sizes[0]
    for size in sizes[1:]:
        made = BinOp(made, Mult(), size)
    return made


class Pushforward:
    """Tangents of expressions of one function; `dot(leaf)` is the tangent of a name or element, `held(partial)` a name
    that the partial is bound to."""

    def __init__(self, typing: Typing, active: frozenset[str], dot: Callable[[AST], AST], shapes: Shapes,
                 zero_law: ZeroLaw, bind_partial: Callable[[AST], AST]):
        self.typing, self.dot, self.shapes, self.flow = typing, dot, shapes, DerivativeFlow(typing, active)
        self.zero_law, self.bind_partial = zero_law, bind_partial

    def tangent(self, node: AST, result: AST | None = None) -> Term | None:
        """The tangent of an expression, None if it is zero."""
        if not self.flow.through(node):
            return None
        if isinstance(node, (Name, Subscript)):
            return Term(self.dot(node))
        if rules.find_array(call_name(node)) is not None:
            return self.function(node, result)
        operation = operated(node, self.typing)
        assert operation is not None
        rule, operands = operation
        terms = []
        for parameter, operand in operands.items():
            inner = None if parameter in rule.zero else self.tangent(operand)
            if inner is None:
                continue
            partial = self.flow.partial(node, rule, parameter, operands, result)
            whole = self.typing.of(node).is_array
            partial = partial if whole else scalar_choices(partial)
            if number(partial) == 0:        # whatever the tangent is
                continue
            tested = self.zero_law.tests_partial(rule, operand, inner, partial)
            partial = self.bind_partial(partial) if tested else partial
            root = self.zero_law.root_test(rule, parameter, operands, result)
            factors = [] if root is None else [root]
            factors += [inner.tree] if rule.is_singular(parameter, operands) else []
            factors += [partial] if tested else []
            terms.append(self.zero_law.product(self.term(rule, inner, partial), factors, whole))
        return total(terms) if terms else None

    def term(self, rule: Rule, inner: Term, partial: AST) -> Term:
        """The tangent of an operation in one operand."""
        if rule.kind == "conjugate":
            return Term(conjugated(inner.tree, self.typing), inner.negative)
        if rule.kind == "gradient":
            made = inner.times(conjugated(partial, self.typing))
            return Term(call("numpy.real", made.tree), made.negative)
        return choice_product(inner, partial) or inner.times(partial)

    def function(self, node: AST, result: AST | None) -> Term | None:
        """The tangent of a function of whole arrays."""
        rule = rules.find_array(call_name(node))
        assert rule is not None and isinstance(node, Call)
        if rule.name == "numpy.sum":
            inner = self.tangent(node.args[0])
            return inner and self.summed(node, inner)
        arguments = rule.arguments(node)
        dots = {p: self.tangent(arguments[p]) for p in rule.adjoints}
        if rule.tangent is None:
            terms = [Term(Call(node.func, [t.tree if o is arguments[p] else copy(o) for o in node.args],
                               copy(node.keywords)), t.negative) for p, t in dots.items() if t is not None]
            return total(terms) if terms else None
        filled = {f"{p}_dot": call("numpy.zeros_like", arguments[p]) if t is None else t.expression()
                  for p, t in dots.items()}
        value = substitute(rule.tangent, {**arguments, **filled, RESULT: copy(node) if result is None else result})
        return Term(*unsigned(value))

    def summed(self, node: Call, inner: Term) -> Term:
        """The sum of a tangent, which is broadcast to the whole operand first."""
        operand, dot = node.args[0], inner.tree
        whole = self.shapes.of(operand)
        if not node.keywords and not self.typing.of(dot).is_array:
            return Term(BinOp(dot, Mult(), size_of(operand, self.shapes)), inner.negative)
        if self.shapes.of(dot) != whole:
            dot = call("numpy.broadcast_to", dot, shape_expression(self.shapes, whole))
        return Term(Call(node.func, [dot], copy(node.keywords)), inner.negative)
