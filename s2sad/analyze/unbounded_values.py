"""unbounded_values: which values and tangents of a function can be infinite or nan, and which values a choice may
discard.

    l = np.log(x)                   l can be infinite
    y = x * l                       so can y, and the partial of x, which is l
    z = np.where(x > 0, y, 0.0)     y may be discarded, and x and l with it

Requires activity; establishes `context.unbounded`.

A value can be infinite or nan where a function that has poles, or is not defined everywhere, is computed of an active
operand, or of one that the kernel compares with something; so can everything that is computed of it. Where a kernel
tests for nan, its operands, and what these are computed of, can be nan. What is read under a branch, of a part of an
array, or in an operand of a choice may be discarded, with its operands. A tangent can be infinite behind a function
whose slope is infinite where the function is not, or that overflows; so can, without overflow, a seed in front of one.
`differentiate.zero_law` has the law.
"""
from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field

from s2sad import rules
from s2sad.analyze.activity import Activity, reach
from s2sad.analyze.context import AnalysisContext
from s2sad.liveness import base_name, targets
from s2sad.analyze.squares import Squares, squares
from s2sad.analyze.uses import is_active, operated, sources
from s2sad.infer.inference import Typing
from s2sad.rules.power import POWERS
from s2sad.rules.rule import Rule, number
from s2sad.tree import (
    AST, Add, Assign, Attribute, AugAssign, BinOp, Call, Compare, Constant, Div, Expr, FunctionDef, If, Load, Mult,
    Name, Pow, Subscript, call_name, dump, indices, names, stored_names, user_call, walk, walk_statements,
)

_NAN_TESTS = ("numpy.isnan", "numpy.isfinite", "numpy.isinf", "math.isnan", "math.isfinite", "math.isinf", "numpy.fmax",
           "numpy.fmin", "numpy.nan_to_num")
_EXTREMES = ("numpy.max", "numpy.min", "numpy.amax", "numpy.amin")
_POSITIVE = frozenset([f"{m}.{n}" for m in ("numpy", "math", "builtins") for n in (
    "abs", "absolute", "fabs", "exp", "square", "hypot", "sqrt", "cosh")])
_GREATER = ("numpy.maximum", "builtins.max", "numpy.fmax")
_ROOTS = ("sqrt", "cbrt")
_STEEP = (*_ROOTS, "arcsin", "asin", "arccos", "acos", "arccosh", "acosh", "arctan2", "atan2", "entr", "xlogy",
          "xlog1py", "rel_entr", "kl_div")
_QUOTIENTS = ("a / b", "a % b", "numpy.divide", "numpy.true_divide", "numpy.reciprocal", "numpy.mod", "numpy.remainder",
              "numpy.fmod", "math.fmod", "math.remainder", "runtime.remainder")


@dataclass(frozen=True)
class UnboundedValues:
    """Names: those whose `values` can be infinite or nan, those that a choice may discard (`discarded`), those whose
    `tangents` or `seeds` can be infinite, what comparisons read; `called` gives this of a kernel that is called;
    `definitions` are the values of names that are bound once, `squares` what has no slope where it is 0. Seeds are
    infinite by operations of the function itself, not by those of a caller or a kernel that is called, where it
    `has_steep_roots_alone`."""
    typing: Typing
    active: frozenset[str]
    squares: Squares
    values: frozenset[str] = frozenset()
    discarded: frozenset[str] = frozenset()
    tangents: frozenset[str] = frozenset()
    seeds: frozenset[str] = frozenset()
    compared: frozenset[str] = frozenset()
    called: Callable[[Call], UnboundedValues | None] = lambda called: None
    definitions: Mapping[str, AST] = field(default_factory=dict, repr=False)
    has_steep_roots_alone: bool = False

    def value(self, node: AST) -> bool:
        """Whether an expression's value can be infinite or nan."""
        return not self.values.isdisjoint(names(node)) or any(map(self.has_poles, walk(node)))

    def tangent(self, node: AST) -> bool:
        """Whether the tangent of an expression can be infinite."""
        return not self.tangents.isdisjoint(sources(node, self.typing)) or any(map(self.is_steep, walk(node)))

    def has_poles(self, node: AST) -> bool:
        return any((is_active(o, self.typing, self.active) or not self.compared.isdisjoint(names(o)))
                   and not (_is_root(rule, node) and self.is_positive(o)) for rule, o, _ in self._singular(node))

    def is_positive(self, node: AST) -> bool:
        """Whether an expression is no negative number, by its text and by that of the names in it."""
        if isinstance(node, Name):
            return node.id in self.definitions and self.is_positive(self.definitions[node.id])
        if isinstance(node, Constant):
            return type(node.value) in (int, float) and node.value >= 0
        if isinstance(node, BinOp) and isinstance(node.op, (Add, Mult, Div)):
            both = isinstance(node.op, Mult) and dump(node.left) == dump(node.right)
            return both or self.is_positive(node.left) and self.is_positive(node.right)
        if isinstance(node, BinOp) and isinstance(node.op, Pow):
            exponent = number(node.right)
            return exponent is not None and exponent % 2 == 0 or self.is_positive(node.left)
        if call_name(node) in _GREATER:
            return any(map(self.is_positive, node.args))
        return call_name(node) in _POSITIVE

    def is_steep(self, node: AST) -> bool:
        """Whether an operation's slope can be infinite where what is computed further is not: no quotient's, and no
        root's of a sum of squares."""
        return any(is_active(o, self.typing, self.active) and not _divides(rule, node)
                   for rule, o, operands in self._singular(node) if not self.flat_root(rule, operands))

    def is_steep_in(self, rule: Rule, parameter: str, operands: Mapping[str, AST]) -> bool:
        """Whether an operation's slope can be infinite where its value is finite."""
        if rule.name in POWERS and (parameter == "b" or self.typing.of(operands["b"]).is_integer):
            return False
        steep = rule.name.rpartition(".")[2] in _STEEP or rule.name in POWERS and (number(operands["b"]) or 1) > 0
        return steep and rule.is_singular(parameter, operands) and not self.flat_root(rule, operands)

    def flat_root(self, rule: Rule, operands: Mapping[str, AST]) -> bool:
        """Whether an operation is the root of what has no slope where it is 0."""
        root = rule.name.rpartition(".")[2] in _ROOTS
        exponent = number(operands["b"]) if {*operands} == {"a", "b"} and rule.name in POWERS else None
        root = root or exponent is not None and 0.5 <= exponent < 1
        return root and self.squares.flat(next(iter(operands.values())))

    def adjoint_boundary(self, statement: AST) -> frozenset[str]:
        """The boundary of a call's adjoint: "values" that can be infinite or nan, if a choice may discard the results,
        and "seeds" that can be infinite."""
        called, bound = statement.value, {base_name(t) for t in targets(statement)}
        bound |= {base_name(a) for a in called.args if self.typing.of(a).is_array}
        inner = self.called(called)
        poles = inner is not None and bool(inner.values)
        values = not self.discarded.isdisjoint(bound) and (poles or any(map(self.value, called.args)))
        return frozenset(["values"] * values + ["seeds"] * (not self.seeds.isdisjoint(bound)))

    def tangent_boundary(self, statement: AST) -> frozenset[str]:
        """The boundary of a call's tangent: "values" if a tangent of an argument can be infinite."""
        return frozenset(["values"] * any(map(self.tangent, statement.value.args)))

    def _singular(self, node: AST) -> Iterator[tuple[Rule, AST, dict[str, AST]]]:
        """The operands on which a partial depends that can be infinite, each with the rule and all operands."""
        found = operated(node, self.typing)
        if found is not None and found[0].singular:
            rule, operands = found
            yield from ((rule, o, operands) for p, o in operands.items() if p not in rule.linear and rule.is_singular(
                p, operands))


def _is_root(rule: Rule, node: AST) -> bool:
    """Whether an operation is a root, which is a finite number of every finite number that is not negative."""
    exponent = number(node.right) if rule.name == "a ** b" and isinstance(node, BinOp) else None
    return rule.name in ("numpy.sqrt", "math.sqrt") or exponent is not None and exponent > 0


def _divides(rule: Rule, node: AST) -> bool:
    power = getattr(node, "right", None) if rule.name == "a ** b" else None
    exponent = None if power is None else number(power)
    return rule.name in _QUOTIENTS or exponent is not None and exponent < 0


def unbounded_values(function: FunctionDef, context: AnalysisContext) -> None:
    """Leaves the table in `context.unbounded`."""
    context.unbounded = unbounded_values_of(function, context.typing, context.activity, context.calls.unbounded,
                                            context.request.unbounded)


def unbounded_values_of(function: FunctionDef, typing: Typing, activity: Activity,
                        called: Callable[[Call], UnboundedValues | None] = lambda called: None,
                        boundary: frozenset[str] = frozenset()) -> UnboundedValues:
    """The table for one function; `called` has that of a callee. With "values" in `boundary` the arguments can be
    infinite, and a choice of the caller's may discard the results; with "seeds" in it the seeds of results can be
    infinite."""
    forwards: dict[str, list[str]] = {}
    backwards: dict[str, list[str]] = {}
    for a, b in activity.edges:
        forwards.setdefault(a, []).append(b)
        backwards.setdefault(b, []).append(a)
    compared = frozenset(_compared(function, typing))
    assigned = [s for s in walk_statements(function.body) if isinstance(s, Assign) and isinstance(s.targets[0], Name)]
    times = Counter(s.targets[0].id for s in assigned)
    definitions = {s.targets[0].id: s.value for s in assigned if times[s.targets[0].id] == 1}
    flat = squares(function, typing, activity.active)
    first = UnboundedValues(typing, activity.active, flat, compared=compared, definitions=definitions)
    parameters = {p.id for p in function.args.args} if "values" in boundary else set[str]()
    poles, steep = set(parameters), set(parameters)
    for s in walk_statements(function.body):
        if not isinstance(s, (Assign, AugAssign, Expr)):
            continue
        bound = {base_name(t) for t in targets(s)}
        if user_call(s.value):
            inner = called(s.value)
            bound |= {base_name(a) for a in s.value.args if typing.of(a).is_array}
            poles |= bound if inner is not None and inner.values else set()
            steep |= bound if inner is not None and inner.tangents else set()
        elif not isinstance(s, Expr):
            poles |= bound if any(map(first.has_poles, walk(s.value))) else set()
            steep |= bound if any(map(first.is_steep, walk(s.value))) else set()
    tested = reach(backwards, set(_nan_tested(function, typing)))
    discarded = reach(backwards, set(_discarded(function, typing))) if poles | tested else set[str]()
    seeds = reach(backwards, set(_seeds(function, first, called)))
    callees = [called(n) for n in walk(function.body) if user_call(n)]
    alone = "seeds" not in boundary and not any(c is not None and c.seeds for c in callees)
    return UnboundedValues(typing, activity.active, flat, frozenset(reach(forwards, poles | tested)),
                           activity.active if "values" in boundary else frozenset(discarded),
                           frozenset(reach(forwards, steep)),
                           activity.active if "seeds" in boundary else frozenset(seeds), compared, called, definitions,
                           alone)


def _seeds(function: FunctionDef, known: UnboundedValues, called: Callable[[Call],
                                                                           UnboundedValues | None]) -> Iterator[str]:
    """The names whose seeds are computed with slopes that can be infinite where values are finite."""
    for node in walk(function.body):
        read: list[AST] = []
        if user_call(node):
            inner = called(node)
            read = node.args if inner is not None and inner.seeds else []
        elif found := operated(node, known.typing):
            rule, operands = found
            read = [o for p, o in operands.items() if known.is_steep_in(rule, p, operands)]
        yield from (n for o in read for n in sources(o, known.typing) if n in known.active)


def _compared(function: FunctionDef, typing: Typing) -> set[str]:
    """The names that comparisons read, and those of their elements."""
    found = {n for c in walk(function.body) if isinstance(c, Compare) for part in (c.left, *c.comparators)
             for n in sources(part, typing)}
    for s in walk_statements(function.body):
        if isinstance(s, Assign) and isinstance(s.value, (Name, Subscript)) and base_name(s.value) in found:
            found |= {base_name(t) for t in targets(s)}
    return found


def _is_whole(node: Subscript) -> bool:
    return isinstance(node.slice, Constant) and node.slice.value is Ellipsis


def _read_in_part(function: FunctionDef, typing: Typing) -> Iterator[str]:
    """The arrays of which a function reads one slice, and no more."""
    parts: dict[str, set[str]] = {}
    inside: set[int] = set()
    for node in walk(function.body):
        if isinstance(node, Subscript) and isinstance(node.value, Name):
            inside.add(id(node.value))
            if isinstance(node.ctx, Load) and typing.of(node).is_array:
                parts.setdefault(node.value.id, set()).add("" if _is_whole(node) else dump(node.slice))
        elif isinstance(node, Attribute) and isinstance(node.value, Name):
            inside.add(id(node.value))
        elif isinstance(node, Name) and id(node) not in inside and isinstance(node.ctx, Load):
            parts.setdefault(node.id, set()).add("")
    yield from (n for n, found in parts.items() if len(found) == 1 and "" not in found)


def _nan_tested(function: FunctionDef, typing: Typing) -> Iterator[str]:
    """The names that a function tests for being finite."""
    for node in walk(function.body):
        if call_name(node) in _NAN_TESTS:
            yield from (n for a in node.args for n in sources(a, typing))
        elif isinstance(node, Compare) and len(node.ops) == 1 and dump(node.left) == dump(node.comparators[0]):
            yield from sources(node.left, typing)


def _discarded(function: FunctionDef, typing: Typing) -> Iterator[str]:
    """The names that choices, branches and parts of arrays read, and arrays that are overwritten in part."""
    bound = set(stored_names(function.body))
    stores = [t for s in walk_statements(function.body) if isinstance(s, Assign) for t in targets(s)
              if isinstance(t, Subscript)]
    parts = {base_name(t) for t in stores if not _is_whole(t) and (
        typing.of(t).is_array or not bound & set(names(t.slice)))}
    filled = {base_name(t) for t in stores if _is_whole(t) or bound & set(names(t.slice))}
    times = Counter(map(base_name, stores))
    yield from (n for n in times if times[n] > 1 and n in parts & filled)
    yield from _read_in_part(function, typing)
    for node in walk(function.body):
        if isinstance(node, If):
            for s in walk_statements([*node.body, *node.orelse]):
                if isinstance(s, (Assign, AugAssign)):
                    yield from sources(s.value, typing)
                    yield from map(base_name, targets(s))
        elif isinstance(node, Subscript):
            one = base_name(node) in filled and not bound & set(names(node.slice)) and not typing.of(node).is_array
            if typing.of(node).is_inexact and (one or any(typing.of(i).is_array for i in indices(node))):
                yield base_name(node)
        elif call_name(node) in _EXTREMES:
            yield from sources(node.args[0], typing)
        elif isinstance(node, Call) and rules.find_array(call_name(node)) is None and (found := operated(node, typing)):
            rule, operands = found
            for parameter, operand in operands.items():
                if call_name(rule.partials[parameter]) == "numpy.where":
                    yield from sources(operand, typing)
