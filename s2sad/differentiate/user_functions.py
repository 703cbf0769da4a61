"""user_functions: the user's own derivatives of a function, as functions of the generated file with s2sad's
signatures.

Requires the request of a call and the types of the function; establishes a function that calls the user's.
That takes a shadow for every float array, and returns the adjoints of all float numbers: shadows that the call has no
use for are zeros, adjoints that it has no use for are dropped.

    def f_adjoint(u, u_bar, p, t, result_bar):
        p_bar = np.zeros_like(p)
        t_bar = given_adjoint(u, u_bar, p, p_bar, t, result_bar)
        return (t_bar,)
"""
from __future__ import annotations

from collections.abc import Mapping, Set
from dataclasses import dataclass

from s2sad.analyze.request import DerivativeRequest
from s2sad.differentiate.derivative import Derivative
from s2sad.infer.types import Type
from s2sad.naming import Names
from s2sad.live_objects.registry import RegisteredDerivative
from s2sad.tree import AST, Expr, FunctionDef, Return, assign, call, const, function, name, tuple_of


SUFFIXES = {"adjoint": "bar", "reverse": "bar", "tangent": "dot"}


@dataclass(frozen=True)
class UserFunction:
    """A function with a derivative of its own: its name in the file, its parameters with their types, the types of its
    results, and the parameters that it writes."""
    title: str
    own: RegisteredDerivative
    types: dict[str, Type]
    results: tuple[Type, ...]
    written: frozenset[str]

    @property
    def numbers(self) -> list[str]:
        """The parameters that are floats."""
        return [p for p, t in self.types.items() if t.is_number and t.is_float]

    @property
    def floats(self) -> list[int]:
        """The results that are floats."""
        return [k for k, t in enumerate(self.results) if t.is_number and t.is_float]

    def seed(self, result: int) -> str:
        """The name of the seed of a result in an adjoint."""
        return "result_bar" if len(self.floats) == 1 else f"result_{result}_bar"

    def refusal(self, what: str, request: DerivativeRequest) -> str:
        """Why a derivative of the user's own cannot serve a call, in words; empty if it can."""
        what = self.half(what)
        if any(t.is_array for t in self.results):
            return "returns an array, which no function with a derivative of its own may: write it"
        if what not in self.own.functions:
            return f"has no {what} of its own, only its {'tangent' if what == 'adjoint' else self.half('adjoint')}"
        return self.missing_parameters(what, request) or self.unavailable_parameters(what) or self.wrong_returns(what)

    def half(self, what: str) -> str:
        """Which of the user's functions a call of a derivative calls: of an adjoint in two halves the second."""
        return "reverse" if what == "adjoint" and "reverse" in self.own.functions else what

    def missing_parameters(self, what: str, request: DerivativeRequest) -> str:
        """Which parameter that the request needs the function does not take."""
        path, roles, ending = self.own.functions[what].path, self.own.roles[what], SUFFIXES[what]
        for primal in (*request.wrt, *request.of):
            if primal.startswith("return "):
                seed = self.seed(int(primal.removeprefix("return ")))
                if ending == "bar" and ("seed", seed) not in roles:
                    return f"has an adjoint, '{path}', that takes no '{seed}', though what it returns is differentiated"
            elif (self.types[primal].is_array or ending == "dot") and ("shadow", primal) not in roles:
                return f"has a derivative, '{path}', that takes no shadow of '{primal}', which is differentiated"
        return ""

    def unavailable_parameters(self, what: str) -> str:
        """Which parameter the function takes that does not exist for these types."""
        path, ending = self.own.functions[what].path, SUFFIXES[what]
        for role, primal in self.own.roles[what]:
            if role == "seed" and primal not in map(self.seed, self.floats):
                there = " and ".join(map(self.seed, self.floats)) or "no seed"
                return f"has an adjoint, '{path}', that takes '{primal}'; for what it returns there is {there}"
            kind = self.types[primal] if role == "shadow" else None
            if kind is not None and not (kind.is_float and (kind.is_array or ending == "dot" and kind.is_number)):
                return f"has a derivative, '{path}', that takes a shadow of '{primal}', which is {kind} here"
        for primal in sorted(self.own.texts[what].stores & set(self.types) - self.written):
            if self.types[primal].is_array:
                return f"has a derivative, '{path}', that overwrites '{primal}', which it does not write itself"
        return ""

    def wrong_returns(self, what: str) -> str:
        """Which result the function should return, and does not."""
        path, count = self.own.functions[what].path, len(self.numbers)
        wish = f"the adjoint{'s' * (count > 1)} of {' and '.join(self.numbers)}" if count else "nothing"
        if what == "tangent":
            count = len(self.results) + len(self.floats)
            wish = f"{count} numbers, results and then tangents" if count > 1 else "its result" if count else "nothing"
        if not self.own.texts[what].returns(count):
            return f"has a derivative, '{path}', that must return {wish}, for these arguments, and does not"
        if what == "reverse":
            first, text = self.own.functions["forward"].path, self.own.texts["forward"]
            if self.results and not text.returns(2):
                return f"has a first half, '{first}', that must return two things, the result and what is kept"
            kept = sorted(n for n in text.named & set(self.types) if self.types[n].is_array)
            if kept:
                return f"has a first half, '{first}', that keeps '{kept[0]}' itself, which may change: keep a copy"
        return ""

    def reads(self, what: str) -> frozenset[str]:
        """The arrays whose content the user's function may read."""
        text = self.own.texts[self.half(what)]
        return frozenset(p for p, t in self.types.items() if t.is_array and (
            text.mentions is None or p in text.mentions))


Edge = tuple[int, int | str]


def user_edges(types: Mapping[str, Type], results: tuple[Type, ...], written: Set[str], edges: list[Edge],
              residual: tuple[str, ...] | None) -> list[Edge]:
    """The edges of dependence in a function with a derivative of its own: all results and all that it writes on
    all of its floats, whatever its text says. Where it is implicit (`residual` has the parameters of that) the solution
    depends on what the residual reads, all else as in the text."""
    order = list(types)
    ends: list[int | str] = [k for k, (p, t) in enumerate(types.items()) if p in written and t.is_float]
    ends += [f"return {k}" for k, t in enumerate(results) if t.is_float]
    if residual is None:
        return [(a, b) for a, t in enumerate(types.values()) if t.is_float for b in ends]
    second = residual[1] if len(residual) > 1 else ""
    array = second in written
    solved = [order.index(second)] if array else [e for e in ends if isinstance(e, str)]
    starts = [order.index(p) for p in residual[2 if array else 1:] if types[p].is_float]
    return [(a, b) for a, b in edges if b not in solved] + [(a, b) for a in starts for b in solved]


class UserFunctionWrapper:
    """The function that stands between a call and the user's function."""

    def __init__(self, owner: UserFunction, request: DerivativeRequest, title: str, ending: str):
        self.owner, self.request, self.title, self.ending = owner, request, title, ending
        self.free = Names(owner.types)
        self.shadows = {p: self.free.fresh(f"{p}_{ending}") for p, t in owner.types.items() if t.is_float}
        self.signature: list[tuple[str, str, str]] = []
        for primal, kind in owner.types.items():
            self.signature.append((primal, "primal", primal))
            requested = primal in request.wrt or kind.is_array and primal in request.of
            if requested and primal in self.shadows and (kind.is_array or ending == "dot"):
                self.signature.append((self.shadows[primal], "shadow", primal))
        self.seeds = {k: self.free.fresh(owner.seed(k)) for k in owner.floats} if ending == "bar" else {}

    def add_seeds(self) -> None:
        """The seeds of the results that the call has a use for become parameters."""
        self.signature += [(s, "seed", f"return {k}") for k, s in self.seeds.items()
                           if f"return {k}" in self.request.of]

    def arguments(self, what: str, kept: str = "") -> tuple[list[AST], list[AST]]:
        """Statements that make what the call does not pass, and the arguments of the user's function."""
        before: list[AST] = []
        passed = {n for n, _, _ in self.signature}
        arguments: list[AST] = []
        seeds = {self.owner.seed(k): s for k, s in self.seeds.items()}
        for role, primal in self.owner.own.roles[what]:
            if role == "primal":
                arguments.append(name(primal))
            elif role == "kept":
                arguments.append(name(kept))
            elif role == "seed":
                arguments.append(name(seeds[primal]) if seeds[primal] in passed else const(0.0))
            elif self.shadows[primal] in passed:
                arguments.append(name(self.shadows[primal]))
            elif self.owner.types[primal].is_array:
                before.append(assign(self.shadows[primal], call("numpy.zeros_like", name(primal))))
                arguments.append(name(self.shadows[primal]))
            else:
                arguments.append(const(0.0))
        return before, arguments

    def build(self, body: list[AST], returns: list[str]) -> Derivative:
        """The function with its table."""
        tree = function(self.title, [n for n, _, _ in self.signature], body)
        return Derivative(tree, dict(self.shadows), self.signature, returns)


def bound(targets: list[str], owner: UserFunction, what: str, arguments: list[AST]) -> AST:
    """The statement that calls one of the user's functions and binds what it returns."""
    called = call(owner.own.name(what), *arguments)
    if not targets:
        return Expr(called)
    single = len(targets) == 1 and not owner.own.texts[what].packs()
    return assign(targets[0] if single else tuple_of(*map(name, targets)), called)


def user_adjoint(owner: UserFunction, request: DerivativeRequest, title: str) -> Derivative:
    """The adjoint that calls the user's, or the second half of a pair; what the first half kept is its last
    parameter."""
    what = owner.half("adjoint")
    wrapper = UserFunctionWrapper(owner, request, title, "bar")
    wrapper.add_seeds()
    kept = ""
    if what == "reverse":
        kept = wrapper.free.fresh("kept")
        wrapper.signature.append((kept, "kept", kept))
    before, arguments = wrapper.arguments(what, kept)
    bars = [wrapper.shadows[n] for n in owner.numbers]
    first = bound(bars, owner, what, arguments)
    returned = [n for n in request.wrt if n in owner.numbers]
    last: list[AST] = [Return(tuple_of(*(name(wrapper.shadows[n]) for n in returned)))] if returned else []
    return wrapper.build([*before, first, *last], returned)


def user_forward(owner: UserFunction, title: str) -> FunctionDef:
    """The first half of a pair: what the function returns, one by one, and what is kept."""
    parameters = list(owner.types)
    called = call(owner.own.name("forward"), *(name(p) for _, p in owner.own.roles["forward"]))
    if len(owner.results) < 2:
        return function(title, parameters, [Return(called)])
    free = Names(parameters)
    results = [free.fresh("result") for _ in owner.results]
    kept = free.fresh("kept")
    first = assign(tuple_of(tuple_of(*map(name, results)), name(kept)), called)
    return function(title, parameters, [first, Return(tuple_of(*map(name, results), name(kept)))])


def user_tangent(owner: UserFunction, request: DerivativeRequest, title: str) -> Derivative:
    """The tangent that calls the user's: results and tangents side by side."""
    wrapper = UserFunctionWrapper(owner, request, title, "dot")
    before, arguments = wrapper.arguments("tangent")
    results = [wrapper.free.fresh("result") for _ in owner.results]
    dots = {k: wrapper.free.fresh("result_dot") for k in owner.floats}
    first = bound([*results, *dots.values()], owner, "tangent", arguments)
    returned = [o for o in request.of if o.startswith("return ")]
    values = [*results, *(dots[int(o.split()[1])] for o in returned)]
    last: list[AST] = [Return(tuple_of(*map(name, values)))] if values else []
    return wrapper.build([*before, first, *last], ["result", *returned])
