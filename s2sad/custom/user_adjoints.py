"""The user's own adjoints, tangents, pairs and residuals: what is checked where they are registered.

A derivative takes the parameters of its function, each followed by its shadow where it has one, and then the seeds:
`f(u, t, n)` has the adjoint `f_adjoint(u, u_bar, t, n, result_bar)` and the tangent `f_tangent(u, u_dot, t, t_dot, n)`.
"""
from __future__ import annotations

import inspect
import re
from collections.abc import Callable
from typing import Any

from s2sad.diagnostics import Diagnostic, S2sadError
from s2sad.read.capture import capture
from s2sad.live_objects.unwrap import python_function
from s2sad.live_objects.registry import RegisteredRule, RegisteredDerivative, RuleText
from s2sad.tree import (
    AST, Assign, Attribute, AugAssign, Constant, FunctionDef, Name, Return, Slice, Subscript, Tuple, indices, walk,
    walk_statements,
)

Role = tuple[str, str]

SOLVERS = ("dense", "cg", "gmres")
ENDINGS = {"adjoint": "bar", "reverse": "bar", "tangent": "dot"}
_TOGETHER = (("adjoint",), ("forward", "reverse"), ("implicit",))


class UserDerivative:
    """One function with what the user gave it, as it is checked; `name` finds a function's path."""

    def __init__(self, path: str, function: Any, named: Callable[[Any], tuple[str, Any]]):
        self.path, self.function, self.named = path, function, named
        self.parameters = self.plain_parameters(function, path)

    def derivative(self, given: dict[str, Any], writes: Any = None, returns: int | None = None) -> RegisteredDerivative:
        """The derivative; `given` has the functions by keyword: adjoint, tangent, forward, reverse, implicit, solver.
        With `writes` or `returns` the function is not read."""
        given = {what: value for what, value in given.items() if value is not None}
        self.check_combination(given)
        solver, residual = given.pop("solver", "dense" if "implicit" in given else ""), given.pop("implicit", None)
        if isinstance(solver, str) and solver and solver not in SOLVERS:
            raise self.wrong(f"solver={solver!r} is none of {', '.join(SOLVERS)}", "or give a function that solves")
        functions = {what: self.function_of(what, value) for what, value in given.items()}
        if solver and not isinstance(solver, str):
            functions["solver"] = self.function_of("solver", solver)
        roles = {what: self.roles(what, g) for what, g in functions.items() if what != "solver"}
        if residual is not None:
            residual = self.residual_of(residual)
        texts = {what: rule_text(g.plain) for what, g in functions.items()}
        if writes is not None or returns is not None:
            functions["primal"] = self.function_of("primal", self.function)
            stored = sorted(rule_text(functions["primal"].plain).stores - set(self.written_arguments(writes)))
            if stored:
                raise self.wrong(f"it writes its argument '{stored[0]}', which writes= does not name",
                                 f"name it, or write `{stored[0]} = {stored[0]} + 1.0` in place of `+=`")
            roles["primal"] = tuple(("primal", p) for p in self.parameters)
        return RegisteredDerivative(self.path.rpartition(".")[2], functions, roles, texts, residual,
                                    solver if isinstance(solver, str) else "", self.written_arguments(writes),
                                    self.returned_count(returns))

    def written_arguments(self, writes: Any) -> tuple[str, ...]:
        named = () if writes is None else (writes,) if isinstance(writes, str) else tuple(writes)
        unknown = [p for p in named if p not in self.parameters]
        if unknown:
            raise self.wrong(f"writes= names {', '.join(map(str, unknown))}, which is no parameter of it",
                             f"its parameters are {', '.join(self.parameters)}")
        return named

    def returned_count(self, returns: int | None) -> int:
        if returns is not None and (type(returns) is not int or returns < 0):
            raise self.wrong(f"returns={returns!r} is no number of floats", "write 0, 1, 2, ...")
        return returns or 0

    def check_combination(self, given: dict[str, Any]) -> None:
        """Which of them go together."""
        there = [group for group in _TOGETHER if any(what in given for what in group)]
        if len(there) > 1:
            raise self.wrong(f"{there[0][0]}= and {there[1][0]}= are two adjoints", "give one of them")
        for what, other in (("forward", "reverse"), ("reverse", "forward")):
            if what in given and other not in given:
                raise self.wrong(f"{what}= is given without {other}=", "an adjoint in two halves has both; one that "
                                 "keeps nothing is adjoint=")
        if "solver" in given and "implicit" not in given:
            raise self.wrong("solver= is given without implicit=", "a solver is for the linear system of a residual")
        if "implicit" in given and "tangent" in given:
            raise self.wrong("implicit= and tangent= are two tangents", "the residual gives both derivatives")

    def function_of(self, what: str, value: Any) -> RegisteredRule:
        if isinstance(value, str) and "." not in value:
            raise self.wrong(f"{what}={value!r} is no function", "give a function, or its dotted name")
        path, function = self.named(value)
        return RegisteredRule(path, function, python_function(function) or function, False)

    def residual_of(self, value: Any) -> Any:
        """The residual, whose parameters are the solution and parameters of the function."""
        path, function = self.named(value)
        taken = self.plain_parameters(function, path)
        others = [p for p in taken[1:] if p not in self.parameters]
        if not taken or len(taken) > 1 and others:
            raise self.wrong(f"the residual '{path}' takes {', '.join(taken) or 'nothing'}", "its first parameter is "
                             "the solution, or the array that it fills; the others are of "
                             f"{', '.join(self.parameters)}")
        return python_function(function) or function

    def plain_parameters(self, function: Any, path: str) -> tuple[str, ...]:
        try:
            given = inspect.signature(python_function(function) or function).parameters.values()
        except (TypeError, ValueError):
            raise self.wrong(f"the parameters of '{path}' are not known", "wrap it in a Python function") from None
        wrong = [p.name for p in given if p.kind not in (p.POSITIONAL_OR_KEYWORD, p.POSITIONAL_ONLY)]
        if wrong:
            raise self.wrong(f"the parameter '{wrong[0]}' of '{path}' is not positional",
                             "take plain positional parameters")
        return tuple(p.name for p in given)

    # -- signatures --------------------------------------------------------------------------------------------------

    def roles(self, what: str, given: RegisteredRule) -> tuple[Role, ...]:
        """What each parameter of a derivative is; raises where the names do not say it."""
        left = list(self.plain_parameters(given.function, given.path))
        found: list[Role] = []
        if what == "reverse":
            if not left or left[0] in self.parameters:
                raise self.misfit(what, given, "begins without a parameter for what the first half kept")
            found.append(("kept", ""))
            left.pop(0)
        for parameter in self.parameters:
            if not left or left[0] != parameter:
                there = f"has '{left[0]}'" if left else "ends"
                raise self.misfit(what, given, f"{there} where '{parameter}' is expected")
            found.append(("primal", left.pop(0)))
            if left and what in ENDINGS and left[0] == self.shadow(parameter, ENDINGS[what]):
                found.append(("shadow", parameter))
                left.pop(0)
        seeds = [n for n in left if ENDINGS.get(what) == "bar" and re.fullmatch(r"result(_\d+)?_bar", n)]
        if left != seeds:
            raise self.misfit(what, given, f"has '{next(n for n in left if n not in seeds)}' where nothing more is "
                              "expected")
        return (*found, *(("seed", n) for n in seeds))

    def shadow(self, parameter: str, ending: str) -> str:
        wished = f"{parameter}_{ending}"
        while wished in self.parameters:
            wished += "_"
        return wished

    def misfit(self, what: str, given: RegisteredRule, problem: str) -> S2sadError:
        ending = ENDINGS.get(what)
        shadows = f", each float{' array' if ending == 'bar' else ''} followed by its shadow '..._{ending}'"
        return self.wrong(f"the {what} '{given.path}' {problem}",
                          f"it takes {'what was kept, then ' if what == 'reverse' else ''}{', '.join(self.parameters)}"
                          f"{shadows if ending else ''}{', and then the seeds, result_bar' if ending == 'bar' else ''}")

    def wrong(self, message: str, help: str = "") -> S2sadError:
        return S2sadError(Diagnostic("S302", f"rule for '{self.path}': {message}", help=help))


def rule_text(function: Any) -> RuleText:
    """What a function mentions, stores to and returns, by its text."""
    try:
        definition = capture(function).tree
    except S2sadError:
        return RuleText()
    returns = [n.value for n in walk_statements(definition.body) if isinstance(n, Return)]
    kept = [e for v in returns if v is not None for e in _parts(v)]
    return RuleText(frozenset(n.id for n in walk(definition.body) if isinstance(n, Name)),
                    frozenset(written_parameters(definition)),
                    tuple(map(_count, returns)), frozenset(b for b in map(_stored_array, kept) if b))


def _parts(value: AST) -> list[AST]:
    """What a value is made of, in tuples in tuples."""
    return [e for item in value.elts for e in _parts(item)] if isinstance(value, Tuple) else [value]


def _count(value: AST | None) -> int:
    if value is None or isinstance(value, Constant) and value.value is None:
        return 0
    return len(value.elts) if isinstance(value, Tuple) else -1


def _stored_array(value: AST) -> str | None:
    """The name of the array that a value is, all of it or a slice."""
    if isinstance(value, Subscript) and not any(isinstance(s, Slice) for s in indices(value)):
        return None
    return _base(value)


def written_parameters(definition: FunctionDef) -> list[str]:
    """The parameters whose content a function's text writes in place."""
    given = definition.args
    parameters = {a.id for a in (*given.posonlyargs, *given.args, *given.kwonlyargs)}
    rebound = {t.id for n in walk_statements(definition.body) if isinstance(n, Assign) for t in n.targets
               if isinstance(t, Name)}
    found: dict[str, None] = {}
    for node in walk(definition.body):
        stored = getattr(node, "targets", None) or [getattr(node, "target", None)]
        places = [t for t in stored if isinstance(t, Subscript) or isinstance(node, AugAssign)]
        found.update({b: None for b in map(_base, places) if b is not None and b in parameters - rebound})
    return list(found)


def _base(place: AST) -> str | None:
    """The name whose content a place is."""
    while isinstance(place, (Subscript, Attribute)):
        place = place.value
    return place.id if isinstance(place, Name) else None
