"""A user's own derivative, for a function that s2sad cannot or should not read."""
from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from typing import Any, TypeVar, overload

from s2sad.custom.user_adjoints import UserDerivative, written_parameters
from s2sad.diagnostics import Diagnostic, S2sadError
from s2sad.custom.partials import Partials, dotted
from s2sad.read.capture import capture
from s2sad.live_objects.unwrap import python_function
from s2sad.live_objects.registry import GIVEN, ROOM, RegisteredRule, imported
from s2sad.rules.rule import TABLE, Rule, divides, number
from s2sad.run.tracebacks import public
from s2sad.tree import Call, Name, expression, names

__all__ = ["nondifferentiable", "rule"]

_RESULTS = ("float", "int", "bool")


F = TypeVar("F", bound=Callable[..., Any])


@overload
def nondifferentiable(function: F, *, result: str = "float") -> F: ...


@overload
def nondifferentiable(function: str, *, result: str = "float") -> Callable[..., Any]: ...


@overload
def nondifferentiable(function: None = None, *, result: str = "float") -> Callable[[F], F]: ...


@public
def nondifferentiable(function: Any = None, *, result: str = "float") -> Any:
    """The function, from now on called as it is by derivatives, and held fixed: what it returns has derivative zero.

    Args: function, a callable or its dotted name; result, "float", "int" or "bool": it returns one number, whatever
    its arguments are. It must give the same number for the same arguments and write none of them: a derivative may call
    it again, or not at all. Also a decorator, `@nondifferentiable` or `@nondifferentiable(result="int")`.
    Generated files import it, so it needs a name in a module; under Numba it is compiled.
    Raises S2sadError: S302 if it cannot be imported by name; later, where it is called, S407 if Numba cannot compile
    it, which `engine="numpy"` does not ask for.

    >>> import math, s2sad
    >>> s2sad.nondifferentiable("textwrap.indent") is __import__("textwrap").indent
    True
    """
    if result not in _RESULTS:
        raise _wrong(f"nondifferentiable: result={result!r} is none of {', '.join(_RESULTS)}")
    if function is None:
        return lambda f: nondifferentiable(f, result=result)
    path, value = _named(function)
    stored = _first_written(value)
    if stored:
        raise _wrong(f"nondifferentiable: '{path}' writes its argument '{stored}'", "write it without, "
                     "`u = u + 1.0` in place of `u += 1.0`")
    _add(path, value, result)
    return value


@overload
def rule(text: F, *, adjoint: Any = None, tangent: Any = None, forward: Any = None, reverse: Any = None,
         implicit: Any = None, solver: Any = None, writes: Any = None, returns: int | None = None) -> F: ...


@overload
def rule(text: str, *, adjoint: Any = None, tangent: Any = None, forward: Any = None, reverse: Any = None,
         implicit: Any = None, solver: Any = None, writes: Any = None, returns: int | None = None,
         domain: Mapping[str, tuple[float, float]] | None = None, singular: tuple[str, ...] | None = None,
         kink: str = "", check: bool = True, **partials: str) -> Callable[..., Any]: ...


@overload
def rule(text: None = None, *, adjoint: Any = None, tangent: Any = None, forward: Any = None, reverse: Any = None,
         implicit: Any = None, solver: Any = None, writes: Any = None, returns: int | None = None,
         domain: Mapping[str, tuple[float, float]] | None = None, singular: tuple[str, ...] | None = None,
         kink: str = "", check: bool = True, **partials: str) -> Callable[[F], F]: ...


@public
def rule(text: Any = None, *, adjoint: Any = None, tangent: Any = None, forward: Any = None, reverse: Any = None,
         implicit: Any = None, solver: Any = None, writes: Any = None, returns: int | None = None,
         domain: Mapping[str, tuple[float, float]] | None = None,
         singular: tuple[str, ...] | None = None, kink: str = "", check: bool = True, **partials: str) -> Any:
    """Gives a function a derivative of the user's own, in one of four ways.

    **Partials**, of a function of numbers: expressions over its parameters and `y`, the result.
    `rule("scipy.special.erf(x)", x="2 / math.sqrt(math.pi) * math.exp(-x * x)")`, or as a decorator above a function's
    definition, `@rule(x="...", a="...")`; it then gives the function back, else the function that the name means. The
    function takes floats and returns one float; a kernel may call it with arrays where it works number by number.
    domain, (low, high) for each parameter, where the partials are compared with differences ((-2, 2) where
    nothing is said); check, False if a partial is not the derivative, on purpose; singular, the parameters whose
    partial can be infinite, so that a zero seed contributes zero (default: those that divide by more than a number);
    kink, what `explain` says where it is not smooth.
    A partial may call functions of numpy and math, others by their dotted name, and functions of the module of the
    function. Parameters cannot be called as these arguments are, nor `y`.

    **An adjoint**, of a function that may write its arrays: `@rule(adjoint=f_adjoint)`, `rule(f, adjoint=f_adjoint)`.
    It takes the parameters of f by their names and in their order, each float array followed by its shadow (`u_bar`),
    and then the seed of each float result: `result_bar`, or of several `result_0_bar`, `result_1_bar`, ... by their
    number. On entry a shadow holds the adjoint of what f leaves in the array, on exit of what f found there; arrays
    hold what f found, and the adjoint may write those that f writes. It returns the adjoints of f's float numbers, in
    order: nothing, a number, or a tuple. `tangent=f_tangent` is called in place of f: `u_dot` follows every float,
    numbers too, and it returns what f returns and then the tangents of the float results.

    **In two halves**, `forward=` and `reverse=`: the first takes f's parameters, does what f does, and returns (what f
    returns, kept), or kept alone where f returns nothing; the second is an adjoint that takes kept before all else.
    What is kept may be a number, an array, or a tuple of such, for NumPy anything; not an argument itself.

    **A residual** that f makes zero, `implicit=residual`: of f(x0, p), which returns a number x, residual(x, p) returns
    a float; of f(x, p), which solves for the array x in place, residual(r, x, p) fills r. Its other parameters are f's,
    by name; what f takes beside them has no influence. The derivative is one linear solve at what f found. solver:
    "dense", which makes the matrix; "cg", for symmetric positive definite ones, and "gmres", without a matrix; or a
    function solver(product, b, operands) that returns x with product(x, operands) equal to b.

    f itself is read like any other function, unless writes= (the parameters that it writes) or returns= (how many
    floats) are given: then it is called as it is. It must give the same for the same arguments.
    Raises S2sadError: S302 for a function that cannot be imported, for names that are unknown or missing, and for
    values that differences contradict; where it is called S301, for what its derivative does not give, and S407, if
    Numba cannot compile it.

    >>> import sys, numpy as np, s2sad
    >>> def energy_adjoint(u, u_bar, k, result_bar):
    ...     u_bar += k * u * result_bar
    ...     return 0.5 * np.sum(u * u) * result_bar
    >>> @s2sad.rule(adjoint=energy_adjoint)
    ... def energy(u, k):
    ...     return 0.5 * k * np.sum(u * u)
    >>> sys.modules[__name__].energy_adjoint = energy_adjoint    # where a generated file imports it from
    >>> found = s2sad.gradient(s2sad.differentiate(energy, engine="numpy"))(np.array([1.0, 2.0]), 3.0)
    >>> found["u"].tolist(), found["k"]
    ([3.0, 6.0], 2.5)
    """
    own = {"adjoint": adjoint, "tangent": tangent, "forward": forward, "reverse": reverse, "implicit": implicit,
           "solver": solver}
    given = [what for what, value in own.items() if value is not None]
    keywords = {"domain": domain, "singular": singular, "kink": kink, "check": check}
    if given and (partials or domain or singular or kink or not check):
        raise _wrong(f"rule: {given[0]}= does not go together with partials", "give one of them")
    if given:
        unread = {"writes": writes, "returns": returns}
        return _owned(text, own, unread) if text is not None else lambda f: _owned(f, own, unread)
    if text is None:
        return lambda f: _ruled(*_named(f), _parameters(f), partials, **keywords)
    try:
        node = expression(text)
    except SyntaxError:
        node = None
    path = dotted(node.func) if isinstance(node, Call) else ""
    operands = node.args if isinstance(node, Call) and not node.keywords else []
    parameters = tuple(a.id for a in operands if isinstance(a, Name))
    if "." not in path or not operands or len(set(parameters)) != len(operands) or "y" in parameters:
        raise _wrong(f"rule: {text!r} is not a function's dotted name with its parameters",
                     "write \"scipy.special.erf(x)\", with different names, and not y, which is the result")
    return _ruled(path, _named(path)[1], parameters, partials, **keywords)


def _owned(function: Any, own: dict[str, Any], unread: dict[str, Any]) -> Any:
    """Registers a derivative of its own for a function that is read, or that is called as it is."""
    value = _named(function)[1] if isinstance(function, str) else function
    plain = python_function(value)
    if plain is None:
        raise _wrong(f"rule: a Python function is needed, not {value!r}", "wrap it in one")
    path = f"{plain.__module__}.{plain.__qualname__}"
    found = UserDerivative(path, plain, _named).derivative(own, **unread)
    TABLE.set_user_rule(ROOM + path, None)
    GIVEN.add(RegisteredRule(path, value, plain, False, own=found))
    return value


def _ruled(path: str, function: Any, parameters: tuple[str, ...], partials: Mapping[str, str], *,
           domain: Mapping[str, tuple[float, float]] | None, singular: tuple[str, ...] | None,
           kink: str, check: bool) -> Any:
    for what, given in (("a partial", partials), ("a domain", domain or {}), ("singular", singular or ())):
        unknown = [p for p in given if p not in parameters]
        if unknown:
            raise _wrong(f"rule for '{path}': {what} is given for {', '.join(unknown)}, which is no parameter of it",
                         f"its parameters are {', '.join(parameters)}")
    missing = [p for p in parameters if p not in partials]
    if missing:
        raise _wrong(f"rule for '{path}': no partial is given for {', '.join(missing)}",
                     f"write {missing[0]}=\"0.0\" if the derivative is zero")
    read = Partials(path, function, parameters, partials)
    if check:
        read.compare(domain or {})
    reads = {p: set(names(t)) for p, t in read.trees.items()}
    if singular is None:
        singular = tuple(p for p, t in read.trees.items() if divides(t))
    found = Rule(ROOM + path, parameters, read.trees, singular=frozenset(singular), domain=dict(domain or {}),
                 kink=kink, linear=frozenset(p for p in parameters if not reads[p] & {p, "y"}),
                 zero=frozenset(p for p in parameters if number(read.trees[p]) == 0))
    helpers = tuple(GIVEN.by_path.get(p) or GIVEN.add(_registered_rule(p, f, False)) for p, f in read.called.items())
    _add(path, function, found, helpers)
    return function


def _parameters(function: Any) -> tuple[str, ...]:
    """The parameters of a function that is decorated: positional ones without a default."""
    given = inspect.signature(python_function(function) or function).parameters.values()
    wrong = [p.name for p in given if p.kind is not p.POSITIONAL_OR_KEYWORD or p.default is not p.empty]
    if wrong:
        raise _wrong(f"rule for '{function.__name__}': the parameter '{wrong[0]}' has a default or is not positional",
                     "take plain positional parameters")
    return tuple(p.name for p in given)


def _named(function: Any) -> tuple[str, Any]:
    """The dotted path of a function, and the function; of a path what it leads to."""
    if isinstance(function, str):
        value = imported(function)
        if not callable(value):
            raise _wrong(f"there is no function '{function}'", "write the name by which it can be imported")
        return function, value
    if not callable(function):
        raise _wrong(f"a function is needed, not {function!r}", "give a function, or its dotted name")
    module, name = getattr(function, "__module__", None), getattr(function, "__qualname__", None)
    if module is None or name is None:
        raise _wrong(f"the module of {function!r} is not known", "give its dotted name, as \"scipy.special.erf\"")
    if not name.isidentifier():
        raise _wrong(f"'{name}' cannot be imported by name", "define it with def at module level")
    return f"{module}.{name}", function


def _first_written(function: Any) -> str | None:
    """A parameter that a function's text writes in place; None if there is none, or no text."""
    try:
        return next(iter(written_parameters(capture(function).tree)), None)
    except S2sadError:
        return None


def _registered_rule(path: str, function: Any, ruled: bool, reads: tuple[RegisteredRule, ...] = ()) -> RegisteredRule:
    return RegisteredRule(path, function, python_function(function) or function, ruled, reads)


def _add(path: str, function: Any, found: Rule | str, reads: tuple[RegisteredRule, ...] = ()) -> None:
    TABLE.set_user_rule(ROOM + path, found)
    GIVEN.add(_registered_rule(path, function, True, reads))


def _wrong(message: str, help: str = "") -> S2sadError:
    return S2sadError(Diagnostic("S302", message, help=help))


