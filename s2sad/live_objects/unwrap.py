"""The plain Python function behind a callable, and the arguments that are bound to it already.

    differentiate(f), njit(f)        f
    model.loss                       Model.loss, self bound
    model, whose class has __call__  Model.__call__, self bound
    functools.partial(f, k=2.0)      f, k bound
    f(g, u), of a function g         f, g bound

A partial application is a function of the parameters that are left, for which it is differentiated. The names of the
others have, in the function's text, the bound values.
"""
from __future__ import annotations

import functools
import inspect
from collections.abc import Callable, Collection, Mapping, Sequence
from types import CodeType, FunctionType, MethodType
from typing import Any

from s2sad.live_objects.guards import ABSENT, STEPS, class_attribute, reached, taken
from s2sad.live_objects.side_table import looked_up, side_table

STEPS["function"] = lambda value: lambda *_: named_function(value)
STEPS["kernel"] = lambda function: lambda *_: partial_application(function)[0]
STEPS["given"] = lambda function: partial_application(function)[1].get
STEPS["bound"] = lambda holder: lambda key, _: bound(holder, key)
_KEPT = 16                              # how many methods and partials of one function are remembered
_LIBRARIES = ("builtins", "functools", "numpy", "numba", "scipy", "s2sad")


class CalledDerivative:
    """A derivative that is called as its function is, by a kernel, too: which one it is (`path`), with respect to which
    names or positions."""
    path = ""
    names: tuple[Any, ...] | None = None
    __wrapped__: Any = None


def python_function(value: Any) -> FunctionType | None:
    """The plain function behind a differentiated one, a Numba dispatcher, a method, a partial or an object that is
    called; None for anything else."""
    found = named_function(value)
    if found is not None:
        return found
    method = _method(value)
    return None if method is None else _partially_applied(method, value)


def named_function(value: Any) -> FunctionType | None:
    """The same, but for objects that are called."""
    for _ in range(8):
        if isinstance(value, FunctionType):
            inner = getattr(value, "__wrapped_kernel__", None)
            return value if inner is None else named_function(inner)
        if isinstance(value, (MethodType, functools.partial)):
            return _partially_applied(value)
        names = ("__wrapped_kernel__", "py_func")
        value = next((getattr(value, n) for n in names if not isinstance(value, type) and hasattr(value, n)), None)
    return None


def partial_application(function: FunctionType) -> tuple[FunctionType, Mapping[str, Any]]:
    """The function whose text is read, and its bound arguments by parameter; of an object that is called what its class
    calls now."""
    kernel, names, called = looked_up(function, "given") or (function, {}, None)
    method = None if called is None else _method(called)
    made = None if method is None else _partially_applied(method)
    if made is not None:
        kernel, names = partial_application(made)
    if kernel is not function:
        reached(function, "kernel", "", kernel)
        for name, value in names.items():
            reached(function, "given", name, value)
    return kernel, names


def default_values(function: FunctionType) -> dict[str, Any]:
    """The defaults of a function's parameters now, by name: the one way to them, since each is a guard."""
    code = taken(function, "code")
    positional, count = code.co_varnames[:code.co_argcount], code.co_argcount + code.co_kwonlyargcount
    found = dict(zip(reversed(positional), reversed(taken(function, "attribute", "__defaults__") or ())))
    keywords = {n: taken(function, "keyword", n) for n in code.co_varnames[code.co_argcount:count]}
    return found | {n: v for n, v in keywords.items() if v is not ABSENT}


def bound(holder: Any, name: str) -> MethodType:
    """A method of an object or a class method of a class, as a holder has it."""
    made = holder if isinstance(holder, type) else type(holder)
    found = class_attribute(made, name)
    return MethodType(found.__func__, made) if isinstance(found, classmethod) else MethodType(found, holder)


def by_position(function: Callable[..., Any]) -> Callable[..., Any]:
    """The function, to be called with all of its arguments by position, those that it takes by keyword only, too."""
    plain = python_function(function)
    if plain is None or not plain.__code__.co_kwonlyargcount and not isinstance(function, functools.partial):
        return function
    return _called(plain, {})


def apply_functions(f: Any, args: Sequence[Any], keywords: Mapping[str, Any]
                    ) -> tuple[Any, tuple[Any, ...], dict[str, Any]]:
    """The partial application of f to those of its arguments that are functions, and the other arguments."""
    if not any(map(callable, args)) and not any(map(callable, keywords.values())):
        return f, tuple(args), dict(keywords)
    function = python_function(f)
    names = [] if function is None else list(inspect.signature(function).parameters)
    found = {n: v for n, v in [*zip(names, args), *keywords.items()] if n in names and _is_function(v)}
    if not found:
        return f, tuple(args), dict(keywords)
    left = [a for k, a in enumerate(args) if k >= len(names) or names[k] not in found]
    return functools.partial(f, **found), tuple(left), {n: v for n, v in keywords.items() if n not in found}


def _is_function(value: Any) -> bool:
    """Whether a value is a function, of a user's or of a library's: no class, and no object that has fields."""
    return callable(value) and not isinstance(value, type) and (
        named_function(value) is not None or type(value).__module__.partition(".")[0] in _LIBRARIES)


def _method(value: Any) -> MethodType | None:
    """What is called where an object of a user's class is called."""
    home = str(getattr(type(value), "__module__", "")).partition(".")[0]
    if isinstance(value, type) or home in _LIBRARIES:
        return None
    called = class_attribute(taken(value, "class"), "__call__")
    return MethodType(called, value) if isinstance(called, FunctionType) else None


def _partially_applied(value: MethodType | functools.partial, called: Any = None) -> FunctionType | None:
    """A function of the arguments that a method or partial leaves; the same one for the same method or partial.
    `called` is the object that is called, if that is how the method was found."""
    inner = value.__func__ if isinstance(value, MethodType) else value.func
    args = (value.__self__,) if isinstance(value, MethodType) else value.args
    keywords = {} if isinstance(value, MethodType) else {
        name: taken(value.keywords, "item", name) for name in _keys(value)}
    function = named_function(inner)
    if function is None:
        return None
    args = (*args, called)
    kept: list[tuple[tuple[Any, ...], dict[str, Any], FunctionType]] = side_table(function).setdefault("bound", [])
    for known, others, made in kept:
        if _same(known, args) and list(others) == list(keywords) and _same(others.values(), keywords.values()):
            return made
    try:
        names = inspect.signature(function).bind_partial(*args[:-1], **keywords).arguments
    except TypeError:
        return None
    kernel, before = partial_application(function)
    made = _called(function, names, called)
    side_table(made)["given"] = kernel, {**before, **names}, called
    kept[:] = [*kept[-_KEPT + 1:], (args, dict(keywords), made)]
    return made


def _keys(value: functools.partial) -> tuple[str, ...]:
    reached(value, "part", "keywords", value.keywords)
    return taken(value.keywords, "keys")


def _same(ours: Collection[Any], theirs: Collection[Any]) -> bool:
    return len(ours) == len(theirs) and all(a is b for a, b in zip(ours, theirs))


def _called(function: FunctionType, named: Mapping[str, Any], called: Any = None) -> FunctionType:
    """A function of the parameters that are left, all of which it takes by position or by name; of an object that is
    called, which knows what its class calls now."""
    whole = inspect.signature(function)
    left = [p for p in whole.parameters.values() if p.name not in named]

    def call(*rest: Any, **others: Any) -> Any:
        if len(rest) > len(left):
            raise TypeError(f"{function.__name__}() takes {len(left)} more arguments but {len(rest)} were given")
        values = {**named, **{p.name: value for p, value in zip(left, rest)}, **others}
        if called is not None:
            return called(*rest, **others)
        bound = inspect.BoundArguments(whole, values)  # pyright: ignore[reportArgumentType]
        return function(*bound.args, **bound.kwargs)

    call.__name__, call.__qualname__, call.__module__ = function.__name__, function.__qualname__, function.__module__
    vars(call)["__signature__"] = inspect.Signature(left)
    return call


def fingerprint(value: Any) -> Any:
    """What two equal codes or constants share; places are left out, 1, 1.0 and True are three things."""
    if isinstance(value, CodeType):
        return (value.co_code, value.co_names, value.co_varnames, value.co_freevars, value.co_cellvars, value.co_flags,
                value.co_argcount, value.co_posonlyargcount, value.co_kwonlyargcount,
                tuple(map(fingerprint, value.co_consts)))
    if isinstance(value, tuple):
        return ("tuple", *map(fingerprint, value))
    if isinstance(value, frozenset):
        return ("frozenset", *sorted(map(repr, value)))
    return type(value).__name__, repr(value)
