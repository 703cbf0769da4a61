"""What the rule of a function of whole arrays is, and how such rules are registered.

A rule names the function with its options and their defaults, and gives for each operand what its shadow gains, as
an expression over `g`, the result's shadow, `y`, the result, the operands and the options:

    arrays("numpy.roll(x, shift, axis=None)", law="same", x="numpy.roll(g, -shift, axis=axis)")
    arrays("numpy.matmul(a, b)", law="matmul", a={(2, 2): "g @ b.T", (2, 1): "numpy.outer(g, b)"}, ...)
    arrays("numpy.linalg.solve(a, b)", law="solved", shared={"s": "numpy.linalg.solve(a.T, g)"}, b="s", ...)

A dictionary has an adjoint for the ranks of the operands, `None` for all others. An operand without an adjoint has no
derivative. What several adjoints read is `shared` and computed once. `law` names how the type and the shape of the
result follow from the arguments (`infer/signatures/laws`). A function without a `tangent` is linear in each operand
that has a derivative: its tangent is the sum of the function with one operand replaced by its tangent. A `tangent` is
an expression over the tangents, `x_dot` for `x`, which are arrays of zeros where an operand has none.
"""
from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

from s2sad import tree
from s2sad.rules.rule import template
from s2sad.tree import AST, Call, call_name

SEED, RESULT = "g", "y"
Ranks = tuple[int, ...]
Refine = Callable[[str, Mapping[str, AST]], "str | None"]
Adjoint = Mapping["Ranks | None", AST]


@dataclass(frozen=True)
class ArrayRule:
    """The rule of one function of whole arrays.

    operands: the parameters without a default; options: those with one, whose arguments hold no derivative.
    adjoints: what the shadow of an operand gains, by operand and by the operands' ranks; shared: what they gain from.
    tangent: the tangent over `x_dot`, None if the function is linear in each operand.
    refine: gives, for the arguments of a call, a shorter text of an operand's adjoint that reads no more, or None.
    value: the function as an expression of others over its operands and options, "" if it is none.
    """
    name: str
    operands: tuple[str, ...]
    options: Mapping[str, AST]
    law: str
    adjoints: Mapping[str, Adjoint] = field(default_factory=dict)
    shared: Mapping[str, AST] = field(default_factory=dict)
    tangent: AST | None = None
    refine: Refine | None = None
    value: str = ""

    def arguments(self, node: Call) -> dict[str, AST]:
        """The operands and options of a call that `bound` has put in order, or of a call in a rule's own text, which
        gives options by place."""
        known = (*self.operands, *self.options)
        assert len(self.operands) <= len(node.args) <= len(known), "an argument that the rule does not know"
        return {**self.options, **dict(zip(known, node.args)), **{str(k.arg): k.value for k in node.keywords}}

    def adjoint(self, operand: str, ranks: Ranks) -> AST:
        """What the shadow of an operand gains, over the rule's names."""
        given = self.adjoints[operand]
        return given[ranks] if ranks in given else given[None]

    def gain(self, operand: str, ranks: Ranks, arguments: Mapping[str, AST]) -> AST:
        """What the shadow of an operand gains for these arguments."""
        refined = self.refine(operand, arguments) if self.refine else None
        return self.adjoint(operand, ranks) if refined is None else template(refined)

    def needs(self, operand: str, ranks: Ranks) -> list[str]:
        """The shared expressions that an operand's adjoint reads, in their order."""
        read = set(tree.names(self.adjoint(operand, ranks)))
        for s in reversed(list(self.shared)):
            read |= set(tree.names(self.shared[s])) if s in read else set()
        return [s for s in self.shared if s in read]

    def uses(self, operand: str, ranks: Ranks) -> frozenset[str]:
        """The operands, options and `y` whose content an operand's adjoint reads."""
        read = [self.adjoint(operand, ranks), *(self.shared[s] for s in self.needs(operand, ranks))]
        found = {n for node in read for n in tree.names(tree.rebuild(node, _shapeless))}
        return frozenset(found - {SEED, *self.shared})


def _shapeless(node: AST) -> AST | None:
    return tree.const(0) if isinstance(node, tree.Attribute) and node.attr in ("shape", "size", "dtype") else None


TABLE: dict[str, ArrayRule] = {}


def arrays(text: str, *, law: str, also: tuple[str, ...] = (), tangent: str | None = None,
           shared: Mapping[str, str] | None = None, refine: Refine | None = None, value: str = "",
           **adjoints: str | Mapping[Ranks | None, str]) -> ArrayRule:
    """Registers the rule of a function of whole arrays, also under other names; gives it back."""
    called = template(text)
    if not isinstance(called, Call) or call_name(called) is None:
        raise ValueError(f"{text!r} is no call such as 'numpy.roll(x, shift, axis=None)'")
    operands = tuple(a.id for a in called.args)
    options = {k.arg: k.value for k in called.keywords}
    trees = {p: {ranks: template(t) for ranks, t in ({None: a} if isinstance(a, str) else a).items()}
             for p, a in adjoints.items()}
    held = {s: template(t) for s, t in (shared or {}).items()}
    read = {n for given in trees.values() for t in given.values() for n in tree.names(t)}
    read |= set(tree.names(template(value))) if value else set()
    read |= {n for t in held.values() for n in tree.names(t)}
    unknown = sorted({*adjoints} - {*operands}) + sorted(read - {SEED, RESULT, *operands, *options, *held})
    if unknown:
        raise ValueError(f"{text!r}: {', '.join(unknown)} is no operand or option of it")
    rule = ArrayRule(call_name(called) or "", operands, options, law, trees, held,
                     None if tangent is None else template(tangent), refine, value)
    for key in (rule.name, *also):
        if key in TABLE:
            raise ValueError(f"{key} has a rule already")
        TABLE[key] = replace(rule, name=key)
    return rule


def find_array(name: str | None) -> ArrayRule | None:
    """The rule of a function of whole arrays, or None.

    >>> from s2sad import rules
    >>> find_array("numpy.matmul").operands, find_array("numpy.exp")
    (('a', 'b'), None)
    """
    return TABLE.get(name or "")


def bound(rule: ArrayRule, node: Call) -> Call | None:
    """The call with its operands in order and its options, those that are not the default, by name; None if its
    arguments do not fit."""
    parameters = [inspect.Parameter(p, inspect.Parameter.POSITIONAL_OR_KEYWORD) for p in rule.operands]
    parameters += [inspect.Parameter(p, inspect.Parameter.POSITIONAL_OR_KEYWORD, default=None) for p in rule.options]
    try:
        given = inspect.Signature(parameters).bind(*node.args, **{str(k.arg): k.value for k in node.keywords})
    except TypeError:
        return None
    options = [tree.keyword(p, given.arguments[p]) for p in rule.options if p in given.arguments
               and not tree.equal(given.arguments[p], rule.options[p])]
    return tree.at(Call(node.func, [given.arguments[p] for p in rule.operands], options), node)
