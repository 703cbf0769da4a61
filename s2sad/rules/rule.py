"""What a derivative rule is, and how rules are registered and found.

A rule reads like calculus: the function with its parameters, and for each parameter the partial derivative as
an expression over the parameters and `y`, the result:

    elementwise("numpy.exp(x)", x="y")
    elementwise("a / b", a="1.0 / b", b="-y / b")

What must be recorded falls out of it (`Rule.uses`), and the same partials serve both modes. Broadcasting is
undone elsewhere, never in a rule. A choice is written `numpy.where(c, a, b)`; scalar code turns it into
`a if c else b`. Registration checks the names; the values are checked against differences by the tests.
"""
from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

from s2sad import tree
from s2sad.tree import AST, Attribute, BinOp, Call, Name, UnaryOp

RESULT = "y"
_MODULES = ("numpy", "math", "builtins", "scipy", "runtime")
_OPERATORS = {"Add": "+", "Sub": "-", "Mult": "*", "Div": "/", "FloorDiv": "//", "Mod": "%", "Pow": "**",
              "USub": "-", "UAdd": "+"}
_KINDS = ("float", "int", "bool", "same")

_PLANES = ("holomorphic", "gradient", "conjugate")

Refine = Callable[[str, Mapping[str, AST]], "str | None"]
Plane = str | tuple[str, Mapping[str, str]]


@dataclass(frozen=True)
class Rule:
    """The partial derivatives of one function, elementwise.

    linear: parameters whose partial reads neither the parameter itself nor the result.
    singular: parameters whose partial can be infinite or nan; a zero seed must be selected there.
    zero: parameters whose partial is zero everywhere.
    domain: where the values are tested, (low, high) by parameter; (-2, 2) where nothing is said.
    result: "float" if the result is a float whatever the arguments are, "same" if it is of their common type.
    kink: where the function is not differentiable and which one-sided choice is made, for the report.
    refine: gives, for actual arguments, a partial that is shorter than the general one, or None.
    plane: the rule for complex operands, None if none is known to hold for them.
    kind: of such a rule, "holomorphic", dy = p * dx; "conjugate", dy = conj(dx); "gradient", y is real and
    dy = Re(conj(p) * dx).
    """
    name: str
    parameters: tuple[str, ...]
    partials: Mapping[str, AST]
    linear: frozenset[str]
    singular: frozenset[str] = frozenset()
    zero: frozenset[str] = frozenset()
    domain: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    result: str = "float"
    kink: str = ""
    refine: Refine | None = None
    plane: Rule | None = None
    kind: str = ""

    def partial(self, parameter: str, arguments: Mapping[str, AST], result: AST) -> AST:
        """The partial with respect to `parameter`, with the operands and the result filled in."""
        return tree.substitute(self._template(parameter, arguments), {**arguments, RESULT: result})

    def uses(self, parameter: str, arguments: Mapping[str, AST] | None = None) -> frozenset[str]:
        """Which of the parameters and "y" the partial reads; with the arguments at hand it may be fewer."""
        return frozenset(tree.names(self._template(parameter, arguments or {})))

    def is_singular(self, parameter: str, arguments: Mapping[str, AST]) -> bool:
        """Whether the partial can be infinite or nan for these arguments: `a / 9.0` cannot."""
        if parameter not in self.singular:
            return False
        partial = self._template(parameter, arguments)
        denominators = [d for d in map(_denominator, tree.walk(partial)) if d is not None]
        # the result itself may be infinite: exp(x) is its own partial
        bounded = _plain(partial) and RESULT not in tree.names(partial)
        return not (bounded and all(_nonzero(tree.substitute(d, arguments)) for d in denominators))

    def chooses(self, parameter: str) -> bool:
        """Whether the partial is one where the operand is taken, and zero where it is left."""
        partial = self.partials[parameter]
        return tree.call_name(partial) == "numpy.where" and all(number(side) is not None for side in partial.args[1:])

    def _template(self, parameter: str, arguments: Mapping[str, AST]) -> AST:
        if parameter not in self.partials:
            raise ValueError(f"{self.name} has no parameter '{parameter}', it has {', '.join(self.parameters)}")
        refined = self.refine(parameter, arguments) if self.refine else None
        return self.partials[parameter] if refined is None else template(refined)


def _denominator(node: AST) -> AST | None:
    """What must not be zero for this node to be finite."""
    if isinstance(node, BinOp) and isinstance(node.op, tree.Div):
        return node.right
    if isinstance(node, BinOp) and isinstance(node.op, tree.Pow):
        exponent = number(node.right)
        return None if exponent is not None and exponent >= 0 else node.left
    return None


def divides(node: AST) -> bool:
    """Whether an expression divides by more than a number.

    >>> divides(template("x / y")), divides(template("x ** -2")), divides(template("x / 2.0"))
    (True, True, False)
    """
    found = map(_denominator, tree.walk(node))
    return any(d is not None and not _nonzero(d) for d in found)


def _plain(node: AST) -> bool:
    return not any(isinstance(n, Call) for n in tree.walk(node))


def _nonzero(node: AST) -> bool:
    value = number(node)
    return value is not None and value != 0


def number(node: AST) -> int | float | None:
    """The number that an expression spells (`2`, `-1.5`), or None."""
    if isinstance(node, UnaryOp) and isinstance(node.op, tree.USub):
        value = number(node.operand)
        return None if value is None else -value
    if isinstance(node, tree.Constant) and type(node.value) in (int, float):
        return node.value
    return None


def template(text: str) -> AST:
    """The tree of an expression of a rule, `numpy.exp` as one name, `a @ b` and `x.T` as calls.

    >>> tree.dump(template("numpy.cos(x)"))
    "Call(Name('numpy.cos'), [Name('x')], [])"
    """
    made = resolved(tree.expression(text))
    for node in tree.walk(made):  # it has no place in a kernel's source
        for place in ("lineno", "col_offset", "end_lineno", "end_col_offset"):
            node.__dict__.pop(place, None)
    return made


def resolved(node: AST) -> AST:
    """A tree of plain Python with its dotted names as one name each."""
    def path(node: AST) -> str | None:
        if isinstance(node, Name):
            return node.id if node.id in _MODULES else None
        inner = path(node.value) if isinstance(node, Attribute) else None
        return f"{inner}.{node.attr}" if inner else None

    def dotted(node: AST) -> AST | None:
        if isinstance(node, BinOp) and isinstance(node.op, tree.MatMult):
            return tree.call("numpy.matmul", *(tree.rebuild(n, dotted) for n in (node.left, node.right)))
        if isinstance(node, Attribute) and node.attr == "T":
            return tree.call("numpy.transpose", tree.rebuild(node.value, dotted))
        found = path(node) if isinstance(node, Attribute) else None
        return tree.name(found) if found else None
    return tree.rebuild(node, dotted)


def signature(text: str) -> tuple[str, tuple[str, ...]]:
    """The name and the parameters of "numpy.exp(x)" or of an operator, "a / b"; ValueError if it is neither."""
    node = template(text)
    if isinstance(node, Call) and isinstance(node.func, Name) and "." in node.func.id and not node.keywords:
        operands, name = node.args, node.func.id
    elif isinstance(node, BinOp) and type(node.op).__name__ in _OPERATORS:
        operands, name = [node.left, node.right], text
    elif isinstance(node, UnaryOp) and type(node.op).__name__ in _OPERATORS:
        operands, name = [node.operand], text
    else:
        raise ValueError(f"{text!r} is neither a call such as 'numpy.exp(x)' nor an operator such as 'a / b'")
    parameters = tuple(o.id for o in operands if isinstance(o, Name) and "." not in o.id)
    if len(set(parameters)) != len(operands) or RESULT in parameters:
        raise ValueError(f"{text!r}: parameters must be different names, and not '{RESULT}', which is the result")
    return name, parameters


class RuleTable:
    """The rules by name: elementwise ones, and what the functions without a derivative return."""

    def __init__(self) -> None:
        self.rules: dict[str, Rule] = {}
        self.constants: dict[str, str] = {}

    def elementwise(self, text: str, *, also: tuple[str, ...] = (), singular: tuple[str, ...] = (),
                    domain: Mapping[str, tuple[float, float]] | None = None, result: str = "float", kink: str = "",
                    refine: Refine | None = None, plane: Plane = "", **partials: str) -> Rule:
        """Registers the partials of a function under its name and the names in `also`; gives the rule back.

        `plane` says that it holds for complex operands, too: "holomorphic" where the partials are the same, else the
        kind with partials of its own, ("gradient", {"x": ...}).
        """
        name, parameters = signature(text)
        _check(text, parameters, partials, singular, domain or {}, result)
        trees = {p: template(partials[p]) for p in parameters}
        reads = {p: set(tree.names(trees[p])) for p in parameters}
        rule = Rule(
            name, parameters, trees, singular=frozenset(singular), domain=dict(domain or {}), result=result, kink=kink,
            linear=frozenset(p for p in parameters if not reads[p] & {p, RESULT}), refine=refine,
            zero=frozenset(p for p in parameters if number(trees[p]) == 0))
        rule = replace(rule, plane=_plane(rule, plane))
        for key in (name, *also):
            self._claim(key)
            self.rules[key] = replace(rule, name=key)
        return self.rules[name]

    def constant(self, result: str, *names: str) -> None:
        """Registers functions whose derivative is zero wherever it exists, with the kind of their result."""
        if result not in _KINDS:
            raise ValueError(f"result={result!r} is none of {', '.join(_KINDS)}")
        for key in names:
            self._claim(key)
            self.constants[key] = result

    def set_user_rule(self, name: str, found: Rule | str | None) -> None:
        """Sets a user's rule, or the kind of result of a user's function without a derivative; None takes either away.
        The last one holds."""
        self.rules.pop(name, None)
        self.constants.pop(name, None)
        if isinstance(found, Rule):
            self.rules[name] = found
        elif found is not None:
            self.constants[name] = found

    def _claim(self, name: str) -> None:
        if name in self.rules or name in self.constants:
            raise ValueError(f"{name} has a rule already")


def _plane(rule: Rule, given: Plane) -> Rule | None:
    """The rule for complex operands."""
    if not given:
        return None
    kind, partials = (given, {}) if isinstance(given, str) else given
    if kind not in _PLANES or kind == "gradient" and {*partials} != {*rule.parameters}:
        raise ValueError(f"{rule.name!r}: plane={given!r} is none of {', '.join(_PLANES)}, with partials")
    _check(rule.name, rule.parameters, {**dict.fromkeys(rule.parameters, "0.0"), **partials}, (), {}, "same")
    trees = {**rule.partials, **{p: template(t) for p, t in partials.items()}}
    reads = {p: set(tree.names(trees[p])) for p in rule.parameters}
    return replace(rule, kind=kind, partials=trees, refine=None if partials else rule.refine,
                   linear=frozenset(p for p in rule.parameters if not reads[p] & {p, RESULT}),
                   zero=frozenset(p for p in rule.parameters if number(trees[p]) == 0))


def _check(text: str, parameters: tuple[str, ...], partials: Mapping[str, str], singular: tuple[str, ...],
           domain: Mapping[str, tuple[float, float]], result: str) -> None:
    missing = [p for p in parameters if p not in partials]
    if missing:
        raise ValueError(f"{text!r}: no partial is given for {', '.join(missing)}; write {missing[0]}=\"0.0\" "
                         "if the derivative is zero")
    for what, given in (("a partial", partials), ("singular", singular), ("a domain", domain)):
        unknown = [p for p in given if p not in parameters]
        if unknown:
            raise ValueError(f"{text!r}: {what} is given for {', '.join(unknown)}, which is no parameter of it")
    if result not in ("float", "same"):
        raise ValueError(f"{text!r}: result={result!r} is neither 'float' nor 'same'")
    for parameter, partial in partials.items():
        free = [n for n in tree.names(template(partial)) if n not in (*parameters, RESULT)]
        if free:
            raise ValueError(f"{text!r}: the partial {parameter}={partial!r} reads {', '.join(free)}; "
                             f"it may read {', '.join(parameters)} and {RESULT}")


TABLE = RuleTable()
elementwise = TABLE.elementwise
constant = TABLE.constant
